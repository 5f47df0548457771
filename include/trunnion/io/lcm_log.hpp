// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// LCM log files, read by blocks and written, without liblcm.
///
///   record = u32 0xEDA1DA01, i64 event number, i64 timestamp [us], u32 channel length, u32 data length, channel, data
///
/// all big-endian. The reader checks every length against the file and the next sync word, resynchronises after damage,
/// goes on, and counts what was lost.

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "trunnion/io/digest.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {

class ByteStream;

struct LcmEvent {
  std::int64_t number = 0;
  std::int64_t timestamp = 0;  ///< us, of the logger
  std::string_view channel;
  std::string_view data;  ///< valid until the next call of next()
  std::int64_t byte = 0;  ///< offset of the record in the file
};

class LcmLogReader {
 public:
  static constexpr std::uint32_t kSync = 0xEDA1DA01U;  ///< a record begins with it
  static constexpr std::size_t kHeader = 28;           ///< bytes of a record before channel and data
  static constexpr std::size_t kLongestChannel = 63;
  static constexpr std::size_t kLargestData = std::size_t{1} << 28U;

  /// @param digest takes every byte of the file when not null
  /// @throws Error (input) when the file is missing, unreadable or empty
  explicit LcmLogReader(std::string path, Sha256* digest = nullptr);
  LcmLogReader(const LcmLogReader&) = delete;
  LcmLogReader& operator=(const LcmLogReader&) = delete;
  ~LcmLogReader();

  /// The next whole record. @return false at the end of the file
  bool next(LcmEvent& event);

  [[nodiscard]] long long lost_records() const { return lost_records_; }
  [[nodiscard]] long long lost_bytes() const { return lost_bytes_; }
  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] const std::string& path() const;

 private:
  void lose(std::size_t bytes);
  bool skip_damage();
  [[nodiscard]] bool plausible_header(std::size_t at) const;

  std::unique_ptr<ByteStream> stream_;
  bool synchronised_ = true;
  std::int64_t last_number_ = -1;
  long long lost_records_ = 0;
  long long lost_bytes_ = 0;
};

/// Appends one record to @p out.
void append_lcm_record(std::int64_t number, std::int64_t timestamp, std::string_view channel, std::string_view data,
                       std::string& out);

class LcmLogWriter {
 public:
  explicit LcmLogWriter(const std::string& path) : file_(path) {}
  void write(std::int64_t timestamp, std::string_view channel, std::string_view data);
  void commit() { file_.commit(); }

 private:
  WholeFile file_;
  std::string record_;
  std::int64_t number_ = 0;
};

}  // namespace trunnion::io
