// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the commands share towards the person: progress on stderr, numbers with a sigma, where the shipped files lie.

#pragma once

#include <chrono>
#include <string>

namespace trunnion::app {

/// One line on stderr that overwrites itself; silent where stderr is no terminal.
class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine();
  void show(const std::string& text);

 private:
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// "%.<digits>g" of @p value.
std::string figure(double value, int digits);

/// A file of apps/share: beside the installed program, or in the source tree.
std::string shared_file(const std::string& name);

/// "imu_calibrate <version>".
std::string tool_name();

}  // namespace trunnion::app
