// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/antenna_epoch.hpp"

#include <cmath>

namespace trunnion::io {

AntennaEpoch<kMostSignals> antenna_epoch(const ObservationEpoch& seen, const std::vector<SignalName>& signals,
                                         const OrbitBook& orbits, LeftOut& left_out) {
  constexpr double kStep = 1.0;  // s, over which a satellite's velocity is a difference: 3e-5 m/s of 4 km/s
  AntennaEpoch<kMostSignals> epoch;
  epoch.time = seen.time;
  for (const SignalObservation& observation : seen.at) {
    if (!std::isfinite(observation.code) || !std::isfinite(observation.phase)) continue;
    if (observation.half_cycle) {
      ++left_out.half_cycles;
      continue;
    }
    const BroadcastOrbit* const orbit = orbits.at(observation.satellite, seen.time);
    if (orbit == nullptr) {
      left_out.without_orbit.insert(observation.satellite.text());
      continue;
    }
    const Result<SatellitePlace> sent = satellite_when_sending(*orbit, seen.time, observation.code);
    const Result<SatellitePlace> before = satellite_when_sending(*orbit, seen.time + -0.5 * kStep, observation.code);
    const Result<SatellitePlace> after = satellite_when_sending(*orbit, seen.time + 0.5 * kStep, observation.code);
    if (!sent.ok() || !before.ok() || !after.ok()) {
      left_out.without_orbit.insert(observation.satellite.text());
      continue;
    }
    if (epoch.count == kMostSignals) {
      ++left_out.too_many;
      continue;
    }
    AntennaSignal& signal = epoch.at[static_cast<std::size_t>(epoch.count++)];
    signal.satellite = observation.satellite.index();
    signal.group = observation.signal;
    signal.wavelength = signals[static_cast<std::size_t>(observation.signal)].wavelength();
    signal.code = observation.code;
    signal.phase = observation.phase;
    signal.range_rate = -signal.wavelength * observation.doppler;
    signal.sent = sent.value();
    signal.velocity = (after.value().r - before.value().r) / kStep;
  }
  return epoch;
}

}  // namespace trunnion::io
