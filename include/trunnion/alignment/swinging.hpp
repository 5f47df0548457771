// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitude of a unit on a base that swings about a point: gravity, seen from inertial space, goes round with the
/// Earth.
///
/// Frame i0 stands still in inertial space, its z the Earth's axis, its x in the meridian of the start; b0 is the body
/// of the start, held by the gyros. The specific force, integrated in each, is the same vector:
///
///   V_b0(t) = integral C_b0b f dt,   V_i0(t) = g (cos L sin Wt / W, cos L (1 - cos Wt) / W, t sin L)       ... (1)
///   C_i0b0 from two such pairs, half way and at the end (TRIAD);  C_nb = C_ni0(t) C_i0b0 C_b0b(t)         ... (2)
///
/// Swinging cancels in (1) as the integral of its acceleration: the velocity of the swing over g t is what it costs, so
/// a minute or more. Gade & Jalving, J. Navigation 51 (1998); Yan, Weng, Bai & Qin, Systems Eng. Electronics 30 (2008);
/// docs/theory/alignment.md.

#pragma once

#include <array>
#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/strapdown/body_motion.hpp"

namespace trunnion {

template <class T>
class SwingingAlignment {
 public:
  /// @param latitude geodetic [rad]; @param duration of the alignment [s]; @param period of a sample [s]
  SwingingAlignment(const T& latitude, const T& duration, const T& period)
      : latitude_(latitude), period_(period), middle_(duration / T(2)) {}

  /// Takes the next sample. @return kOutOfRange, and nothing changed, for a sample that is not finite
  Status add(const Increment<T>& sample) {
    const T sum = sample.angle.sum() + sample.velocity.sum();
    if (!(sum - sum == T(0))) return Status::kOutOfRange;
    const std::array<Increment<T>, 1> samples = {sample};
    const BodyMotion<T> motion = algorithm_(samples);
    velocity_ += q_b0b_ * motion.velocity;
    const Vec3<T>& v = motion.rotation_v;
    q_b0b_ = (q_b0b_ * Quaternion<T>(T(1) + motion.rotation_w, v.x(), v.y(), v.z())).normalized();
    time_ += period_;
    if (time_ <= middle_) {
      velocity_middle_ = velocity_;
      time_middle_ = time_;
    }
    return Status::kOk;
  }

  /// q_nb at the last sample, eq. (2). @return kNotObservable before nine tenths of the duration or a tenth of a minute
  /// have passed, or near a pole
  [[nodiscard]] Result<Quaternion<T>> attitude() const {
    using std::cos;
    using std::sin;
    if (!(time_ > T(6)) || !(time_ > T(1.8) * middle_) || !(cos(latitude_) > T(0.02))) return Status::kNotObservable;
    const Mat3<T> seen = triad(velocity_middle_, velocity_);
    const Mat3<T> expected = triad(expected_velocity(time_middle_), expected_velocity(time_));
    const Mat3<T> C_i0b0 = expected * seen.transpose();
    const T turn = T(kEarthRate) * time_;
    const T s = sin(latitude_);
    const T c = cos(latitude_);
    Mat3<T> C_ni0;
    C_ni0 << -s * cos(turn), -s * sin(turn), c, -sin(turn), cos(turn), T(0), -c * cos(turn), -c * sin(turn), -s;
    return (Quaternion<T>(Mat3<T>(C_ni0 * C_i0b0)) * q_b0b_).normalized();
  }

  /// What the heading may be off by [rad]: the angle between the two directions of gravity is to be that of eq. (1),
  /// and a gyro bias that changes it turns the heading by as much of it. One of two components: a hint, no sigma.
  [[nodiscard]] T heading_doubt() const {
    using std::abs;
    const T expected = angle(expected_velocity(time_middle_), expected_velocity(time_));
    return expected > T(0) ? abs(angle(velocity_middle_, velocity_) - expected) / expected : T(0);
  }

 private:
  static T angle(const Vec3<T>& a, const Vec3<T>& b) {
    using std::atan2;
    return atan2(a.cross(b).norm(), a.dot(b));
  }
  /// Direction of V_i0, eq. (1).
  Vec3<T> expected_velocity(const T& t) const {
    using std::cos;
    using std::sin;
    const T w = T(kEarthRate);
    const T half = sin(w * t / T(2));
    return Vec3<T>(cos(latitude_) * sin(w * t) / w, cos(latitude_) * T(2) * half * half / w, t * sin(latitude_));
  }
  static Mat3<T> triad(const Vec3<T>& first, const Vec3<T>& second) {
    Mat3<T> axes;
    axes.col(0) = second.normalized();
    axes.col(1) = second.cross(first).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  }

  T latitude_;
  T period_;
  T middle_;
  T time_ = T(0);
  T time_middle_ = T(0);
  PreviousSample<T> algorithm_;
  Quaternion<T> q_b0b_ = Quaternion<T>::Identity();
  Vec3<T> velocity_ = Vec3<T>::Zero();
  Vec3<T> velocity_middle_ = Vec3<T>::Zero();
};

}  // namespace trunnion
