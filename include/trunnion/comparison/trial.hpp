// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One trial of a campaign: one simulated unit on one simulated bench, calibrated by every method, and navigated.
///
/// | method          | what it gets                                                             | what it knows      |
/// |-----------------|--------------------------------------------------------------------------|--------------------|
/// | traditional     | the design run in the first mount                                        | the drawing        |
/// | rate_test       | the design run in every mount                                            | the drawing        |
/// | twelve_position | the design run in every mount, and the experiment (`experiment`)         | the drawing, roughly
/// | | kalman_36       | nineteen positions on a level gimbal, without its encoders               | gravity | | by_hand
/// | the same log                                                             | gravity            | | three_axis |
/// sixteen positions on a level gimbal with encoders, by the batch solve    | the drawing, roughly |
///
/// The same seed is the same unit, and for the methods on the table the same table. docs/theory/comparison.md.

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "trunnion/positions/table_move.hpp"
#include "trunnion/simulation/table_run.hpp"

namespace trunnion::comparison {

enum class Method { kTraditional, kRateTest, kKalman36, kByHand, kThreeAxis, kTwelvePosition, kExperiment };
inline constexpr std::array<const char*, 7> kMethodNames = {"traditional", "rate_test",       "kalman_36", "by_hand",
                                                            "three_axis",  "twelve_position", "experiment"};

/// What a method is from the truth: root mean squares over the entries that it determines.
struct Outcome {
  std::string failure;             ///< why there is no result, or empty
  double seconds = 0.0;            ///< of table time
  double installation_deg = -1.0;  ///< gyros' cross-coupling in the frame of the case; negative: it has no such frame
  double aligned_deg = -1.0;       ///< ... in the frame of the accelerometers; negative: it has none
  double gyro_scale_ppm = -1.0;
  double accel_scale_ppm = -1.0;
  double accel_aligned_deg = -1.0;
  double squared_pulls = -1.0;  ///< NEES of the whole posterior, of those that have one
  int parameters = 0;
};

/// An hour at rest and in the table's motions, from the true state after a minute at rest in which each arm takes its
/// biases anew: what is left at the end.
struct NavigationOutcome {
  struct Error {
    double position_m = 0.0;  ///< horizontal
    double velocity_m_s = 0.0;
    double attitude_deg = 0.0;
  };
  Error raw;         ///< of a unit as it comes
  Error calibrated;  ///< by the experiment's calibration
  Error floor;       ///< by the true one: in-run wander and noise
};

struct TrialSettings {
  simulation::TableRunSettings run;
  Rig table;
  TableLimits limits;
  Rig gimbal;  ///< its outer axis level, one mount, no limits
  Site site;
  double height = 0.0;  ///< m
  int navigations = 0;
  double navigation_time = 3600.0;  ///< s
  double navigation_rate = 100.0;   ///< Hz
};

struct Trial {
  std::uint64_t seed = 0;
  std::vector<std::pair<Method, Outcome>> methods;
  std::vector<NavigationOutcome> navigations;
};

Trial run_trial(const TrialSettings& settings, const std::vector<Method>& methods, std::uint64_t seed);

}  // namespace trunnion::comparison
