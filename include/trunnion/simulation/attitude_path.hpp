// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A body that turns at rates written as functions of time; and the motions at which the interferometer is tried.
///
///   q <- q Exp(h/2 (w_1 + w_2) + sqrt(3) h^2 / 12 w_1 x w_2),   w_i = w(t + (1/2 -+ sqrt(3)/6) h)         ... (1)
///
/// The paper's rates are lost: these are stand-ins for its examples, named as such. (1): the Magnus expansion of fourth
/// order, Iserles & Norsett, Phil. Trans. R. Soc. A 357 (1999), 983; its sign is that of rates in the body.

#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "trunnion/core/rotation.hpp"

namespace trunnion::simulation {

/// w_nb_b [rad/s] at t [s].
using RatePath = std::function<Vec3<double>(double)>;

class AttitudePath {
 public:
  /// @param start q_nb at t = 0; @param duration [s], beyond which the last attitude stays
  AttitudePath(RatePath rate, const Quaternion<double>& start, double duration);

  [[nodiscard]] Quaternion<double> q_nb(double t) const;
  [[nodiscard]] Vec3<double> rate(double t) const { return rate_(t); }
  [[nodiscard]] double duration() const;

 private:
  [[nodiscard]] Quaternion<double> step(const Quaternion<double>& q, double from, double to) const;

  RatePath rate_;
  std::vector<Quaternion<double>> knots_;
};

/// Stand-ins for example 1, a platform that turns: each of the rates is a sine of its own.
enum class PlatformMotion { kSlow, kMedium, kFast };
/// Start at roll 5, pitch 3, yaw 30 deg; up to 0.9, 5 and 20 deg/s.
AttitudePath example_1_stand_in(PlatformMotion motion, double duration);

/// Stand-in for example 2, 110 s of flight: level, a climb at 10 deg, level, two turns by 90 deg banked by -15 deg.
AttitudePath example_2_stand_in();

}  // namespace trunnion::simulation
