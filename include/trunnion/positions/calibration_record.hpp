// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A calibration as plain numbers: what was found of the unit and of the rig, and one sigma beside each.
/// A sigma of zero says "fixed, not estimated". Files carry it as docs/reference/files.md says.

#pragma once

#include <array>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion {

inline constexpr int kMaxRecordings = 32;

/// Unit, rig and the turn-on biases of the recordings: used for the values and, in the same shape, for their sigmas.
struct CalibrationValues {
  InertialUnit<double> unit;  ///< biases: mean over the recordings
  TwoAxisErrors<double> rig;
  std::array<Vec3<double>, kMaxMounts> mount_error{};  ///< rad; the first mount is the datum
  std::array<Vec3<double>, kMaxMounts> lever_arm{};    ///< m, in the pitch stage
  double clock_offset = 0.0;                           ///< s, unit's stamp minus encoder's stamp of the same instant
  double gravity = 0.0;                                ///< m/s^2
  std::array<InertialSample<double>, kMaxRecordings> recording_bias{};  ///< rad/s and m/s^2

  CalibrationValues() {
    for (auto& v : mount_error) v.setZero();
    for (auto& v : lever_arm) v.setZero();
  }
};

struct FitFigures {
  long long samples = 0;
  long long windows = 0;
  long long outliers = 0;
  long long lost_records = 0;
  long long lost_bytes = 0;
  double reduced_chi_square = 0.0;
  int iterations = 0;
};

struct CalibrationRecord {
  CalibrationValues value;
  CalibrationValues sigma;
  bool has_rig = false;
  int mounts = 0;
  int recordings = 0;
  std::array<int, kMaxRecordings> recording_mount{};
  FitFigures fit;
};

}  // namespace trunnion
