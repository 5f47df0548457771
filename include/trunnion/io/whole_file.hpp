// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Output that is written whole or not at all: a temporary file beside the target, fsync, rename. What was there keeps
/// its permissions.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trunnion::io {

class WholeFile {
 public:
  /// @throws Error (input) when the folder cannot be written
  explicit WholeFile(std::string path);
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;
  /// Removes the temporary file unless commit() was called.
  ~WholeFile();

  /// Buffered. @throws Error (input) when the disk is full
  void write(std::string_view bytes);
  /// Flushes and syncs: all that a full disk refuses. @throws Error (input)
  void settle();
  /// Settles and renames. @throws Error (input)
  void commit();
  /// What commit() would replace is gone from now on.
  void remove_old() const;

 private:
  void flush();
  std::string path_;
  std::string temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// Where WholeFile(@p path) writes: what a link points to, and the link stays.
std::string written_path(const std::string& path);

/// Removes what was written and not committed: for a handler of signals, of a program that ends.
void remove_unfinished() noexcept;

/// The text as a whole file.
void write_whole(const std::string& path, std::string_view text);

/// Reads a whole file. @throws Error (input) when it is missing or unreadable, or larger than @p most bytes
std::string read_whole(const std::string& path, std::size_t most = std::size_t{1} << 30U);

}  // namespace trunnion::io
