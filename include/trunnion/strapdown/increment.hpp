// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What an inertial unit delivers and what a strapdown algorithm makes of it.

#pragma once

#include "trunnion/core/linear.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

/// Integrals of w_ib_b and f_b over one sample. A stamp is that of the *end* of the sample.
template <class T>
struct Increment {
  Vec3<T> angle = Vec3<T>::Zero();     ///< rad
  Vec3<T> velocity = Vec3<T>::Zero();  ///< m/s
};

/// Increments of a unit that delivers means: @p mean rate [rad/s] and specific force [m/s^2] over the @p period [s]
/// that ends at the stamp.
template <class T>
Increment<T> increment_of(const InertialSample<T>& mean, const T& period) {
  return {mean.w * period, mean.f * period};
}

/// The motion of the case over one update, seen from where it started.
template <class T>
struct BodyMotion {
  T rotation_w = T(0);                   ///< scalar part of the rotation's quaternion, minus one
  Vec3<T> rotation_v = Vec3<T>::Zero();  ///< its vector part: start_from_end
  Vec3<T> velocity = Vec3<T>::Zero();    ///< integral of C_start_b f_b [m/s]
};

}  // namespace trunnion
