// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Motion of one table axis as a function of time: rates reached by jerk-limited ramps, moves between angles, and
/// oscillations that fade in and out.
///
///   S(u) = 10 u^3 - 15 u^4 + 6 u^5,  u in [0, 1]                                                      ... (1)
///   ramp:  rate(t) = r_0 + (r_1 - r_0) S((t - t_0) / d)          move:  angle(t) = a_0 + (a_1 - a_0) S((t - t_0) / d)
///
/// (1) has zero rate and acceleration at both ends: Flash & Hogan, J. Neurosci. 5 (1985), 1688.

#pragma once

#include <vector>

namespace trunnion::simulation {

class AxisCourse {
 public:
  explicit AxisCourse(double start_angle = 0.0) : angle_(start_angle) {}

  /// From @p t on, within @p duration, the rate becomes @p rate [rad/s]. In order of time.
  void ramp(double t, double duration, double rate);
  /// From @p t on, within @p duration, the angle moves by @p step [rad], on top of everything else.
  void move(double t, double duration, double step);
  /// Between @p from and @p to, amplitude * sin(2 pi frequency (t - from)), faded over @p fade seconds at both ends.
  void oscillate(double from, double to, double amplitude, double frequency, double fade);

  [[nodiscard]] double angle(double t) const;
  /// rad/s, the derivative of angle().
  [[nodiscard]] double rate(double t) const;

 private:
  struct Ramp {
    double t, duration, rate_before, rate_after, angle;
  };
  struct Move {
    double t, duration, step;
  };
  struct Oscillation {
    double from, to, amplitude, frequency, fade;
  };
  double angle_;
  std::vector<Ramp> ramps_;
  std::vector<Move> moves_;
  std::vector<Oscillation> oscillations_;
};

}  // namespace trunnion::simulation
