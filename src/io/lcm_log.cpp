// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_log.hpp"

#include <cstring>
#include <utility>

#include "big_endian.hpp"
#include "byte_stream.hpp"

namespace trunnion::io {

LcmLogReader::LcmLogReader(std::string path, Sha256* digest)
    : stream_(std::make_unique<ByteStream>(std::move(path), digest)) {}

LcmLogReader::~LcmLogReader() = default;

std::int64_t LcmLogReader::size() const { return stream_->size(); }
const std::string& LcmLogReader::path() const { return stream_->path(); }

/// Sync word, and lengths that fit the format and the rest of the file, of the record @p at bytes further on.
bool LcmLogReader::plausible_header(std::size_t at) const {
  const char* p = stream_->data() + at;
  if (load_u32(p) != kSync) return false;
  const std::size_t channel = load_u32(p + 20);
  const std::size_t data = load_u32(p + 24);
  return channel <= kLongestChannel && data <= kLargestData &&
         static_cast<std::int64_t>(kHeader + channel + data) <=
             stream_->size() - stream_->offset() - static_cast<std::int64_t>(at);
}

void LcmLogReader::lose(std::size_t bytes) {
  stream_->skip(bytes);
  lost_bytes_ += static_cast<long long>(bytes);
}

/// Goes on to the next plausible header. @return false when there is none
bool LcmLogReader::skip_damage() {
  constexpr char kFirstByte = static_cast<char>(kSync >> 24U);
  while (stream_->have(kHeader)) {
    const std::size_t places = stream_->available() - kHeader + 1;  // where a whole header fits
    const auto* hit = static_cast<const char*>(std::memchr(stream_->data(), kFirstByte, places));
    lose(hit != nullptr ? static_cast<std::size_t>(hit - stream_->data()) : places);
    if (hit == nullptr) continue;
    if (plausible_header(0)) return true;
    lose(1);
  }
  lose(stream_->available());
  return false;
}

bool LcmLogReader::next(LcmEvent& event) {
  for (;;) {
    if (!stream_->have(kHeader)) {
      if (stream_->available() > 0) {
        ++lost_records_;
        lose(stream_->available());
      }
      return false;
    }
    if (!plausible_header(0)) {
      ++lost_records_;
      synchronised_ = false;
      lose(1);
      if (!skip_damage()) return false;
    }
    const std::size_t channel = load_u32(stream_->data() + 20);
    const std::size_t data = load_u32(stream_->data() + 24);
    const std::size_t length = kHeader + channel + data;
    // the lengths are true where another record, or the end, follows
    if (stream_->have(length + 4) ? load_u32(stream_->data() + length) != kSync : stream_->available() != length) {
      // damage: in this record when another begins inside what it claims, else in the next
      bool inside = stream_->available() < length;
      for (std::size_t at = 4; !inside && at + kHeader <= length; ++at) inside = plausible_header(at);
      if (inside) {
        ++lost_records_;
        synchronised_ = false;
        lose(4);
        if (!skip_damage()) return false;
        continue;
      }
    }
    const char* p = stream_->data();
    event.number = load_i64(p + 4);
    event.timestamp = load_i64(p + 12);
    event.channel = {p + kHeader, channel};
    event.data = {p + kHeader + channel, data};
    event.byte = stream_->offset();
    if (!synchronised_) {
      // the logger's numbers tell how many records the damage took; one was counted when it was met
      const std::int64_t gap = last_number_ < 0 || event.number < last_number_ ? 1 : event.number - last_number_ - 1;
      if (gap > 1 && gap < stream_->size() / static_cast<std::int64_t>(kHeader)) lost_records_ += gap - 1;
      synchronised_ = true;
    }
    last_number_ = event.number;
    stream_->skip(length);
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
