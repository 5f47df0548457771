// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What an MCAP recording is made of. Between two marks records: kind (8 bits), length (64), content; numbers are
/// little-endian, a text is its length (32 bits) and its bytes, a list the length of its bytes (32) and these.

#pragma once

#include <zlib.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "trunnion/io/log_format.hpp"

namespace trunnion::io {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kMcapRecordHeader = 9;  // bytes: kind and length
constexpr std::uint64_t kMcapDataEnd = 4;     // bytes of content: a checksum
constexpr std::size_t kMcapTotals = 42;       // bytes of statistics before the counts by channel

enum class McapKind : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kDataEnd = 15,
};

inline std::uint32_t mcap_crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// /imu/data and /joint_states, in compressed chunks with their indices and a summary.
std::unique_ptr<LogWriter> write_mcap(const std::string& path);

}  // namespace trunnion::io
