// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From what the body feels to where it went.

#pragma once

#include <string>
#include <vector>

#include "motion.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/strapdown/dead_reckoning.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion::app {

enum class Align { kNone, kLevel, kCompass, kFine, kSwinging };

struct Start {
  double latitude = 0.0;   // rad
  double longitude = 0.0;  // rad
  double height = 0.0;     // m
  double heading = 0.0;    // rad
  Align align = Align::kLevel;
  double align_time = 10.0;                       // s
  Vec3<double> lever_arm = Vec3<double>::Zero();  // m, from the point at rest to the unit
  UnitNoise noise;                                // of the sheet; kCompass and kFine need it
  bool has_noise = false;
};

struct Epoch {
  double t = 0.0;  // s
  NavigationState<double> state;
};

struct Track {
  std::vector<Epoch> epoch;
  double heading_at_start = 0.0;  // rad
  double heading_sigma = 0.0;     // rad; 0: given, not estimated
  double latitude_seen = 0.0;     // rad, by the Earth's rate
  double latitude_sigma = 0.0;    // rad; 0: not estimated
  double distance = 0.0;          // m along the track, of a wheel
  double axle_scale = 0.0;        // of a wheel
  double saturated_time = 0.0;    // s, of a wheel
  std::vector<std::string> warnings;
};

/// Strapdown navigation with the algorithm named: previous, 2, 3, 4, exact4, exact6, exact8.
/// @throws Error (input) for a base that moves while it is aligned, with what was seen; (numerics) for a heading that
/// the data cannot decide
Track navigate(const BodyMotionSeries& motion, const Start& start, const std::string& algorithm, double output_hz);

/// Dead reckoning of a wheel. @throws Error (input) when it never rests
Track reckon(const BodyMotionSeries& motion, const Start& start, const Wheel<double>& wheel, double output_hz);

}  // namespace trunnion::app
