// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "big_endian.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16U;

}  // namespace

LcmJournal::LcmJournal(std::string path, const std::function<void(const LcmEvent&)>& recover) : path_(std::move(path)) {
  const std::string part = part_of(path_);
  descriptor_ = ::open(part.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw input_error(part, 0, "", std::string("cannot write: ") + std::strerror(errno));
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw input_error(part, 0, "", "another program is recording there");
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
      throw input_error(part, 0, "", "is no file to write");
    if (status.st_size > 0) {
      LcmLogReader log(part);
      LcmEvent event;
      while (log.next(event)) {
        if (recover) recover(event);
        size_ =
            event.byte + static_cast<std::int64_t>(LcmLogReader::kHeader + event.channel.size() + event.data.size());
        ++recovered_;
      }
      number_ = recovered_;
      dropped_ = status.st_size - size_;
      char first[4] = {};
      const ssize_t got = ::pread(descriptor_, first, sizeof first, 0);
      if (recovered_ == 0 && (got != sizeof first || load_u32(first) != LcmLogReader::kSync))
        throw input_error(part, 0, "", "is no LCM log that was begun: move it away");
      if (::ftruncate(descriptor_, size_) != 0 || ::lseek(descriptor_, size_, SEEK_SET) != size_)
        throw input_error(part, 0, "", std::string("cannot write: ") + std::strerror(errno));
    }
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

LcmJournal::~LcmJournal() {
  if (descriptor_ < 0) return;
  flush();
  ::close(descriptor_);
}

void LcmJournal::fail(const char* doing) {
  failure_ = part_of(path_) + ": cannot " + doing + ": " + std::strerror(errno);
  buffer_.clear();
  // a record that was cut off is no record; where not even that can be done, the next start drops it
  if (::ftruncate(descriptor_, size_) != 0) return;
}

void LcmJournal::write(std::int64_t timestamp, std::string_view channel, std::string_view data) {
  if (!failure_.empty()) return;
  append_lcm_record(number_++, timestamp, channel, data, buffer_);
  if (buffer_.size() >= kBlock) flush();
}

void LcmJournal::flush() {
  std::size_t done = 0;
  while (failure_.empty() && done < buffer_.size()) {
    const ssize_t wrote = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return fail("write");
    done += static_cast<std::size_t>(wrote);
  }
  size_ += static_cast<std::int64_t>(buffer_.size());
  buffer_.clear();
}

std::string LcmJournal::finish() {
  flush();
  if (failure_.empty() && ::fsync(descriptor_) != 0) fail("write");
  if (failure_.empty() && std::rename(part_of(path_).c_str(), path_.c_str()) != 0) fail("rename");
  if (!failure_.empty()) return {};
  ::close(std::exchange(descriptor_, -1));
  return digest_of_log(path_);
}

std::string LcmJournal::set_aside() {
  flush();
  std::string name;
  struct stat status {};
  int n = 1;
  do {
    name = path_ + ".interrupted-" + std::to_string(n++);
  } while (::stat(name.c_str(), &status) == 0);
  if (std::rename(part_of(path_).c_str(), name.c_str()) != 0) fail("rename");
  ::close(std::exchange(descriptor_, -1));
  return name;
}

std::string digest_of_log(const std::string& path) {
  Sha256 digest;
  LcmLogReader log(path, &digest);
  LcmEvent event;
  while (log.next(event)) continue;
  return digest.finish();
}

}  // namespace trunnion::io
