// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A turning unit in integers: over whole turns, what the body feels and what the unit adds, the same bits everywhere.
///
/// Frame p is fixed to the unit, its z is the axis, phi the angle of p against the body, from turning_phase.hpp. With
/// m = x + i y of gyros and of accelerometers:
///
///   a = sum m,   b = sum exp(i phi) m,   e = sum exp(i phi)       over a turn, whole samples on 64 bits       ... (1)
///   u = g (b - e a) / (1 - |e|^2),   bias = (a - e* b) / (1 - |e|^2),   g = 1 / sinc,   of the sums' means     ... (2)
///
/// A sample costs additions and products; every division is once a turn, and only when its result is asked for. Of the
/// sample that a pulse falls in, whole counts go to either side and none is lost: the sums are exact. The phasor has as
/// many digits as leave room for MostSamples full readings: 31 where there is.
/// AngleBins does the same for less a sample and more memory. docs/theory/modulation.md, section 2.

#pragma once

#include <array>
#include <cstdint>

#include "trunnion/core/binary_angle.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/modulation/revolution_average.hpp"
#include "trunnion/modulation/turning_phase.hpp"

namespace trunnion {

/// A turn, or several of which pulses were missed; T: std::int32_t in 2^-kFraction counts, or float or double in
/// counts.
template <class T>
struct TurnSplit {
  UnitOutput<T> body{};  ///< u of (2) in body axes; along the axis the mean
  UnitOutput<T> unit{};  ///< bias of (2) in p; along the axis the mean
  /// false: no turn, less than four samples in one, a speed that changed too much within it, or a doubtful record.
  bool valid = false;
};

namespace kernel {

constexpr int bits_of(std::int64_t value) {
  int bits = 0;
  while ((std::int64_t{1} << bits) < value) ++bits;
  return bits;
}

/// To the nearest; @p divisor positive.
constexpr std::int64_t divided(std::int64_t value, std::int64_t divisor) {
  const std::int64_t half = divisor / 2;
  return (value >= 0 ? value + half : value - half) / divisor;
}

/// The sums of (1).
struct TurnSums {
  std::array<std::int64_t, 6> a{};
  std::array<std::int64_t, 4> b{};  // gyro x, y, accelerometer x, y
  std::array<std::int64_t, 2> e{};

  /// @p s, @p c the phasor
  void add(const UnitOutput<std::int32_t>& y, std::int32_t s, std::int32_t c) {
    const std::int32_t minus_s = -s;
    b[0] = b[0] + static_cast<std::int64_t>(y[0]) * c + static_cast<std::int64_t>(y[1]) * minus_s;
    TRUNNION_IN_ORDER;
    b[1] = b[1] + static_cast<std::int64_t>(y[0]) * s + static_cast<std::int64_t>(y[1]) * c;
    TRUNNION_IN_ORDER;
    b[2] = b[2] + static_cast<std::int64_t>(y[3]) * c + static_cast<std::int64_t>(y[4]) * minus_s;
    TRUNNION_IN_ORDER;
    b[3] = b[3] + static_cast<std::int64_t>(y[3]) * s + static_cast<std::int64_t>(y[4]) * c;
    TRUNNION_IN_ORDER;
    e[0] += c;
    e[1] += s;
    TRUNNION_IN_ORDER;
    kernel::add<true>(a, y);
  }
};

/// value share / 65536, rounded down.
TRUNNION_INLINE std::int32_t share_of(std::int32_t value, std::int32_t share) {
  return static_cast<std::int32_t>((static_cast<std::int64_t>(value) * share) >> 16);
}

/// By a processor's own conversions, which take 32 bits: no library, the same bits everywhere. To three roundings.
template <class T>
T real(std::int64_t value) {
  const auto size =
      value < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  const T sum = static_cast<T>(static_cast<std::uint32_t>(size >> 32U)) * T(4294967296.0) +
                static_cast<T>(static_cast<std::uint32_t>(size));
  return value < 0 ? -sum : sum;
}

/// 1 / sinc of half of @p turns in @p samples (65536ths), Q30: what the mean over a sample lost of a vector that turns.
constexpr std::int64_t inverse_sinc(std::int64_t samples, std::int64_t turns) {
  constexpr auto kPi2 = static_cast<std::int64_t>(kPi * kPi * 268435456.0);  // Q28
  const std::int64_t per_sample = divided(turns << 46, samples);             // Q30
  const std::int64_t a2 = (((per_sample * per_sample) >> 30) * kPi2) >> 28;  // (pi turns / samples)^2, Q30
  const std::int64_t a4 = (a2 * a2) >> 30;
  return (std::int64_t{1} << 30) + a2 / 6 + a4 * 7 / 360 + ((a4 * a2) >> 30) * 31 / 15120;
}

/// @p a + i @p b times the phasor.
constexpr void turn_by(const SinCos& phasor, std::int32_t& a, std::int32_t& b) {
  const std::int64_t s = phasor.sine.raw;
  const std::int64_t c = phasor.cosine.raw;
  const auto turned = static_cast<std::int32_t>(round_shift(c * a - s * b, 31));
  b = static_cast<std::int32_t>(round_shift(s * a + c * b, 31));
  a = turned;
}

}  // namespace kernel

/// The sums of a complete turn.
struct TurnRecord {
  kernel::TurnSums sums;     ///< a in counts, b and e in 2^-PhasorBits of them
  std::int32_t samples = 0;  ///< in 65536ths
  std::int32_t ahead = 0;    ///< how far the phase was from whole turns at the pulse: 2^32 is a turn
  std::int16_t turns = 0;    ///< between the two pulses, positive
  bool saturated = false;    ///< mark_saturated() was called in it
  bool reversed = false;     ///< the axial gyro turned against the phase: one of the two has the wrong sign
  /// Pulses within it that were none (AxialPhase): one every turn, and turns are miscounted.
  std::int16_t passed_over = 0;

