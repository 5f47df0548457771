// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/modulation/count_demodulator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/modulation/angle_bins.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

constexpr int kBits = 22;
constexpr int kMost = 4096;
using Demodulator = CountDemodulator<kBits, kMost>;
using Bins = AngleBins<kBits, kMost>;
using Complex = std::complex<double>;

/// A platform and what the unit on it reads, in counts: means over samples of what turns and of what does not.
struct Platform {
  double turns_a_sample = 1.0 / 200.0;  ///< signed
  double ripple = 0.0;                  ///< of the speed, once a turn
  double noise = 0.0;                   ///< counts, 1 sigma
  Complex body_w{31000.0, -12000.0}, body_f{-90000.0, 45000.0};
  Complex unit_w{700.0, -350.0}, unit_f{1300.0, 2900.0};
  double axial_counts_a_turn = 2e8;  ///< what one turn sums to
  double axial_bias = 250.0;
  double axial_f = -130000.0;

  struct Sample {
    UnitOutput<std::int32_t> counts;
    BinaryAngle angle;  ///< at the end
    double turns;       ///< at the end, not wrapped
  };

  /// @param at turns at the start
  [[nodiscard]] double turns(double i) const {
    const double even = turns_a_sample * i + 0.3;
    return even + ripple * std::sin(2.0 * kPi * even) / (2.0 * kPi);
  }
  [[nodiscard]] Sample sample(int i, simulation::Gaussian& dice) const {
    constexpr int kSteps = 32;  // the mean over a sample, by its midpoints
    Complex turning = 0.0;
    for (int k = 0; k < kSteps; ++k) turning += std::polar(1.0 / kSteps, -2.0 * kPi * turns(i + (k + 0.5) / kSteps));
    const double from = turns(i);
    const double to = turns(i + 1);
    const Complex w = turning * body_w + unit_w;
    const Complex f = turning * body_f + unit_f;
    const auto count = [&](double x) { return static_cast<std::int32_t>(std::lround(x + noise * dice())); };
    return {{count(w.real()), count(w.imag()), count(axial_counts_a_turn * (to - from) + axial_bias), count(f.real()),
             count(f.imag()), count(axial_f)},
            static_cast<BinaryAngle>(static_cast<std::int64_t>(std::floor(to * 4294967296.0))),
            to};
  }
  [[nodiscard]] BinaryAngle start() const {
    return static_cast<BinaryAngle>(static_cast<std::int64_t>(std::floor(turns(0) * 4294967296.0)));
  }
};

template <class Split>
double largest_error(const Split& split, const Platform& p, double per_count) {
  const auto off = [&](const auto& found, std::size_t at, Complex truth) {
    return std::abs(Complex(static_cast<double>(found[at]), static_cast<double>(found[at + 1])) / per_count - truth);
  };
  return std::max({off(split.body, 0, p.body_w), off(split.body, 3, p.body_f), off(split.unit, 0, p.unit_w),
                   off(split.unit, 3, p.unit_f)});
}

/// Turns the platform with an encoder through both. @return the largest errors in counts: integers, double, bins
std::array<double, 3> with_encoder(const Platform& p, int samples) {
  simulation::Gaussian dice(1, 1);
  EncoderPhase phase(p.start());
  Demodulator demodulator;
  Bins bins;
  std::array<double, 3> worst{};
  int turns = 0;
  for (int i = 0; i < samples; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    const EncoderPhase::Step step = phase.add(s.angle);
    if (step.pulse.before < 0) {
      EXPECT_EQ(demodulator.add(s.counts, sin_cos(step.middle)), Status::kOk);
      EXPECT_EQ(bins.add(s.counts, step.middle), Status::kOk);
      continue;
    }
    const bool in_bins = bins.add_with_pulse(s.counts, step.middle, step.pulse);
    if (!demodulator.add_with_pulse(s.counts, sin_cos(step.middle), step.pulse)) continue;
    EXPECT_TRUE(in_bins);
    ++turns;
    const auto& record = demodulator.record();
    EXPECT_EQ(record.turns, 1);
    EXPECT_FALSE(record.reversed || record.saturated);
    constexpr double kOne = 1 << Demodulator::kFraction;
    const auto split = demodulator.split();
    EXPECT_TRUE(split.valid);
    worst[0] = std::max(worst[0], largest_error(split, p, kOne));
    worst[1] = std::max(worst[1], largest_error(demodulator.split_as<double>(), p, 1.0));
    worst[2] = std::max(worst[2], largest_error(bins.turn().split(), p, kOne));
    EXPECT_NEAR(split.unit[5] / kOne, p.axial_f, 2.0 * std::abs(p.turns_a_sample));  // a count at either pulse
    EXPECT_EQ(split.unit[5], split.body[5]);
  }
  EXPECT_GE(turns, 3);
  return worst;
}

