// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A flight for tests: banks, climbs, turns and vibrates as a small aircraft does; the vibration is a cone of 0.2 deg.

#pragma once

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"

namespace trunnion {

using PathJet = simulation::TimeJet<long double>;

inline PathJet of(double v) { return PathJet(static_cast<long double>(v)); }
inline PathJet wave(double amplitude, double period, double phase, const PathJet& t) {
  return of(amplitude) * sin(of(2.0 * kPi / period) * t + of(phase));
}

struct SmallAircraft {
  double vibration_period = 0.05;  ///< s

  simulation::Pose<PathJet> operator()(const PathJet& t) const {
    return {of(47.0 * kRadPerDeg) + wave(4e-4, 260.0, 0.0, t),
            of(8.0 * kRadPerDeg) + wave(6e-4, 310.0, 0.4, t),
            of(800.0) + wave(150.0, 200.0, 0.0, t),
            wave(25.0 * kRadPerDeg, 31.0, 0.0, t) + wave(0.2 * kRadPerDeg, vibration_period, 0.0, t),
            wave(8.0 * kRadPerDeg, 17.0, 0.0, t) + wave(0.2 * kRadPerDeg, vibration_period, 0.5 * kPi, t),
            wave(150.0 * kRadPerDeg, 300.0, 0.0, t)};
  }
};

struct OnABench {
  simulation::Pose<PathJet> operator()(const PathJet&) const {
    return {of(0.8), of(-2.0), of(300.0), of(0.1), of(0.2), of(0.3)};
  }
};

}  // namespace trunnion