  /// More pulses than samples without: the index is read with the wrong polarity.
  [[nodiscard]] bool index_inverted() const { return passed_over > samples / 131072; }
  /// A phase off by more than 0.3 rad, of the wrong sign, or by an index that is none.
  [[nodiscard]] bool is_doubtful() const {
    constexpr std::int32_t kFar = 205074450;
    return ahead > kFar || ahead < -kFar || reversed || index_inverted();
  }
};

/// @tparam Bits of the readings, sign included: |reading| <= 2^(Bits-1)
/// @tparam MostSamples of a turn, or without a pulse
template <int Bits, int MostSamples>
class CountDemodulator {
  static constexpr int kRoom = 63 - Bits - kernel::bits_of(MostSamples);

 public:
  static_assert(Bits >= 8 && Bits <= 30, "readings have 8 to 30 bits");
  static_assert(MostSamples >= 8 && MostSamples < 32767, "a turn has 8 to 32766 samples");
  static constexpr int kPhasorBits = kRoom < 31 ? kRoom : 31;
  static_assert(kPhasorBits >= 22,
                "a turn of so many samples of so many bits overflows its sums: fewer of one of them");
  /// Digits behind the point that a TurnSplit<std::int32_t> has.
  static constexpr int kFraction = [] {
    const int by_reading = 30 - Bits;
    const int by_sum = kPhasorBits - 16;
    const int least = by_reading < by_sum ? by_reading : by_sum;
    return least < 8 ? least : 8;
  }();

  /// A sample without a pulse. @param phasor of its middle
  /// @return kTimeOut when no pulse came for MostSamples: the open turn is forgotten
  TRUNNION_INLINE Status add(const UnitOutput<std::int32_t>& sample, const SinCos& phasor) {
    sums_.add(sample, phasor.sine.raw >> kLess, phasor.cosine.raw >> kLess);
    if (++count_ < static_cast<std::int16_t>(MostSamples)) return Status::kOk;
    return time_out();
  }

