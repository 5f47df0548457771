// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the errors of a navigator grow: x' = F x, n = north-east-down.
///
///   x = (phi, dv, dr, b_g, b_a);  true C_nb = Exp(phi) C_nb;  dv, dr = navigated minus true, dr in metres N, E, D
///   phi' = -w_in x phi + dw_in - C_nb b_g                                                         ... (1)
///   dv'  = f_n x phi + C_nb b_a - (2 w_ie + w_en) x dv - (2 dw_ie + dw_en) x v + dg               ... (2)
///   dr'  = dv + (what the ellipsoid makes of dr at v)                                             ... (3)
///
/// b_g, b_a [rad/s, m/s^2]: navigated input minus true input, constant here. Groves, 2nd ed., sec. 14.2.4, in metres;
/// Titterton & Weston, 2nd ed., eq. (12.28). Not for a pole: use a navigator there.

#pragma once

#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion {

enum ErrorState : Eigen::Index { kPhi = 0, kVelocityError = 3, kPositionError = 6, kGyroBias = 9, kAccelBias = 12 };

template <class T>
using ErrorMatrix = Eigen::Matrix<T, 15, 15>;

/// F of (1)-(3). @param f_n specific force in n [m/s^2]
template <class T>
ErrorMatrix<T> error_dynamics(const NavigationState<T>& state, const Vec3<T>& f_n) {
  using std::cos;
  using std::sin;
  const T sl = sin(state.latitude);
  const T cl = cos(state.latitude);
  const T tl = sl / cl;
  const Ellipsoid<T> ellipsoid(sl * sl);
  const T north = T(1) / (ellipsoid.north_radius + state.height);
  const T east = T(1) / (ellipsoid.east_radius + state.height);
  const Vec3<T>& v = state.velocity;
  const Vec3<T> w_ie(T(kEarthRate) * cl, T(0), T(-kEarthRate) * sl);
  const Vec3<T> w_en(east * v.y(), -north * v.x(), -east * tl * v.y());

  // dw_ie = A dr, dw_en = B dr + D dv
  Mat3<T> A = Mat3<T>::Zero();
  A(0, 0) = T(-kEarthRate) * sl * north;
  A(2, 0) = T(-kEarthRate) * cl * north;
  Mat3<T> B = Mat3<T>::Zero();
  B(0, 2) = east * w_en.x();
  B(1, 2) = north * w_en.y();
  B(2, 2) = east * w_en.z();
  B(2, 0) = -v.y() * east * north / (cl * cl);
  Mat3<T> D = Mat3<T>::Zero();
  D(0, 1) = east;
  D(1, 0) = -north;
  D(2, 1) = -east * tl;

  ErrorMatrix<T> F = ErrorMatrix<T>::Zero();
  const Mat3<T> C_nb = state.attitude.toRotationMatrix();
  F.template block<3, 3>(kPhi, kPhi) = -skew<T>(w_ie + w_en);
  F.template block<3, 3>(kPhi, kVelocityError) = D;
  F.template block<3, 3>(kPhi, kPositionError) = A + B;
  F.template block<3, 3>(kPhi, kGyroBias) = -C_nb;

  const Mat3<T> V = skew<T>(v);
  F.template block<3, 3>(kVelocityError, kPhi) = skew<T>(f_n);
  F.template block<3, 3>(kVelocityError, kVelocityError) = V * D - skew<T>(T(2) * w_ie + w_en);
  F.template block<3, 3>(kVelocityError, kPositionError) = V * (T(2) * A + B);
  // gravity over height and latitude, as the navigator has it
  const T step(1);
  const T below = ellipsoid.gravity_excess(state.height - step);
  const T above = ellipsoid.gravity_excess(state.height + step);
  F(kVelocityError + 2, kPositionError + 2) += (below - above) / (T(2) * step);
  constexpr double kLatitudeGradient = 0.0053 * kEquatorGravity;  // of gamma over sin^2 L: k + e^2 / 2
  F(kVelocityError + 2, kPositionError) += T(2.0 * kLatitudeGradient) * sl * cl * north;
  F.template block<3, 3>(kVelocityError, kAccelBias) = C_nb;

  F.template block<3, 3>(kPositionError, kVelocityError).setIdentity();
  F(kPositionError, kPositionError) = -north * v.z();
  F(kPositionError, kPositionError + 2) = north * v.x();
  F(kPositionError + 1, kPositionError) = north * tl * v.y();
  F(kPositionError + 1, kPositionError + 1) = -east * v.z() - north * tl * v.x();
  F(kPositionError + 1, kPositionError + 2) = east * v.y();
  return F;
}

/// P after @p dt [s]: Phi P Phi^T + Q dt, Phi = I + F dt + (F dt)^2 / 2. @param density of the noise that drives each
/// state, per second: gyro and accelerometer white noise squared in phi and dv
template <class T>
ErrorMatrix<T> propagate_covariance(const ErrorMatrix<T>& P, const ErrorMatrix<T>& F,
                                    const Eigen::Matrix<T, 15, 1>& density, const T& dt) {
  ErrorMatrix<T> Phi = F * dt;
  Phi = (ErrorMatrix<T>::Identity() + Phi + T(0.5) * Phi * Phi).eval();
  ErrorMatrix<T> next = Phi * P * Phi.transpose();
  next.diagonal() += density * dt;
  return T(0.5) * (next + next.transpose());
}

}  // namespace trunnion
