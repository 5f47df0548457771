// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18U;

Error failed(const std::string& path, const char* doing) {
  return input_error(path, 0, "", std::string("cannot ") + doing + ": " + std::strerror(errno));
}

}  // namespace

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
  struct stat status {};
  if (::stat(path_.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw input_error(path_, 0, "", "is a folder, not a file to write");
    if (!S_ISREG(status.st_mode)) throw input_error(path_, 0, "", "is a device, not a file to write");
    path_ = std::filesystem::canonical(path_).string();  // what a link points to is written, the link stays
  }
  temporary_ = path_ + ".part-" + std::to_string(::getpid());
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw failed(path_, "write");
}

WholeFile::~WholeFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void WholeFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t wrote = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) throw failed(path_, "write");
    done += static_cast<std::size_t>(wrote);
  }
  buffer_.clear();
}

void WholeFile::write(std::string_view bytes) {
  buffer_.append(bytes);
  if (buffer_.size() >= kBlock) flush();
}

void WholeFile::commit() {
  flush();
  if (::fsync(descriptor_) != 0) throw failed(path_, "write");
  const int closing = std::exchange(descriptor_, -1);
  if (::close(closing) != 0 || std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    const Error error = failed(path_, "write");
    ::unlink(temporary_.c_str());
    throw error;
  }
}

void write_whole(const std::string& path, std::string_view text) {
  WholeFile file(path);
  file.write(text);
  file.commit();
}

std::string read_whole(const std::string& path, std::size_t most) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw failed(path, "read");
  std::string text;
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw input_error(path, 0, "", "is not a regular file");
  }
  text.reserve(std::min(static_cast<std::size_t>(status.st_size), most) + 1);
  std::string block(kBlock, '\0');
  ssize_t got = 0;
  while (text.size() <= most) {
    got = ::read(descriptor, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    text.append(block.data(), static_cast<std::size_t>(got));
  }
  if (got < 0) {
    const Error error = failed(path, "read");
    ::close(descriptor);
    throw error;
  }
  ::close(descriptor);
  if (text.size() > most) throw input_error(path, 0, "", "larger than " + std::to_string(most) + " bytes");
  return text;
}

}  // namespace trunnion::io
