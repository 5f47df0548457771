// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/error_model/flash_block.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>

namespace trunnion {
namespace {

static_assert(std::is_trivially_copyable_v<FlashBlock>);
constexpr std::size_t kSize = sizeof(FlashBlock);

struct alignas(8) Bytes {
  std::array<unsigned char, kSize + 8> at{};
};

FlashBlock filled() {
  InertialUnit<double> unit;
  unit.gyro.bias << 0.01, -0.02, 0.03;
  unit.accel.M(0, 1) = 0.002;
  const UnitScale<double> scale{{938.73, 0.0}, {208.83, 0.0}};
  FlashBlock block;
  block.unit = UnitCorrection<float>(unit, scale).coefficients();
  block.counts = count_calibration(unit, scale, 16, 6).value().coefficients;
  block.has_counts = 1;
  std::memcpy(block.name.data(), "TEST 1", 6);
  block.seal();
  return block;
}

Bytes bytes_of(const FlashBlock& block) {
  Bytes bytes;
  std::memcpy(bytes.at.data(), &block, kSize);
  return bytes;
}

// The check value of CRC-32 in every catalogue; and in two parts as in one.
TEST(Crc32, HasItsCheckValue) {
  const std::string digits = "123456789";
  const auto* bytes = reinterpret_cast<const unsigned char*>(digits.data());
  EXPECT_EQ(crc32(bytes, 9), 0xcbf43926U);
  EXPECT_EQ(crc32(bytes + 4, 5, crc32(bytes, 4)), 0xcbf43926U);
  EXPECT_EQ(crc32(bytes, 0), 0U);
}

TEST(FlashBlock, IsReadWhereItLies) {
  const FlashBlock block = filled();
  const Bytes bytes = bytes_of(block);
  const auto read = read_flash_block(bytes.at.data(), kSize);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(static_cast<const void*>(read.value()), bytes.at.data());
  EXPECT_EQ(std::memcmp(read.value(), &block, kSize), 0);
  const UnitCorrection<float> correction(read.value()->unit);
  const InertialSample<float> zero;
  EXPECT_NEAR(correction.correct(zero).w.x(), -0.01F, 1e-8F);
}

TEST(FlashBlock, RefusesEveryBitThatFlips) {
  const Bytes good = bytes_of(filled());
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * kSize; ++bit) {
    Bytes bytes = good;
    bytes.at[bit / 8] = static_cast<unsigned char>(bytes.at[bit / 8] ^ (1U << (bit % 8)));
    const auto read = read_flash_block(bytes.at.data(), kSize);
    EXPECT_FALSE(read.ok()) << "bit " << bit;
    refused += read.ok() ? 0 : 1;
  }
  std::printf("[ FIGURE   ] flash block: %d of %zu single-bit flips refused\n", refused, 8 * kSize);
}

// Sealed anew, so that nothing but the version is wrong.
TEST(FlashBlock, RefusesEveryOtherVersion) {
  const auto refused = [](std::uint32_t version) {
    FlashBlock block = filled();
    block.version = version;
    block.seal();
    return read_flash_block(&block, kSize).status();
  };
  for (std::uint32_t version = 0; version < 1000; ++version) {
    if (version == FlashBlock::kVersion) continue;
    ASSERT_EQ(refused(version), Status::kOtherVersion) << version;
  }
  for (std::uint32_t bit = 0; bit < 32; ++bit)
    EXPECT_EQ(refused(FlashBlock::kVersion ^ (1U << bit)), Status::kOtherVersion);
}

TEST(FlashBlock, RefusesTheOtherByteOrder) {
  Bytes bytes = bytes_of(filled());
  for (std::size_t word = 0; word < kSize; word += 4) {
    std::swap(bytes.at[word], bytes.at[word + 3]);
    std::swap(bytes.at[word + 1], bytes.at[word + 2]);
  }
  EXPECT_EQ(read_flash_block(bytes.at.data(), kSize).status(), Status::kOtherByteOrder);
}

// Sealed, but by no factory of ours: a shift that no processor defines must not be reached.
TEST(FlashBlock, RefusesCountsThatCannotBe) {
  const auto status = [](int bits, int shift, int linear, int has_counts) {
    FlashBlock block = filled();
    block.counts.bits = static_cast<std::int16_t>(bits);
    block.counts.shift = static_cast<std::int16_t>(shift);
    block.counts.is_linear = linear;
    block.has_counts = has_counts;
    block.seal();
    return read_flash_block(&block, kSize).status();
  };
  EXPECT_EQ(status(16, 8, 1, 1), Status::kOk);
  for (const auto& bad :
       {std::array<int, 4>{0, 8, 1, 1}, {16, 40, 1, 1}, {16, 17, 1, 1}, {16, 0, 1, 1}, {16, 8, 2, 1}, {16, 8, 1, 3}})
    EXPECT_EQ(status(bad[0], bad[1], bad[2], bad[3]), Status::kDamaged);
  FlashBlock without;  // of a calibration in SI
  without.seal();
  const auto read = read_flash_block(&without, kSize);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(CountCorrection(read.value()->counts).correct_saturated({7, 7, 7, 7, 7, 7}), (UnitOutput<std::int32_t>{}));
}

TEST(FlashBlock, RefusesErasedShortAndCrookedMemory) {
  Bytes bytes = bytes_of(filled());
  EXPECT_EQ(read_flash_block(bytes.at.data(), kSize - 1).status(), Status::kOutOfRange);
  EXPECT_EQ(read_flash_block(nullptr, kSize).status(), Status::kOutOfRange);
  std::memmove(bytes.at.data() + 4, bytes.at.data(), kSize);
  EXPECT_EQ(read_flash_block(bytes.at.data() + 4, kSize).status(), Status::kOutOfRange);
  for (const unsigned char fill : {std::uint8_t{0}, std::uint8_t{0xff}}) {
    bytes.at.fill(fill);
    EXPECT_EQ(read_flash_block(bytes.at.data(), kSize).status(), Status::kDamaged);
  }
}

}  // namespace
}  // namespace trunnion
