// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A two-axis table run, from truth as functions of time to what the unit and the encoders publish.
///
/// Nothing here shares a formula with the estimator: angular rate comes from differences of attitude, specific force
/// from second differences of position in inertial space. So an error in either shows in the tests of the solve.
///
///   w = (1/P) sum_j Log(C_ip(t_j)^T C_ip(t_j+1)),  f = mean of C_ip^T (d^2 r_i / dt^2 + g up_i)            ... (1)
///
/// with four steps a sample; the coning left in a step is (h^2 / 12) |w x dw/dt|, below 3e-8 rad/s at 50 deg/s.

#pragma once

#include <cstdint>
#include <functional>

#include "trunnion/error_model/noise.hpp"
#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/positions/soak.hpp"
#include "trunnion/simulation/table_sequence.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::simulation {

/// Declared corruption: what the sheet of the unit and of the table would say. 1 sigma unless it says otherwise.
struct TableRunSettings {
  std::uint64_t seed = 1;
  double rate = 400.0;          ///< of the unit [Hz]
  double encoder_rate = 200.0;  ///< Hz
  int encoder_bits = 21;        ///< 0: exact
  UnitNoise noise;              ///< white noise and bias wander
  double gyro_quantum = 0.0;    ///< rad/s a count; 0: not quantised
  double accel_quantum = 0.0;   ///< m/s^2 a count

  double gyro_bias, gyro_turn_on_bias;     ///< rad/s
  double gyro_scale, gyro_cross_coupling;  ///< -, rad
  double gyro_cubic;                       ///< s^2/rad^2
  double gyro_g_sensitivity;               ///< (rad/s)/(m/s^2)
  double accel_bias, accel_turn_on_bias;   ///< m/s^2
  double accel_scale, accel_cross_coupling;
  double accel_quadratic = 0.0;                        ///< s^2/m
  double gyro_asymmetry = 0.0, accel_asymmetry = 0.0;  ///< -
  double accel_place = 0.0;                            ///< m, a component

  double tilt, nonorthogonality, mount_error, eccentricity;  ///< rad
  double lever_arm;                                          ///< m, length; direction at random in each mount
  double largest_clock_offset;                               ///< s, uniform on both sides

  /// Of the temperature, in each recording; where it is known, every bias and scale is a polynomial of the order below
  /// about its middle, whose every term has these sizes at the range's ends.
  Soak soak;
  int thermal_order = 3;
  double gyro_thermal_bias, gyro_thermal_scale;    ///< rad/s, -
  double accel_thermal_bias, accel_thermal_scale;  ///< m/s^2, -

  bool exact_gravity = false;     ///< gravity is what the site says, else drawn about it
  double outlier_fraction = 0.0;  ///< of the samples
  double gyro_outlier = 1.0;      ///< rad/s
  double accel_outlier = 5.0;     ///< m/s^2
  double dropped_fraction = 0.0;

  /// A MEMS unit of the grade of the 3DM-CV7 on a good table.
  TableRunSettings();

  /// The same run without any random error: exact encoders, no noise, no wander.
  [[nodiscard]] TableRunSettings noise_free() const;
};

/// Draws a unit, a table and a site's gravity. The first mount is the datum: its error is zero by definition.
CalibrationValues draw_truth(const TableRunSettings& settings, const Rig& rig, const Site& site, int recordings);

struct TableSinks {
  std::function<void(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample)> imu;
  std::function<void(std::int64_t utime, std::int64_t sequence, double azimuth, double pitch)> encoder;
  std::function<void(double celsius)> temperature = {};  ///< before each sample of a soak; may be empty
};

/// Runs recording @p index with the unit in @p mount and feeds the sinks in order of time.
void run_table(const TableRunSettings& settings, const CalibrationValues& truth, const Rig& rig, const Site& site,
               const TableMotion& motion, int mount, int index, const TableSinks& sinks);

}  // namespace trunnion::simulation
