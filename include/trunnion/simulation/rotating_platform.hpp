// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a perfect unit feels on a platform that turns against its body: a modulation axis, a flip, a wheel.
///
///   C_bp = C_b0 Rn(phi),   w_p = C_bp^T w_b + phi' n,   f_p = C_bp^T f_b + w_p' x r + w_p x (w_p x r)       ... (1)
///
/// n: the axis, fixed in both frames; r: the unit's place from the axis [p]. Platforms stand on platforms. Shares
/// nothing with the demodulation: C_bp is a matrix product, w_p' a difference of w_p over 2e-5 s (1e-8 of it at 4 Hz).

#pragma once

#include <Eigen/Geometry>
#include <utility>

#include "trunnion/simulation/analytic_path.hpp"

namespace trunnion::simulation {

/// @tparam Body callable: InertialSample<long double>(long double t), what the body feels
/// @tparam Angle callable: TimeJet<long double>(long double t), phi [rad]
template <class Body, class Angle>
class RotatingPlatform {
 public:
  using T = long double;

  /// @param mounting C_b0: p's axes in b at phi = 0; @param axis n in p, unit length; @param lever_arm r [m]
  RotatingPlatform(Body body, Angle angle, const Mat3<T>& mounting, const Vec3<T>& axis, const Vec3<T>& lever_arm)
      : body_(std::move(body)), angle_(std::move(angle)), mounting_(mounting), axis_(axis), lever_arm_(lever_arm) {}

  /// Eq. (1).
  InertialSample<T> operator()(T t) const {
    InertialSample<T> unit = at_axis(t);
    if (lever_arm_.isZero()) return unit;
    constexpr T kStep = 1e-5L;
    const Vec3<T> turning = (at_axis(t + kStep).w - at_axis(t - kStep).w) / (T(2) * kStep);
    unit.f += turning.cross(lever_arm_) + unit.w.cross(unit.w.cross(lever_arm_));
    return unit;
  }

  [[nodiscard]] T angle(T t) const { return angle_(t).value; }

 private:
  InertialSample<T> at_axis(T t) const {
    const TimeJet<T> angle = angle_(t);
    const Mat3<T> C_bp = mounting_ * Eigen::AngleAxis<T>(angle.value, axis_).toRotationMatrix();
    const InertialSample<T> body = body_(t);
    return {C_bp.transpose() * body.w + angle.rate * axis_, C_bp.transpose() * body.f};
  }

  Body body_;
  Angle angle_;
  Mat3<T> mounting_;
  Vec3<T> axis_;
  Vec3<T> lever_arm_;
};

}  // namespace trunnion::simulation
