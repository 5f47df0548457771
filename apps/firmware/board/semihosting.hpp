// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a firmware image says to the machine that runs it: text, files and its exit code, by ARM semihosting
/// (specification IHI 0014, operations by their numbers there). Nothing here allocates or divides 64-bit numbers.

#pragma once

#include <cstddef>
#include <cstdint>

namespace board {

std::intptr_t semihosting(std::intptr_t operation, const void* arguments);

/// @p text ends with a zero.
inline void print(const char* text) { semihosting(0x04, text); }

inline void print(std::uint32_t number) {
  char digits[11];
  char* at = digits + 10;
  *at = '\0';
  do {
    *--at = static_cast<char>('0' + number % 10U);
    number /= 10U;
  } while (number != 0U);
  print(at);
}

inline void print_hex(std::uint64_t number) {
  char digits[17];
  for (int i = 15; i >= 0; --i, number >>= 4U) digits[i] = "0123456789abcdef"[number & 15U];
  digits[16] = '\0';
  print(digits);
}

/// A file of the machine's folder, opened for reading. @return a negative number when it is not there
inline std::intptr_t open(const char* path, std::size_t length) {
  const std::intptr_t arguments[3] = {reinterpret_cast<std::intptr_t>(path), 1, static_cast<std::intptr_t>(length)};
  return semihosting(0x01, arguments);
}
/// @return bytes that were read
inline std::size_t read(std::intptr_t file, void* to, std::size_t bytes) {
  const std::intptr_t arguments[3] = {file, reinterpret_cast<std::intptr_t>(to), static_cast<std::intptr_t>(bytes)};
  return bytes - static_cast<std::size_t>(semihosting(0x06, arguments));
}

/// Ends the machine with @p code.
[[noreturn]] inline void exit(int code) {
  const std::intptr_t arguments[2] = {0x20026, code};
  semihosting(0x20, arguments);
  for (;;) {
  }
}

/// What an image does: its exit code.
int run();

/// The deepest the stack has been since reset [bytes].
std::uint32_t stack_used();

}  // namespace board
