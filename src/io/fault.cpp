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

bool is_utf_8(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto first = static_cast<unsigned char>(text[i]);
    if (first < 0x80) continue;
    const std::size_t more = first >= 0xf8 || first < 0xc0 ? 0 : first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    if (more == 0 || more >= text.size() - i) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0U) != 0x80U) return false;
    }
    i += more;
  }
  return true;
}

std::string printable(std::string name) {
  const bool is_text = is_utf_8(name);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || (byte > 0x7f && !is_text)) c = '?';
  }
  return name;
}

}  // namespace trunnion::io