  /// A sample with a pulse in it, of which turning_phase.hpp has seen that it is one; with a pulse that is none, as
  /// add().
  /// @return whether a turn is complete: it stands in record(), until the next
  TRUNNION_COLD bool add_with_pulse(const UnitOutput<std::int32_t>& sample, const SinCos& phasor,
                                    const IndexPulse& pulse) {
    if (pulse.before < 0 || pulse.before > kOne) {
      (void)add(sample, phasor);
      return false;
    }
    const std::int32_t s = phasor.sine.raw >> kLess;
    const std::int32_t c = phasor.cosine.raw >> kLess;
    const bool complete = started_ && pulse.turns != 0 && pulse.turns > -32768 && pulse.turns < 32768;
    UnitOutput<std::int32_t> part{};
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = kernel::share_of(sample[i], pulse.before);
    add_part(part, s, c, pulse.before);
    if (complete) {
      record_.sums = sums_;
      record_.samples = count_ * kOne + first_share_ + pulse.before;
      record_.ahead = pulse.ahead;
      record_.turns = static_cast<std::int16_t>(pulse.turns < 0 ? -pulse.turns : pulse.turns);
      record_.saturated = saturated_;
      record_.passed_over = static_cast<std::int16_t>(pulse.passed_over < 32767 ? pulse.passed_over : 32767);
      record_.reversed = (sums_.a[2] < 0) != (pulse.turns < 0);
    }
    restart();
    started_ = true;
    first_share_ = kOne - pulse.before;
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = sample[i] - part[i];
    add_part(part, s, c, first_share_);
    return complete;
  }

  /// @p count samples at one angle, their sums; @p sine and @p cosine in Q31, of more than 32 bits.
  void add_many(const std::array<std::int64_t, 6>& sum, std::int32_t count, std::int64_t sine, std::int64_t cosine) {
    const std::int64_t s = sine >> kLess;
    const std::int64_t c = cosine >> kLess;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::int64_t x = sum[3 * i];
      const std::int64_t y = sum[3 * i + 1];
      sums_.b[2 * i] += x * c - y * s;
      sums_.b[2 * i + 1] += x * s + y * c;
    }
    for (std::size_t i = 0; i < 6; ++i) sums_.a[i] += sum[i];
    sums_.e[0] += count * c;
    sums_.e[1] += count * s;
    count_ = static_cast<std::int16_t>(count_ + count);
  }

  [[nodiscard]] const TurnRecord& record() const { return record_; }

  /// Eq. (2) of a record in integers; some twenty divisions.
  [[nodiscard]] static TurnSplit<std::int32_t> split(const TurnRecord& r) {
    TurnSplit<std::int32_t> result;
    if (!is_sampled(r)) return result;
    const std::int64_t n = r.samples;
    const std::int64_t gain = kernel::inverse_sinc(n, r.turns);
    UnitOutput<std::int32_t> mean;
    for (std::size_t i = 0; i < 6; ++i)
      mean[i] = saturate(kernel::divided(r.sums.a[i] * (std::int64_t{1} << (16 + kFraction)), n));
    std::array<std::int32_t, 6> b;  // and e, Q30
    for (std::size_t i = 0; i < 6; ++i) {
      const std::int64_t sum = i < 4 ? r.sums.b[i] >> (kPhasorBits - 16 - kFraction)
                                     : r.sums.e[i - 4] * (std::int64_t{1} << (46 - kPhasorBits));
      b[i] = saturate(kernel::divided(sum, n));
    }
    // the phase ran ahead evenly: by half of it on average
    const SinCos back = sin_cos(static_cast<BinaryAngle>(-(r.ahead / 2)));
    for (std::size_t i = 0; i < 6; i += 2) kernel::turn_by(back, b[i], b[i + 1]);
    constexpr std::int64_t kUnit = std::int64_t{1} << 30;
    const std::int64_t re = b[4];
    const std::int64_t im = b[5];
    const std::int64_t rest = kUnit - ((re * re + im * im) >> 30);
    result.valid = rest > kUnit / 2 && !r.is_doubtful();
    for (std::size_t i = 0; i < 4 && result.valid; i += 2) {
      const std::size_t k = i == 0 ? 0 : 3;
      const std::int64_t ax = mean[k];
      const std::int64_t ay = mean[k + 1];
      result.body[k] = gained(kernel::divided(b[i] * kUnit - (re * ax - im * ay), rest), gain);
      result.body[k + 1] = gained(kernel::divided(b[i + 1] * kUnit - (re * ay + im * ax), rest), gain);
      result.unit[k] = saturate(kernel::divided(ax * kUnit - (re * b[i] + im * b[i + 1]), rest));
      result.unit[k + 1] = saturate(kernel::divided(ay * kUnit - (re * b[i + 1] - im * b[i]), rest));
    }
    result.body[2] = result.unit[2] = mean[2];
    result.body[5] = result.unit[5] = mean[5];
    return result;
  }

