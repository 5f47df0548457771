// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Random errors of one three-axis sensor, as a data sheet states them.
///
///   white noise N:      1 sigma of a mean over dt is N / sqrt(dt)
///   bias wander:        first-order Gauss-Markov process, E[b(t) b(t + s)] = sigma^2 exp(-|s| / tau)
///
/// Both stand for each of the three sensors alone. IEEE Std 952-1997, annex B and C.

#pragma once

namespace trunnion {

struct TriadNoise {
  double density = 0.0;                  ///< N, [unit of the sensor / sqrt(Hz)]
  double wander = 0.0;                   ///< 1 sigma of the Gauss-Markov process [unit of the sensor]
  double wander_correlation_time = 1.0;  ///< tau [s]
};

struct UnitNoise {
  TriadNoise gyro;   ///< rad/s
  TriadNoise accel;  ///< m/s^2
};

}  // namespace trunnion
