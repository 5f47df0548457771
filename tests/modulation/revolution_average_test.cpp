// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/modulation/revolution_average.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

constexpr double kStep = 0.01;  // s

/// A unit on a platform that turns about its z axis at a constant rate, the axis horizontal: samples are exact means.
struct Platform {
  double turns_per_second;
  double body_rate;   // across the axis, rad/s
  double body_force;  // across the axis, m/s^2
  UnitOutput<double> bias{};

  [[nodiscard]] UnitOutput<double> sample(long long i) const {
    const double w = 2.0 * kPi * turns_per_second;
    const double from = w * kStep * static_cast<double>(i);
    const double to = w * kStep * static_cast<double>(i + 1);
    const double c = (std::sin(to) - std::sin(from)) / (to - from);
    const double s = (std::cos(from) - std::cos(to)) / (to - from);
    UnitOutput<double> out = {body_rate * c, -body_rate * s, w, body_force * c, -body_force * s, 0.0};
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += bias[k];
    return out;
  }

  /// Whether the index passes within sample i, and the share of the sample before it.
  [[nodiscard]] bool pulse(long long i, double& before) const {
    const double from = turns_per_second * kStep * static_cast<double>(i);
    const double to = turns_per_second * kStep * static_cast<double>(i + 1);
    // the index stands at a tenth of a turn; a boundary of two samples belongs to the first
    const double mark = std::floor(to - 0.1 + 1e-9) + 0.1;
    before = std::min((mark - from) / (to - from), 1.0);
    return mark > from + 1e-9;
  }
};

// The law of (1): on a platform whose turn is a whole number of samples, what is constant in the body vanishes and the
// bias stays, to rounding.
TEST(RevolutionAverage, KeepsTheBiasAndLosesTheBody) {
  const Platform platform{0.5, 0.02, 9.8, {1e-3, -2e-3, 5e-4, 0.03, -0.01, 0.02}};
  RevolutionAverage<double> average(2, 2.0 * kPi / kStep, 0.0);
  int turns = 0;
  for (long long i = 0; i < 4000; ++i) {
    double before = 0.0;
    bool complete = false;
    if (platform.pulse(i, before))
      complete = average.add_with_pulse(platform.sample(i), before) == Pulse::kTurn;
    else
      average.add(platform.sample(i));
    if (!complete) continue;
    ++turns;
    const Revolution<double>& turn = average.turn();
    EXPECT_EQ(turn.turns, 1);
    EXPECT_NEAR(turn.samples * kStep, 2.0, 1e-9);
    EXPECT_NEAR(turn.mean(2) - 2.0 * kPi / (turn.samples * kStep), 5e-4, 1e-9);  // the axial bias
    for (const std::size_t k : {0U, 1U, 3U, 4U}) EXPECT_NEAR(turn.mean(k), platform.bias[k], 1e-9) << k;
  }
  EXPECT_EQ(turns, 19);
}

