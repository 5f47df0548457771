// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Big-endian numbers in bytes, as LCM writes them.

#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace trunnion::io {

inline std::uint32_t swap_bytes(std::uint32_t v) { return __builtin_bswap32(v); }
inline std::uint64_t swap_bytes(std::uint64_t v) { return __builtin_bswap64(v); }

template <class U>
U to_big_endian(U v) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  return swap_bytes(v);
#else
  return v;
#endif
}

inline std::uint32_t load_u32(const char* p) {
  std::uint32_t v = 0;
  std::memcpy(&v, p, sizeof v);
  return to_big_endian(v);
}

inline std::uint64_t load_u64(const char* p) {
  std::uint64_t v = 0;
  std::memcpy(&v, p, sizeof v);
  return to_big_endian(v);
}

inline std::int64_t load_i64(const char* p) { return static_cast<std::int64_t>(load_u64(p)); }

inline double load_double(const char* p) {
  const std::uint64_t bits = load_u64(p);
  double v = 0.0;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

inline float load_float(const char* p) {
  const std::uint32_t bits = load_u32(p);
  float v = 0.0F;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

template <class U>
void append_unsigned(std::string& out, U v) {
  const U big = to_big_endian(v);
  char bytes[sizeof big];
  std::memcpy(bytes, &big, sizeof big);
  out.append(bytes, sizeof big);
}

inline void append_i64(std::string& out, std::int64_t v) { append_unsigned(out, static_cast<std::uint64_t>(v)); }

inline void store_double(double v, char* p) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &v, sizeof bits);
  bits = to_big_endian(bits);
  std::memcpy(p, &bits, sizeof bits);
}

inline void append_double(std::string& out, double v) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &v, sizeof bits);
  append_unsigned(out, bits);
}

}  // namespace trunnion::io
