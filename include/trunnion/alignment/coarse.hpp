// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitude of a unit at rest from gravity and the Earth's rate (TRIAD), and its covariance; n = north-east-down.
///
///   d = -f / |f|,   e = d x w / |d x w|,   n = e x d,   C_nb = [n e d]^T                          ... (1)
///   phi_N = df_E / g,   phi_E = -df_N / g,   phi_D = dw_E / (W cos L) - tan L df_E / g            ... (2)
///   sin L = -d . w / |w|                                                                          ... (3)
///
/// where the true attitude is Exp(phi) q_nb and df, dw [n-components] are the errors of the means: noise *and* bias.
/// Black, AIAA J. 2 (1964), 1350; Groves, 2nd ed., sec. 5.6.2. The computation itself adds rounding only.

#pragma once

#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

/// 1 sigma of each axis of a mean over the rest: what noise leaves and what the bias may be.
template <class T>
struct MeanSigma {
  T w = T(0);  ///< rad/s
  T f = T(0);  ///< m/s^2
};

template <class T>
struct Alignment {
  Quaternion<T> q_nb = Quaternion<T>::Identity();
  Mat3<T> covariance = Mat3<T>::Zero();  ///< of phi, eq. (2) [rad^2]; the heading's is (2, 2)
};

/// Eq. (1), (2). @param mean over the rest; @param latitude geodetic [rad]
/// @return kNotObservable where the Earth's rate across gravity is within three sigmas of none: near a pole, or with
/// gyros whose bias hides it
template <class T>
Result<Alignment<T>> coarse_align(const InertialSample<T>& mean, const MeanSigma<T>& sigma, const T& latitude) {
  using std::abs;
  using std::cos;
  using std::sqrt;
  using std::tan;
  const T force = mean.f.norm();
  if (!(force > T(0)) || !(abs(latitude) <= T(1.5707963267948968))) return Status::kOutOfRange;
  const Vec3<T> down = mean.f / -force;
  const Vec3<T> across = down.cross(mean.w);
  const T rate = across.norm();
  const T horizontal = T(kEarthRate) * cos(latitude);
  if (!(rate > T(3) * sigma.w) || !(horizontal > T(3) * sigma.w)) return Status::kNotObservable;
  const Vec3<T> east = across / rate;
  Mat3<T> C_nb;
  C_nb.row(0) = east.cross(down).transpose();
  C_nb.row(1) = east.transpose();
  C_nb.row(2) = down.transpose();
  Alignment<T> alignment;
  alignment.q_nb = Quaternion<T>(C_nb).normalized();
  const T tilt = sigma.f / force;
  const T heading = sigma.w / horizontal;
  const T share = tan(latitude) * tilt;
  alignment.covariance(0, 0) = alignment.covariance(1, 1) = tilt * tilt;
  alignment.covariance(2, 2) = heading * heading + share * share;
  alignment.covariance(0, 2) = alignment.covariance(2, 0) = -tilt * share;
  return alignment;
}

template <class T>
struct LatitudeEstimate {
  T latitude = T(0);    ///< rad
  T sigma = T(0);       ///< rad
  T earth_rate = T(0);  ///< |w| [rad/s]: far from 7.292e-5, the base moves or the gyros are biased
};

/// Eq. (3). @return kNotObservable where the rate is within three sigmas of none
template <class T>
Result<LatitudeEstimate<T>> latitude_from_rest(const InertialSample<T>& mean, const MeanSigma<T>& sigma) {
  using std::atan2;
  using std::sqrt;
  const T force = mean.f.norm();
  if (!(force > T(0))) return Status::kOutOfRange;
  const Vec3<T> up = mean.f / force;
  LatitudeEstimate<T> estimate;
  estimate.earth_rate = mean.w.norm();
  if (!(estimate.earth_rate > T(3) * sigma.w)) return Status::kNotObservable;
  estimate.latitude = atan2(mean.w.dot(up), mean.w.cross(up).norm());
  const T of_rate = sigma.w / T(kEarthRate);
  const T of_force = sigma.f / force;
  estimate.sigma = sqrt(of_rate * of_rate + of_force * of_force);
  return estimate;
}

}  // namespace trunnion
