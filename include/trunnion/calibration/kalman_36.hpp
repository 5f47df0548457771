// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// System-level calibration: a unit that is turned between rests navigates, and its velocity at the rests, which should
/// be zero, tells its errors. No encoder, no table but one that stops.
///
///   x = (phi, dv, b_g, b_a, dM_g, dM_a, q_a, r_y, r_z)   3 + 3 + 3 + 3 + 9 + 6 + 3 + 3 + 3 = 36            ... (1)
///   phi' = -w_in x phi - C_nb dw,   dv' = f_n x phi + C_nb df - 2 w_ie x dv                               ... (2)
///   dw = b_g + dM_g w,   df = b_a + dM_a f + q_a f^o2 + size effect,   z = v at rest                       ... (3)
///
/// The accelerometers define the frame: dM_a is upper triangular, and r_y, r_z are the places of the y and z
/// accelerometers against x. Biases walk as the sheet's wander does. After a pass the unit's model takes what was found
/// and the pass is run again, until nothing is: constants need no smoother, the last estimate is the smoothed one. The
/// error model has neither g-sensitivity nor a cubic. Cai et al., Sensors 16 (2016), 940, for the kind; states rebuilt;
/// docs/theory/comparison.md, eq. 4-6.

#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/positions/sample_sink.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

struct Kalman36Options {
  UnitNoise noise;
  int most_rounds = 12;
  double converged = 1e-3;  ///< of a sigma: the largest change of a round
};

struct Kalman36Result {
  InertialUnit<double> unit;  ///< in the frame of the accelerometers
  std::array<Vec3<double>, 2> lever = {Vec3<double>::Zero(),
                                       Vec3<double>::Zero()};  ///< of the y and z accelerometers against x [m]
  Eigen::MatrixXd covariance;                                  ///< of the 30 parameters in the order of eq. (1), SI
  int rounds = 0;
  int rests = 0;
};

class Kalman36 final : public SampleSink {
 public:
  explicit Kalman36(std::string name) : name_(std::move(name)) {}

  /// Feeds one sample.
  void imu(std::int64_t utime, const InertialSample<double>& sample) override;
  /// Not looked at.
  void encoder(std::int64_t, double, double) override {}

  /// @throws Error (input) without ten seconds at rest first, or with fewer than six rests; (numerics) when the rounds
  /// do not converge
  [[nodiscard]] Kalman36Result finish(const Site& site, const Kalman36Options& options) const;

 private:
  std::string name_;
  std::vector<std::int64_t> utime_;
  std::vector<InertialSample<double>> samples_;
};

/// The unit in the frame in which its accelerometers' matrix is upper triangular with a positive diagonal: what two
/// calibrations without a common frame can be compared in.
InertialUnit<double> in_accelerometer_frame(const InertialUnit<double>& unit);

}  // namespace trunnion::calibration
