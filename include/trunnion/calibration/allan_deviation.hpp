// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Overlapping Allan deviation of a sensor at rest, and the noise terms that it shows.
///
///   sigma^2(m P) = 1 / (2 (m P)^2 (n - 2 m + 1)) sum_k (x_k+2m - 2 x_k+m + x_k)^2,  x: integral of the readings  ...
///   (1) sigma^2(tau) = 3 Q^2 / tau^2 + N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3 + R^2 tau^2 / 2 ... (2)
///   sigma^2(tau) = N^2 / tau + 2 s^2 T / tau (1 - T / (2 tau) (3 - 4 exp(-tau / T) + exp(-2 tau / T)))          ...
///   (3)
///
/// Q: quantisation, N: white noise, B: bias instability, K: rate random walk, R: ramp; s, T: Gauss-Markov wander as a
/// sensor sheet states it. Both are fitted without negative terms by maximum likelihood, each tau chi-square with its
/// degrees of freedom; that neighbouring taus share data is not in it. A wander that takes off less deviance than
/// chance does one time in a hundred is none. Limits are 1 sigma of chi-square with those degrees of freedom after the
/// noise that the local slope shows. IEEE Std 952-1997, annex C; Riley, Handbook of Frequency Stability Analysis, NIST
/// SP 1065 (2008), sections 5.2 and 5.4; docs/theory/noise.md.

#pragma once

#include <cstddef>
#include <vector>

#include "trunnion/error_model/noise.hpp"

namespace trunnion::calibration {

struct AllanPoint {
  double tau = 0.0;        ///< s
  double deviation = 0.0;  ///< unit of the readings
  double low = 0.0;        ///< 1 sigma limits
  double high = 0.0;
  double freedom = 0.0;  ///< degrees of
};

/// Eq. (1) at tau = P, 2 P, 4 P, ... while two whole taus fit: one pass over the data for all of them.
/// @param readings at least three, without holes; integrated where they lie: move what is not needed again.
/// @param period P [s]
std::vector<AllanPoint> allan_deviation(std::vector<double> readings, double period);

/// Coefficients of eq. (2); a term that the data do not show is zero.
struct NoiseTerms {
  double quantisation = 0.0;      ///< Q [unit s]
  double white = 0.0;             ///< N [unit / sqrt(Hz)]
  double bias_instability = 0.0;  ///< B [unit]
  double rate_random_walk = 0.0;  ///< K [unit / sqrt(s)]
  double ramp = 0.0;              ///< R [unit / s]
};

NoiseTerms fit_noise_terms(const std::vector<AllanPoint>& curve);

/// Eq. (3), as a sheet has it; a wander of zero has the correlation time 1 s.
TriadNoise fit_sheet_noise(const std::vector<AllanPoint>& curve);

}  // namespace trunnion::calibration
