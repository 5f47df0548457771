// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The rate test of the textbooks, as it is done on a two-axis table whose drawing is believed.
///
///   F_j = mean output at rate j - (output at rest before + after) / 2                                     ... (1)
///   F_ij = K_i w_ij + F_i0 + v_ij          over the runs whose rate lies along sensor i                   ... (2)
///   Y_i = F_i - K_i w_i = A_i e_i          the cross-talk against the other input rates, all runs         ... (3)
///   nonlinearity max |v_ij| / max |F_ij|,  asymmetry |K+ - K-| / mean
///
/// The input rate comes sample by sample from both encoders through the mount of the drawing, and is then averaged:
/// with the pitch swinging by A about the level the azimuth's rate along the vertical case axis is on average W J_0(A).
/// Rests taken off, the bias goes, and forward and backward over one arc the Earth's rate. What a method of this kind
/// does not know, the errors of fixture, axes and encoders, it takes for the unit's. GJB 2426A; IEEE Std 1431-2004,
/// sec. 12; docs/theory/comparison.md, eq. 1-3.

#pragma once

#include <array>
#include <string>
#include <vector>

#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/error_model/triad.hpp"

namespace trunnion::calibration {

struct RateTestAxis {
  bool excited = false;       ///< some run's rate lies along it
  double scale_error = 0.0;   ///< K - 1
  double zero = 0.0;          ///< F_0 [rad/s]
  double nonlinearity = 0.0;  ///< of the largest output
  double asymmetry = 0.0;
};

struct RateTestResult {
  Triad<double> gyro;  ///< matrix, and the bias at rest with the Earth's rate taken off
  std::array<RateTestAxis, 3> axis;
  /// Entries of the matrix that the runs tell; the others are left as in a perfect unit.
  Eigen::Matrix<bool, 3, 3> determined = Eigen::Matrix<bool, 3, 3>::Constant(false);
  int runs = 0;
};

/// @param recordings one mount (the traditional test) or several. @throws Error (input) without runs, or without a rest
/// before and after one
RateTestResult rate_test(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site);

}  // namespace trunnion::calibration
