// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The run file: everything a calibration needs, relative to itself (docs/reference/files.md).

#pragma once

#include <map>
#include <string>
#include <vector>

#include "trunnion/io/csv.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/positions/entry.hpp"
#include "trunnion/positions/soak.hpp"
#include "trunnion/positions/table_plan.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::io {

/// Where one recording lies; paths are resolved against the run file.
struct RecordingFiles {
  int line = 0;       ///< of the run file
  std::string mount;  ///< empty by hand
  std::string log;    ///< all in one, of any format; or empty
  std::string imu;    ///< unit and encoders in files of their own, of any format; or empty
  std::string encoder;
  std::string gyro;  ///< gyro and accelerometers in tables of their own; or empty
  std::string accel;

  /// For messages: the first file.
  [[nodiscard]] const std::string& name() const { return !log.empty() ? log : !imu.empty() ? imu : gyro; }
};

/// A verdict's limits on one kind of entry, in the unit of its key; negative: none.
struct EntryVerdict {
  double value = -1.0;
  double sigma = -1.0;
};

struct RunFile {
  std::string path;
  Site site;
  double height = 0.0;  ///< of the site [m]
  std::string rig;      ///< URDF, or empty: by hand
  std::string outer_axis = "azimuth";
  std::string inner_axis = "pitch";
  std::string sheet_path;  ///< or empty
  SensorSheet sheet;       ///< read from it
  std::string serial;
  bool estimate_clock_offset = true;
  double clock_offset = 0.0;  ///< s
  bool bias_per_recording = true;
  bool cubic = true;
  bool g_sensitivity = true;
  bool quadratic = false;
  bool asymmetry = false;
  bool size_effect = false;
  int temperature = 0;  ///< order
  EntryLimits refuse_above = default_refuse_above();
  std::array<EntryVerdict, kEntries> limits;
  LogChannels channels;
  std::vector<std::string> lcm_types;  ///< definitions, files or folders
  ColumnMap columns;
  PlanRequest plan;   ///< what a live calibration asks of each mount
  std::string moves;  ///< of the table, or empty
  Soak soak;          ///< of the chamber, for a simulation and a plan
  std::vector<RecordingFiles> recordings;
};

/// @throws Error (input) naming file, line and field
RunFile read_run_file(const std::string& path);

/// By its extension: .yaml, .yml. What another file is, its content tells (format_of).
bool is_run_file(const std::string& path);

/// How a run reads a log: its channels, columns, joints, counts.
LogRequest log_request(const RunFile& run, const std::string& path);

/// Reads one recording into @p sink. @param inputs takes path and SHA-256 of each file
LogLosses read_recording(const RunFile& run, const RecordingFiles& files, SampleSink& sink,
                         std::vector<std::pair<std::string, std::string>>& inputs, const Progress& progress = {});

}  // namespace trunnion::io
