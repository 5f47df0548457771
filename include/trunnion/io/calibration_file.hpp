// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The calibration file: what was found, a sigma beside each number, and where it came from (docs/reference/files.md).

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "trunnion/positions/calibration_record.hpp"

namespace trunnion::io {

struct CalibrationFile {
  std::string model;
  std::string serial;
  CalibrationRecord record;
  std::vector<std::string> mounts;  ///< names, as many as the record has
  std::vector<std::string> gauge;
  bool within_limits = true;
  std::vector<std::string> out_of_limits;
  std::string tool;
  std::string run;
  long long seed = -1;                                      ///< of a simulation; negative: none
  std::vector<std::pair<std::string, std::string>> inputs;  ///< path and SHA-256
};

/// The file as text: numbers in their shortest form that reads back exactly.
std::string to_yaml(const CalibrationFile& file);
/// The same content as JSON, schema trunnion-calibration/1.
std::string to_json(const CalibrationFile& file);

/// @throws Error (input) naming file, line and field
CalibrationFile read_calibration_file(const std::string& path);

/// The unit of a calibration, with the turn-on bias of @p recording, from 1; 0: the mean over them.
/// @throws Error (input) when the file, read from @p path, has fewer
InertialUnit<double> unit_of(const CalibrationFile& file, const std::string& path, int recording);

}  // namespace trunnion::io
