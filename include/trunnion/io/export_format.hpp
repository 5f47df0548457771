// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Calibrations in the files of other programs: each is one entry of a list, with the formula that its reader applies.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/io/sensor_sheet.hpp"

namespace trunnion::io {

/// What is exported.
struct ExportRequest {
  InertialUnit<double> unit;
  std::string name;                ///< of the unit: model and serial
  std::vector<std::string> notes;  ///< where it comes from, for comments
  SensorSheet sheet;               ///< noise and rate, where the target has a place for them
  long long gyro_id = 0;           ///< of the devices, where the target tells them apart by it; 0: not stated
  long long accel_id = 0;
  int instance = 0;                      ///< which of a vehicle's units it is
  std::string function = "correct_imu";  ///< name of a function, where the file is one
};

struct Exported {
  std::string text;
  /// What the target computes of a reading with the numbers of the file, and with our biases where it has its own of
  /// them: true rate and specific force. The size effect is not in it.
  std::function<InertialSample<double>(const InertialSample<double>&)> correct;
  Mat3<double> C_tb = Mat3<double>::Identity();  ///< to the axes in which the target states them
  std::vector<std::string> advice;               ///< for people: what to do with it, what was not known
};

struct ExportFormat {
  const char* name;       ///< as on a command line
  const char* title;      ///< for people
  const char* extension;  ///< of the file
  double precision;       ///< relative, of the numbers that the target keeps
  bool holds_temperature;
  bool holds_places;  ///< of the accelerometers: the size effect
  bool holds_biases;  ///< else its reader estimates them itself
  Exported (*make)(const ExportRequest& request);
};

/// @throws Error (usage) for a name that no format has
const ExportFormat& export_format(const std::string& name);
const std::vector<ExportFormat>& export_formats();

/// Something of the unit that a target cannot say.
struct Omission {
  std::string term;
  InertialSample<double> size;  ///< by how much it moves a reading, at most [rad/s, m/s^2]
};

/// How far the target's correction is from the true input, at most, over rates to @p rate about each axis and between,
/// and gravity in every direction; each sensor alone, at the reference temperature.
InertialSample<double> departure(const ExportFormat& format, const ExportRequest& request, double rate);

/// What @p format leaves out of the unit, term by term, each with its size at @p rate and one g.
std::vector<Omission> omissions(const ExportFormat& format, const ExportRequest& request, double rate);

}  // namespace trunnion::io
