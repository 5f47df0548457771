// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Broadcast orbits of RINEX 2.1x and 3 navigation files, and of messages.
///
/// BeiDou's messages are in its own time, 14 s behind, and are carried over to GPS time.
/// RINEX 2.11 (Gurtner & Estey, 2007); RINEX 3.04 (IGS & RTCM, 2018), tables A5-A14.

#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trunnion/interferometer/broadcast_orbit.hpp"
#include "trunnion/io/rinex_names.hpp"

namespace trunnion::io {

/// Broadcast orbits, the one nearest in time for each satellite.
class OrbitBook {
 public:
  /// Adds a navigation file's; messages that cannot be read are counted. @throws Error (input) for a file that is
  /// missing, is no navigation file or holds no orbit
  void add(const std::string& path);
  /// One more; one of the same satellite and toe is replaced.
  void add(const BroadcastOrbit& orbit);

  /// The healthy orbit whose toe is nearest to @p time, kOrbitLasts at most; nullptr where there is none.
  [[nodiscard]] const BroadcastOrbit* at(const SatelliteName& satellite, const GpsTime& time) const;
  void each(const std::function<void(const BroadcastOrbit&)>& visit) const;
  [[nodiscard]] const RinexLosses& losses() const { return losses_; }
  [[nodiscard]] const std::string& digest() const { return digest_; }
  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  std::map<int, std::vector<BroadcastOrbit>> orbits_;
  std::size_t count_ = 0;
  RinexLosses losses_;
  std::string digest_;
};

}  // namespace trunnion::io
