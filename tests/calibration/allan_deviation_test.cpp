// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/allan_deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::calibration {
namespace {

std::vector<double> white(std::size_t n, double density, double period, std::uint64_t seed) {
  simulation::Gaussian random(seed, 7);
  std::vector<double> y(n);
  for (double& value : y) value = density / std::sqrt(period) * random();
  return y;
}

/// Eq. (1) as it is written.
TEST(AllanDeviation, IsItsDefinition) {
  const std::vector<double> y = white(1500, 0.3, 0.02, 1);
  std::vector<double> x(1, 0.0);
  for (const double value : y) x.push_back(x.back() + value * 0.02);
  const std::vector<AllanPoint> curve = allan_deviation(y, 0.02);
  std::size_t m = 1;
  for (const AllanPoint& point : curve) {
    EXPECT_DOUBLE_EQ(point.tau, static_cast<double>(m) * 0.02);
    double sum = 0.0;
    for (std::size_t k = 0; k + 2 * m < x.size(); ++k) sum += std::pow(x[k + 2 * m] - 2.0 * x[k + m] + x[k], 2.0);
    const double variance = sum / (2.0 * point.tau * point.tau * static_cast<double>(x.size() - 2 * m));
    EXPECT_NEAR(point.deviation / std::sqrt(variance), 1.0, 1e-10) << point.tau;
    m *= 2;
  }
  EXPECT_EQ(m, 1024U);  // two whole taus no longer fit
}

TEST(AllanDeviation, KnowsNoConstantAndNoScale) {
  std::vector<double> y = white(4000, 0.3, 0.01, 2);
  const std::vector<AllanPoint> before = allan_deviation(y, 0.01);
  for (double& value : y) value = 5.0 - 3.0 * value;
  const std::vector<AllanPoint> after = allan_deviation(y, 0.01);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i].deviation / before[i].deviation, 3.0, 1e-9);
}

/// A ramp a t has sigma = a tau / sqrt(2), to the last bit of the arithmetic.
TEST(AllanDeviation, OfARampIsItsClosedForm) {
  std::vector<double> y(5000);
  for (std::size_t k = 0; k < y.size(); ++k) y[k] = 2e-3 * 0.1 * static_cast<double>(k);
  for (const AllanPoint& point : allan_deviation(y, 0.1))
    EXPECT_NEAR(point.deviation / (2e-3 * point.tau / std::sqrt(2.0)), 1.0, 1e-8);
}

/// The limits hold 68 % of the truth: over 400 series and the taus of more than three degrees of freedom, 7 points on
/// either side of that are more than five sigmas of their count.
TEST(AllanDeviation, LimitsHoldTheTruthAsOftenAsTheySay) {
  int inside = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    for (const AllanPoint& point : allan_deviation(white(2048, 1.0, 1.0, seed), 1.0)) {
      if (point.freedom < 3.0) continue;
      const double truth = 1.0 / std::sqrt(point.tau);
      inside += point.low <= truth && truth <= point.high ? 1 : 0;
      ++all;
    }
  }
  std::printf("[ FIGURE   ] Allan limits of 1 sigma hold the truth in %.1f %% of %d points\n", 100.0 * inside / all,
              all);
  EXPECT_NEAR(static_cast<double>(inside) / all, 0.683, 0.07);
}

/// Of its own expectation, eq. (2) gives back every term.
TEST(AllanDeviation, FitGivesBackTheTermsOfAnExactCurve) {
  const NoiseTerms truth{2e-6, 3e-4, 5e-5, 1e-6, 1e-9};
  std::vector<AllanPoint> curve;
  for (double tau = 0.01; tau < 1e5; tau *= 2.0) {
    AllanPoint point;
    point.tau = tau;
    point.deviation =
        std::sqrt(3.0 * std::pow(truth.quantisation / tau, 2.0) + truth.white * truth.white / tau +
                  2.0 * std::log(2.0) / 3.14159265358979323846 * std::pow(truth.bias_instability, 2.0) +
                  std::pow(truth.rate_random_walk, 2.0) * tau / 3.0 + std::pow(truth.ramp * tau, 2.0) / 2.0);
    point.freedom = 1e5 / tau;
    curve.push_back(point);
  }
  const NoiseTerms found = fit_noise_terms(curve);
  EXPECT_NEAR(found.quantisation / truth.quantisation, 1.0, 1e-4);
  EXPECT_NEAR(found.white / truth.white, 1.0, 1e-6);
  EXPECT_NEAR(found.bias_instability / truth.bias_instability, 1.0, 1e-3);
  EXPECT_NEAR(found.rate_random_walk / truth.rate_random_walk, 1.0, 1e-3);
  EXPECT_NEAR(found.ramp / truth.ramp, 1.0, 1e-2);
}

/// Short recordings of white noise are not drawn down by a long tau that came out low: over 60 of them.
TEST(AllanDeviation, WhiteNoiseIsFoundInShortRecordings) {
  double lowest = 10.0;
  double highest = 0.0;
  double mean = 0.0;
  int wandering = 0;
  constexpr int kRuns = 60;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const TriadNoise found = fit_sheet_noise(allan_deviation(white(50000, 1.0, 0.01, 100 + seed), 0.01));
    lowest = std::min(lowest, found.density);
    highest = std::max(highest, found.density);
    mean += found.density / kRuns;
    wandering += found.wander > 0.0 ? 1 : 0;
  }
  std::printf("[ FIGURE   ] white noise of 500 s, 60 times: %.3f on average, %.3f to %.3f; a wander in %d\n", mean,
              lowest, highest, wandering);
  EXPECT_NEAR(mean, 1.0, 0.01);
  EXPECT_GT(lowest, 0.95);
  EXPECT_LT(highest, 1.05);
  EXPECT_LE(wandering, 6);
}

/// White noise and wander of a simulated day come out within what a day can tell.
TEST(AllanDeviation, SheetNoiseOfASimulatedUnit) {
  constexpr double kPeriod = 0.1;
  constexpr double kDensity = 1e-4;
  constexpr double kWander = 1e-4;
  constexpr double kTime = 200.0;
  simulation::Gaussian random(11, 3);
  std::vector<double> y = white(1000000, kDensity, kPeriod, 11);
  const double phi = std::exp(-kPeriod / kTime);
  double state = kWander * random();
  for (double& value : y) {
    state = phi * state + kWander * std::sqrt(1.0 - phi * phi) * random();
    value += state;
  }
  const TriadNoise found = fit_sheet_noise(allan_deviation(y, kPeriod));
  std::printf("[ FIGURE   ] sheet from 28 h: white noise %.3f, wander %.2f, correlation time %.2f of the truth\n",
              found.density / kDensity, found.wander / kWander, found.wander_correlation_time / kTime);
  EXPECT_NEAR(found.density / kDensity, 1.0, 0.01);
  EXPECT_NEAR(found.wander / kWander, 1.0, 0.15);  // 500 correlation times: 6 %
  EXPECT_NEAR(found.wander_correlation_time / kTime, 1.0, 0.3);
  // white noise alone has no wander to speak of
  const TriadNoise alone = fit_sheet_noise(allan_deviation(white(1000000, kDensity, kPeriod, 12), kPeriod));
  EXPECT_LT(alone.wander, 0.1 * kWander);
}

}  // namespace
}  // namespace trunnion::calibration
