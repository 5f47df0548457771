// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Antennas on a body that moves under a constellation, and what their receivers tell.
///
///   P = c ((t + dt_r) - (t_sent + dt_sat)) + multipath + noise,   |Rz(w_e (t - t_sent)) r_sat - r_a| = c (t - t_sent)
///   lambda phi = the same without them + lambda N + multipath' + noise'                                   ... (1)
///
/// t: the true time at which a receiver's clock, dt_r off, shows the epoch. Multipath: first-order Gauss-Markov of each
/// satellite at each antenna. Noise and multipath grow as sqrt(1/2 + 1/2 sin^-2 elevation). The way of the light is
/// solved with the Earth turned under it, not with the formula of Sagnac that the estimator uses.

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "trunnion/interferometer/antenna_signals.hpp"
#include "trunnion/simulation/attitude_path.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::simulation {

/// A circular constellation of @p count GPS-like satellites in six planes, inclined by 55 deg; a stand-in for a
/// message.
std::vector<BroadcastOrbit> walker_constellation(int count, const GpsTime& toe);

struct Outage {
  int antenna = 0;
  int satellite = 0;            ///< number of its orbit; 0: all
  double from = 0.0, to = 0.0;  ///< s after the start
};

struct GnssArrayOptions {
  std::uint64_t seed = 1;
  std::vector<BroadcastOrbit> orbits;
  GpsTime start;
  double rate_hz = 1.0;
  std::vector<Vec3<double>> antennas;                  ///< in the body [m]; the first is the master
  std::function<Vec3<double>(double)> place;           ///< of the body's origin, Earth-fixed [m]
  double code_sigma = 0.3, phase_sigma = 0.002;        ///< of one receiver at the zenith [m]
  double code_multipath = 0.0, phase_multipath = 0.0;  ///< 1 sigma [m]
  double multipath_time = 60.0;                        ///< s
  double clocks = 1e-3;                                ///< the receivers' are off by up to this, either way [s]
  double slips_per_hour = 0.0;                         ///< of each signal, by 1 to 100 cycles
  double half_slips_per_hour = 0.0;                    ///< by half a cycle, not flagged
  double mask = 10.0 * kRadPerDeg;
  std::vector<Outage> outages;
};

class GnssArray {
 public:
  /// @throws Error (input) for options that make no array
  GnssArray(GnssArrayOptions options, AttitudePath attitude);

  struct Epoch {
    double t = 0.0;                                   ///< s after the start, of the receivers' clocks
    std::vector<AntennaEpoch<kMostSignals>> antenna;  ///< an antenna that is out has none
    Quaternion<double> q_nb = Quaternion<double>::Identity();
  };
  /// The next epoch.
  const Epoch& next();
  /// Elements as a receiver would have them.
  [[nodiscard]] const std::vector<BroadcastOrbit>& orbits() const { return options_.orbits; }

 private:
  struct Signal {
    double cycles = 0.0;
    double code_multipath = 0.0, phase_multipath = 0.0;
    bool fresh = true;
  };
  [[nodiscard]] Vec3<double> antenna_at(std::size_t antenna, double t) const;
  [[nodiscard]] bool out(std::size_t antenna, int satellite, double t) const;

  GnssArrayOptions options_;
  AttitudePath attitude_;
  Gaussian noise_, multipath_, slips_;
  std::vector<double> clock_, drift_;
  std::vector<std::vector<Signal>> signal_;
  long epochs_ = 0;
  Epoch epoch_;
};

}  // namespace trunnion::simulation
