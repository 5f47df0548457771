// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A turning unit in integers for the smallest processors: readings are sorted by the angle they were taken at, and
/// demodulated once a turn.
///
///   bin k = sum of the samples with phi in [2 pi k / N, 2 pi (k + 1) / N)                                ... (1)
///   a = sum bin_k,   b = sum exp(2 pi i (k + 1/2) / N) bin_k / sinc(pi / N),   e likewise of the counts  ... (2)
///
/// A sample costs six additions, whatever the processor thinks of products; the sample with the pulse does all of (2),
/// some 22,000 instructions on a Cortex-M4. An angle is taken for its bin's middle: with n samples a turn that leaves
/// some pi / (N sqrt(3 n)) of what turns. 64 bins of six channels are 3.6 KB. docs/theory/modulation.md, section 2.

#pragma once

#include "trunnion/modulation/count_demodulator.hpp"

namespace trunnion {

/// @tparam Bits as for CountDemodulator
/// @tparam MostSamples as there
/// @tparam Bins a power of two
template <int Bits, int MostSamples, int Bins = 64>
class AngleBins {
  static_assert(Bins >= 8 && (Bins & (Bins - 1)) == 0, "bins: 8, 16, 32, 64 ...");
  static constexpr int kShift = 32 - kernel::bits_of(Bins);

 public:
  AngleBins() { empty(); }  // not by the linker: a static one takes no flash

  /// A sample without a pulse. @param phase of its middle
  /// @return kTimeOut when no pulse came for MostSamples: the open turn is forgotten
  TRUNNION_INLINE Status add(const UnitOutput<std::int32_t>& sample, BinaryAngle phase) {
    Bin* bin = &bins_[phase >> kShift];
    TRUNNION_ONE_ADDRESS(bin);
    kernel::add<false>(bin->sum, sample);
    ++bin->count;
    return --left_ != 0U ? Status::kOk : run_out();
  }

  /// A sample with a pulse in it; as CountDemodulator::add_with_pulse().
  bool add_with_pulse(const UnitOutput<std::int32_t>& sample, BinaryAngle phase, const IndexPulse& pulse) {
    if (pulse.before < 0 || pulse.before > 65536) {
      (void)add(sample, phase);
      return false;
    }
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(Bins); ++k) {
      const SinCos phasor = sin_cos((k << kShift) + (BinaryAngle{1} << (kShift - 1)));
      turn_.add_many(bins_[k].sum, bins_[k].count, widened(phasor.sine.raw), widened(phasor.cosine.raw));
    }
    empty();
    return turn_.add_with_pulse(sample, sin_cos(phase), pulse);
  }
  /// Forgets the open turn.
  void restart() {
    empty();
    turn_.restart();
  }
  /// Has record(), split(), split_as() and mark_saturated().
  [[nodiscard]] CountDemodulator<Bits, MostSamples>& turn() { return turn_; }
  [[nodiscard]] const CountDemodulator<Bits, MostSamples>& turn() const { return turn_; }

 private:
  struct Bin {
    std::array<std::int64_t, 6> sum{};
    std::int32_t count = 0;
  };

  TRUNNION_COLD Status run_out() {
    restart();
    return Status::kTimeOut;
  }
  /// @p part over sinc(pi / Bins)
  static std::int64_t widened(std::int32_t part) {
    constexpr double kHalf = kPi / Bins;
    constexpr double kExcess = kHalf * kHalf * (1.0 / 6.0 + kHalf * kHalf * 7.0 / 360.0);
    constexpr auto kMore = static_cast<std::int32_t>(kExcess * 1073741824.0);
    return part + ((static_cast<std::int64_t>(part) * kMore) >> 30);
  }
  TRUNNION_COLD void empty() {
    bins_ = {};
    left_ = static_cast<std::uint32_t>(MostSamples);
  }

  std::array<Bin, static_cast<std::size_t>(Bins)> bins_{};
  std::uint32_t left_;
  CountDemodulator<Bits, MostSamples> turn_;
};

}  // namespace trunnion
