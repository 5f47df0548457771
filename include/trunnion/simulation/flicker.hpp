// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// 1/f noise: a sum of first-order Gauss-Markov processes whose correlation times are in the ratio of four.
///
///   S(f) = K / f (one-sided) between 1/(2 pi t_0 4^n) and 1/(2 pi t_0),   variance of each = K ln 4          ... (1)
///
/// The flat of the Allan deviation, the bias instability of a data sheet, is B = sqrt(2 ln 2 K): IEEE Std 952-2020,
/// C.1.2.

#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::simulation {

class Flicker {
 public:
  /// @param level K [unit^2]; @param step of the samples [s]; @param span the longest time that matters [s]
  Flicker(double level, double step, double span, std::uint64_t seed, std::uint64_t stream) : noise_(seed, stream) {
    const double sigma = std::sqrt(level * std::log(4.0));
    for (double time = step; time < 4.0 * span; time *= 4.0) {
      const double keep = std::exp(-step / time);
      stages_.push_back({keep, sigma * std::sqrt(1.0 - keep * keep), sigma * noise_()});
    }
  }

  double operator()() {
    double sum = 0.0;
    for (Stage& stage : stages_) {
      stage.value = stage.keep * stage.value + stage.kick * noise_();
      sum += stage.value;
    }
    return sum;
  }

 private:
  struct Stage {
    double keep, kick, value;
  };
  Gaussian noise_;
  std::vector<Stage> stages_;
};

}  // namespace trunnion::simulation
