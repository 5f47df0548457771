// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Observations of a receiver with the places of their satellites: what interferometer/antenna_signals.hpp takes.

#pragma once

#include <set>
#include <string>
#include <vector>

#include "trunnion/interferometer/antenna_signals.hpp"
#include "trunnion/io/observation_reader.hpp"
#include "trunnion/io/orbit_book.hpp"

namespace trunnion::io {

/// What was left out, satellite by satellite.
struct LeftOut {
  std::set<std::string> without_orbit;  ///< none, none within four hours, none that is healthy
  long long half_cycles = 0;            ///< phases that the receiver calls doubtful
  long long too_many = 0;               ///< signals beyond kMostSignals
};

/// Signals with code and phase whose satellites have an orbit; a signal's group is its index among @p signals.
AntennaEpoch<kMostSignals> antenna_epoch(const ObservationEpoch& seen, const std::vector<SignalName>& signals,
                                         const OrbitBook& orbits, LeftOut& left_out);

}  // namespace trunnion::io
