// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitude alone, for a gimbal or a stabiliser: two samples an update, coning corrected, no trigonometric function.
///
///   phi = theta_1 + theta_2 + 2/3 theta_1 x theta_2,   q <- q dq(phi),  its length brought back to one    ... (1)
///
/// q takes components of the body to those of the frame that its start named; what turns that frame (the Earth) is not
/// here. Miller, J. Guidance 6 (1983), 287. For position too: two_speed_navigator.hpp.

#pragma once

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/strapdown/body_motion.hpp"

namespace trunnion {

template <class T>
class Attitude {
 public:
  /// @param start finite and not zero; its length is made one
  explicit Attitude(const Quaternion<T>& start) : q_(kernel::normalized(kernel::quad(start))) {}

  /// @param first integral of w_ib_b over the earlier sample [rad]
  /// @param second ... over the later one
  /// @return kOutOfRange, and nothing changed, when they are not finite or turn by more than half a radian
  TRUNNION_INLINE Status add(const Vec3<T>& first, const Vec3<T>& second) {
    using namespace kernel;
    const Triple<T> theta_1 = triple(first);
    const Triple<T> theta_2 = triple(second);
    const Triple<T> phi = add_cross(theta_1 + theta_2, T(2.0 / 3.0) * theta_1, theta_2);
    const T phi2 = dot(phi, phi);
    if (!(phi2 <= T(0.25))) return Status::kOutOfRange;
    const auto factor = RotationFactors<T>::short_series(phi2);
    const T w = T(1) + (factor.w + (T(0.5) - T(0.5) * dot(q_, q_)));
    q_ = product(q_, Quad<T>{w, factor.v * phi});
    return Status::kOk;
  }

  [[nodiscard]] Quaternion<T> q() const { return kernel::quaternion(q_); }

 private:
  kernel::Quad<T> q_;
};

}  // namespace trunnion
