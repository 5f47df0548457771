// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The running estimate of a calibration that is being recorded: the problem of the batch solve, in information form.
///
///   N_k = N_k-1 + sum of the new windows' J^T J,   b_k likewise with r
///   x_k = x_0 - (N_k + P)^-1 (b_k + P (x_0 - m))                                                          ... (1)
///
/// Residuals and Jacobians are taken at x_0, so that a window is looked at once. When x_k has left x_0 by half a sigma,
/// the last windows do not fit, or the data have grown by a third, all windows are linearised anew from the estimate.
/// P and m are priors as wide as an instrument can be wrong: what the data do not tell yet has a sigma as wide as that.
/// The estimate leads the operator; the calibration itself is solve_table() of the same windows.
/// Bierman, Factorization Methods for Discrete Sequential Estimation, ch. II; docs/theory/calibration.md, eq. 33.

#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "trunnion/calibration/twelve_position_solve.hpp"

namespace trunnion::calibration {

struct RunningEstimate {
  std::vector<Parameter> parameters;
  Eigen::VectorXd x;      ///< SI
  Eigen::VectorXd sigma;  ///< SI; of what the data do not tell yet that of its wide prior
  CalibrationValues values;
  std::size_t recordings = 0;  ///< that are in it
  double chi_square = 0.0;     ///< reduced, of the last windows at the last linearisation, which knows them; 0: too few
  int linearisations = 0;      ///< since the beginning
};

class SequentialSolve {
 public:
  /// The references must outlive it.
  SequentialSolve(const Rig& rig, const Site& site, TableSolveOptions options);
  SequentialSolve(const SequentialSolve&) = delete;
  SequentialSolve& operator=(const SequentialSolve&) = delete;
  ~SequentialSolve();

  /// A recording begins, with the unit in @p mount.
  void begin(int mount);

  /// The recording that was begun last is no good: as if it had never been.
  void abandon();

  /// Windows that the last begun recording has got since the last call, and its course so far
  /// (Compressor::so_far()). @return the estimate; without parameters as long as there are too few data
  /// @throws Error (input) for units or nominal scales that cannot be right, and where no sheet states the noise and
  /// there are not ten seconds at rest yet
  const RunningEstimate& update(CompressedRecording part);

  [[nodiscard]] const RunningEstimate& estimate() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trunnion::calibration