// Both directions, speeds that are no whole number of samples, uneven ones: apart from the rounding to counts, which is
// uniform and averages over a turn, the split is right. The demodulation's own parts: phasor 1.2e-9, pulse 6e-5 of a
// sample.
TEST(CountDemodulator, TellsTheBodyFromTheUnit) {
  for (const double speed : {1.0 / 200.0, -1.0 / 200.0, 0.013, -0.0211, 0.002, 0.0613, -0.115, 0.188, 0.2326}) {
    Platform p;
    p.turns_a_sample = speed;
    const auto worst = with_encoder(p, static_cast<int>(9.5 / std::abs(speed)));
    // of 100,000: half a count a sample, either pulse to 6e-5 of a sample, and the eighth order of 1 / sinc where a
    // sample is a quarter of a turn
    const double most = 4.0 + 2.0 * 6.0 * std::abs(speed) + 1e5 * std::pow(kPi * std::abs(speed), 8) * 127.0 / 604800.0;
    EXPECT_LT(worst[0], most) << speed;
    EXPECT_LT(worst[1], most) << speed;
  }
}
TEST(CountDemodulator, FollowsAnUnevenSpeed) {
  Platform p;
  p.turns_a_sample = 1.0 / 301.0;
  p.ripple = 0.3;
  const auto worst = with_encoder(p, 1500);
  std::printf("[ FIGURE   ] integer demodulation, speed uneven by 30 %%: %.2f counts of 100000; bins %.0f\n", worst[0],
              worst[2]);
  EXPECT_LT(worst[0], 2.0);  // half a count a sample, amplified by 1 / (1 - |E|^2), and the pulses
  EXPECT_LT(std::abs(worst[1] - worst[0]), 0.2);
}
// In a bin a sample may be half a bin, 0.05 rad, from the middle it is taken for; over a turn of 200 samples that is
// some 0.05 / sqrt(3 * 200) of the turning vector.
TEST(CountDemodulator, AngleBinsAreWithinTheirCoarseness) {
  Platform p;
  p.turns_a_sample = 0.00487;
  const auto worst = with_encoder(p, 1500);
  EXPECT_LT(worst[2], 4.0 * 0.05 / std::sqrt(3.0 * 205.0) * std::abs(p.body_f));
  EXPECT_GT(worst[2], 0.0);
}

// A pulse that says of itself that it is none is a sample like any other.
TEST(CountDemodulator, TakesAPulseThatIsNoneForASample) {
  Platform p;
  simulation::Gaussian dice(9, 9);
  std::array<EncoderPhase, 2> phase = {EncoderPhase(p.start()), EncoderPhase(p.start())};
  std::array<Demodulator, 2> demodulator;
  std::array<Bins, 2> bins;
  int turns = 0;
  for (int i = 0; i < 1000; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    for (std::size_t k = 0; k < 2; ++k) {
      const EncoderPhase::Step step = phase[k].add(s.angle);
      if (step.pulse.before >= 0) {
        turns += demodulator[k].add_with_pulse(s.counts, sin_cos(step.middle), step.pulse) ? 1 : 0;
        (void)bins[k].add_with_pulse(s.counts, step.middle, step.pulse);
      } else if (k == 0) {
        (void)demodulator[k].add(s.counts, sin_cos(step.middle));
        (void)bins[k].add(s.counts, step.middle);
      } else {
        IndexPulse none;
        none.before = i % 2 == 0 ? -1 : 65537;
        EXPECT_FALSE(demodulator[k].add_with_pulse(s.counts, sin_cos(step.middle), none));
        EXPECT_FALSE(bins[k].add_with_pulse(s.counts, step.middle, none));
      }
    }
  }
  EXPECT_GE(turns, 6);
  EXPECT_EQ(demodulator[0].split().body, demodulator[1].split().body);
  EXPECT_EQ(bins[0].turn().split().body, bins[1].turn().split().body);
}

