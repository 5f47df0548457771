// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The sensor sheet: ranges, noise and nominal scale of a unit, as its data sheet states them
/// (docs/reference/files.md).

#pragma once

#include <string>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/error_model/noise.hpp"

namespace trunnion::io {

struct SensorSheet {
  std::string model;
  double rate_hz = 0.0;      ///< 0: not stated
  double gyro_range = 0.0;   ///< rad/s; 0: not stated
  double accel_range = 0.0;  ///< m/s^2; 0: not stated
  UnitNoise noise;
  bool has_noise = false;    ///< both triads state their noise
  UnitScale<double> counts;  ///< of a raw output; scale 1 where not stated
};

/// @throws Error (input) naming file, line and field
SensorSheet read_sensor_sheet(const std::string& path);

}  // namespace trunnion::io
