// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18U;

constexpr int kMostNames = 1000;  // of temporary files that others left

Error failed(const std::string& path, const char* doing) {
  return input_error(path, 0, "", std::string("cannot ") + doing + ": " + std::strerror(errno));
}

/// Names of temporary files where a signal's handler can read them.
class Unfinished {
 public:
  void add(const std::string& path) {
    if (path.size() >= sizeof(Slot::path)) return;
    for (Slot& slot : slots_) {
      int free = kFree;
      if (!slot.state.compare_exchange_strong(free, kFilling)) continue;
      std::memcpy(slot.path, path.c_str(), path.size() + 1);
      slot.state = kNamed;
      return;
    }
  }
  void forget(const std::string& path) {
    for (Slot& slot : slots_) {
      if (slot.state == kNamed && path == slot.path) slot.state = kFree;
    }
  }
  void remove() const {
    for (const Slot& slot : slots_) {
      if (slot.state == kNamed) ::unlink(slot.path);
    }
  }

 private:
  static constexpr int kFree = 0;
  static constexpr int kFilling = 1;
  static constexpr int kNamed = 2;
  struct Slot {
    std::atomic<int> state{kFree};
    char path[4096] = {};
  };
  std::array<Slot, 8> slots_;
};

Unfinished unfinished;

}  // namespace

std::string written_path(const std::string& path) {
  constexpr int kMostLinks = 40;
  std::filesystem::path at(path);
  std::error_code none;
  for (int k = 0; k < kMostLinks && std::filesystem::is_symlink(at, none); ++k)
    at = at.parent_path() / std::filesystem::read_symlink(at, none);
  return at.string();
}

void remove_unfinished() noexcept { unfinished.remove(); }

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
  struct stat status {};
  const bool replaces = ::stat(path_.c_str(), &status) == 0;
  if (replaces && S_ISDIR(status.st_mode)) throw input_error(path_, 0, "", "is a folder, not a file to write");
  if (replaces && !S_ISREG(status.st_mode)) throw input_error(path_, 0, "", "is a device, not a file to write");
  path_ = written_path(path_);
  const std::string name = path_ + ".part-" + std::to_string(::getpid());
  for (int k = 0; k < kMostNames && descriptor_ < 0; ++k) {
    temporary_ = k == 0 ? name : name + "-" + std::to_string(k);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) throw failed(path_, "write");
  if (replaces && ::fchmod(descriptor_, status.st_mode & 0777U) != 0) {
    const Error error = failed(path_, "write");
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
    throw error;
  }
  unfinished.add(temporary_);
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  unfinished.forget(temporary_);
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

void WholeFile::settle() {
  if (descriptor_ < 0) return;
  flush();
  if (::fsync(descriptor_) != 0 || ::close(std::exchange(descriptor_, -1)) != 0) throw failed(path_, "write");
}

void WholeFile::remove_old() const { ::unlink(path_.c_str()); }

void WholeFile::commit() {
  settle();
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) throw failed(path_, "write");
  unfinished.forget(temporary_);
  temporary_.clear();
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
