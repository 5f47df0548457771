// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What RINEX calls satellites, signals and times.
///
/// GPS, Galileo, QZSS and BeiDou. A signal is named as in RINEX 3, system and two characters: "G1C" is C1C and L1C of
/// GPS. RINEX 3.04 (IGS & RTCM, 2018), tables 5-13.

#pragma once

#include <array>
#include <string>

#include "trunnion/interferometer/broadcast_orbit.hpp"

namespace trunnion::io {

struct SatelliteName {
  SatelliteSystem system = SatelliteSystem::kGps;
  int number = 0;
  /// "G05".
  [[nodiscard]] std::string text() const;
  /// One number for each satellite of every system.
  [[nodiscard]] int index() const { return static_cast<int>(system) * 100 + number; }
};

/// A system's signal: its letter, then band and attribute, "G1C".
struct SignalName {
  SatelliteSystem system = SatelliteSystem::kGps;
  std::array<char, 2> code{};
  [[nodiscard]] std::string text() const;
  /// m. @throws Error (input) for a band that the system has not
  [[nodiscard]] double wavelength() const;
  /// @throws Error (usage) for what names no signal of the four systems
  static SignalName parse(const std::string& text);
};

/// What was passed over in a file.
struct RinexLosses {
  long long epochs = 0;      ///< that could not be read
  long long satellites = 0;  ///< lines of them
  std::string first;         ///< what is wrong with the first: "file:line: field: ..."
};

/// Calendar to GPS time; the calendar is that of GPS, without leap seconds.
GpsTime gps_time(int year, int month, int day, int hour, int minute, double second);

}  // namespace trunnion::io
