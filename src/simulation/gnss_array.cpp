// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/gnss_array.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "trunnion/core/error.hpp"

namespace trunnion::simulation {
namespace {

constexpr double kL1 = kLightSpeed / 1575.42e6;
constexpr double kDrift = 1e-7;                  // of the receivers' clocks, up to
constexpr double kDopplerSigma = 0.03;           // m/s
constexpr double kEarthTurns = 7.2921151467e-5;  // as GPS has it

/// c (t - t_sent) [m], and where the satellite was.
double light_way(const BroadcastOrbit& orbit, const GpsTime& t, const Vec3<double>& r, SatellitePlace& sent) {
  double way = 7.5e-2 * kLightSpeed;
  for (int i = 0; i < 8; ++i) {
    const Result<SatellitePlace> place = satellite_at(orbit, t + -way / kLightSpeed);
    if (!place.ok()) return std::numeric_limits<double>::quiet_NaN();
    sent = place.value();
    const double angle = kEarthTurns * way / kLightSpeed;
    way = (turn_about_z<double>(-std::sin(angle), std::cos(angle), sent.r) - r).norm();
  }
  return way;
}

}  // namespace

std::vector<BroadcastOrbit> walker_constellation(int count, const GpsTime& toe) {
  constexpr int kPlanes = 6;
  std::vector<BroadcastOrbit> orbits;
  for (int k = 0; k < count; ++k) {
    BroadcastOrbit orbit;
    orbit.number = k + 1;
    orbit.toe = orbit.toc = toe;
    orbit.toe_of_week = toe.seconds;
    orbit.sqrt_a = 5153.7;
    orbit.e = 0.005;
    orbit.i0 = 55.0 * kRadPerDeg;
    orbit.omega0 = 2.0 * kPi * (k % kPlanes) / kPlanes;
    const int row = k / kPlanes;
    const int rows = (count + kPlanes - 1) / kPlanes;
    orbit.m0 = 2.0 * kPi * (static_cast<double>(row) / rows + 0.37 * (k % kPlanes) / kPlanes);
    orbit.af0 = 1e-5 * ((k * 7) % 11 - 5);
    orbits.push_back(orbit);
  }
  return orbits;
}

GnssArray::GnssArray(GnssArrayOptions options, AttitudePath attitude)
    : options_(std::move(options)),
      attitude_(std::move(attitude)),
      noise_(options_.seed, 1),
      multipath_(options_.seed, 2),
      slips_(options_.seed, 3) {
  if (options_.antennas.size() < 2 || options_.orbits.size() < 4 || !options_.place || !(options_.rate_hz > 0.0))
    throw Error(ExitCode::kInput, "an array is two antennas, four satellites, a place and a rate at least");
  Gaussian clocks(options_.seed, 4);
  for (std::size_t a = 0; a < options_.antennas.size(); ++a) {
    clock_.push_back(options_.clocks * (2.0 * clocks.uniform() - 1.0));
    drift_.push_back(kDrift * (2.0 * clocks.uniform() - 1.0));
    signal_.emplace_back(options_.orbits.size());
  }
}

Vec3<double> GnssArray::antenna_at(std::size_t antenna, double t) const {
  const Vec3<double> r = options_.place(t);
  return r + north_from_earth(r).transpose() * (attitude_.q_nb(t) * options_.antennas[antenna]);
}

bool GnssArray::out(std::size_t antenna, int satellite, double t) const {
  for (const Outage& o : options_.outages) {
    if (static_cast<std::size_t>(o.antenna) == antenna && (o.satellite == 0 || o.satellite == satellite) &&
        t >= o.from && t < o.to)
      return true;
  }
  return false;
}

const GnssArray::Epoch& GnssArray::next() {
  const double period = 1.0 / options_.rate_hz;
  epoch_.t = static_cast<double>(epochs_++) * period;
  epoch_.antenna.clear();
  for (std::size_t a = 0; a < options_.antennas.size(); ++a) {
    const double off = clock_[a] + drift_[a] * epoch_.t;
    const double true_t = epoch_.t - off;
    if (a == 0) epoch_.q_nb = attitude_.q_nb(true_t);
    const Vec3<double> r = antenna_at(a, true_t);
    const Mat3<double> C_ne = north_from_earth(r);
    AntennaEpoch<kMostSignals> seen;
    seen.time = options_.start + epoch_.t;
    for (std::size_t k = 0; k < options_.orbits.size() && seen.count < kMostSignals; ++k) {
      const BroadcastOrbit& orbit = options_.orbits[k];
      Signal& signal = signal_[a][k];
      SatellitePlace sent;
      const double way = light_way(orbit, options_.start + true_t, r, sent);
      const double elevation = std::asin(-(C_ne * (sent.r - r).normalized()).z());
      if (!(elevation > options_.mask) || out(a, orbit.number, epoch_.t)) {
        signal.fresh = true;
        continue;
      }
      if (signal.fresh) {  // locks on to any cycle
        signal.cycles = std::floor(1e6 * (2.0 * slips_.uniform() - 1.0));
        signal.code_multipath = multipath_();
        signal.phase_multipath = multipath_();
        signal.fresh = false;
      } else {
        const double kept = std::exp(-period / options_.multipath_time);
        signal.code_multipath = kept * signal.code_multipath + std::sqrt(1.0 - kept * kept) * multipath_();
        signal.phase_multipath = kept * signal.phase_multipath + std::sqrt(1.0 - kept * kept) * multipath_();
      }
      if (slips_.uniform() < options_.slips_per_hour * period / 3600.0)
        signal.cycles += std::floor(1.0 + 100.0 * slips_.uniform());
      if (slips_.uniform() < options_.half_slips_per_hour * period / 3600.0) signal.cycles += 0.5;
      const double longer = std::sqrt(0.5 + 0.5 / std::pow(std::sin(elevation), 2));
      const double pseudorange = way + kLightSpeed * (off - sent.clock);
      AntennaSignal& out_signal = seen.at[static_cast<std::size_t>(seen.count++)];
      out_signal.satellite = orbit.number;
      out_signal.group = static_cast<int>(orbit.system);
      out_signal.wavelength = kL1;
      out_signal.code =
          pseudorange + longer * (options_.code_sigma * noise_() + options_.code_multipath * signal.code_multipath);
      out_signal.phase = (pseudorange + longer * (options_.phase_sigma * noise_() +
                                                  options_.phase_multipath * signal.phase_multipath)) /
                             kL1 +
                         signal.cycles;
      constexpr double kHalf = 0.05;  // s
      SatellitePlace ignored;
      const double later = light_way(orbit, options_.start + (true_t + kHalf), antenna_at(a, true_t + kHalf), ignored);
      const double sooner = light_way(orbit, options_.start + (true_t - kHalf), antenna_at(a, true_t - kHalf), ignored);
      out_signal.range_rate = (later - sooner) / (2.0 * kHalf) + kLightSpeed * drift_[a] + kDopplerSigma * noise_();
      // as a receiver finds it: from its own tag and code
      const Result<SatellitePlace> found = satellite_when_sending(orbit, seen.time, out_signal.code);
      const Result<SatellitePlace> next_found = satellite_when_sending(orbit, seen.time + 1.0, out_signal.code);
      if (!found.ok() || !next_found.ok()) {
        --seen.count;
        continue;
      }
      out_signal.sent = found.value();
      out_signal.velocity = next_found.value().r - found.value().r;
    }
    epoch_.antenna.push_back(seen);
  }
  return epoch_;
}

}  // namespace trunnion::simulation
