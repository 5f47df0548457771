// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/comparison/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::comparison {
namespace {

TEST(Statistics, IncompleteBetaKeepsItsLaws) {
  for (const double a : {0.5, 1.0, 2.5, 24.5, 300.0}) {
    for (const double b : {0.5, 1.0, 3.0, 40.0}) {
      for (const double x : {0.001, 0.2, 0.5, 0.9, 0.999}) {
        EXPECT_NEAR(incomplete_beta(a, b, x) + incomplete_beta(b, a, 1.0 - x), 1.0, 1e-12) << a << ' ' << b << ' ' << x;
        // I_x(a, 1) = x^a
        EXPECT_NEAR(incomplete_beta(a, 1.0, x), std::pow(x, a), 1e-12) << a << ' ' << x;
        // d I / dx is the density
        const double h = 1e-6;
        const double density = std::exp((a - 1.0) * std::log(x) + (b - 1.0) * std::log1p(-x) + std::lgamma(a + b) -
                                        std::lgamma(a) - std::lgamma(b));
        if (x > 0.01 && x < 0.99) {
          EXPECT_NEAR((incomplete_beta(a, b, x + h) - incomplete_beta(a, b, x - h)) / (2.0 * h), density,
                      1e-5 * (1.0 + density));
        }
      }
    }
  }
}

// Of every printed table of Student's and Fisher's distributions.
TEST(Statistics, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_quantile(0.05, 1), 12.7062, 1e-4);
  EXPECT_NEAR(student_quantile(0.05, 9), 2.2622, 1e-4);
  EXPECT_NEAR(student_quantile(0.05, 49), 2.0096, 1e-4);
  EXPECT_NEAR(student_quantile(0.01, 30), 2.7500, 1e-4);
  EXPECT_NEAR(student_quantile(0.05, 1e6), 1.95997, 1e-4);
  EXPECT_NEAR(fisher_tail(2.5787, 4, 45), 0.05, 1e-4);
  EXPECT_NEAR(fisher_tail(4.0, 1, 1e7), 0.0455, 1e-4);  // chi-square of one
}

TEST(Statistics, IntervalsHoldTheMeanAsOftenAsTheySay) {
  int inside = 0;
  constexpr int kCampaigns = 2000;
  simulation::Gaussian random(5, 1);
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    std::vector<double> values(10);
    for (double& value : values) value = 3.0 + 2.0 * random();
    const Summary s = summarise(values);
    inside += s.low <= 3.0 && 3.0 <= s.high ? 1 : 0;
  }
  // four sigmas of the count
  EXPECT_NEAR(inside / static_cast<double>(kCampaigns), 0.95, 4.0 * std::sqrt(0.95 * 0.05 / kCampaigns));
}

TEST(Statistics, TestsAreRightAboutNothingAsOftenAsTheySay) {
  int paired = 0;
  int groups = 0;
  constexpr int kCampaigns = 2000;
  simulation::Gaussian random(6, 1);
  for (int campaign = 0; campaign < kCampaigns; ++campaign) {
    std::vector<double> a(50);
    std::vector<double> b(50);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double common = 5.0 * random();
      a[i] = common + random();
      b[i] = common + random();
    }
    paired += paired_t_test(a, b) < 0.05 ? 1 : 0;
    groups += homogeneity(a, 5) < 0.05 ? 1 : 0;
  }
  const double allowed = 4.0 * std::sqrt(0.95 * 0.05 / kCampaigns);
  EXPECT_NEAR(paired / static_cast<double>(kCampaigns), 0.05, allowed);
  EXPECT_NEAR(groups / static_cast<double>(kCampaigns), 0.05, allowed);
}

TEST(Statistics, SeeADifferenceThatIsThere) {
  std::vector<double> a(50);
  std::vector<double> b(50);
  simulation::Gaussian random(7, 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = 1.0 + random() + (i < 10 ? 3.0 : 0.0);
    b[i] = random();
  }
  EXPECT_LT(paired_t_test(a, b), 1e-3);
  EXPECT_LT(homogeneity(a, 5), 1e-3);
  EXPECT_EQ(paired_t_test(a, a), 1.0);
}

TEST(Statistics, OfOneValueThereIsNoInterval) {
  const Summary s = summarise({4.0});
  EXPECT_EQ(s.mean, 4.0);
  EXPECT_EQ(s.low, 4.0);
  EXPECT_EQ(summarise({}).n, 0);
  EXPECT_EQ(paired_t_test({1.0}, {2.0}), 1.0);
}

}  // namespace
}  // namespace trunnion::comparison
