// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a stretch of samples becomes: an observation window, in which the unit's mean output meets the mean of what the
/// rig's motion says it should read.
///
/// A sample is a mean over the nominal period P that ends at its stamp, so n samples cover n intervals, not always
/// without holes. The window keeps the moments of that covering as the weights of a quadrature: for every polynomial g
/// of degree <= 4, and for a whole window of degree <= 9,
///
///   sum_k weight_k g(t + half_width x_k) = 1/(n P) sum_i integral from t_i - P to t_i of g(s) ds         ... (1)
///
/// x_k: Gauss-Legendre nodes of order 5. A turn of 50 deg/s sweeps 5 deg in 0.1 s: the error of (1) is then below
/// 1e-12. docs/theory/calibration.md, eq. 13-15.

#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "trunnion/core/linear.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

inline constexpr int kWindowNodes = 5;
inline constexpr std::array<double, kWindowNodes> kNodeAbscissa = {-0.90617984593866399280, -0.53846931010568309104,
                                                                   0.0, 0.53846931010568309104, 0.90617984593866399280};

struct ObservationWindow {
  double t = 0.0;           ///< middle, on the unit's clock [s]
  double half_width = 0.0;  ///< [s]
  std::array<double, kWindowNodes> weight{};
  InertialSample<double> mean;  ///< of the readings
  int samples = 0;
  double temperature = std::numeric_limits<double>::quiet_NaN();  ///< mean over the samples [degC]; NaN: not measured
};

/// Weights of eq. (1) from the moments m_j = mean of x^j over the covering, j = 0..4, x = (s - t) / half_width.
inline std::array<double, kWindowNodes> quadrature_weights(const std::array<double, kWindowNodes>& moment) {
  std::array<double, kWindowNodes> weight{};
  for (std::size_t k = 0; k < weight.size(); ++k) {
    // the Lagrange polynomial of node k, as coefficients of x^j, against the moments
    std::array<double, kWindowNodes> c{1.0};
    std::size_t degree = 0;
    double scale = 1.0;
    for (std::size_t other = 0; other < weight.size(); ++other) {
      if (other == k) continue;
      ++degree;
      for (std::size_t j = degree; j > 0; --j) c[j] = c[j - 1] - kNodeAbscissa[other] * c[j];
      c[0] *= -kNodeAbscissa[other];
      scale *= kNodeAbscissa[k] - kNodeAbscissa[other];
    }
    for (std::size_t j = 0; j < weight.size(); ++j) weight[k] += c[j] * moment[j];
    weight[k] /= scale;
  }
  return weight;
}

}  // namespace trunnion
