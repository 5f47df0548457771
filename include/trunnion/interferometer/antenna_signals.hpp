// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From what the receivers tell to the single differences of two antennas, each at its own time.
///
///   P = rho + c (dt_r - clock),   rho(r, t_sent)                                                          ... (1)
///   D_P = (P_s - P_m) - (rho_s(r_s0) - rho_m(r_m)) + c (clock_s - clock_m),   D_phi likewise              ... (2)
///   r_s0 = r_m + v ((t_s - t_m) - c^-1 mean D_P)                                                          ... (3)
///   -lambda Doppler = e . (v_sat - v) + clocks                                                            ... (4)
///   sigma^2 = s^2 (1/2 + 1/2 sin^-2 elevation)                                                            ... (5)
///
/// Receivers are not synchronised: half a millisecond is 0.4 m of a satellite's way (2), and 5 cm of a vehicle's at
/// 100 m/s (3). Each satellite is taken where it was when it sent to each receiver. The range of a baseline of zero is
/// computed in double; what is left of it, metres, fits a float. That the body has turned between the two times is left
/// out: 1 ms at 20 deg/s is 0.02 deg.

#pragma once

#include "trunnion/core/earth.hpp"
#include "trunnion/interferometer/broadcast_orbit.hpp"
#include "trunnion/interferometer/double_difference.hpp"

