// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From what the unit feels to what the body feels.

#pragma once

#include "recording.hpp"

namespace trunnion::app {

enum class Modulation { kNone, kIndex, kEncoder, kWheel };

struct BodyMotionSeries {
  std::vector<double> stamp;                 // s, period apart
  std::vector<InertialSample<double>> mean;  // body axes
  double period = 0.0;                       // s
  long long turns = 0;
  long long missed_pulses = 0;
  long long stray_pulses = 0;
  long long saturated_turns = 0;
};

/// @param axial_range at which the gyro about the axis saturates [rad/s], 0: unknown
BodyMotionSeries body_motion(const Recording& recording, Modulation modulation, double axial_range, double delay);

}  // namespace trunnion::app
