// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One move of a two-axis table, as a motion controller is told it.

#pragma once

#include <array>
#include <limits>

namespace trunnion {

/// What one axis does: goes to an angle, and from there on stands, turns or swings.
struct AxisCommand {
  double angle = 0.0;      ///< rad, reached within the transition
  double rate = 0.0;       ///< rad/s, of a turn: reached within the transition, and left within it before the end
  double amplitude = 0.0;  ///< rad, of a swing amplitude sin(2 pi frequency t), faded over the transition at both ends
  double frequency = 0.0;  ///< Hz
};

struct TableMove {
  double duration = 0.0;            ///< s, transitions included; 0: where the table stands at the beginning
  double transition = 1.0;          ///< s
  std::array<AxisCommand, 2> axis;  ///< kAzimuth, kPitch

  [[nodiscard]] bool is_rest() const {
    return axis[0].rate == 0.0 && axis[1].rate == 0.0 && axis[0].amplitude == 0.0 && axis[1].amplitude == 0.0;
  }
};

/// What a joint can do.
struct AxisLimits {
  double lowest = -std::numeric_limits<double>::infinity();  ///< rad
  double highest = std::numeric_limits<double>::infinity();
  double rate = std::numeric_limits<double>::infinity();  ///< rad/s
  double acceleration = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool endless() const { return !(highest - lowest < std::numeric_limits<double>::infinity()); }
};

using TableLimits = std::array<AxisLimits, 2>;  ///< kAzimuth, kPitch

}  // namespace trunnion
