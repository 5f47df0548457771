// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rotation modulation with an index pulse a turn and no angle sensor: whole-turn means, in floating point or exactly
/// in integers.
///
/// A unit S turns about an axis fixed in the body. What is constant in the body averages to zero across the axis over a
/// whole turn; what is constant in the unit, its bias, stays:
///
///   b_xy = (1/T) integral of the output over a turn,   W = +-2 pi / T,   w_body,axial = mean w_z - W       ... (1)
///
/// The pulse falls within a sample: of that sample the fraction before the pulse belongs to the turn that ends, the
/// rest to the one that begins,
///
///   sum = (1 - r_0) s_0 + s_1 + ... + s_(n-1) + r_n s_n                                                    ... (2)
///
/// so that the scatter of (1) is that of white noise over T, not that of the sampling (docs/theory/modulation.md).
/// The axial sum tells how many turns lie between two pulses: a pulse that bounces or has no business there is passed
/// over, a missed one noticed, and the mean over two or three turns is as good as over one. It tells as long as the
/// body itself turns about the axis by less than a quarter of the platform's speed; beyond, pulses are passed over, or
/// two turns taken for one: a bounce every turn is the sign of it. In integers, r counts in 65536ths and sums are
/// exact; a sample costs additions alone.

#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

/// How sums over samples of type C are kept: sample * kOne is one sample.
template <class C, bool = std::is_integral_v<C>>
struct RevolutionSum {
  using Type = C;
  static constexpr Type kOne = C(1);
};
template <class C>
struct RevolutionSum<C, true> {
  static_assert(sizeof(C) <= 4, "sums are kept for counts of up to 32 bits");
  using Type = std::int64_t;
  static constexpr Type kOne = 65536;
};

template <class C>
struct Revolution {
  using Sum = typename RevolutionSum<C>::Type;
  std::array<Sum, 6> sum{};  ///< eq. (2), in outputs times kOne
  Sum samples{};             ///< in kOne: T is samples / kOne sample periods
  int turns = 0;             ///< between the two pulses: more than one where pulses were missed
  int bounces = 0;           ///< pulses passed over within it
  bool saturated = false;    ///< the axial gyro was at its range: turns comes from the time of the turn before

  /// More samples with a pulse than without: the pulse is read with the wrong polarity.
  [[nodiscard]] bool is_index_inverted() const {
    return static_cast<Sum>(bounces) * Sum(2) * RevolutionSum<C>::kOne > samples;
  }

  /// Mean of an output over the turn, eq. (1); integers round to the nearest count. Zero before there is a turn.
  [[nodiscard]] C mean(std::size_t output) const {
    const Sum s = sum[output];
    if (!(samples > Sum(0))) return C(0);
    if constexpr (std::is_integral_v<C>) {
      const Sum half = samples / 2;
      return static_cast<C>((s >= 0 ? s + half : s - half) / samples);
    } else {
      return s / samples;
    }
  }
};

/// What an index pulse turned out to be.
enum class Pulse : std::uint8_t {
  kFirst,   ///< a turn begins; none was open
  kTurn,    ///< a turn, or several of which pulses were missed, is complete
  kBounce,  ///< not within a quarter of a whole number of turns after the last: passed over
};

namespace kernel {

/// Written out: at -O2 and at -Os it would stay a loop.
/// @tparam InOrder channel by channel, which costs fewest registers
template <bool InOrder, class Sum, class C>
TRUNNION_INLINE void add(std::array<Sum, 6>& sum, const UnitOutput<C>& sample) {
  const auto add_one = [&sum, &sample](std::size_t i) TRUNNION_INLINE_LAMBDA {
    sum[i] += static_cast<Sum>(sample[i]);
    if constexpr (InOrder) TRUNNION_IN_ORDER;
  };
  add_one(0);
  add_one(1);
  add_one(2);
  add_one(3);
  add_one(4);
  add_one(5);
}

}  // namespace kernel

/// @tparam MostSamples in a turn; a longer one is broken off
/// @tparam WatchesRange false: the caller watches (error_model/channel_watch.hpp) and calls mark_saturated()
template <class C, int MostSamples = 32767, bool WatchesRange = true>
class RevolutionAverage {
  static_assert(MostSamples >= 2, "a turn has samples");
  static_assert(!std::is_integral_v<C> || MostSamples <= (std::int64_t{1} << (8 * (6 - sizeof(C)) - 1)),
                "a turn of so many samples would overflow the 64 bits of its sums");

 public:
  using Sum = typename RevolutionSum<C>::Type;
  static constexpr Sum kOne = RevolutionSum<C>::kOne;

  /// @param axial output along the axis, 0, 1 or 2 (gyro x, y, z)
  /// @param full_turn what the axial output of one turn sums to: 2 pi rad by outputs a rad/s by samples a second;
  /// positive
  /// @param axial_range output at which the axial gyro saturates; 0: unknown
  RevolutionAverage(std::size_t axial, Sum full_turn, C axial_range)
      : axial_(axial),
        full_turn_(full_turn),
        axial_range_(axial_range),
        near_range_(static_cast<C>(axial_range - axial_range / C(200))) {}