  /// The same in float or double, for a processor that has them: smaller, and what an estimator takes.
  template <class T>
  [[nodiscard]] static TurnSplit<T> split_as(const TurnRecord& r) {
    TurnSplit<T> result;
    if (!is_sampled(r)) return result;
    constexpr double kSmall = 1.0 / 65536.0;
    const T n = T(1) / (static_cast<T>(r.samples) * T(kSmall));
    const T a = T(kPi) * static_cast<T>(r.turns) * n;
    const T a2 = a * a;
    const T gain = T(1) + a2 * (T(1.0 / 6.0) + a2 * (T(7.0 / 360.0) + a2 * T(31.0 / 15120.0)));
    const T per_turning = n * T(1.0 / static_cast<double>(std::int64_t{1} << kPhasorBits));
    // of a small angle its sine and cosine to fourth order: half a radian at most
    const T back = static_cast<T>(r.ahead) * T(-kPi / 4294967296.0);
    const T back2 = back * back;
    const T s = per_turning * back * (T(1) - back2 * T(1.0 / 6.0));
    const T c = per_turning * (T(1) - back2 * (T(0.5) - back2 * T(1.0 / 24.0)));
    const auto turned_x = [&](std::int64_t x, std::int64_t y) {
      return c * kernel::real<T>(x) - s * kernel::real<T>(y);
    };
    const T re = turned_x(r.sums.e[0], r.sums.e[1]);
    const T im = turned_x(r.sums.e[1], -r.sums.e[0]);
    const T rest = T(1) - (re * re + im * im);
    result.valid = rest > T(0.5) && !r.is_doubtful();
    const T over = T(1) / rest;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t k = 3 * i;
      const T ax = kernel::real<T>(r.sums.a[k]) * n;
      const T ay = kernel::real<T>(r.sums.a[k + 1]) * n;
      const T bx = turned_x(r.sums.b[2 * i], r.sums.b[2 * i + 1]);
      const T by = turned_x(r.sums.b[2 * i + 1], -r.sums.b[2 * i]);
      result.body[k] = (bx - (re * ax - im * ay)) * (gain * over);
      result.body[k + 1] = (by - (re * ay + im * ax)) * (gain * over);
      result.unit[k] = (ax - (re * bx + im * by)) * over;
      result.unit[k + 1] = (ay - (re * by - im * bx)) * over;
      result.body[k + 2] = result.unit[k + 2] = kernel::real<T>(r.sums.a[k + 2]) * n;
    }
    return result;
  }

  /// Both of record().
  [[nodiscard]] TurnSplit<std::int32_t> split() const { return split(record_); }
  template <class T>
  [[nodiscard]] TurnSplit<T> split_as() const {
    return split_as<T>(record_);
  }

  /// A reading was at the end of its range: the open turn is marked. Of a sample with a pulse, call it before and
  /// after.
  void mark_saturated() { saturated_ = true; }
  /// Forgets the open turn.
  void restart() {
    sums_ = {};
    count_ = 0;
    first_share_ = 0;
    saturated_ = started_ = false;
  }

 private:
  static std::int32_t gained(std::int64_t value, std::int64_t gain) {
    return saturate(round_shift(std::int64_t{saturate(value)} * gain, 30));
  }
  /// There is one, and it has four samples a turn.
  static bool is_sampled(const TurnRecord& r) { return r.turns > 0 && r.samples >= std::int64_t{4} * kOne * r.turns; }

  TRUNNION_COLD Status time_out() {
    restart();
    return Status::kTimeOut;
  }

  /// A share of a sample. @p part its readings' share
  TRUNNION_COLD void add_part(const UnitOutput<std::int32_t>& part, std::int32_t s, std::int32_t c,
                              std::int32_t share) {
    sums_.add(part, s, c);
    sums_.e[0] += kernel::share_of(c, share) - c;
    sums_.e[1] += kernel::share_of(s, share) - s;
  }

  static constexpr std::int32_t kOne = 65536;
  static constexpr int kLess = 31 - kPhasorBits;

  kernel::TurnSums sums_;
  std::int32_t first_share_ = 0;  // of the sample that the open turn's pulse fell in
  std::int16_t count_ = 0;        // whole samples
  bool saturated_ = false;
  bool started_ = false;
  TurnRecord record_;
};

}  // namespace trunnion
