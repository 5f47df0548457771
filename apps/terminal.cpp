// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "terminal.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

namespace trunnion::app {

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::show(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || (shown_ && now - last_ < std::chrono::milliseconds(50))) return;
  last_ = now;
  shown_ = true;
  std::fprintf(stderr, "\r\033[K%s", text.c_str());
}

std::string figure(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string shared_file(const std::string& name) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share" / "trunnion" / name;
  if (!error && std::filesystem::exists(installed, error)) return installed.string();
  return (std::filesystem::path(TRUNNION_SOURCE_SHARE) / name).string();
}

std::string tool_name() { return TRUNNION_TOOL " " TRUNNION_VERSION; }

}  // namespace trunnion::app
