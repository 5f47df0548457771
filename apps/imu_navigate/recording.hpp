// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What was recorded: samples at even periods, holes filled and counted, with the angle or the pulses of the axis.

#pragma once

#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion::app {

struct RecordingSource {
  std::string log;      // of any format
  std::string channel;  // of the IMU, in a log; empty: where it usually is
  std::string axis;     // CSV of the axis: t_s,angle_rad, or t_s of the pulses; empty: none, or in the log
  bool needs_angle = false;
  bool needs_pulses = false;
  bool increments = false;   // the values are angle and velocity increments
  double longest_gap = 0.1;  // s, that may be bridged
  std::string calibration;   // file; empty: none
};

struct Recording {
  std::vector<double> stamp;                   // s, of the end of each sample
  std::vector<InertialSample<double>> sample;  // means over the period that ends at the stamp
  std::vector<double> celsius;                 // degC, of each sample; not a number where it is not stated
  std::vector<double> angle;                   // rad, of the axis at each stamp, not wrapped; empty without an encoder
  std::vector<double> pulse;                   // s; empty without an index
  double period = 0.0;                         // s
  long long duplicates = 0;
  long long strays = 0;
  long long filled = 0;  // samples that were missing, interpolated
  long long damaged = 0;
  std::vector<std::string> warnings;
};

/// @throws Error (input) for files that cannot be used: what, where and why
Recording read_recording(const RecordingSource& source);

}  // namespace trunnion::app
