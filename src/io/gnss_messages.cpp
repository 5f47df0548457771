// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/gnss_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "big_endian.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kRawHead = 3 * 8 + 4 + 4 + 8 + 4;
constexpr std::size_t kRawSignal = 4 + 4 + 3 * 8 + 1;
constexpr int kMostInMessage = 1000;
constexpr std::size_t kOrbitBytes = 3 * 8 + 2 * 4 + 2 * (4 + 8) + 8 + 3 * 8 + 15 * 8;
constexpr std::size_t kAttitudeBytes = 3 * 8 + 1 + 1 + 2 + 8 * (4 + 9 + 3 + 3);
constexpr int kWeeks = 10000;

/// The numbers of a message one after the other.
class Reader {
 public:
  explicit Reader(std::string_view message) : p_(message.data()) {}
  std::int64_t i64() { return load_i64(advance(8)); }
  std::int32_t i32() { return static_cast<std::int32_t>(load_u32(advance(4))); }
  std::int8_t i8() { return static_cast<std::int8_t>(*advance(1)); }
  double number() { return load_double(advance(8)); }

 private:
  const char* advance(std::size_t bytes) {
    const char* const here = p_;
    p_ += bytes;
    return here;
  }
  const char* p_;
};

void append_i32(std::string& out, int v) { append_unsigned(out, static_cast<std::uint32_t>(v)); }

bool is_time(const GpsTime& time) {
  return time.week >= 0 && time.week < kWeeks && time.seconds >= 0.0 && time.seconds < kSecondsPerWeek + 1.0;
}

std::optional<SatelliteName> satellite_of(std::int32_t index) {
  if (index < 1 || index >= 400 || index % 100 == 0) return std::nullopt;
  return SatelliteName{static_cast<SatelliteSystem>(index / 100), index % 100};
}

/// The elements in the order of gnss_orbit_t.
std::array<double*, 15> elements_of(BroadcastOrbit& o) {
  return {&o.sqrt_a, &o.e,   &o.i0,  &o.omega0, &o.omega, &o.m0,  &o.delta_n, &o.omega_dot,
          &o.i_dot,  &o.cuc, &o.cus, &o.crc,    &o.crs,   &o.cic, &o.cis};
}

}  // namespace

void encode_gnss_raw(const GnssRaw& raw, const std::vector<SignalName>& signals, std::string& out) {
  out.clear();
  append_unsigned(out, kGnssRawFingerprint);
  append_i64(out, raw.utime);
  append_i64(out, raw.sequence);
  append_i32(out, raw.antenna);
  append_i32(out, raw.epoch.time.week);
  append_double(out, raw.epoch.time.seconds);
  append_i32(out, static_cast<int>(raw.epoch.at.size()));
  for (const SignalObservation& o : raw.epoch.at) append_i32(out, o.satellite.index());
  for (const SignalObservation& o : raw.epoch.at) {
    const SignalName& name = signals[static_cast<std::size_t>(o.signal)];
    append_i32(out, name.code[0] * 256 + name.code[1]);
  }
  for (const SignalObservation& o : raw.epoch.at) append_double(out, o.code);
  for (const SignalObservation& o : raw.epoch.at) append_double(out, o.phase);
  for (const SignalObservation& o : raw.epoch.at) append_double(out, o.doppler);
  for (const SignalObservation& o : raw.epoch.at) out.push_back(o.half_cycle ? '\1' : '\0');
}

std::optional<GnssRaw> decode_gnss_raw(std::string_view message, const std::vector<SignalName>& signals) {
  if (message.size() < kRawHead || load_u64(message.data()) != kGnssRawFingerprint) return std::nullopt;
  Reader head(message.substr(8));
  GnssRaw raw;
  raw.utime = head.i64();
  raw.sequence = head.i64();
  raw.antenna = head.i32();
  raw.epoch.time.week = head.i32();
  raw.epoch.time.seconds = head.number();
  const int count = head.i32();
  if (count < 0 || count > kMostInMessage ||
      message.size() != kRawHead + kRawSignal * static_cast<std::size_t>(count) || raw.antenna < 0 ||
      !is_time(raw.epoch.time))
    return std::nullopt;
  const auto n = static_cast<std::size_t>(count);
  const char* const satellites = message.data() + kRawHead;
  const char* const names = satellites + 4 * n;
  const char* const codes = names + 4 * n;
  const char* const phases = codes + 8 * n;
  const char* const dopplers = phases + 8 * n;
  const char* const halves = dopplers + 8 * n;
  for (std::size_t i = 0; i < n; ++i) {
    const auto satellite = satellite_of(static_cast<std::int32_t>(load_u32(satellites + 4 * i)));
    if (!satellite) continue;
    const std::uint32_t name = load_u32(names + 4 * i);
    const auto wanted = std::find_if(signals.begin(), signals.end(), [&](const SignalName& s) {
      return s.system == satellite->system && name == static_cast<std::uint32_t>(s.code[0] * 256 + s.code[1]);
    });
    if (wanted == signals.end()) continue;
    SignalObservation observation;
    observation.satellite = *satellite;
    observation.signal = static_cast<int>(wanted - signals.begin());
    observation.code = load_double(codes + 8 * i);
    observation.phase = load_double(phases + 8 * i);
    observation.doppler = load_double(dopplers + 8 * i);
    observation.half_cycle = halves[i] != '\0';
    // as in RINEX: what no receiver measures was not measured
    if (!(observation.code > 1e7 && observation.code < 1e8) || !(std::abs(observation.phase) < 1e11)) continue;
    const auto same = std::find_if(raw.epoch.at.begin(), raw.epoch.at.end(), [&](const SignalObservation& o) {
      return o.satellite.index() == satellite->index() && o.signal == observation.signal;
    });
    if (same == raw.epoch.at.end()) raw.epoch.at.push_back(observation);
  }
  return raw;
}