namespace trunnion {

/// As many signals as the programs of a host hold; a microcontroller chooses its own.
inline constexpr int kMostSignals = 64;

/// One signal of one satellite at one antenna.
struct AntennaSignal {
  int satellite = 0;                             ///< the caller's number for it
  int group = 0;                                 ///< of system and signal, 0 ... kGroups - 1
  double wavelength = 0.0;                       ///< m
  double code = 0.0;                             ///< P [m]
  double phase = 0.0;                            ///< cycles, growing with the range
  double range_rate = 0.0;                       ///< -lambda Doppler [m/s]; not a number: not measured
  SatellitePlace sent;                           ///< where it was, satellite_when_sending()
  Vec3<double> velocity = Vec3<double>::Zero();  ///< of the satellite [m/s]; for (4)
};

/// What an antenna saw at one time of its receiver's clock.
template <int N>
struct AntennaEpoch {
  GpsTime time;
  std::array<AntennaSignal, static_cast<std::size_t>(N)> at{};
  int count = 0;
};

/// C_ne: components of the Earth's axes to north-east-down at @p r [m, Earth-fixed], geodetic (Bowring's start, one
/// step).
inline Mat3<double> north_from_earth(const Vec3<double>& r) {
  constexpr double kPolar = kEarthRadius * (1.0 - kEarthFlattening);
  const double p = std::hypot(r.x(), r.y());
  const double longitude = std::atan2(r.y(), r.x());
  const double reduced = std::atan2(r.z() * kEarthRadius, p * kPolar);
  const double latitude =
      std::atan2(r.z() + kEarthEccentricity2 / (1.0 - kEarthEccentricity2) * kPolar * std::pow(std::sin(reduced), 3),
                 p - kEarthEccentricity2 * kEarthRadius * std::pow(std::cos(reduced), 3));
  const double sl = std::sin(latitude);
  const double cl = std::cos(latitude);
  const double so = std::sin(longitude);
  const double co = std::cos(longitude);
  Mat3<double> C;
  C << -sl * co, -sl * so, cl, -so, co, 0.0, -cl * co, -cl * so, -sl;
  return C;
}

struct AntennaPlace {
  Vec3<double> r = Vec3<double>::Zero();  ///< Earth-fixed [m]
  Vec3<double> v = Vec3<double>::Zero();  ///< of (4) [m/s]; zero where fewer than four Dopplers were measured
  int used = 0;                           ///< satellites
};

/// Where the antenna is, from its codes alone, without any model of the air: good to 50 m, and 100 m are 0.001 deg.
/// Codes that are off by kilometres are left out.
///
/// @param start anywhere, the Earth's centre too
/// @return kNotObservable with fewer than four satellites; kInconsistent when it does not settle near the Earth
template <int N>
Result<AntennaPlace> antenna_place(const AntennaEpoch<N>& epoch, const Vec3<double>& start = Vec3<double>::Zero()) {
  constexpr double kFar = 1000.0;  // m of a code
  SingleDifferences<double, N> set;
  std::array<int, static_cast<std::size_t>(N)> from{};
  for (int i = 0; i < epoch.count; ++i) {
    const AntennaSignal& s = epoch.at[static_cast<std::size_t>(i)];
    if (s.group < 0 || s.group >= kGroups) continue;
    from[static_cast<std::size_t>(set.count)] = i;
    set[set.count++].group = s.group;
  }
  const auto of = [&](int i) -> const AntennaSignal& {
    return epoch.at[static_cast<std::size_t>(from[static_cast<std::size_t>(i)])];
  };
  const auto one = [](int) { return 1.0; };
  AntennaPlace place;
  place.r = start;
  for (int step = 0; step < 100; ++step) {
    if (set.count < 4) return Status::kNotObservable;
    BaselineSum<double> sum;
    for (int i = 0; i < set.count; ++i) {
      set[i].e = (of(i).sent.r - place.r).normalized();
      set[i].code = of(i).code + kLightSpeed * of(i).sent.clock - range_to(of(i).sent.r, place.r);
    }
    add_centred(
        set, [&](int i) { return set[i].code; }, one, sum);
    const Eigen::SelfAdjointEigenSolver<Mat3<double>> parts(sum.information);
    if (!(parts.eigenvalues()(0) > 1e-6)) return Status::kNotObservable;
    const Vec3<double> moved = sum.information.ldlt().solve(sum.moment);
    place.r += moved;
    if (!place.r.allFinite() || place.r.norm() > 1e9) return Status::kInconsistent;
    if (moved.norm() > 1e-3) continue;
    // settled: does one code lie?
    std::array<double, kGroups> clock{};
    std::array<int, kGroups> members{};
    for (int i = 0; i < set.count; ++i) {
      clock[static_cast<std::size_t>(set[i].group)] += set[i].code;
      ++members[static_cast<std::size_t>(set[i].group)];
    }
    int worst = -1;
    double off = kFar;
    for (int i = 0; i < set.count; ++i) {
      const auto g = static_cast<std::size_t>(set[i].group);
      if (members[g] < 2 || std::abs(set[i].code - clock[g] / members[g]) <= off) continue;
      off = std::abs(set[i].code - clock[g] / members[g]);
      worst = i;
    }
    if (worst < 0) {
      if (std::abs(place.r.norm() - kEarthRadius) > 1e6) return Status::kInconsistent;
      place.used = set.count;
      SingleDifferences<double, N> moving;
      for (int i = 0; i < set.count; ++i) {
        const double rate = of(i).range_rate - set[i].e.dot(of(i).velocity);
        if (!std::isfinite(rate)) continue;
        moving[moving.count] = set[i];
        moving[moving.count++].code = rate;
      }
      BaselineSum<double> speed;
      add_centred(
          moving, [&](int i) { return moving[i].code; }, one, speed);
      const Eigen::SelfAdjointEigenSolver<Mat3<double>> known(speed.information);
      if (known.eigenvalues()(0) > 1e-6) place.v = speed.information.ldlt().solve(speed.moment);
      return place;
    }
    set = set.without(worst);
    for (int i = worst; i < set.count; ++i) from[static_cast<std::size_t>(i)] = from[static_cast<std::size_t>(i) + 1];
  }
  return Status::kInconsistent;
}

/// Eq. (5) of one receiver, and the lowest satellite.
struct SignalNoise {
  double code = 0.3;     ///< s of the codes [m]
  double phase = 0.002;  ///< s of the phases [m]
  double mask = 10.0 * kRadPerDeg;
};

/// Eq. (2), (3), of the signals that both antennas have, satellite and group being the same. Phases whose sigma (5) is
/// past a sixteenth of their wavelength are left out: they tell no whole cycles, and would leave those of all in doubt.
///
/// @param place of the master's antenna
/// @return kTimeOut when the receivers' times are more than 5 ms apart
template <class T, int N>
Result<SingleDifferences<T, N>> single_differences(const AntennaEpoch<N>& master, const AntennaEpoch<N>& slave,
                                                   const AntennaPlace& place, const SignalNoise& noise) {
  constexpr double kFarthest = 0.005;        // s
  constexpr double kMostNoise = 1.0 / 16.0;  // of a wavelength
  const double apart = slave.time - master.time;
  if (!(std::abs(apart) <= kFarthest)) return Status::kTimeOut;
  const Mat3<double> C_ne = north_from_earth(place.r);
  const double lowest = std::sin(noise.mask);
  struct Pair {
    const AntennaSignal* m;
    const AntennaSignal* s;
    Vec3<double> e;
    double code;
  };
  std::array<Pair, static_cast<std::size_t>(N)> pairs;
  int count = 0;
  double clock = 0.0;
  for (int i = 0; i < master.count; ++i) {
    const AntennaSignal& m = master.at[static_cast<std::size_t>(i)];
    const Vec3<double> e = C_ne * (m.sent.r - place.r).normalized();
    if (!(-e.z() >= lowest)) continue;
    for (int j = 0; j < slave.count; ++j) {
      const AntennaSignal& s = slave.at[static_cast<std::size_t>(j)];
      if (s.satellite != m.satellite || s.group != m.group) continue;
      const double zero =
          range_to(s.sent.r, place.r) - range_to(m.sent.r, place.r) - kLightSpeed * (s.sent.clock - m.sent.clock);
      pairs[static_cast<std::size_t>(count)] = {&m, &s, e, zero};
      clock += s.code - m.code - zero;
      ++count;
      break;
    }
  }
  SingleDifferences<T, N> set;
  if (count == 0) return set;
  clock /= count;
  const Vec3<double> way = C_ne * place.v * (apart - clock / kLightSpeed);
  for (int k = 0; k < count; ++k) {
    const Pair& pair = pairs[static_cast<std::size_t>(k)];
    const double zero = pair.code - pair.e.dot(way);
    const double code = pair.s->code - pair.m->code - zero - clock;
    const double phase = pair.s->phase - pair.m->phase - (zero + clock) / pair.m->wavelength;
    const double whole = std::round(phase - code / pair.m->wavelength);
    if (!std::isfinite(code) || !std::isfinite(phase)) continue;
    const double longer = std::sqrt(0.5 + 0.5 / (pair.e.z() * pair.e.z()));
    if (!(noise.phase * longer <= kMostNoise * pair.m->wavelength)) continue;
    SingleDifference<T>& d = set[set.count++];
    d.e = pair.e.template cast<T>();
    d.wavelength = static_cast<T>(pair.m->wavelength);
    d.code = static_cast<T>(code);
    d.phase = static_cast<T>(phase - whole);
    d.code_sigma = static_cast<T>(noise.code * longer);
    d.phase_sigma = static_cast<T>(noise.phase * longer);
    d.group = pair.m->group;
    d.satellite = pair.m->satellite;
  }
  return set;
}

}  // namespace trunnion