// Integers, a million samples: nothing is lost at a pulse, whichever side of it a count goes to.
TEST(CountDemodulator, LosesNoCount) {
  simulation::Gaussian dice(2, 2);
  Platform p;
  p.turns_a_sample = 0.00731;
  p.noise = 5000.0;
  EncoderPhase phase(p.start());
  Demodulator demodulator;
  UnitOutput<std::int64_t> all{};
  UnitOutput<std::int64_t> in_turns{};
  UnitOutput<std::int64_t> before_last{};
  std::int64_t samples = 0;
  bool started = false;
  for (int i = 0; i < 100000; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    const EncoderPhase::Step step = phase.add(s.angle);
    if (step.pulse.before < 0) {
      (void)demodulator.add(s.counts, sin_cos(step.middle));
    } else if (demodulator.add_with_pulse(s.counts, sin_cos(step.middle), step.pulse)) {
      for (std::size_t k = 0; k < 6; ++k) in_turns[k] += demodulator.record().sums.a[k];
      samples += demodulator.record().samples;
    }
    // all that lies between the first pulse and this one
    for (std::size_t k = 0; k < 6; ++k) {
      const std::int64_t part = step.pulse.before < 0 ? 0 : kernel::share_of(s.counts[k], step.pulse.before);
      if (step.pulse.before >= 0) before_last[k] = started ? all[k] + part : 0;
      if (step.pulse.before >= 0 && !started)
        all[k] = s.counts[k] - part;
      else
        all[k] += started || step.pulse.before >= 0 ? s.counts[k] : 0;
    }
    started = started || step.pulse.before >= 0;
  }
  EXPECT_EQ(in_turns, before_last);
  EXPECT_NEAR(static_cast<double>(samples) / 65536.0, 100000.0, 300.0);
}

struct IndexRun {
  int turns = 0;
  int largest_turns = 0;
  double worst = 0.0;
  int bounces = 0;
  int most_without_pulse = 0;
  int valid = 0;
  int passed_over = 0;
};

/// An index pulse a turn and the axial gyro; @p passes says which of the pulses come, @p extra a pulse in any sample.
template <class Passes, class Extra>
IndexRun with_index(const Platform& p, int samples, const Passes& passes, const Extra& extra, bool good = true,
                    double full_turn = 1.02) {
  simulation::Gaussian dice(3, 3);
  AxialPhase phase(static_cast<std::int64_t>(full_turn * p.axial_counts_a_turn));  // a scale error until it has learnt
  Demodulator demodulator;
  IndexRun run;
  for (int i = 0; i < samples; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    const double from = p.turns(i);
    const BinaryAngle middle = phase.middle(s.counts[2]);
    const double zero = p.turns_a_sample > 0.0 ? std::floor(s.turns) : std::ceil(s.turns);
    const bool passed = p.turns_a_sample > 0.0 ? from < zero && zero <= s.turns : from > zero && zero >= s.turns;
    std::int32_t before = -1;
    if (passed && passes(static_cast<int>(std::abs(zero))))
      before = static_cast<std::int32_t>(std::lround((zero - from) / (s.turns - from) * 65536.0));
    else if (extra(i))
      before = 30000;
    const IndexPulse pulse = before < 0 ? IndexPulse{} : phase.pulse(before, s.counts[2]);
    run.bounces = std::max(run.bounces, phase.bounces());
    run.most_without_pulse = std::max(run.most_without_pulse, phase.turns_without_pulse());
    if (pulse.before < 0) {
      (void)demodulator.add(s.counts, sin_cos(middle));
    } else if (demodulator.add_with_pulse(s.counts, sin_cos(middle), pulse)) {
      ++run.turns;
      run.largest_turns = std::max(run.largest_turns, static_cast<int>(demodulator.record().turns));
      EXPECT_FALSE(good && demodulator.record().reversed);
      run.valid += demodulator.split().valid ? 1 : 0;
      run.passed_over = std::max(run.passed_over, static_cast<int>(demodulator.record().passed_over));
      if (run.turns > 2)  // by then the scale is learnt, and no share of a sample is from before
        run.worst = std::max(run.worst, largest_error(demodulator.split(), p, 1 << Demodulator::kFraction));
    }
  }
  return run;
}

constexpr auto kAlways = [](int) { return true; };
constexpr auto kNever = [](int) { return false; };

