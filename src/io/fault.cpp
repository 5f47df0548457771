// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/fault.hpp"

#include <cstdio>

namespace trunnion::io {

Error input_error(const std::string& file, long long line, const std::string& field, const std::string& what) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (!field.empty()) text += ": " + field;
  return {ExitCode::kInput, text + ": " + what};
}

Error input_error_at_byte(const std::string& file, long long byte, const std::string& field, const std::string& what) {
  return {ExitCode::kInput,
          file + ": byte " + std::to_string(byte) + (field.empty() ? "" : ": " + field) + ": " + what};
}

std::string hexadecimal(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string printable(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return name;
}

}  // namespace trunnion::io
