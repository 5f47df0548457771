// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The bytes of a file from front to back: as many at hand as a reader asks for, each read once.

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "trunnion/io/digest.hpp"

namespace trunnion::io {

class ByteStream {
 public:
  static constexpr std::size_t kBlock = std::size_t{1} << 18U;  // stays in the cache

  /// @param digest takes every byte when not null
  /// @throws Error (input) when the file is missing, unreadable, empty or no regular file
  explicit ByteStream(std::string path, Sha256* digest = nullptr);
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  ~ByteStream();

  /// Brings @p bytes to hand, from data() on, which may move. @return false when the file ends before
  bool have(std::size_t bytes) { return available() >= bytes || fill(bytes); }
  [[nodiscard]] const char* data() const { return buffer_.data() + begin_; }
  [[nodiscard]] std::size_t available() const { return end_ - begin_; }
  /// Goes on by @p bytes that are at hand.
  void skip(std::size_t bytes) { begin_ += bytes; }
  /// Goes on by any number of bytes. @return false when the file ends before
  bool pass(std::uint64_t bytes);

  [[nodiscard]] std::int64_t offset() const { return offset_ + static_cast<std::int64_t>(begin_); }  // of data()
  [[nodiscard]] std::int64_t size() const { return size_; }  // when it was opened
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  bool fill(std::size_t bytes);

  std::string path_;
  Sha256* digest_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::int64_t offset_ = 0;  // of buffer_[0] in the file
  bool at_end_ = false;
};

}  // namespace trunnion::io