TEST(AxialPhase, DemodulatesByIndexAlone) {
  for (const double speed : {1.0 / 200.0, -0.0071}) {
    Platform p;
    p.turns_a_sample = speed;
    const IndexRun run = with_index(p, 2000, kAlways, kNever);
    EXPECT_GE(run.turns, 9) << speed;
    EXPECT_EQ(run.largest_turns, 1);
    EXPECT_LT(run.worst, 8.0) << speed;
    EXPECT_EQ(run.bounces, 0);
  }
}
TEST(AxialPhase, PassesOverBouncesAndNoticesMissedPulses) {
  Platform p;
  const IndexRun bounced = with_index(p, 2000, kAlways, [](int i) { return i == 270 || i == 830; });
  const IndexRun plain = with_index(p, 2000, kAlways, kNever);
  EXPECT_EQ(bounced.turns, plain.turns);
  EXPECT_EQ(bounced.worst, plain.worst);
  EXPECT_EQ(bounced.bounces, 1);
  const IndexRun missed = with_index(
      p, 2000, [](int turn) { return turn % 4 != 0; }, kNever);
  EXPECT_EQ(missed.largest_turns, 2);
  EXPECT_EQ(missed.most_without_pulse, 1);
  EXPECT_LT(missed.worst, 8.0);
}
// A nominal turn that is off by 15 % is learnt; one of twice the size makes two turns one, and every turn says so.
TEST(AxialPhase, LearnsTheTurnOrShowsThatItCannot) {
  Platform p;
  for (const double off : {0.85, 1.15}) {
    const IndexRun run = with_index(p, 3000, kAlways, kNever, true, off);
    EXPECT_EQ(run.largest_turns, 1) << off;
    EXPECT_LT(run.worst, 8.0) << off;
  }
  const IndexRun twice = with_index(p, 3000, kAlways, kNever, true, 2.0);
  EXPECT_EQ(twice.passed_over, 1);
  const IndexRun half = with_index(p, 3000, kAlways, kNever, true, 0.5);
  EXPECT_EQ(half.largest_turns, 2);
}
// The body turns by a third of a turn under the platform, once: the index is somewhere else by the gyro, and found
// again.
TEST(AxialPhase, FindsTheIndexAgainAfterTheBodyTurned) {
  AxialPhase phase(200 * 1000);
  int accepted = 0;
  for (int i = 0; i < 4000; ++i) {
    const bool pulse = i % 200 == 50;
    const bool disturbed = i > 1000 && i < 1200;
    (void)phase.middle(disturbed ? 1400 : 1000);
    if (pulse) accepted += phase.pulse(30000, 1000).before >= 0 && i > 2400 ? 1 : 0;
  }
  EXPECT_GE(accepted, 7);
}
// Between two pulses, so that the next is no longer where the gyro has it: passed over twice, and then believed.
TEST(AxialPhase, BeginsAnewWhereTheIndexInsists) {
  AxialPhase phase(200 * 1000);
  std::vector<IndexPulse> seen;
  for (int i = 0; i < 3000; ++i) {
    const std::int32_t axial = i > 1060 && i < 1240 ? 1440 : 1000;
    (void)phase.middle(axial);
    if (i % 200 == 50) seen.push_back(phase.pulse(30000, axial));
  }
  ASSERT_EQ(seen.size(), 15U);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const bool lost = k == 6 || k == 7;
    EXPECT_EQ(seen[k].before, lost ? -1 : 30000) << k;
    EXPECT_EQ(seen[k].turns, lost || k == 0 || k == 8 ? 0 : 1) << k;
  }
}
TEST(AxialPhase, TellsAnInvertedIndex) {
  Platform p;
  // low for a moment, high for the rest: a level-triggered input sees a pulse in nearly every sample
  const IndexRun run = with_index(
      p, 3000, kNever, [](int i) { return i % 200 != 0; }, false);
  EXPECT_GT(run.bounces, 50);
  EXPECT_EQ(run.valid, 0);  // and no turn is taken for one
}

TEST(CountDemodulator, NoticesAnEncoderOfTheWrongSign) {
  Platform p;
  simulation::Gaussian dice(4, 4);
  EncoderPhase phase(0U - p.start());
  Demodulator demodulator;
  bool reversed = false;
  for (int i = 0; i < 700; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    const EncoderPhase::Step step = phase.add(0U - s.angle);
    if (step.pulse.before < 0)
      (void)demodulator.add(s.counts, sin_cos(step.middle));
    else if (demodulator.add_with_pulse(s.counts, sin_cos(step.middle), step.pulse))
      reversed = demodulator.record().reversed;
  }
  EXPECT_TRUE(reversed);
}

// No index for ever, at full scale: a status, sums that never overflow (UBSan sees to it), and a new start.
TEST(CountDemodulator, SaysThatTheIndexIsMissing) {
  UnitOutput<std::int32_t> full{};
  full.fill(-(1 << (kBits - 1)));
  Demodulator demodulator;
  Bins bins;
  RevolutionAverage<std::int32_t, kMost> average(2, 1000000, 0);
  int said = 0;
  for (int i = 0; i < 3 * kMost; ++i) {
    const Status status = demodulator.add(full, sin_cos(3U << 29U));
    EXPECT_EQ(bins.add(full, 3U << 29U), status);
    EXPECT_EQ(average.add(full), status);
    said += status == Status::kTimeOut ? 1 : 0;
  }
  EXPECT_EQ(said, 3);
  EXPECT_FALSE(demodulator.add_with_pulse(full, sin_cos(0), {100, 0, 1}));  // the first after it opens a turn
}

