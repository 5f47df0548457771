// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/positions/observation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace trunnion {
namespace {

/// Moments of a covering by intervals [a, b] in units of the half width.
std::array<double, kWindowNodes> moments(const std::vector<std::pair<double, double>>& intervals) {
  std::array<double, kWindowNodes> moment{};
  double length = 0.0;
  for (const auto& [a, b] : intervals) {
    length += b - a;
    for (int j = 0; j < kWindowNodes; ++j)
      moment[static_cast<std::size_t>(j)] += (std::pow(b, j + 1) - std::pow(a, j + 1)) / (j + 1);
  }
  for (double& m : moment) m /= length;
  return moment;
}

TEST(QuadratureWeights, OfAWholeWindowAreGaussLegendre) {
  const auto weight = quadrature_weights(moments({{-1.0, 1.0}}));
  constexpr std::array<double, 5> kHalfLegendre = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                                   0.23931433524968324, 0.11846344252809454};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(weight[k], kHalfLegendre[k], 1e-14);
}

// The law (1): exact for polynomials up to degree four whatever is missing, and to degree nine where nothing is.
TEST(QuadratureWeights, IntegrateAPolynomialOverWhatIsThere) {
  const std::vector<std::pair<double, double>> holes = {{-1.0, -0.9}, {-0.85, 0.2}, {0.3, 0.35}, {0.4, 1.0}};
  const auto weight = quadrature_weights(moments(holes));
  for (int degree = 0; degree <= 4; ++degree) {
    double quadrature = 0.0;
    for (std::size_t k = 0; k < 5; ++k) quadrature += weight[k] * std::pow(kNodeAbscissa[k], degree);
    EXPECT_NEAR(quadrature, moments(holes)[static_cast<std::size_t>(degree)], 1e-14) << degree;
  }
  const auto whole = quadrature_weights(moments({{-1.0, 1.0}}));
  for (int degree = 5; degree <= 9; ++degree) {
    double quadrature = 0.0;
    for (std::size_t k = 0; k < 5; ++k) quadrature += whole[k] * std::pow(kNodeAbscissa[k], degree);
    EXPECT_NEAR(quadrature, degree % 2 == 0 ? 1.0 / (degree + 1) : 0.0, 1e-14) << degree;
  }
}

}  // namespace
}  // namespace trunnion
