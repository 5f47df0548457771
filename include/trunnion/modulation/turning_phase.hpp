// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a turning platform is within a sample, as a BinaryAngle, and when it passes its index: from an encoder, or
/// from an index pulse and the axial gyro. Integers alone, and no division but once a turn.
///
///   encoder:   phi_mid = phi_before + (phi - phi_before) / 2                                               ... (1)
///   gyro:      phi = sum of z 2^64 / Z,   Z what z sums to over the last turn                              ... (2)
///
/// (2) ends every turn where the pulse says; how far it was off is what the demodulation is told. A pulse that is not
/// within a quarter of a whole number of turns from the last, or that would make a turn of less than 0.7 or more
/// than 1.4 of the nominal sum, is passed over; one that was missed is noticed. When three turns have gone by without
/// one that fits, the next begins anew. A nominal sum that is twice the true one, or a body that turns with half the
/// platform's speed, makes two turns one: then a pulse is passed over every turn, which passed_over shows and nothing
/// else.

#pragma once

#include <cstdint>
#include <limits>

#include "trunnion/core/binary_angle.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/modulation/revolution_average.hpp"

namespace trunnion {

/// A pulse that lies in a sample.
struct IndexPulse {
  std::int32_t before = -1;      ///< 65536ths of the sample before the pulse, 0 to 65536; negative: there is none
  std::int32_t ahead = 0;        ///< how far the phase was beyond whole turns at it: 2^32 is a turn
  std::int32_t turns = 0;        ///< since the last pulse, signed as the phase; 0: this is the first
  std::int32_t passed_over = 0;  ///< pulses since then that were none
};

class EncoderPhase {
 public:
  struct Step {
    BinaryAngle middle;  ///< phi in the middle of the sample
    std::int32_t moved;  ///< within it: less than half a turn
    IndexPulse pulse;    ///< where the angle passed zero
  };

  /// @param angle when the first sample begins
  explicit EncoderPhase(BinaryAngle angle) : last_(angle) {}

  /// @param angle at the stamp, the end of the sample
  TRUNNION_INLINE Step add(BinaryAngle angle) {
    const BinaryAngle from = last_;
    const auto moved = static_cast<std::int32_t>(angle - from);
    last_ = angle;
    Step step{from + static_cast<BinaryAngle>(moved / 2), moved, {}};
    if (moved >= 0 ? angle < from : angle > from) step.pulse = pass_zero(from, moved);
    return step;
  }
  /// Samples were lost: the next one begins at @p angle.
  void restart(BinaryAngle angle) {
    last_ = angle;
    direction_ = 0;
  }

 private:
  /// A turn lies between two passages in one direction; between one and the next in the other lies none.
  TRUNNION_COLD IndexPulse pass_zero(BinaryAngle from, std::int32_t moved) {
    const std::int32_t direction = moved < 0 ? -1 : 1;
    const IndexPulse pulse{share(from, moved), 0, direction == direction_ ? direction : 0, 0};
    direction_ = direction;
    return pulse;
  }
  static std::int32_t share(BinaryAngle from, std::int32_t moved) {
    std::uint32_t way = moved > 0 ? 0U - from : from;
    std::uint32_t size = moved > 0 ? static_cast<std::uint32_t>(moved) : 0U - static_cast<std::uint32_t>(moved);
    while (size > 0xffffU) {  // so many digits as 32 bits divide: within 4 of the 65536ths
      size >>= 1U;
      way >>= 1U;
    }
    return static_cast<std::int32_t>(way >= size ? 65536U : (way << 16U) / size);
  }

  BinaryAngle last_;
  std::int32_t direction_ = 0;  // of the last passage
};

class AxialPhase {
 public:
  /// @param full_turn what the axial output of one turn sums to: 2 pi rad times counts by rad/s times samples a second;
  /// to 15 %, 16 or more
  explicit AxialPhase(std::int64_t full_turn) : full_turn_(full_turn) { learn(full_turn, 1); }

