// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a navigation satellite was when it sent, from its broadcast elements: GPS, Galileo, QZSS, BeiDou.
///
///   M = M_0 + (sqrt(GM / A^3) + dn) t,   E - e sin E = M,   u = nu(E) + omega + ...,   t = time - toe       ... (1)
///   Omega = Omega_0 + (Omega' - w_e) t - w_e toe_s,   r_e = Rz(Omega) Rx(i) r_orbit                         ... (2)
///   BeiDou's geostationary ones: Omega = Omega_0 + Omega' t - w_e toe_s,  then Rz(w_e t) Rx(-5 deg)         ... (3)
///   clock = af0 + af1 (time - toc) + af2 (time - toc)^2 - 2 sqrt(GM A) e sin E / c^2                        ... (4)
///   sent at t_tag - P / c - clock:  the receiver's own clock is in both and cancels                         ... (5)
///
/// double only: a metre in 4e7. IS-GPS-200, 20.3.3.4.3; OS-SIS-ICD (Galileo), 5.1; BDS-SIS-ICD B1I, 5.2.4, whose Earth
/// turns at 7.292115e-5 rad/s, not at GPS's 7.2921151467e-5: 7 m of a medium orbit.

#pragma once

#include <cmath>
#include <cstdint>

#include "trunnion/core/gps_time.hpp"
#include "trunnion/core/linear.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion {

inline constexpr double kLightSpeed = 299792458.0;  // m/s, exact

enum class SatelliteSystem : std::uint8_t { kGps, kGalileo, kQzss, kBeidou };

/// The elements of one message; radians, seconds, metres.
struct BroadcastOrbit {
  SatelliteSystem system = SatelliteSystem::kGps;
  int number = 0;  ///< as in RINEX: of the system
  GpsTime toe;     ///< GPS time, whatever the system's own
  GpsTime toc;
  double toe_of_week = 0.0;  ///< in the system's own time, as (2) wants it
  double af0 = 0.0, af1 = 0.0, af2 = 0.0;
  double sqrt_a = 0.0, e = 0.0, i0 = 0.0, omega0 = 0.0, omega = 0.0, m0 = 0.0;
  double delta_n = 0.0, omega_dot = 0.0, i_dot = 0.0;
  double cuc = 0.0, cus = 0.0, crc = 0.0, crs = 0.0, cic = 0.0, cis = 0.0;
  bool healthy = true;
};

struct SatellitePlace {
  Vec3<double> r = Vec3<double>::Zero();  ///< Earth-fixed, of the time of sending [m]
  double clock = 0.0;                     ///< its clock less GPS time [s]
};

/// Farther from its toe an orbit is worth nothing.
inline constexpr double kOrbitLasts = 4.0 * 3600.0;  // s

/// Eq. (1)-(4). @return kOutOfRange for elements of no orbit; kTimeOut when @p time is more than kOrbitLasts from toe
inline Result<SatellitePlace> satellite_at(const BroadcastOrbit& orbit, const GpsTime& time) {
  const bool gps = orbit.system == SatelliteSystem::kGps || orbit.system == SatelliteSystem::kQzss;
  const double gm = gps ? 3.9860050e14 : 3.986004418e14;
  const double earth_rate = orbit.system == SatelliteSystem::kBeidou ? 7.292115e-5 : 7.2921151467e-5;
  const bool geostationary =
      orbit.system == SatelliteSystem::kBeidou && (orbit.number <= 5 || (orbit.number >= 59 && orbit.number <= 61));
  const double t = time - orbit.toe;
  if (!(std::abs(t) <= kOrbitLasts)) return Status::kTimeOut;
  if (!(orbit.sqrt_a > 2500.0 && orbit.sqrt_a < 8000.0) || !(orbit.e >= 0.0 && orbit.e < 0.5))
    return Status::kOutOfRange;
  const double a = orbit.sqrt_a * orbit.sqrt_a;
  const double mean = orbit.m0 + (std::sqrt(gm / (a * a * a)) + orbit.delta_n) * t;
  if (!(std::abs(mean) < 1e6)) return Status::kOutOfRange;
  double E = mean;
  for (int i = 0; i < 30; ++i) {
    const double step = (E - orbit.e * std::sin(E) - mean) / (1.0 - orbit.e * std::cos(E));
    E -= step;
    if (std::abs(step) < 1e-14) break;
  }
  const double sine = std::sin(E);
  const double cosine = std::cos(E);
  const double phase = std::atan2(std::sqrt(1.0 - orbit.e * orbit.e) * sine, cosine - orbit.e) + orbit.omega;
  const double s2 = std::sin(2.0 * phase);
  const double c2 = std::cos(2.0 * phase);
  const double u = phase + orbit.cus * s2 + orbit.cuc * c2;
  const double r = a * (1.0 - orbit.e * cosine) + orbit.crs * s2 + orbit.crc * c2;
  const double i = orbit.i0 + orbit.i_dot * t + orbit.cis * s2 + orbit.cic * c2;
  const double node =
      orbit.omega0 + (orbit.omega_dot - (geostationary ? 0.0 : earth_rate)) * t - earth_rate * orbit.toe_of_week;
  const double x = r * std::cos(u);
  const double y = r * std::sin(u);
  SatellitePlace place;
  place.r << x * std::cos(node) - y * std::cos(i) * std::sin(node),
      x * std::sin(node) + y * std::cos(i) * std::cos(node), y * std::sin(i);
  if (geostationary) {
    const double tilt = -5.0 * kRadPerDeg;
    const Vec3<double> q(place.r.x(), place.r.y() * std::cos(tilt) + place.r.z() * std::sin(tilt),
                         place.r.z() * std::cos(tilt) - place.r.y() * std::sin(tilt));
    const double turned = earth_rate * t;
    place.r << q.x() * std::cos(turned) + q.y() * std::sin(turned), q.y() * std::cos(turned) - q.x() * std::sin(turned),
        q.z();
  }
  const double dt = time - orbit.toc;
  place.clock = orbit.af0 + dt * (orbit.af1 + dt * orbit.af2) -
                2.0 * std::sqrt(gm * a) * orbit.e * sine / (kLightSpeed * kLightSpeed);
  if (!place.r.allFinite() || !(std::abs(place.clock) < 1.0)) return Status::kOutOfRange;
  return place;
}

/// Eq. (5). @param tag of the receiver's clock; @param code [m]
inline Result<SatellitePlace> satellite_when_sending(const BroadcastOrbit& orbit, const GpsTime& tag, double code) {
  const GpsTime by_its_clock = tag + -code / kLightSpeed;
  const Result<SatellitePlace> first = satellite_at(orbit, by_its_clock);
  if (!first.ok()) return first.status();
  return satellite_at(orbit, by_its_clock + -first.value().clock);
}

/// From @p receiver to a satellite [m], by way of an Earth that turns while the signal travels (Sagnac).
inline double range_to(const Vec3<double>& satellite, const Vec3<double>& receiver) {
  return (satellite - receiver).norm() +
         7.2921151467e-5 * (satellite.x() * receiver.y() - satellite.y() * receiver.x()) / kLightSpeed;
}

}  // namespace trunnion
