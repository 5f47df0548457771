// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Random errors from the data, where no sheet states them.

#pragma once

#include <vector>

#include "trunnion/error_model/noise.hpp"

namespace trunnion::calibration {

/// Residuals of one sensor over one recording, equally spaced: mean over the step, about an unknown constant.
struct ResidualSeries {
  double step = 1.0;  ///< s
  std::vector<double> value;
};

/// White noise and Gauss-Markov wander of the sensors that made @p series, by restricted maximum likelihood: the
/// constant of each series is integrated out, so that a short record does not make the wander too small.
///
///   -2 log L = sum_k log S_k + sum_k (e_k - beta u_k)^2 + log sum_k u_k^2,  beta = sum e u / sum u^2       ... (1)
///
/// e, u: the whitened series and the whitened constant. Harville, J. Am. Stat. Assoc. 72 (1977), 320.
/// @param start density [unit/sqrt(Hz)] to begin at; its wander is not used
TriadNoise estimate_noise(const std::vector<ResidualSeries>& series, double start);

}  // namespace trunnion::calibration
