// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/report/picture.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace trunnion::report {
namespace {

/// A file that goes when it is out of sight.
class TemporaryScript {
 public:
  explicit TemporaryScript(const std::string& text) {
    const char* const folder = std::getenv("TMPDIR");
    path_ = std::string(folder != nullptr && *folder != '\0' ? folder : "/tmp") + "/trunnion-plot-XXXXXX";
    const int file = ::mkstemp(path_.data());
    if (file < 0) return;
    std::size_t written = 0;
    while (written < text.size()) {
      const ssize_t count = ::write(file, text.data() + written, text.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      written += static_cast<std::size_t>(count);
    }
    whole_ = ::close(file) == 0 && written == text.size();
  }
  TemporaryScript(const TemporaryScript&) = delete;
  TemporaryScript& operator=(const TemporaryScript&) = delete;
  ~TemporaryScript() { ::unlink(path_.c_str()); }
  [[nodiscard]] bool whole() const { return whole_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool whole_ = false;
};

}  // namespace

Picture gnuplot(const std::string& title, const std::string& script, int width, int height) {
  Picture picture{title, {}, {}};
  const TemporaryScript file("set terminal svg size " + std::to_string(width) + "," + std::to_string(height) +
                             " dynamic font 'sans-serif,12' background 'white'\nset encoding utf8\n" + script);
  if (!file.whole()) {
    picture.absent = "No picture: a temporary file could not be written.";
    return picture;
  }
  // the path holds nothing that a shell would see, but for what TMPDIR has: in single quotes, and none within
  if (file.path().find('\'') != std::string::npos) {
    picture.absent = "No picture: TMPDIR has a quote in its name.";
    return picture;
  }
  const auto close = [](std::FILE* pipe) { return pipe == nullptr ? -1 : ::pclose(pipe); };
  std::FILE* const pipe = ::popen(("gnuplot '" + file.path() + "' 2>/dev/null").c_str(), "r");
  std::string out;
  std::array<char, 1 << 16> buffer{};
  while (pipe != nullptr) {
    const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe);
    if (count == 0) break;
    out.append(buffer.data(), count);
  }
  const int status = close(pipe);
  const std::size_t svg = out.find("<svg");
  if (status != 0 || svg == std::string::npos || out.find("</svg>") == std::string::npos) {
    picture.absent = "No picture: gnuplot is not installed, or failed.";
    return picture;
  }
  picture.svg = out.substr(svg);
  return picture;
}

std::string data_block(const std::string& name, const std::vector<std::vector<double>>& rows) {
  std::string out = "$" + name + " << EOD\n";
  std::array<char, 40> text{};
  for (const std::vector<double>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      out += i == 0 ? "" : " ";
      if (!std::isfinite(row[i])) {
        out += "NaN";
        continue;
      }
      const auto end = std::to_chars(text.data(), text.data() + text.size(), row[i], std::chars_format::general, 7);
      out.append(text.data(), end.ptr);
    }
    out += "\n";
  }
  return out + "EOD\n";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    // a name from a file may hold what gnuplot's enhanced text takes for an order
    if (c == '_' || c == '^' || c == '@' || c == '{' || c == '}' || c == '~' || c == '&') out += "\\\\";
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace trunnion::report
