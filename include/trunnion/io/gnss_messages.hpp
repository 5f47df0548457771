// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Raw phases, broadcast orbits and attitudes as messages of package trunnion_lcm: gnss_raw_t, gnss_orbit_t,
/// attitude_t.

#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trunnion/interferometer/attitude_tracker.hpp"
#include "trunnion/io/observation_reader.hpp"
#include "trunnion/io/orbit_book.hpp"

namespace trunnion::io {

/// Fingerprints of the types: part of the format.
inline constexpr std::uint64_t kGnssRawFingerprint = 0x4419abd9f87f422aULL;
inline constexpr std::uint64_t kGnssOrbitFingerprint = 0xa95913de56646e0eULL;
inline constexpr std::uint64_t kAttitudeFingerprint = 0x57a0ca37053d3d0dULL;

struct GnssRaw {
  std::int64_t utime = 0;
  std::int64_t sequence = 0;
  int antenna = 0;
  ObservationEpoch epoch;
};

void encode_gnss_raw(const GnssRaw& raw, const std::vector<SignalName>& signals, std::string& out);
/// @param signals those that are wanted; others, and satellites of other systems, are left out
/// @return nothing for a message of another type, of a length that it does not state, or of no antenna or time
std::optional<GnssRaw> decode_gnss_raw(std::string_view message, const std::vector<SignalName>& signals);

void encode_gnss_orbit(std::int64_t utime, std::int64_t sequence, const BroadcastOrbit& orbit, std::string& out);
/// @return nothing for a message of another type or system, or with a number that is not finite
std::optional<BroadcastOrbit> decode_gnss_orbit(std::string_view message);

struct AttitudeMessage {
  std::int64_t utime = 0;
  std::int64_t sequence = 0;
  AttitudeStatus status = AttitudeStatus::kNone;
  int satellites = 0;
  AttitudeEstimate<double> attitude;
  Vec3<double> rate = Vec3<double>::Constant(std::numeric_limits<double>::quiet_NaN());
};

void encode_attitude(const AttitudeMessage& message, std::string& out);
/// @return nothing for a message of another type
std::optional<AttitudeMessage> decode_attitude(std::string_view message);

}  // namespace trunnion::io
