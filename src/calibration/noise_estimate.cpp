// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/noise_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "whitening.hpp"

namespace trunnion::calibration {
namespace {

double deviance(const std::vector<ResidualSeries>& series, const TriadNoise& noise) {
  double total = 0.0;
  for (const ResidualSeries& one : series) {
    Whitening<Eigen::Array2d> whitening(noise, Eigen::Array2d::Zero());
    const double R = noise.density * noise.density / one.step;
    double ee = 0.0;
    double eu = 0.0;
    double uu = 0.0;
    for (std::size_t k = 0; k < one.value.size(); ++k) {
      total += std::log(whitening.predict(static_cast<double>(k) * one.step, R));
      const Eigen::Array2d e = whitening.innovate(Eigen::Array2d(one.value[k], 1.0));
      ee += e(0) * e(0);
      eu += e(0) * e(1);
      uu += e(1) * e(1);
    }
    if (uu > 0.0) total += ee - eu * eu / uu + std::log(uu);
  }
  return total;
}

}  // namespace

TriadNoise estimate_noise(const std::vector<ResidualSeries>& series, double start) {
  double longest = 1.0;
  for (const ResidualSeries& one : series)
    longest = std::max(longest, one.step * static_cast<double>(one.value.size()));
  // the three unknowns as logarithms: density, wander against density, correlation time
  using Point = std::array<double, 3>;
  const auto noise_at = [&](const Point& p) {
    TriadNoise noise;
    noise.density = std::exp(p[0]);
    noise.wander = noise.density * std::exp(p[1]);
    // a correlation time far past the record is a constant, one below the step is white: neither can be told
    noise.wander_correlation_time = std::exp(std::clamp(p[2], std::log(5.0), std::log(longest)));
    return noise;
  };
  Point best = {std::log(start), std::log(0.01), std::log(100.0)};
  double lowest = deviance(series, noise_at(best));
  for (const double wander : {1e-4, 0.003, 0.03, 0.1, 0.3, 1.0}) {
    for (const double tau : {10.0, 50.0, 200.0}) {
      const Point candidate = {std::log(start), std::log(wander), std::log(tau)};
      const double value = deviance(series, noise_at(candidate));
      if (value < lowest) {
        lowest = value;
        best = candidate;
      }
    }
  }
  for (double step = 0.7; step > 0.01; step *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t i = 0; i < 3; ++i) {
        for (const double direction : {-1.0, 1.0}) {
          Point candidate = best;
          candidate[i] += direction * step;
          if (candidate[1] < std::log(1e-5) || candidate[2] < std::log(5.0) || candidate[2] > std::log(longest))
            continue;
          const double value = deviance(series, noise_at(candidate));
          if (value < lowest - 1e-6) {
            lowest = value;
            best = candidate;
            moved = true;
          }
        }
      }
    }
  }
  return noise_at(best);
}

}  // namespace trunnion::calibration
