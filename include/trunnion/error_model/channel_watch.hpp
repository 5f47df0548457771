// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether raw counts are what a working sensor delivers.
///
/// A reading at the end of its range says nothing but "at least": every sample is held against it. A channel that has
/// not moved by one count for a while has no noise, and so is no sensor: every sixteenth sample is held against the one
/// before.

#pragma once

#include <array>
#include <cstdint>

#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

class ChannelWatch {
 public:
  /// @param gyro_range, @param accel_range counts at which a reading is saturated, positive
  /// @param stuck_samples for which a channel may read the same at every sixteenth, 16 to 4000: a second or so; a unit
  /// whose noise is below a count wants more
  ChannelWatch(std::int32_t gyro_range, std::int32_t accel_range, int stuck_samples)
      : gyro_most_(gyro_range - 1),
        accel_most_(accel_range - 1),
        still_most_(static_cast<std::uint8_t>(stuck_samples < 16     ? 1
                                              : stuck_samples > 4000 ? 250
                                                                     : stuck_samples / 16)) {}

  /// @return kSaturated (which() has bits 0 to 5 of the channels), kStuck (likewise), or kOk. Saturation comes first.
  TRUNNION_INLINE Status look(const UnitOutput<std::int32_t>& y) {
    if ((++count_ & 15U) == 0U) look_for_stuck(y);
    // negative where |y| > most; the magnitude without a branch, and without that of the least integer overflowing
    const std::int32_t gyro = (gyro_most_ - size(y[0])) | (gyro_most_ - size(y[1])) | (gyro_most_ - size(y[2]));
    const std::int32_t accel = (accel_most_ - size(y[3])) | (accel_most_ - size(y[4])) | (accel_most_ - size(y[5]));
    if ((gyro | accel) < 0) return look_for_saturated(y);
    return stuck_ == 0 ? Status::kOk : Status::kStuck;
  }
  /// The channels of the last kSaturated or kStuck.
  [[nodiscard]] std::uint8_t which() const { return saturated_ != 0 ? saturated_ : stuck_; }

 private:
  /// |y|, or one less of a negative one.
  static TRUNNION_INLINE std::int32_t size(std::int32_t y) { return y ^ (y >> 31); }

  TRUNNION_COLD Status look_for_saturated(const UnitOutput<std::int32_t>& y) {
    saturated_ = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      if (size(y[i]) > (i < 3 ? gyro_most_ : accel_most_))
        saturated_ = static_cast<std::uint8_t>(saturated_ | (1U << i));
    }
    return Status::kSaturated;
  }
  TRUNNION_COLD void look_for_stuck(const UnitOutput<std::int32_t>& y) {
    stuck_ = saturated_ = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const auto low = static_cast<std::uint16_t>(y[i]);
      still_[i] = low != last_[i] ? std::uint8_t{0} : static_cast<std::uint8_t>(still_[i] + (still_[i] < 255 ? 1 : 0));
      last_[i] = low;
      if (still_[i] >= still_most_) stuck_ = static_cast<std::uint8_t>(stuck_ | (1U << i));
    }
  }

  std::int32_t gyro_most_;
  std::int32_t accel_most_;
  std::array<std::uint16_t, 6> last_{};  // the low digits: a channel that moves by multiples of 65536 alone is none
  std::array<std::uint8_t, 6> still_{};
  std::uint8_t still_most_;
  std::uint8_t count_ = 0;
  std::uint8_t stuck_ = 0;
  std::uint8_t saturated_ = 0;
};

}  // namespace trunnion
