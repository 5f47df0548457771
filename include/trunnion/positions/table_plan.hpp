// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a mount should go through on the table, and how much of it has been seen.
///
/// The plan says nothing of the order. Rests over the range of the pitch tell the accelerometers apart; turns of the
/// azimuth, both ways and at several rates, the gyros' scales and their nonlinearity, while the pitch swings.

#pragma once

#include <array>
#include <cmath>

#include "trunnion/core/units.hpp"

namespace trunnion {

struct PlanStep {
  enum class Kind { kRest, kTurn };
  Kind kind = Kind::kRest;
  double pitch_from = 0.0;  ///< rad, of a rest
  double pitch_to = 0.0;
  double rate = 0.0;     ///< rad/s, of a turn of the azimuth
  double seconds = 0.0;  ///< of it
  double seen = 0.0;     ///< s so far

  [[nodiscard]] bool done() const { return seen >= seconds; }
};

/// What a run file asks of each mount.
struct PlanRequest {
  static constexpr int kMostRates = 10;
  int rest_zones = 5;  ///< the range of the pitch in so many equal parts
  double rest_seconds = 10.0;
  std::array<double, kMostRates> rates{10.0 * kRadPerDeg, 20.0 * kRadPerDeg, 30.0 * kRadPerDeg, 40.0 * kRadPerDeg,
                                       50.0 * kRadPerDeg};  ///< rad/s, each in both directions
  int number_of_rates = 5;
  double turn_seconds = 20.0;
};

class TablePlan {
 public:
  static constexpr int kMostZones = 20;
  static constexpr int kMostSteps = kMostZones + 2 * PlanRequest::kMostRates;
  static constexpr double kStill = 2e-3;          ///< rad/s: slower is a rest
  static constexpr double kRateTolerance = 0.15;  ///< of a turn's rate

  TablePlan() = default;
  /// @param lowest, highest limits of the pitch [rad]
  TablePlan(const PlanRequest& request, double lowest, double highest) {
    const double zone = (highest - lowest) / request.rest_zones;
    for (int i = 0; i < request.rest_zones && i < kMostZones; ++i)
      add({PlanStep::Kind::kRest, lowest + i * zone, lowest + (i + 1) * zone, 0.0, request.rest_seconds});
    for (int i = 0; i < request.number_of_rates; ++i) {
      const double rate = request.rates[static_cast<std::size_t>(i)];
      for (const double direction : {1.0, -1.0})
        add({PlanStep::Kind::kTurn, 0.0, 0.0, direction * rate, request.turn_seconds});
    }
  }

  /// @p dt seconds were spent at these rates [rad/s] and this pitch [rad].
  void see(double dt, double azimuth_rate, double pitch, double pitch_rate) {
    const bool still = std::abs(azimuth_rate) < kStill && std::abs(pitch_rate) < kStill;
    for (int i = 0; i < steps_; ++i) {
      PlanStep& step = step_[static_cast<std::size_t>(i)];
      const double slack = 1e-3 + 0.02 * (step.pitch_to - step.pitch_from);  // a limit may be touched
      const bool fits = step.kind == PlanStep::Kind::kRest
                            ? still && pitch >= step.pitch_from - slack && pitch <= step.pitch_to + slack
                            : std::abs(azimuth_rate - step.rate) <= kRateTolerance * std::abs(step.rate);
      if (fits) step.seen += dt;
    }
  }

  [[nodiscard]] int size() const { return steps_; }
  [[nodiscard]] const PlanStep& operator[](int i) const { return step_[static_cast<std::size_t>(i)]; }

  /// The first step that is not done; -1 when all are.
  [[nodiscard]] int next() const {
    for (int i = 0; i < steps_; ++i) {
      if (!step_[static_cast<std::size_t>(i)].done()) return i;
    }
    return -1;
  }

 private:
  void add(const PlanStep& step) { step_[static_cast<std::size_t>(steps_++)] = step; }

  std::array<PlanStep, kMostSteps> step_{};
  int steps_ = 0;
};

}  // namespace trunnion