void encode_gnss_orbit(std::int64_t utime, std::int64_t sequence, const BroadcastOrbit& orbit, std::string& out) {
  out.clear();
  append_unsigned(out, kGnssOrbitFingerprint);
  append_i64(out, utime);
  append_i64(out, sequence);
  append_i32(out, SatelliteName{orbit.system, orbit.number}.index());
  append_i32(out, orbit.healthy ? 1 : 0);
  append_i32(out, orbit.toe.week);
  append_double(out, orbit.toe.seconds);
  append_i32(out, orbit.toc.week);
  append_double(out, orbit.toc.seconds);
  append_double(out, orbit.toe_of_week);
  for (const double clock : {orbit.af0, orbit.af1, orbit.af2}) append_double(out, clock);
  BroadcastOrbit copy = orbit;
  for (const double* element : elements_of(copy)) append_double(out, *element);
}

std::optional<BroadcastOrbit> decode_gnss_orbit(std::string_view message) {
  if (message.size() != kOrbitBytes || load_u64(message.data()) != kGnssOrbitFingerprint) return std::nullopt;
  Reader reader(message.substr(24));
  const auto satellite = satellite_of(reader.i32());
  if (!satellite) return std::nullopt;
  BroadcastOrbit orbit;
  orbit.system = satellite->system;
  orbit.number = satellite->number;
  orbit.healthy = reader.i32() == 1;
  orbit.toe.week = reader.i32();
  orbit.toe.seconds = reader.number();
  orbit.toc.week = reader.i32();
  orbit.toc.seconds = reader.number();
  orbit.toe_of_week = reader.number();
  bool finite = std::isfinite(orbit.toe_of_week);
  for (double* clock : {&orbit.af0, &orbit.af1, &orbit.af2}) finite = std::isfinite(*clock = reader.number()) && finite;
  for (double* element : elements_of(orbit)) finite = std::isfinite(*element = reader.number()) && finite;
  const auto near = [](const GpsTime& t) {
    return t.week >= 0 && t.week < kWeeks && std::abs(t.seconds) < 2.0 * kSecondsPerWeek;
  };
  if (!finite || !near(orbit.toe) || !near(orbit.toc)) return std::nullopt;
  return orbit;
}

void encode_attitude(const AttitudeMessage& message, std::string& out) {
  out.clear();
  append_unsigned(out, kAttitudeFingerprint);
  append_i64(out, message.utime);
  append_i64(out, message.sequence);
  out.push_back(static_cast<char>(message.status));
  out.push_back(static_cast<char>(message.attitude.observable));
  out.push_back(static_cast<char>(message.satellites / 256));
  out.push_back(static_cast<char>(message.satellites % 256));
  const Quaternion<double>& q = message.attitude.q_nb;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) append_double(out, value);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) append_double(out, message.attitude.covariance(i, j));
  }
  for (int i = 0; i < 3; ++i) append_double(out, message.attitude.free_axis(i));
  for (int i = 0; i < 3; ++i) append_double(out, message.rate(i));
}

std::optional<AttitudeMessage> decode_attitude(std::string_view message) {
  if (message.size() != kAttitudeBytes || load_u64(message.data()) != kAttitudeFingerprint) return std::nullopt;
  Reader reader(message.substr(8));
  AttitudeMessage attitude;
  attitude.utime = reader.i64();
  attitude.sequence = reader.i64();
  const std::int8_t status = reader.i8();
  if (status < 0 || status > static_cast<std::int8_t>(AttitudeStatus::kFixed)) return std::nullopt;
  attitude.status = static_cast<AttitudeStatus>(status);
  attitude.attitude.observable = static_cast<std::uint8_t>(reader.i8());
  const auto high = static_cast<std::uint8_t>(reader.i8());
  attitude.satellites = high * 256 + static_cast<std::uint8_t>(reader.i8());
  Quaternion<double>& q = attitude.attitude.q_nb;
  for (double* value : {&q.w(), &q.x(), &q.y(), &q.z()}) *value = reader.number();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) attitude.attitude.covariance(i, j) = reader.number();
  }
  for (int i = 0; i < 3; ++i) attitude.attitude.free_axis(i) = reader.number();
  for (int i = 0; i < 3; ++i) attitude.rate(i) = reader.number();
  return attitude;
}

}  // namespace trunnion::io
