// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Deterministic errors of three orthogonal sensors of one kind.
///
///   measured = (I + M) u + b + n(u),   n(u) = A |u| / 2 + Q u^o2 + N u^o3          ... (1)
///   u        = (I + M)^-1 (measured - b - n(u))                                    ... (2)  solved by iteration
///   I + M    = (I + S) T R                                                         ... (3)
///
/// u: the true angular rate w_ib_b [rad/s] or specific force f_b [m/s^2]. b: bias [unit of u]. M: scale errors on the
/// diagonal [-], cross-coupling off it [rad]. A: asymmetry, the scale of positive inputs less that of negative ones
/// over their mean [-] (IEEE Std 528); Q [1/u], N [1/u^2]: second- and third-order scale-factor nonlinearity; one
/// coefficient an axis, |.|, ^o2 and ^o3 are element by element. S: scale; T: non-orthogonality, lower triangular with
/// rows of unit length; R: rotation from the case to the first sensitive axis and the plane of the first two.
/// Zero parameters are the perfect instrument. IEEE Std 1554-2005, 1293-2018; docs/theory/calibration.md, eq. 1-3.

#pragma once

#include <cmath>

#include "trunnion/core/linear.hpp"
#include "trunnion/core/rotation.hpp"

namespace trunnion {

/// The parts of eq. (3).
template <class T>
struct TriadGeometry {
  Vec3<T> scale = Vec3<T>::Zero();  ///< S, relative [-]
  Mat3<T> nonorthogonality =
      Mat3<T>::Zero();                     ///< T - I, strictly the lower triangle and what unit rows make of it [rad]
  Vec3<T> installation = Vec3<T>::Zero();  ///< rotation vector of R [rad]
};

template <class T>
struct Triad {
  /// Steps of the fixed-point iteration of eq. (2). With a nonlinearity of e of full scale, k steps leave about
  /// e (3 e)^k of full scale: two leave 1e-11 for 100 ppm and 1e-8 for 1000 ppm.
  static constexpr int kCorrectionSteps = 2;

  Vec3<T> bias = Vec3<T>::Zero();
  Mat3<T> M = Mat3<T>::Zero();
  Vec3<T> asymmetry = Vec3<T>::Zero();
  Vec3<T> quadratic = Vec3<T>::Zero();
  Vec3<T> cubic = Vec3<T>::Zero();

  /// I + M, what the file format calls the matrix.
  [[nodiscard]] Mat3<T> matrix() const { return Mat3<T>::Identity() + M; }

  /// n(u) of eq. (1).
  [[nodiscard]] Vec3<T> nonlinearity(const Vec3<T>& u) const {
    return (T(0.5) * u.array().abs() * asymmetry.array() +
            u.array() * u.array() * (quadratic.array() + cubic.array() * u.array()))
        .matrix();
  }

  [[nodiscard]] bool is_linear() const {
    return asymmetry.isZero(T(0)) && quadratic.isZero(T(0)) && cubic.isZero(T(0));
  }

  /// Whether eq. (2) can be relied on for what came out as @p u: each slope of n there is below a half. False for
  /// what is not finite.
  [[nodiscard]] bool converges_at(const Vec3<T>& u) const {
    const auto size = u.array().abs();
    const auto slope =
        T(0.5) * asymmetry.array().abs() + size * (T(2) * quadratic.array().abs() + T(3) * cubic.array().abs() * size);
    return (slope < T(0.5)).all();
  }

  /// What the sensors read for the true input @p u, eq. (1).
  [[nodiscard]] Vec3<T> distort(const Vec3<T>& u) const { return u + M * u + bias + nonlinearity(u); }

  /// The true input for what the sensors read, eq. (2). @p inverse is matrix().inverse(): compute it once.
  [[nodiscard]] Vec3<T> correct(const Vec3<T>& measured, const Mat3<T>& inverse) const {
    const Vec3<T> unbiased = measured - bias;
    Vec3<T> u = inverse * unbiased;
    if (is_linear()) return u;
    for (int step = 0; step < kCorrectionSteps; ++step) u = inverse * (unbiased - nonlinearity(u));
    return u;
  }

  /// Splits I + M by eq. (3): Gram-Schmidt over its rows. I + M must be near a rotation (right-handed, no row zero).
  [[nodiscard]] TriadGeometry<T> geometry() const {
    const Mat3<T> A = matrix();
    Mat3<T> R;
    R.row(0) = A.row(0).normalized();
    R.row(1) = (A.row(1) - A.row(1).dot(R.row(0)) * R.row(0)).normalized();
    R.row(2) = R.row(0).cross(R.row(1));
    const Mat3<T> L = A * R.transpose();
    TriadGeometry<T> parts;
    for (int i = 0; i < 3; ++i) {
      const T length = L.row(i).norm();
      parts.scale(i) = length - T(1);
      parts.nonorthogonality.row(i) = L.row(i) / length - Mat3<T>::Identity().row(i);
    }
    parts.installation = quaternion_log(Quaternion<T>(R));
    return parts;
  }
};

}  // namespace trunnion
