// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a column of a table measures, by name, and in which units it may.

#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace trunnion::io {

struct Unit {
  const char* name;
  const char* suffix;  ///< of a header name
  double si;
};

struct Units {
  const Unit* first;
  std::size_t count;
};

constexpr std::array<const char*, 6> kSensors = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};
constexpr const char* kTemperature = "temperature";
constexpr const char* kWeek = "week";
constexpr const char* kCounts = "counts";
constexpr const char* kSamples = "samples";  ///< of the time: the sheet has the rate

Units units_of(const std::string& quantity);

}  // namespace trunnion::io
