// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A calibration as bytes for flash: `imu_calibrate export --block` writes it, firmware reads it where it lies.
///
///   magic "TRUN", version, size of the whole, CRC-32 of the whole but itself, then the coefficients       ... (1)
///
/// CRC-32: polynomial 0x04c11db7 reflected, start and end inverted (IEEE 802.3). Every number is little-endian and at
/// its natural alignment. A block is refused that is damaged in any bit, of another version, or of the other byte
/// order.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "trunnion/core/status.hpp"
#include "trunnion/error_model/count_correction.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

/// Of @p size bytes, from @p crc of those before. Eight steps a byte and no table: a block is checked once, at start.
constexpr std::uint32_t crc32(const unsigned char* bytes, std::size_t size, std::uint32_t crc = 0) {
  crc = ~crc;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ (0xedb88320U & (0U - (crc & 1U)));
  }
  return ~crc;
}

struct FlashBlock {
  static constexpr std::uint32_t kMagic = 0x4e555254U;           // "TRUN" as bytes
  static constexpr std::uint32_t kMagicElsewhere = 0x5452554eU;  // the same, of the other byte order
  static constexpr std::uint32_t kVersion = 2;

  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t size = 0;
  std::uint32_t crc = 0;
  UnitCorrection<float>::Coefficients unit{};  ///< of raw counts where has_counts, else of readings in SI
  std::int32_t has_counts = 0;                 ///< 0: readings in SI; 1: raw counts, counts filled; 2: unfilled
  CountCoefficients counts{};
  std::array<char, 32> name{};  ///< model and serial, the rest zeros

  [[nodiscard]] std::uint32_t check() const {
    const auto* bytes = reinterpret_cast<const unsigned char*>(this);
    constexpr std::size_t kAfter = 4 * sizeof(std::uint32_t);
    return crc32(bytes + kAfter, sizeof(FlashBlock) - kAfter, crc32(bytes, kAfter - sizeof(crc)));
  }
  /// Fills in size and CRC.
  void seal() {
    size = sizeof(FlashBlock);
    crc = check();
  }
};
static_assert(sizeof(FlashBlock) == 736 && alignof(FlashBlock) <= 8, "the block is a format: no padding may move it");

/// The block at @p address, in place.
/// @param bytes that may be read there
/// @return kOutOfRange when too few or not at a multiple of eight, kOtherByteOrder, kOtherVersion, or kDamaged
inline Result<const FlashBlock*> read_flash_block(const void* address, std::size_t bytes) {
  if (address == nullptr || reinterpret_cast<std::uintptr_t>(address) % 8U != 0 || bytes < sizeof(FlashBlock))
    return Status::kOutOfRange;
  const auto* block = static_cast<const FlashBlock*>(address);
  if (block->magic == FlashBlock::kMagicElsewhere) return Status::kOtherByteOrder;
  if (block->magic != FlashBlock::kMagic) return Status::kDamaged;
  if (block->version != FlashBlock::kVersion) return Status::kOtherVersion;
  if (block->size != sizeof(FlashBlock) || block->crc != block->check()) return Status::kDamaged;
  if (block->has_counts < 0 || block->has_counts > 2 || !block->counts.is_usable()) return Status::kDamaged;
  return block;
}

}  // namespace trunnion
