// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/noise_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::calibration {
namespace {

std::vector<ResidualSeries> draw(std::uint64_t seed, int series, int length, double white, double wander, double tau) {
  std::vector<ResidualSeries> all;
  simulation::Gaussian gaussian(seed, 5);
  const double phi = std::exp(-1.0 / tau);
  for (int s = 0; s < series; ++s) {
    ResidualSeries one;
    double state = wander * gaussian();
    const double constant = 100.0 * gaussian();
    for (int k = 0; k < length; ++k) {
      one.value.push_back(constant + state + white * gaussian());
      state = phi * state + wander * std::sqrt(1.0 - phi * phi) * gaussian();
    }
    all.push_back(one);
  }
  return all;
}

// 9 series of 700 s, the experiment's own: white noise to 3 %, wander to 40 % (tau = 200 s gives some 30 independent
// values in all), the mean over eight seeds to 15 %.
TEST(EstimateNoise, FindsWhatMadeTheSeries) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TriadNoise noise = estimate_noise(draw(seed, 9, 700, 5.0, 1.5, 200.0), 4.0);
    EXPECT_NEAR(noise.density, 5.0, 0.15) << seed;
    EXPECT_NEAR(noise.wander, 1.5, 0.6) << seed;
    sum += noise.wander / 8.0;
  }
  EXPECT_NEAR(sum, 1.5, 0.225);
}

TEST(EstimateNoise, FindsNoWanderWhereThereIsNone) {
  const TriadNoise noise = estimate_noise(draw(9, 9, 700, 5.0, 0.0, 200.0), 4.0);
  EXPECT_NEAR(noise.density, 5.0, 0.15);
  EXPECT_LT(noise.wander, 0.4);
}

}  // namespace
}  // namespace trunnion::calibration
