// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Calibration by hand, without a table: the norm of gravity at rest and the turns between rests in one problem.
///
///   rest k:   y_a = distort_a(C_bu g up),   y_g = distort_g(C_bu w_ie, C_bu g up)                         ... (1)
///   turn k:   C_ub(k+1) = C_ub(k) dC_k,  dC_k = product of Exp((w_ib_b - C_bu w_ie) dt), w_ib_b corrected  ... (2)
///
/// Unknowns: both triads, g-sensitivity with a prior, and the attitude of every rest. The accelerometers define the
/// frame (their matrix is upper triangular). The Earth's rate is modelled; north is found as far as the gyros can.
/// What white noise does not explain is estimated as a variance of the rests' force, the rests' rate and the turns each
/// (Helmert's variance components). Tedaldi et al., ICRA 2014; docs/theory/calibration.md, eq. 23-27.

#pragma once

#include <vector>

#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"

namespace trunnion::calibration {

struct HandSolveOptions {
  ModelTerms terms;
  EntryLimits refuse_above = default_refuse_above();
  bool bias_per_recording = true;
  bool has_noise = false;  ///< white noise from a sheet; else from the rests
  UnitNoise noise;
  double g_sensitivity_sigma = 1.75e-4;  ///< prior, (rad/s)/(m/s^2): 0.1 deg/s/g
  int hold_out = 0;                      ///< leave every n-th turn out of the fit; 0: none
};

struct HandSolution {
  Solution solution;
  int rests = 0;
  int turns = 0;
  double rest_scatter = 0.0;     ///< 1 sigma of a rest's force beyond white noise [m/s^2]
  double turn_scatter = 0.0;     ///< 1 sigma of a turn beyond white noise [rad]
  std::vector<double> held_out;  ///< error of the predicted direction of gravity after each turn left out [rad]
};

/// @throws Error (input) without a rest, (numerics) when the iteration does not converge
HandSolution solve_by_hand(const std::vector<HandRecording>& recordings, const Site& site,
                           const HandSolveOptions& options);

/// Angle [rad] between the direction of gravity that each turn predicts from the rest before and the one measured at
/// the rest after, for a unit taken as known. The Earth's rate is left out: its direction is not known here.
std::vector<double> turn_errors(const HandRecording& recording, const InertialUnit<double>& unit);

}  // namespace trunnion::calibration