  /// The next sample. @return phi in its middle
  TRUNNION_INLINE BinaryAngle middle(std::int32_t axial) {
    step_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(static_cast<std::int64_t>(axial)) * per_count_);
    const std::uint64_t start = phase_;
    phase_ += static_cast<std::uint64_t>(step_);
    if (step_ >= 0 ? phase_ < start : phase_ > start) turns_ += step_ >= 0 ? 1 : -1;
    sum_ += axial;
    return static_cast<BinaryAngle>((start + static_cast<std::uint64_t>(step_ / 2)) >> 32U);
  }

  /// The last sample had a pulse. @param before its 65536ths before it, 0 to 65536
  /// @param axial what middle() was told of it
  /// @return the pulse, or one with before < 0: not within a quarter of a whole number of turns, a bounce
  IndexPulse pulse(std::int32_t before, std::int32_t axial) {
    if (before < 0 || before > 65536) return {};
    const auto rest = static_cast<std::uint64_t>((step_ / 65536) * (65536 - before));
    const std::uint64_t at = phase_ - rest;
    // whole turns at the pulse: a rest that is taken back over the zero takes a turn back
    std::int32_t turns = turns_;
    if (step_ >= 0 ? at > phase_ : at < phase_) turns -= step_ >= 0 ? 1 : -1;
    const auto ahead = static_cast<std::int32_t>(at >> 32U);
    turns += ahead < 0 ? 1 : 0;  // the nearest whole number
    constexpr std::int32_t kQuarter = 1 << 30;
    const std::int64_t late = (static_cast<std::int64_t>(axial) * (65536 - before)) / 65536;
    if (started_ && (turns == 0 || ahead > kQuarter || ahead < -kQuarter || !is_likely(sum_ - late, turns))) {
      if (turns > -kLostAfter && turns < kLostAfter) {
        if (bounces_ < std::numeric_limits<std::int32_t>::max()) ++bounces_;
        return {};
      }
      started_ = false;  // whatever the gyro says, the index is here: begin anew
    }
    const IndexPulse result{before, ahead, started_ ? turns : 0, bounces_};
    if (started_) learn(sum_ - late, turns);
    sum_ = late;
    phase_ = static_cast<std::uint64_t>(late) * per_count_;  // by what has just been learnt
    turns_ = late < 0 ? -1 : 0;
    bounces_ = 0;
    started_ = true;
    return result;
  }

  /// Turns since the last pulse by the gyro: two or more, and the pulse is missing.
  [[nodiscard]] int turns_without_pulse() const { return turns_ < 0 ? -(turns_ + 1) : turns_; }
  /// Pulses passed over since the last: one in most samples, and the index is read with the wrong polarity.
  [[nodiscard]] std::int32_t bounces() const { return bounces_; }
  /// The axis was not followed for a while.
  void restart() {
    started_ = false;
    sum_ = 0;
    turns_ = bounces_ = 0;
  }

 private:
  [[nodiscard]] bool is_likely(std::int64_t sum, std::int32_t turns) const {
    const std::int64_t a_turn = (sum < 0 ? -sum : sum) / (turns < 0 ? -turns : turns);
    return a_turn > full_turn_ - full_turn_ * 3 / 10 && a_turn < full_turn_ + full_turn_ * 4 / 10;
  }
  /// 2^64 turns / |sum|: the sum's own sign stays with the axial output.
  void learn(std::int64_t sum, std::int32_t turns) {
    const auto size = static_cast<std::uint64_t>(sum < 0 ? -sum : sum);
    const auto count = static_cast<std::uint64_t>(turns < 0 ? -turns : turns);
    if (size >= 16U * count) per_count_ = (~std::uint64_t{0} / size) * count;
  }

  static constexpr std::int32_t kLostAfter = 3;  // turns

  std::int64_t full_turn_;
  std::uint64_t phase_ = 0;  // 2^64 is a turn
  std::uint64_t per_count_ = 0;
  std::int64_t step_ = 0;
  std::int64_t sum_ = 0;
  std::int32_t turns_ = 0;  // floor of the phase since the last pulse
  std::int32_t bounces_ = 0;
  bool started_ = false;
};

}  // namespace trunnion
