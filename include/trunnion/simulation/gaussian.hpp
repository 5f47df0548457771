// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Normal deviates that are the same on every platform: the standard fixes mt19937_64 but not normal_distribution.
/// Marsaglia's polar method over 53-bit uniforms; one stream for each cause, so that switching one on leaves the others
/// as they were.

#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace trunnion::simulation {

class Gaussian {
 public:
  /// @param seed of the experiment; @param stream which cause in it, any number
  Gaussian(std::uint64_t seed, std::uint64_t stream) : engine_(mix(seed) ^ mix(stream + 0x9e3779b97f4a7c15ULL)) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }

  /// Zero mean, unit variance.
  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = 2.0 * uniform() - 1.0;
      v = 2.0 * uniform() - 1.0;
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double k = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * k;
    has_spare_ = true;
    return u * k;
  }

 private:
  /// SplitMix64, Steele, Lea, Flood 2014: neighbouring seeds become unrelated ones.
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }

  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace trunnion::simulation