double scatter(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

// White noise of 120 ug/rtHz over a turn is the floor; at turns that no sample divides, interpolation reaches it within
// 15 % (400 turns: 3.5 % is one sigma), and the nearest sample stays ten times above.
TEST(RevolutionAverage, InterpolationReachesTheFloorOfWhiteNoise) {
  constexpr double kDensity = 120e-6 * kStandardGravity;
  for (const double rate : {0.4973, 3.9871}) {
    const Platform platform{rate, 0.0, kStandardGravity};
    simulation::Gaussian gaussian(5, 7);
    RevolutionAverage<double> fine(2, 2.0 * kPi / kStep, 0.0);
    RevolutionAverage<double> coarse(2, 2.0 * kPi / kStep, 0.0);
    std::vector<double> fine_means;
    std::vector<double> coarse_means;
    const auto samples = static_cast<long long>(401.0 / rate / kStep);
    for (long long i = 0; i < samples; ++i) {
      UnitOutput<double> s = platform.sample(i);
      for (std::size_t k = 3; k < 6; ++k) s[k] += kDensity / std::sqrt(kStep) * gaussian();
      double before = 0.0;
      if (!platform.pulse(i, before)) {
        fine.add(s);
        coarse.add(s);
        continue;
      }
      if (fine.add_with_pulse(s, before) == Pulse::kTurn) fine_means.push_back(fine.turn().mean(3));
      if (coarse.add_with_pulse(s, 1.0) == Pulse::kTurn) coarse_means.push_back(coarse.turn().mean(3));
    }
    const double floor = kDensity * std::sqrt(rate);
    const double milli = 1e-3 * kStandardGravity;
    std::printf(
        "[ FIGURE   ] per-turn scatter at %.2f Hz: nearest sample %.3f mg, interpolated %.4f mg, white noise %.4f mg\n",
        rate, scatter(coarse_means) / milli, scatter(fine_means) / milli, floor / milli);
    EXPECT_NEAR(scatter(fine_means) / floor, 1.0, 0.15) << rate;
    EXPECT_GT(scatter(coarse_means), 10.0 * floor) << rate;
  }
}

// Conservation, for every input: in integers the turns and what is still open add up to every count that went in.
TEST(RevolutionAverage, IntegersLoseNothing) {
  simulation::Gaussian gaussian(9, 8);
  RevolutionAverage<std::int32_t> average(2, 37 * 2000000000LL, 0);
  std::array<std::int64_t, 6> in{};
  std::array<std::int64_t, 6> out{};
  std::int64_t carried = 0;
  bool first = true;
  for (int i = 0; i < 20000; ++i) {
    UnitOutput<std::int32_t> s{};
    for (auto& c : s) c = static_cast<std::int32_t>(4e8 * gaussian());
    s[2] = 2000000000;  // 37 samples a turn, give or take one
    if (i % 37 != 36) {
      if (!first) {
        for (std::size_t k = 0; k < 6; ++k) in[k] += 65536LL * s[k];
        carried += 65536;
      }
      average.add(s);
      continue;
    }
    const auto before = static_cast<std::int64_t>(65536.0 * gaussian.uniform());
    if (!first) {
      for (std::size_t k = 0; k < 6; ++k) in[k] += before * s[k];
      carried += before;
    }
    const bool complete = average.add_with_pulse(s, before) == Pulse::kTurn;
    EXPECT_EQ(complete, !first);
    if (complete) {
      for (std::size_t k = 0; k < 6; ++k) out[k] += average.turn().sum[k];
      EXPECT_EQ(average.turn().samples, carried);
      EXPECT_EQ(in, out);
    }
    first = false;
    carried = 65536 - before;
    for (std::size_t k = 0; k < 6; ++k) in[k] += (65536 - before) * s[k];
  }
}

// Integers round to the nearest count: within half of one of the same turn in double.
TEST(RevolutionAverage, IntegersFollowDouble) {
  const Platform platform{0.4973, 300.0, 40000.0, {11.0, -7.0, 0.0, 130.0, -55.0, 3.0}};
  const double full = 2.0 * kPi / kStep * 1e4;
  RevolutionAverage<std::int32_t> counts(2, static_cast<std::int64_t>(full), 0);
  RevolutionAverage<double> reals(2, full, 0.0);
  int turns = 0;
  for (long long i = 0; i < 20000; ++i) {
    UnitOutput<double> s = platform.sample(i);
    s[2] *= 1e4;
    UnitOutput<std::int32_t> c{};
    for (std::size_t k = 0; k < 6; ++k) s[k] = c[k] = static_cast<std::int32_t>(std::lround(s[k]));
    double before = 0.0;
    if (!platform.pulse(i, before)) {
      counts.add(c);
      reals.add(s);
      continue;
    }
    const auto share = static_cast<std::int64_t>(std::lround(65536.0 * before));
    const bool complete = counts.add_with_pulse(c, share) == Pulse::kTurn;
    ASSERT_EQ(reals.add_with_pulse(s, static_cast<double>(share) / 65536.0) == Pulse::kTurn, complete);
    if (!complete) continue;
    ++turns;
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_NEAR(static_cast<double>(counts.turn().mean(k)), reals.turn().mean(k), 0.5 + 1e-6);
  }
  EXPECT_GT(turns, 95);
}

// Every third pulse is missing, every fifth bounces: turns are counted, and no mean is spoiled.
TEST(RevolutionAverage, NoticesMissedAndBouncingPulses) {
  const Platform platform{0.5, 0.02, 9.8, {1e-3, 0.0, 0.0, 0.0, 0.0, 0.0}};
  RevolutionAverage<double> average(2, 2.0 * kPi / kStep, 0.0);
  int pulses = 0;
  int missed = 0;
  int bounces = 0;
  int counted = 0;
  int turns = 0;
  long long bounce_at = -1;
  for (long long i = 0; i < 12000; ++i) {
    double before = 0.0;
    bool complete = false;
    const bool pulse = platform.pulse(i, before);
    if (pulse) ++pulses;
    if (pulse && pulses % 3 == 2) {
      ++missed;
      average.add(platform.sample(i));
      for (int more = 1; more < 30; ++more) average.add(platform.sample(++i));  // past the mark, the turn is overdue
      if (pulses > 2) {
        EXPECT_EQ(average.turns_without_pulse(), 1);
      }
    } else if (pulse) {
      complete = average.add_with_pulse(platform.sample(i), before) == Pulse::kTurn;
      if (pulses % 5 == 0) bounce_at = i + 2;
    } else if (i == bounce_at) {
      EXPECT_EQ(average.add_with_pulse(platform.sample(i), 0.5), Pulse::kBounce);
      ++bounces;
    } else {
      average.add(platform.sample(i));
    }
    if (!complete) continue;
    turns += average.turn().turns;
    counted += average.turn().bounces;
    EXPECT_NEAR(average.turn().mean(0), 1e-3, 1e-9);
    EXPECT_NEAR(average.turn().mean(3), 0.0, 1e-9);
  }
  EXPECT_GT(missed, 10);
  EXPECT_GT(bounces, 3);
  EXPECT_NEAR(counted, bounces, 1);  // the last turn is still open
  EXPECT_NEAR(turns, pulses - 1, 1);
}

TEST(RevolutionAverage, SaysWhenTheAxialGyroSaturated) {
  RevolutionAverage<std::int16_t> average(2, 131072, 32767);
  UnitOutput<std::int16_t> fine{};
  fine[2] = 32000;
  UnitOutput<std::int16_t> pinned = fine;
  pinned[2] = 32767;
  EXPECT_EQ(average.add_with_pulse(fine, 0), Pulse::kFirst);
  average.add(fine);
  average.add(fine);
  average.add(fine);
  EXPECT_EQ(average.add_with_pulse(fine, 9), Pulse::kTurn);
  EXPECT_FALSE(average.turn().saturated);
  for (int i = 0; i < 7; ++i) average.add(pinned);
  EXPECT_EQ(average.add_with_pulse(fine, 9), Pulse::kTurn);
  EXPECT_TRUE(average.turn().saturated);
  EXPECT_EQ(average.turn().turns, 2);  // by the time of the turn before
  EXPECT_EQ(average.add_with_pulse(pinned, 9), Pulse::kBounce);
}

// Of a caller that watches the range itself, and of an index that is high for nearly the whole turn.
TEST(RevolutionAverage, TakesTheCallersWordAndTellsAnInvertedIndex) {
  RevolutionAverage<std::int32_t, 1000, false> average(2, 1000, 50);
  const UnitOutput<std::int32_t> beyond{0, 0, 100, 0, 0, 0};
  EXPECT_EQ(average.add_with_pulse(beyond, 0), Pulse::kFirst);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(average.add(beyond), Status::kOk);
  EXPECT_EQ(average.add_with_pulse(beyond, 0), Pulse::kTurn);
  EXPECT_FALSE(average.turn().saturated);
  EXPECT_FALSE(average.turn().is_index_inverted());
  average.mark_saturated();
  for (int i = 0; i < 9; ++i) EXPECT_EQ(average.add(beyond), Status::kOk);
  EXPECT_EQ(average.add_with_pulse(beyond, 0), Pulse::kTurn);
  EXPECT_TRUE(average.turn().saturated);
  int turns = 0;
  for (int i = 0; i < 30; ++i) {
    if (average.add_with_pulse(beyond, 0) != Pulse::kTurn) continue;
    ++turns;
    EXPECT_TRUE(average.turn().is_index_inverted());
  }
  EXPECT_GT(turns, 1);
}

// No pulse for ever at full scale: sums stay where they are exact, and a mean before any turn is none.
TEST(RevolutionAverage, IsExactHoweverLongNoPulseComes) {
  RevolutionAverage<std::int32_t> average(2, 1000000, 0);
  EXPECT_EQ(average.turn().mean(0), 0);
  UnitOutput<std::int32_t> full{};
  full.fill(2147483647);
  EXPECT_EQ(average.add_with_pulse(full, 0), Pulse::kFirst);
  for (int i = 0; i < 200000; ++i) average.add(full);
  EXPECT_EQ(average.add_with_pulse(full, 70000), Pulse::kBounce);  // no share of a sample
}

}  // namespace
}  // namespace trunnion