// The three scalars of a split agree, of small sums of either sign too.
TEST(CountDemodulator, SplitsInFloatAsInIntegers) {
  for (const std::int32_t offset : {-100000, -129, -2, 0, 1, 11, 99999}) {
    Platform p;
    p.turns_a_sample = 0.00987;
    p.unit_w = {static_cast<double>(offset), -3.0};
    p.unit_f = {7.0, static_cast<double>(-offset)};
    simulation::Gaussian dice(6, 6);
    EncoderPhase phase(p.start());
    Demodulator demodulator;
    for (int i = 0; i < 350; ++i) {
      const Platform::Sample s = p.sample(i, dice);
      const EncoderPhase::Step step = phase.add(s.angle);
      if (step.pulse.before < 0)
        (void)demodulator.add(s.counts, sin_cos(step.middle));
      else
        (void)demodulator.add_with_pulse(s.counts, sin_cos(step.middle), step.pulse);
    }
    const auto in_integers = demodulator.split();
    const auto in_float = demodulator.split_as<float>();
    const auto in_double = demodulator.split_as<double>();
    ASSERT_TRUE(in_integers.valid && in_float.valid && in_double.valid);
    for (std::size_t k : {0U, 1U, 3U, 4U, 5U}) {
      EXPECT_NEAR(in_integers.unit[k] / 256.0, in_double.unit[k], 0.02) << offset << " " << k;
      EXPECT_NEAR(static_cast<double>(in_float.unit[k]), in_double.unit[k], 0.06) << offset << " " << k;
      EXPECT_NEAR(static_cast<double>(in_float.body[k]), in_double.body[k], 0.06) << offset << " " << k;
    }
  }
}

TEST(CountDemodulator, HasNoSplitWithoutATurnOrWithTooFewSamples) {
  Demodulator demodulator;
  EXPECT_FALSE(demodulator.split().valid);
  EXPECT_FALSE(demodulator.split_as<float>().valid);
  const UnitOutput<std::int32_t> y{1, 2, 3, 4, 5, 6};
  EXPECT_FALSE(demodulator.add_with_pulse(y, sin_cos(0), {0, 0, 0}));
  EXPECT_TRUE(demodulator.add_with_pulse(y, sin_cos(0), {0, 0, 1}));  // one sample a turn
  EXPECT_FALSE(demodulator.split().valid);
  EXPECT_FALSE(demodulator.split_as<double>().valid);
}

TEST(CountDemodulator, MarksASaturatedTurnAndNoOther) {
  Platform p;
  simulation::Gaussian dice(5, 5);
  EncoderPhase phase(p.start());
  Demodulator demodulator;
  std::vector<bool> marks;
  for (int i = 0; i < 900; ++i) {
    const Platform::Sample s = p.sample(i, dice);
    const EncoderPhase::Step step = phase.add(s.angle);
    if (i == 400) demodulator.mark_saturated();
    if (step.pulse.before < 0)
      (void)demodulator.add(s.counts, sin_cos(step.middle));
    else if (demodulator.add_with_pulse(s.counts, sin_cos(step.middle), step.pulse))
      marks.push_back(demodulator.record().saturated);
  }
  EXPECT_EQ(marks, (std::vector<bool>{false, true, false}));
}

TEST(EncoderPhase, FindsTheZeroWithinASample) {
  EncoderPhase forward(0xf0000000U);
  EXPECT_EQ(forward.add(0x10000000U).pulse.before, 32768);
  EncoderPhase back(0x10000000U);
  const EncoderPhase::Step step = back.add(0xd0000000U);
  EXPECT_EQ(step.pulse.before, 16384);
  EXPECT_EQ(step.pulse.turns, 0);  // the first
  EXPECT_EQ(step.middle, 0xf0000000U);
  // to and fro about zero is no turn; all the way round is one
  EncoderPhase swinging(0xffff0000U);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(swinging.add(0x00010000U).pulse.turns, 0);
    EXPECT_EQ(swinging.add(0xffff0000U).pulse.turns, 0);
  }
  for (const BinaryAngle angle : {0x90000000U, 0x20000000U}) EXPECT_LT(swinging.add(angle).pulse.before, 0);
  EXPECT_EQ(swinging.add(0xf0000000U).pulse.turns, -1);
  EncoderPhase still(5U);
  EXPECT_LT(still.add(5U).pulse.before, 0);
  EXPECT_LT(still.add(6U).pulse.before, 0);
}

}  // namespace
}  // namespace trunnion
