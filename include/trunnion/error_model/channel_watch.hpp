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
  /// @param gyro_range counts at which a reading of either sign is saturated, 1 to 2^30
  /// @param accel_range the same of the accelerometers
  /// @param stuck_samples for which a channel may read the same at every sixteenth, 16 to 4000: a second or so; a unit
  /// whose noise is below a count wants more
  ChannelWatch(std::int32_t gyro_range, std::int32_t accel_range, int stuck_samples)
      : gyro_most_(gyro_range - 1),
        accel_most_(accel_range - 1),
        still_most_(static_cast<std::uint8_t>(stuck_samples < 16     ? 1
                                              : stuck_samples > 4000 ? 250
                                                                     : stuck_samples / 16)) {}

  /// @return kSaturated, kStuck or kOk. Saturation comes first.
  TRUNNION_INLINE Status look(const UnitOutput<std::int32_t>& y) {
    if ((++count_ & 15U) == 0U) look_for_stuck(y);
    const std::uint32_t gyro = beyond(gyro_most_, y[0]) | beyond(gyro_most_, y[1]) | beyond(gyro_most_, y[2]);
    const std::uint32_t accel = beyond(accel_most_, y[3]) | beyond(accel_most_, y[4]) | beyond(accel_most_, y[5]);
    if (((gyro | accel) >> 31U) != 0U) return look_for_saturated(y);
    return stuck_ == 0 ? Status::kOk : Status::kStuck;
  }
  /// The channels of the last kSaturated, as bits 0 to 5.
  [[nodiscard]] std::uint8_t saturated() const { return saturated_; }
  /// Those of kStuck.
  [[nodiscard]] std::uint8_t stuck() const { return stuck_; }

 private:
  /// Its top bit is set where |y| > most, without a branch and whatever y is: what wraps has it set too.
  static TRUNNION_INLINE std::uint32_t beyond(std::int32_t most, std::int32_t y) {
    const auto m = static_cast<std::uint32_t>(most);
    const auto u = static_cast<std::uint32_t>(y);
    return (m - u) | (m + u);
  }

  TRUNNION_COLD Status look_for_saturated(const UnitOutput<std::int32_t>& y) {
    saturated_ = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      if ((beyond(i < 3 ? gyro_most_ : accel_most_, y[i]) >> 31U) != 0U)
        saturated_ = static_cast<std::uint8_t>(saturated_ | (1U << i));
    }
    return Status::kSaturated;
  }
  TRUNNION_COLD void look_for_stuck(const UnitOutput<std::int32_t>& y) {
    stuck_ = 0;
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
