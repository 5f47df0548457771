// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/comparison/statistics.hpp"

#include <cmath>
#include <cstddef>

namespace trunnion::comparison {
namespace {

constexpr double kTiny = 1e-300;

/// The continued fraction of eq. (1), by Lentz's method.
double beta_fraction(double a, double b, double x) {
  constexpr int kMostTerms = 10000;
  constexpr double kEnough = 1e-15;
  double c = 1.0;
  double d = 1.0 - (a + b) * x / (a + 1.0);
  d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
  double value = d;
  const auto step = [&](double numerator) {
    d = 1.0 + numerator * d;
    c = 1.0 + numerator / c;
    d = 1.0 / (std::abs(d) < kTiny ? kTiny : d);
    c = std::abs(c) < kTiny ? kTiny : c;
    value *= c * d;
    return std::abs(c * d - 1.0) < kEnough;
  };
  for (int term = 1; term < kMostTerms; ++term) {
    const double m = term;
    step(m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)));
    if (step(-(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)))) break;
  }
  return value;
}

}  // namespace

double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1.0) / (a + b + 2.0) ? front * beta_fraction(a, b, x) / a
                                       : 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

double student_tail(double t, double n) { return incomplete_beta(0.5 * n, 0.5, n / (n + t * t)); }

double student_quantile(double p, double n) {
  double low = 0.0;
  double high = 1.0;
  while (student_tail(high, n) > p) high *= 2.0;
  for (int step = 0; step < 200 && high - low > 1e-13 * high; ++step) {
    const double middle = 0.5 * (low + high);
    (student_tail(middle, n) > p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double fisher_tail(double f, double m, double n) { return incomplete_beta(0.5 * n, 0.5 * m, n / (n + m * f)); }

Summary summarise(const std::vector<double>& values) {
  Summary s;
  s.n = static_cast<int>(values.size());
  if (s.n == 0) return s;
  for (const double value : values) s.mean += value / s.n;
  s.low = s.high = s.mean;
  if (s.n < 2) return s;
  double squares = 0.0;
  for (const double value : values) squares += (value - s.mean) * (value - s.mean);
  s.deviation = std::sqrt(squares / (s.n - 1));
  const double half = student_quantile(0.05, s.n - 1) * s.deviation / std::sqrt(static_cast<double>(s.n));
  s.low = s.mean - half;
  s.high = s.mean + half;
  return s;
}

double paired_t_test(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
  const Summary s = summarise(difference);
  if (s.n < 2) return 1.0;
  if (s.deviation == 0.0) return s.mean == 0.0 ? 1.0 : 0.0;
  return student_tail(std::abs(s.mean) / (s.deviation / std::sqrt(static_cast<double>(s.n))), s.n - 1);
}

double homogeneity(const std::vector<double>& values, int groups) {
  const std::size_t each = values.size() / static_cast<std::size_t>(groups);
  if (groups < 2 || each < 2) return 1.0;
  double whole = 0.0;
  std::vector<double> mean(static_cast<std::size_t>(groups), 0.0);
  for (std::size_t g = 0; g < mean.size(); ++g) {
    for (std::size_t i = 0; i < each; ++i) mean[g] += values[g * each + i] / static_cast<double>(each);
    whole += mean[g] / groups;
  }
  double between = 0.0;
  double within = 0.0;
  for (std::size_t g = 0; g < mean.size(); ++g) {
    between += static_cast<double>(each) * (mean[g] - whole) * (mean[g] - whole);
    for (std::size_t i = 0; i < each; ++i) within += std::pow(values[g * each + i] - mean[g], 2.0);
  }
  const double m = groups - 1;
  const double n = static_cast<double>(each) * groups - groups;
  if (within == 0.0) return between == 0.0 ? 1.0 : 0.0;
  return fisher_tail(between / m / (within / n), m, n);
}

}  // namespace trunnion::comparison
