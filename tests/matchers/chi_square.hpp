// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Quantiles of the chi-square distribution, by Wilson and Hilferty's cube: within 1 % of the tails' distance from the
/// mean for 3 degrees of freedom and more at the levels used here.

#pragma once

#include <cmath>

#include "trunnion/core/chi_square.hpp"

namespace trunnion {

/// Upper quantile of the standard normal for a tail of @p p < 0.5: Abramowitz & Stegun 26.2.23, |error| < 4.5e-4.
inline double normal_quantile(double p) {
  const double t = std::sqrt(-2.0 * std::log(p));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

struct ChiSquareBand {
  double low, high;
};

/// Two-sided band that chi-square with @p n degrees of freedom leaves with probability @p false_alarm.
inline ChiSquareBand chi_square_band(double n, double false_alarm) {
  const double z = normal_quantile(0.5 * false_alarm);
  return {chi_square_quantile(n, -z), chi_square_quantile(n, z)};
}

}  // namespace trunnion
