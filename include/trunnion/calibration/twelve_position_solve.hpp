// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The batch solve: one least-squares problem for every deterministic error of the unit and of the table.
///
///   r_k = y_k - mean over window k of distort(unit, C_bp input(rig, encoders(t - offset)))              ... (1)
///   min_x  sum_axes (r^T W r)(x) + priors,   W^-1 = white noise + Gauss-Markov bias wander              ... (2)
///
/// W whitens exactly: a scalar Kalman filter for each sensor carries the wander, and its innovations are the residuals.
/// The bias of a recording is the constant about which the bias wanders. Windows whose innovation passes four sigmas
/// lose weight (Huber), in rounds. Covariance and gate come from the same Jacobian. docs/theory/calibration.md, eq.
/// 13-22.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "trunnion/calibration/compress.hpp"
#include "trunnion/calibration/observability.hpp"
#include "trunnion/calibration/parameters.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

struct TableSolveOptions {
  ModelTerms terms;
  EntryLimits refuse_above = default_refuse_above();
  bool even_temperatures = true;  ///< with terms of temperature: every part of its range has the same weight
  bool bias_per_recording = true;
  bool estimate_clock_offset = true;
  double clock_offset = 0.0;             ///< s, where it is not estimated
  bool noise_from_data = false;          ///< white noise from the rests, wander by restricted maximum likelihood
  UnitNoise noise;                       ///< where it is not from the data
  std::vector<std::string> mount_names;  ///< one a mount of the rig, for messages
  int threads = 0;                       ///< 0: as many as the machine has
  std::function<void(const std::string&)> progress;  ///< told once a stage; may be empty
};

struct TableRecording {
  CompressedRecording data;
  int mount = 0;  ///< index into Rig::mount
};

struct Solution {
  CalibrationRecord record;
  Eigen::VectorXd x;  ///< the unknowns, SI
  std::vector<Parameter> parameters;
  Observability
      observability;  ///< its covariance belongs to x; the record holds only what is observable when refused is empty
  UnitNoise noise;    ///< used
  std::vector<std::string> gauge;  ///< directions fixed by definition
};

/// Solves eq. (2).
/// @throws Error (input) for an empty problem or a recording that shares no time with its encoders,
///         Error (numerics) when the iteration does not converge
Solution solve_table(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
                     const TableSolveOptions& options);

}  // namespace trunnion::calibration
