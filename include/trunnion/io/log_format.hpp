// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The formats that recordings come in: each is one entry of a list, and one source file.

#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trunnion/io/csv.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/message_map.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/positions/sample_sink.hpp"

namespace trunnion::io {

/// Where the unit and the encoders lie in a log: channels, topics or messages; empty: where they usually are.
struct LogChannels {
  ChannelChoice imu;
  ChannelChoice encoder;
  SensorSheet sheet;  ///< what a count is, and the period of a sample, where messages do not say

  /// In LCM logs and on a bus.
  [[nodiscard]] std::string imu_channel() const { return imu.name.empty() ? "IMU" : imu.name; }
  [[nodiscard]] std::string encoder_channel() const { return encoder.name.empty() ? "ENCODER" : encoder.name; }
};

struct LogLosses {
  long long records = 0;  ///< damaged in the file
  long long bytes = 0;
  long long samples = 0;  ///< of the unit, that its sequence numbers or its recorder's count miss
  std::string note;       ///< in words, what else there is to know: of what was not read, of what is in the readings
};

using Progress = std::function<void(double fraction)>;

/// What is read, and from where.
struct LogRequest {
  std::string path;
  LogChannels channels;
  ColumnMap columns;                                      ///< of a table
  std::array<std::string, 2> joints{"azimuth", "pitch"};  ///< of ROS joint states: outer, inner
  bool need_imu = true;                                   ///< a log without samples of the unit is refused
  bool need_encoder = false;                              ///< ... without readings of the encoders
  Sha256* digest = nullptr;                               ///< takes every byte of the file
  Progress progress;
};

/// Writes what is told to it as a log: whole, or not at all.
class LogWriter : public SampleSink {
 public:
  /// @throws Error (input) when a disk is full
  virtual void commit() = 0;
  /// Whether what temperature() tells is kept.
  [[nodiscard]] virtual bool holds_temperature() const { return true; }
  /// The files that commit() made.
  [[nodiscard]] virtual std::vector<std::string> files() const = 0;
};

struct LogFormat {
  const char* name;       ///< as on a command line
  const char* title;      ///< for people
  const char* extension;  ///< of a file that is written
  bool (*matches)(std::string_view head);
  LogLosses (*read)(const LogRequest& request, SampleSink& sink);
  std::unique_ptr<LogWriter> (*write)(const std::string& path);  ///< null: is only read
  /// The file beside @p path that a writer gives the encoders; null: they are in the same.
  std::string (*encoder_file)(const std::string& path) = nullptr;
  bool by_channel = false;  ///< holds messages of a bus, some of other kinds than these
};

/// In the order in which they are tried; the last takes what nobody knows.
const std::vector<LogFormat>& log_formats();

/// By its own name. @throws Error (usage) for a name that no format has
const LogFormat& format_by_name(const std::string& name);

/// By the first bytes of the file, not by its name. @throws Error (input) for a file that is missing or empty
const LogFormat& format_of(const std::string& path);

/// Reads a log of any format into @p sink.
/// @throws Error (input) for a missing, empty or useless log, and values that are not finite
LogLosses read_log(const LogRequest& request, SampleSink& sink);

}  // namespace trunnion::io
