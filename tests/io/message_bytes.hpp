// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages written by hand, byte by byte: what a reader is tested with must not come from its own house.

#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace trunnion::io {

class MessageBytes {
 public:
  explicit MessageBytes(std::uint64_t fingerprint) { whole(fingerprint); }

  MessageBytes& i8(int v) { return whole(static_cast<std::int8_t>(v)); }
  MessageBytes& i16(int v) { return whole(static_cast<std::int16_t>(v)); }
  MessageBytes& i32(std::int32_t v) { return whole(v); }
  MessageBytes& i64(std::int64_t v) { return whole(v); }
  MessageBytes& f32(float v) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    return whole(bits);
  }
  MessageBytes& f64(double v) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    return whole(bits);
  }
  MessageBytes& text(const std::string& v) {
    i32(static_cast<std::int32_t>(v.size()) + 1);
    bytes_ += v;
    bytes_ += '\0';
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <class Number>
  MessageBytes& whole(Number v) {
    for (std::size_t i = sizeof v; i-- > 0;)
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(v) >> (8U * static_cast<unsigned>(i)) & 0xffU);
    return *this;
  }
  std::string bytes_;
};

}  // namespace trunnion::io
