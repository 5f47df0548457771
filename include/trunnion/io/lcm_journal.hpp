// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An LCM log that is being recorded: what was written survives the program, and can be read back and gone on with.
///
/// The log grows as "<path>.part" and gets its name when it is whole. A record that was cut off at the end is dropped.
/// A file that holds no record is nobody's journal and is refused.

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "trunnion/io/lcm_log.hpp"

namespace trunnion::io {

class LcmJournal {
 public:
  /// Where the log of @p path grows.
  static std::string part_of(const std::string& path) { return path + ".part"; }

  /// Opens the journal of a log, or begins it. @p recover gets every record that is there already.
  /// @throws Error (input) when it cannot be written, or another program is recording there
  LcmJournal(std::string path, const std::function<void(const LcmEvent&)>& recover);
  LcmJournal(const LcmJournal&) = delete;
  LcmJournal& operator=(const LcmJournal&) = delete;
  /// Leaves the journal where it is, flushed.
  ~LcmJournal();

  /// Buffered; see flush(). After a failure nothing more is written.
  void write(std::int64_t timestamp, std::string_view channel, std::string_view data);
  /// Hands what was written to the system: a killed program loses no more than what came since.
  void flush();

  /// Why nothing is written any more; empty while all is well.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] long long records() const { return number_; }
  [[nodiscard]] long long recovered() const { return recovered_; }
  /// Bytes after the last whole record that were found and dropped.
  [[nodiscard]] long long dropped() const { return dropped_; }

  /// The log gets its name. @return its SHA-256; empty where something failed, and the journal stays
  std::string finish();
  /// Gives the journal the name @p path.interrupted-N, the first that is free, and closes it. @return the name
  std::string set_aside();

 private:
  void fail(const char* doing);

  std::string path_;
  std::string buffer_;
  std::string failure_;
  int descriptor_ = -1;
  std::int64_t number_ = 0;
  std::int64_t recovered_ = 0;
  long long dropped_ = 0;
  std::int64_t size_ = 0;  // of whole records in the file
};

/// SHA-256 of a log, read by blocks.
std::string digest_of_log(const std::string& path);

}  // namespace trunnion::io
