// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A calibration in the file of another program, and what that cannot say.

#pragma once

#include <string>
#include <vector>

namespace trunnion::app {

struct TargetOptions {
  std::string calibration;
  std::string format;
  std::string output;
  std::string sheet;              // or empty
  int recording = 0;              // whose turn-on bias, from 1; 0: the mean
  double rate_deg_per_s = 100.0;  // at which the sizes of what is left out are stated
  long long gyro_id = 0;
  long long accel_id = 0;
  int instance = 0;
};

/// The names of the formats, and what each is.
std::vector<std::string> target_names();
std::string target_titles();

/// Writes the file; on standard error what it leaves out, and what there is to know.
void export_to_target(const TargetOptions& o);

}  // namespace trunnion::app
