// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The array of the paper's examples: a master and slaves at (1, 0, 0) and (0, 1, 0) m under eight satellites of a real
/// sky, whole cycles known, white noise of the undifferenced phases.

#pragma once

#include <array>
#include <cmath>

#include "trunnion/core/units.hpp"
#include "trunnion/interferometer/attitude_from_baselines.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {

class ThreeAntennas {
 public:
  static constexpr int kSatellites = 8;

  explicit ThreeAntennas(double sigma) : sigma_(sigma), figure_(slaves()) {
    static constexpr std::array<std::array<double, 2>, kSatellites> kSky = {{{52.8, 67.4},
                                                                             {158.8, 23.0},
                                                                             {9.9, 71.1},
                                                                             {284.2, 57.1},
                                                                             {314.5, 29.5},
                                                                             {100.2, 49.5},
                                                                             {198.7, 22.0},
                                                                             {49.0, 26.4}}};
    for (int i = 0; i < kSatellites; ++i) {
      const double azimuth = kSky[static_cast<std::size_t>(i)][0] * kRadPerDeg;
      const double elevation = kSky[static_cast<std::size_t>(i)][1] * kRadPerDeg;
      SingleDifference<double> s;
      s.e << std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), -std::sin(elevation);
      s.wavelength = 0.1902936727983649;
      s.code_sigma = 0.3;
      s.phase_sigma = sigma;
      s.satellite = i;
      sky_[sky_.count++] = s;
    }
  }

  /// One epoch of both baselines.
  [[nodiscard]] VectorObservation<double, 2> observe(const Quaternion<double>& q_nb, simulation::Gaussian& noise) {
    std::array<SingleDifferences<double, kSatellites>, 2> sets = {sky_, sky_};
    for (int i = 0; i < kSatellites; ++i) {
      const double master = sigma_ * noise();
      for (int k = 0; k < 2; ++k) {
        const double range = -sky_[i].e.dot(q_nb * Vec3<double>(figure_.b().col(k)));
        sets[static_cast<std::size_t>(k)][i].phase = (range + sigma_ * noise() - master) / sky_[i].wavelength;
      }
    }
    VectorObservation<double, 2> seen = with_common_master(baseline(sets[0]), baseline(sets[1]));
    for (std::size_t k = 0; k < 2; ++k) plain_.col(static_cast<int>(k)) = plain_baseline(sets[k]);
    return seen;
  }

  /// The same epoch's baselines as the paper computes them: its equation (5) with a weight matrix of ones, as if double
  /// differences that share a satellite had independent errors.
  [[nodiscard]] const Eigen::Matrix<double, 3, 2>& plain() const { return plain_; }

  [[nodiscard]] const RigidVectors<double, 2>& figure() const { return figure_; }
  [[nodiscard]] const SingleDifferences<double, kSatellites>& sky() const { return sky_; }

  static Eigen::Matrix<double, 3, 2> slaves() {
    Eigen::Matrix<double, 3, 2> b;
    b << 1, 0, 0, 1, 0, 0;
    return b;
  }

 private:
  static VectorObservation<double, 1> baseline(const SingleDifferences<double, kSatellites>& set) {
    const BaselineSum<double> sum = fixed_sum(set, std::array<double, kSatellites>{}, BaselineSum<double>());
    VectorObservation<double, 1> seen;
    seen.information = sum.information;
    seen.value = sum.information.ldlt().solve(sum.moment);
    return seen;
  }

  static Vec3<double> plain_baseline(const SingleDifferences<double, kSatellites>& set) {
    Eigen::Matrix<double, kSatellites - 1, 3> G;
    Eigen::Matrix<double, kSatellites - 1, 1> y;
    for (int i = 1; i < kSatellites; ++i) {
      G.row(i - 1) = -(set[i].e - set[0].e).transpose();
      y(i - 1) = set[i].wavelength * (set[i].phase - set[0].phase);
    }
    return (G.transpose() * G).ldlt().solve(G.transpose() * y);
  }

  double sigma_;
  Eigen::Matrix<double, 3, 2> plain_;
  RigidVectors<double, 2> figure_;
  SingleDifferences<double, kSatellites> sky_;
};

/// Rotation vector from an estimate to the truth, in the body [rad].
inline Vec3<double> rotation_error(const Quaternion<double>& estimate, const Quaternion<double>& truth) {
  return quaternion_log<double>(estimate.conjugate() * truth);
}

}  // namespace trunnion
