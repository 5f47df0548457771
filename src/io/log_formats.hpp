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

/// A list of names for people: the first of them, and how many more there are.
class NameList {
 public:
  void add(const std::string& name) {
    if (names_++ < kMost) text_ += (text_.empty() ? "" : ", ") + printable(name.substr(0, kLongest));
  }
  [[nodiscard]] bool empty() const { return names_ == 0; }
  [[nodiscard]] std::string text() const {
    return text_ + (names_ > kMost ? " and " + std::to_string(names_ - kMost) + " more" : "");
  }

 private:
  static constexpr std::size_t kMost = 20;
  static constexpr std::size_t kLongest = 256;  // bytes
  std::string text_;
  std::size_t names_ = 0;
};

/// @param bytes at the end of a log that was cut there, within a record
inline LogLosses losses_of(const SampleIntake& intake, std::int64_t bytes, const std::string& note) {
  LogLosses losses;
  losses.records = intake.damaged_records() + intake.lost_stretches() + (bytes > 0 ? 1 : 0);
  losses.bytes = intake.damaged_bytes() + intake.lost_bytes() + bytes;
  losses.note = note;
  return losses;
}

/// " on 'name'", where the user gave one.
inline std::string on(const std::string& name) { return name.empty() ? "" : " on '" + printable(name) + "'"; }

/// Refuses a log that had not what was asked for. @param bytes of it; @param holds what it had instead, for people
inline void require(const LogRequest& request, const SampleIntake& intake, std::int64_t bytes,
                    const std::string& holds) {
  intake.finish(bytes);
  if (request.need_imu && intake.samples() == 0)
    throw input_error(
        request.path, 0, "",
        "has no samples of an IMU" + on(request.channels.imu.name) + (holds.empty() ? "" : "; it has " + holds));
  if (request.need_encoder && intake.encoders() == 0)
    throw input_error(request.path, 0, "",
                      "has no readings of two encoders" + on(request.channels.encoder.name) +
                          (holds.empty() ? "" : "; it has " + holds));
}

}  // namespace trunnion::io
