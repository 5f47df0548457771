// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "big_endian.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18U;  // stays in the cache

}  // namespace

LcmLogReader::LcmLogReader(std::string path, Sha256* digest)
    : path_(std::move(path)), digest_(digest), buffer_(2 * kBlock) {
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw input_error(path_, 0, "", std::string("cannot read: ") + std::strerror(errno));
  struct stat status {};
  const bool regular = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
  if (!regular || status.st_size == 0) {
    ::close(descriptor_);
    throw input_error(path_, 0, "", regular ? "is empty" : "is not a regular file");
  }
  size_ = status.st_size;
}

LcmLogReader::~LcmLogReader() { ::close(descriptor_); }

/// Makes @p bytes available from begin_ on. @return false when the file ends before
bool LcmLogReader::have(std::size_t bytes) {
  while (end_ - begin_ < bytes && !at_end_) {
    if (begin_ + std::max(bytes, kBlock) > buffer_.size()) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      offset_ += static_cast<std::int64_t>(begin_);
      end_ -= begin_;
      begin_ = 0;
      if (buffer_.size() < bytes + kBlock) buffer_.resize(bytes + kBlock);
    }
    const ssize_t got = ::read(descriptor_, buffer_.data() + end_, std::min(kBlock, buffer_.size() - end_));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw input_error_at_byte(path_, offset_ + static_cast<std::int64_t>(end_), "",
                                std::string("cannot read: ") + std::strerror(errno));
    }
    if (got == 0) {
      at_end_ = true;
    } else {
      if (digest_ != nullptr) digest_->update({buffer_.data() + end_, static_cast<std::size_t>(got)});
      end_ += static_cast<std::size_t>(got);
    }
  }
  return end_ - begin_ >= bytes;
}

/// Sync word, and lengths that fit the format and the rest of the file.
bool LcmLogReader::plausible_header(std::size_t at) const {
  const char* p = buffer_.data() + at;
  if (load_u32(p) != kSync) return false;
  const std::size_t channel = load_u32(p + 20);
  const std::size_t data = load_u32(p + 24);
  return channel <= kLongestChannel && data <= kLargestData &&
         static_cast<std::int64_t>(kHeader + channel + data) <= size_ - offset_ - static_cast<std::int64_t>(at);
}

/// Moves begin_ on to the next plausible header. @return false when there is none
bool LcmLogReader::skip_damage() {
  constexpr char kFirstByte = static_cast<char>(kSync >> 24U);
  while (have(kHeader)) {
    const char* from = buffer_.data() + begin_;
    const char* last = buffer_.data() + end_ - kHeader;  // the last place where a whole header fits
    const auto* hit =
        static_cast<const char*>(std::memchr(from, kFirstByte, static_cast<std::size_t>(last - from) + 1));
    const char* stop = hit != nullptr ? hit : last + 1;
    lost_bytes_ += stop - from;
    begin_ += static_cast<std::size_t>(stop - from);
    if (hit == nullptr) continue;
    if (plausible_header(begin_)) return true;
    ++begin_;
    ++lost_bytes_;
  }
  lost_bytes_ += static_cast<long long>(end_ - begin_);
  begin_ = end_;
  return false;
}

bool LcmLogReader::next(LcmEvent& event) {
  for (;;) {
    if (!have(kHeader)) {
      if (end_ != begin_) {
        ++lost_records_;
        lost_bytes_ += static_cast<long long>(end_ - begin_);
        begin_ = end_;
      }
      return false;
    }
    if (!plausible_header(begin_)) {
      ++lost_records_;
      synchronised_ = false;
      ++begin_;
      ++lost_bytes_;
      if (!skip_damage()) return false;
    }
    const std::size_t channel = load_u32(buffer_.data() + begin_ + 20);
    const std::size_t data = load_u32(buffer_.data() + begin_ + 24);
    const std::size_t length = kHeader + channel + data;
    // the lengths are true where another record, or the end, follows
    if (have(length + 4) ? load_u32(buffer_.data() + begin_ + length) != kSync : end_ - begin_ != length) {
      // damage: in this record when another begins inside what it claims, else in the next
      bool inside = end_ - begin_ < length;
      for (std::size_t at = begin_ + 4; !inside && at + kHeader <= begin_ + length; ++at) inside = plausible_header(at);
      if (inside) {
        ++lost_records_;
        synchronised_ = false;
        begin_ += 4;
        lost_bytes_ += 4;
        if (!skip_damage()) return false;
        continue;
      }
    }
    const char* p = buffer_.data() + begin_;
    event.number = load_i64(p + 4);
    event.timestamp = load_i64(p + 12);
    event.channel = {p + kHeader, channel};
    event.data = {p + kHeader + channel, data};
    event.byte = offset_ + static_cast<std::int64_t>(begin_);
    if (!synchronised_) {
      // the logger's numbers tell how many records the damage took; one was counted when it was met
      const std::int64_t gap = last_number_ < 0 ? 1 : event.number - last_number_ - 1;
      if (gap > 1 && gap < size_ / static_cast<std::int64_t>(kHeader)) lost_records_ += gap - 1;
      synchronised_ = true;
    }
    last_number_ = event.number;
    begin_ += length;
    return true;
  }
}

void append_lcm_record(std::int64_t number, std::int64_t timestamp, std::string_view channel, std::string_view data,
                       std::string& out) {
  append_unsigned(out, LcmLogReader::kSync);
  append_i64(out, number);
  append_i64(out, timestamp);
  append_unsigned(out, static_cast<std::uint32_t>(channel.size()));
  append_unsigned(out, static_cast<std::uint32_t>(data.size()));
  out.append(channel);
  out.append(data);
}

void LcmLogWriter::write(std::int64_t timestamp, std::string_view channel, std::string_view data) {
  record_.clear();
  append_lcm_record(number_++, timestamp, channel, data, record_);
  file_.write(record_);
}

}  // namespace trunnion::io
