// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The unknowns of a calibration: their names, their places in the vector, and the limits beyond which one is refused.

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "trunnion/calibration/observability.hpp"
#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/positions/entry.hpp"

namespace trunnion::calibration {

/// Which terms beyond bias and matrix are estimated.
struct ModelTerms {
  bool cubic = true;  ///< of the gyros
  bool g_sensitivity = true;
  bool quadratic = false;    ///< of the accelerometers
  bool asymmetry = false;    ///< of all sensors
  bool size_effect = false;  ///< the accelerometers' places
  int temperature = 0;       ///< order of the polynomials of all biases and scales; 0: none
};

/// Of the data [degC]; NaN where there is none.
struct TemperatureRange {
  double lowest = std::numeric_limits<double>::quiet_NaN();
  double highest = std::numeric_limits<double>::quiet_NaN();

  /// Beyond the range by more than this a reading is the thermometer's mistake [K].
  static constexpr double kMargin = 0.5;

  [[nodiscard]] bool is_known() const { return lowest <= highest; }
  [[nodiscard]] bool holds(double celsius) const { return celsius >= lowest - kMargin && celsius <= highest + kMargin; }
  /// T_0: the middle, in whole degrees.
  [[nodiscard]] double reference() const { return std::round(0.5 * (lowest + highest)); }
  /// From T_0 to the farther end [K].
  [[nodiscard]] double reach() const { return std::max(highest - reference(), reference() - lowest); }
};

/// What is asked of the layout.
struct LayoutRequest {
  ModelTerms terms;
  EntryLimits refuse_above = default_refuse_above();
  double largest_rate = 1.0;  ///< rad/s, of the data
  TemperatureRange temperature;
  int recordings = 1;
  bool bias_per_recording = true;
  bool accel_upper_triangular = false;  ///< by hand: the accelerometers define the frame
  bool rig = true;
  std::vector<std::string> mounts;  ///< names; the first is the datum
  std::vector<bool> mount_used;     ///< a mount without a recording has no unknowns
  bool clock_offset = true;
};

/// Places in the parameter vector; -1: not estimated.
struct Layout {
  std::vector<Parameter> parameters;
  std::vector<int> gyro_bias;  ///< per recording, first of three
  std::vector<int> accel_bias;
  int gyro_matrix = -1;  ///< nine, by rows
  int gyro_cubic = -1;
  int g_sensitivity = -1;  ///< nine, by rows
  int accel_matrix[3][3];
  int accel_quadratic = -1;
  int gyro_asymmetry = -1;
  int accel_asymmetry = -1;
  int accel_place = -1;  ///< six: of y, of z
  int thermal = -1;      ///< for each order: biases of gyros and accelerometers, then their scales
  int thermal_order = 0;
  TemperatureRange temperature;  ///< of the windows that are used
  int tilt = -1;                 ///< two
  int heading = -1;
  int nonorthogonality = -1;
  int eccentricity = -1;         ///< four: azimuth c, s, pitch c, s
  std::vector<int> mount_error;  ///< per mount, first of three
  std::vector<int> lever_arm;
  int clock_offset = -1;
  int gravity = -1;

  explicit Layout(const LayoutRequest& request);

  [[nodiscard]] int size() const { return static_cast<int>(parameters.size()); }

  /// Values to vector and back. read() leaves what is not estimated as it was.
  void write(const CalibrationValues& values, Eigen::VectorXd& x) const;
  void read(const Eigen::VectorXd& x, CalibrationValues& values) const;
  /// Posterior sigmas in the shape of the values; zero where not estimated.
  [[nodiscard]] CalibrationValues sigmas(const Eigen::MatrixXd& covariance) const;

 private:
  EntryLimits refuse_above_;
  int add(const std::string& name, Entry kind);
  template <class Visit>
  void visit(CalibrationValues& values, Visit&& visit) const;
};

/// Whether limits hold for the entry: gravity has its prior, and a heading may be anything.
bool has_verdict(const Parameter& parameter);

/// The entries whose value no instrument and no rig has (EntryKind::largest), a line each; empty where there are none.
std::string implausible(const std::vector<Parameter>& parameters, const Eigen::VectorXd& x);

}  // namespace trunnion::calibration
