// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The kinds of entries of a calibration, as files name them: the keys of `refuse_above` and `limits`, their units, and
/// the posterior sigma beyond which an entry is refused unless the run file says otherwise: about a twentieth of what
/// an uncalibrated MEMS unit may have.

#pragma once

#include <array>

#include "trunnion/core/units.hpp"

namespace trunnion {

enum class Entry : int {
  kGyroBias,
  kGyroScale,
  kGyroCrossCoupling,
  kGyroCubic,
  kGyroGSensitivity,
  kGyroAsymmetry,
  kGyroThermalBias,
  kGyroThermalScale,
  kAccelBias,
  kAccelScale,
  kAccelCrossCoupling,
  kAccelQuadratic,
  kAccelAsymmetry,
  kAccelPlace,
  kAccelThermalBias,
  kAccelThermalScale,
  kRigAngle,
  kLeverArm,
  kClockOffset,
};

inline constexpr int kEntries = 19;

struct EntryKind {
  const char* key;
  const char* unit;
  double si;            ///< one unit in SI
  double refuse_above;  ///< in the unit
  double largest;       ///< in the unit; beyond it is no error of an instrument but a mistake in the files
};

inline constexpr std::array<EntryKind, kEntries> kEntryKinds = {{
    {"gyro_bias_deg_per_h", "deg/h", kRadPerSPerDegPerH, 180.0, 2e5},
    {"gyro_scale_ppm", "ppm", 1e-6, 500.0, 2e5},
    {"gyro_cross_coupling_deg", "deg", kRadPerDeg, 0.1, 10.0},
    {"gyro_cubic_ppm", "ppm at the largest rate", 1e-6, 500.0, 2e5},
    {"gyro_g_sensitivity_deg_per_h_per_g", "deg/h/g", kRadPerSPerDegPerH / kStandardGravity, 36.0, 2e4},
    {"gyro_asymmetry_ppm", "ppm", 1e-6, 500.0, 2e5},
    {"gyro_thermal_bias_deg_per_h", "deg/h at the end of the range", kRadPerSPerDegPerH, 180.0, 2e5},
    {"gyro_thermal_scale_ppm", "ppm at the end of the range", 1e-6, 500.0, 2e5},
    {"accel_bias_ug", "ug", kMetresPerS2PerMicroG, 2500.0, 5e5},
    {"accel_scale_ppm", "ppm", 1e-6, 500.0, 2e5},
    {"accel_cross_coupling_deg", "deg", kRadPerDeg, 0.1, 10.0},
    {"accel_quadratic_ppm", "ppm at 1 g", 1e-6 / kStandardGravity, 500.0, 2e5},
    {"accel_asymmetry_ppm", "ppm", 1e-6, 500.0, 2e5},
    {"accel_place_m", "m", 1.0, 0.02, 1.0},
    {"accel_thermal_bias_ug", "ug at the end of the range", kMetresPerS2PerMicroG, 2500.0, 5e5},
    {"accel_thermal_scale_ppm", "ppm at the end of the range", 1e-6, 500.0, 2e5},
    {"rig_angle_deg", "deg", kRadPerDeg, 0.1, 10.0},
    {"lever_arm_m", "m", 1.0, 0.1, 3.0},
    {"clock_offset_ms", "ms", 1e-3, 5.0, 1e3},
}};

/// Of the unit; the others are of the rig.
constexpr bool is_of_unit(Entry entry) { return entry < Entry::kRigAngle; }

constexpr const EntryKind& kind_of(Entry entry) { return kEntryKinds[static_cast<std::size_t>(entry)]; }

/// Limits, one a kind, each in the unit of its key.
using EntryLimits = std::array<double, kEntries>;

constexpr EntryLimits default_refuse_above() {
  EntryLimits limits{};
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = kEntryKinds[i].refuse_above;
  return limits;
}

}  // namespace trunnion
