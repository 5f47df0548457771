// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Little-endian numbers in bytes.

#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

namespace trunnion::io {

/// The other way round.
template <class T>
T reversed(T v) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &v, sizeof v);
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&v, bytes.data(), sizeof v);
  return v;
}

template <class T>
T load_little(const char* p) {
  T v{};
  std::memcpy(&v, p, sizeof v);
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  return v;
#else
  return reversed(v);
#endif
}

template <class T>
void append_little(std::string& out, T v) {
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
  v = reversed(v);
#endif
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &v, sizeof v);
  out.append(bytes.data(), bytes.size());
}

}  // namespace trunnion::io
