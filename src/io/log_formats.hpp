// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The entries of the list of formats, each from its own file, and what they share.

#pragma once

#include <string>

#include "byte_stream.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/io/sample_intake.hpp"

namespace trunnion::io {

extern const LogFormat kCsvFormat;
extern const LogFormat kLcmFormat;
extern const LogFormat kMcapFormat;
extern const LogFormat kMipFormat;
extern const LogFormat kUlogFormat;

/// Tells a request how far its reader is, now and then.
class ByteProgress {
 public:
  explicit ByteProgress(const Progress& progress) : progress_(progress) {}
  void show(const ByteStream& stream) {
    if (!progress_ || stream.offset() - shown_ <= kBytes) return;
    shown_ = stream.offset();
    progress_(static_cast<double>(shown_) / static_cast<double>(stream.size()));
  }

 private:
  static constexpr std::int64_t kBytes = std::int64_t{1} << 22U;  // between two calls
  const Progress& progress_;
  std::int64_t shown_ = 0;
};

/// What SampleIntake takes for a place in a file.
class AtByte {
 public:
  AtByte(const std::string& path, std::int64_t byte) : path_(path), byte_(byte) {}
  Error operator()(const std::string& field, const std::string& what) const {
    return input_error_at_byte(path_, byte_, field, what);
  }

 private:
  const std::string& path_;
  std::int64_t byte_;
};

/// Refuses a log that had not what was asked for. @param holds what it had instead, for people
inline void require(const LogRequest& request, const SampleIntake& intake, const std::string& holds) {
  intake.finish();
  if (request.need_imu && intake.samples() == 0)
    throw input_error(request.path, 0, "", "has no samples of an IMU" + (holds.empty() ? "" : "; it has " + holds));
  if (request.need_encoder && intake.encoders() == 0)
    throw input_error(request.path, 0, "",
                      "has no readings of two encoders" + (holds.empty() ? "" : "; it has " + holds));
}

}  // namespace trunnion::io