  /// A sample without a pulse.
  /// @return kTimeOut when for MostSamples no pulse has come: the turn is broken off, a new one begins with the next
  TRUNNION_INLINE Status add(const UnitOutput<C>& sample) {
    kernel::add<true>(whole_, sample);
    look_at_range(sample);
    if (++count_ < MostSamples) return Status::kOk;
    return time_out();
  }

  /// A sample with a pulse in it. @param before fraction of the sample that lies before the pulse, in [0, kOne]
  /// @return kTurn: the turn stands in turn()
  Pulse add_with_pulse(const UnitOutput<C>& sample, Sum before) {
    if (!(before >= Sum(0) && before <= kOne)) {
      (void)add(sample);
      return Pulse::kBounce;
    }
    look_at_range(sample);
    const Sum samples = static_cast<Sum>(count_) * kOne + edge_share_ + before;
    const Sum angle = sum(axial_) + static_cast<Sum>(sample[axial_]) * before;
    const Sum size = angle < Sum(0) ? -angle : angle;
    const Sum turn_size = full_turn_ * kOne;
    int turns = whole(size, turn_size);
    Sum off = size - static_cast<Sum>(turns) * turn_size;
    if (saturated_) {  // the gyro says too little: the last turn's time may say more
      if (closed_.turns > 0) {
        const int by_time = whole(samples, closed_.samples / static_cast<Sum>(closed_.turns));
        turns = by_time > turns ? by_time : turns;
      }
      off = Sum(0);
    }
    if (started_ && (turns < 1 || (off < Sum(0) ? -off : off) > turn_size / Sum(4))) {
      ++bounces_;
      (void)add(sample);
      return Pulse::kBounce;
    }
    const Pulse pulse = started_ ? Pulse::kTurn : Pulse::kFirst;
    if (started_) {
      for (std::size_t i = 0; i < sample.size(); ++i) closed_.sum[i] = sum(i) + static_cast<Sum>(sample[i]) * before;
      closed_.samples = samples;
      closed_.turns = turns;
      closed_.bounces = bounces_;
      closed_.saturated = saturated_;
    }
    begin();
    saturated_ = is_saturated(sample);
    started_ = true;
    edge_share_ = kOne - before;
    edge_ = sample;
    return pulse;
  }

  /// The axial gyro was at its range in the last sample.
  void mark_saturated() { saturated_ = true; }
  /// Forgets the open turn: the axis was not followed for a while.
  void restart() {
    begin();
    closed_.turns = 0;  // the next turn may have another speed
    started_ = false;
  }

  /// The last complete turn.
  [[nodiscard]] const Revolution<C>& turn() const { return closed_; }

  /// Turns since the last pulse, by the axial gyro: two or more, and the pulse is missing.
  [[nodiscard]] int turns_without_pulse() const {
    const Sum angle = sum(axial_);
    return static_cast<int>((angle < Sum(0) ? -angle : angle) / (full_turn_ * kOne));
  }

 private:
  /// The whole number nearest to size / unit; 0 when that is not to be told.
  static int whole(const Sum& size, const Sum& unit) {
    const bool countable = unit > Sum(0) && size / unit < Sum(32767);
    return countable ? static_cast<int>((size + unit / Sum(2)) / unit) : 0;
  }
  TRUNNION_COLD Status time_out() {
    restart();
    return Status::kTimeOut;
  }
  /// Of the open turn so far.
  [[nodiscard]] Sum sum(std::size_t output) const {
    return whole_[output] * kOne + static_cast<Sum>(edge_[output]) * edge_share_;
  }
  void begin() {
    whole_ = {};
    edge_ = {};
    edge_share_ = Sum(0);
    count_ = bounces_ = 0;
    saturated_ = false;
  }
  [[nodiscard]] TRUNNION_INLINE bool is_saturated(const UnitOutput<C>& sample) const {
    if constexpr (!WatchesRange) return false;
    const C z = sample[axial_];
    return axial_range_ > C(0) && (z >= near_range_ || z <= -near_range_);
  }
  TRUNNION_INLINE void look_at_range(const UnitOutput<C>& sample) {
    if (is_saturated(sample)) saturated_ = true;
  }

  std::size_t axial_;
  Sum full_turn_;
  C axial_range_;
  C near_range_;                // a reading within half a per cent of the range is at it
  std::array<Sum, 6> whole_{};  // of the open turn: samples that lie in it whole,
  UnitOutput<C> edge_{};        // and the one that its first pulse fell in
  Sum edge_share_{};
  int count_ = 0;
  int bounces_ = 0;
  bool saturated_ = false;
  Revolution<C> closed_;
  bool started_ = false;
};

}  // namespace trunnion
