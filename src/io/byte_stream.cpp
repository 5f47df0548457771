// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "byte_stream.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "trunnion/io/fault.hpp"

namespace trunnion::io {

ByteStream::ByteStream(std::string path, Sha256* digest)
    : path_(std::move(path)), digest_(digest), buffer_(2 * kBlock) {
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe without a writer is refused
  if (descriptor_ < 0) throw input_error(path_, 0, "", std::string("cannot read: ") + std::strerror(errno));
  struct stat status {};
  const bool regular = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
  if (!regular || status.st_size == 0) {
    ::close(descriptor_);
    throw input_error(path_, 0, "", regular ? "is empty" : "is not a regular file");
  }
  size_ = status.st_size;
}

ByteStream::~ByteStream() { ::close(descriptor_); }

bool ByteStream::fill(std::size_t bytes) {
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

bool ByteStream::pass(std::uint64_t bytes) {
  while (bytes > 0) {
    if (!have(1)) return false;
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, available()));
    skip(step);
    bytes -= step;
  }
  return true;
}

}  // namespace trunnion::io
