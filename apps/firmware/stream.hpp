// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Samples of a turning unit, made with integers alone: the same bits on every machine.
///
/// A unit of 16 bits, 2000 deg/s and 16 g at 400 Hz on a platform of two turns a second. Its base lies still, a little
/// out of level. Biases, noise and cross-coupling are there, numbers without a meaning; what the meaning is for is that
/// every branch of the chain is taken.

#pragma once

#include <cstdint>

#include "trunnion/core/binary_angle.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace firmware {

/// As it stands in the stream's file: little-endian, 32 bytes.
struct Sample {
  trunnion::UnitOutput<std::int32_t> counts;
  trunnion::BinaryAngle angle;  ///< of the platform, at the stamp
  std::int32_t temperature;     ///< 1/256 degC
};

/// Marsaglia, J. Stat. Software 8 (2003) 14: xorshift32.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : state_(seed) {}
  std::uint32_t operator()() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_;
  }
  /// Sum of four throws of -size..size, about.
  std::int32_t noise(std::int32_t size) {
    std::int32_t sum = 0;
    for (int i = 0; i < 4; ++i) sum += static_cast<std::int32_t>((*this)() >> 24U) - 127;
    return static_cast<std::int32_t>((static_cast<std::int64_t>(sum) * size) / 128);
  }

 private:
  std::uint32_t state_;
};

/// Of the platform.
class Turning {
 public:
  Sample next() {
    using trunnion::kernel::upper;
    angle_ += kStep;
    const trunnion::SinCos p = trunnion::sin_cos(angle_ - kStep / 2);
    const auto turned = [&](std::int32_t x, std::int32_t y, std::int32_t& to_x, std::int32_t& to_y) {
      // exp(-i phi): from the body to the platform; upper() of Q31 is half
      to_x += 2 * (upper(p.cosine.raw, x * 256) + upper(p.sine.raw, y * 256)) / 256;
      to_y += 2 * (upper(p.cosine.raw, y * 256) - upper(p.sine.raw, x * 256)) / 256;
    };
    Sample s{{}, angle_ & 0xfffff000U, 25 * 256 + count_ / 64};
    // counts: 938.7 by rad/s, 208.8 by m/s^2; two turns a second are 11796 counts
    s.counts = {7 + dice_.noise(3),  -5 + dice_.noise(3),  11796 + 3 + dice_.noise(3),
                20 + dice_.noise(4), -31 + dice_.noise(4), -2047 + 12 + dice_.noise(4)};
    turned(90, -40, s.counts[3], s.counts[4]);
    turned(0, 0, s.counts[0], s.counts[1]);
    ++count_;
    return s;
  }

 private:
  static constexpr trunnion::BinaryAngle kStep = 21474836;  // 1/200 of a turn
  trunnion::BinaryAngle angle_ = 0x12345678U;
  std::int32_t count_ = 0;
  Dice dice_{2463534242U};
};

/// What no unit delivers in one second: ends of ranges, zeros, single bits, jumps.
class Extremes {
 public:
  Sample next() {
    Sample s{};
    const bool in_range = (dice_() & 1U) != 0U;  // so that what refuses the others has something to do
    for (std::int32_t& count : s.counts) count = in_range ? static_cast<std::int16_t>(one()) : one();
    s.angle = dice_();
    s.temperature = one() >> (dice_() & 15U);
    return s;
  }

 private:
  std::int32_t one() {
    const std::uint32_t throw_of = dice_();
    switch (throw_of >> 29U) {
      case 0:
        return 32767;
      case 1:
        return -32768;
      case 2:
        return static_cast<std::int32_t>(0x7fffffffU + (throw_of & 1U));
      case 3:
        return static_cast<std::int32_t>(throw_of & 3U) - 1;
      case 4:
        return static_cast<std::int32_t>(std::uint32_t{1} << (throw_of & 31U));
      default:
        return static_cast<std::int32_t>(dice_()) >> (throw_of & 15U);
    }
  }
  Dice dice_{88172645U};
};

/// FNV-1a of 64 bits, by words.
class Digest {
 public:
  void add(std::uint32_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
  void add(std::int32_t number) { add(static_cast<std::uint32_t>(number)); }
  void add(std::int64_t number) {
    add(static_cast<std::uint32_t>(static_cast<std::uint64_t>(number)));
    add(static_cast<std::uint32_t>(static_cast<std::uint64_t>(number) >> 32U));
  }
  /// Every NaN is one.
  void add(float number) {
    std::uint32_t bits = 0x7fc00000U;
    if (number == number) __builtin_memcpy(&bits, &number, sizeof(bits));
    add(bits);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace firmware
