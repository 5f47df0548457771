// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a calibration will know, before anyone turns the table: the covariance of the batch solve from its motions
/// alone.
///
///   A = sum over recordings of J^T W J + priors,   sigma_i = sqrt((A^-1)_ii)                              ... (1)
///
/// J and W are those of the solve (twelve_position_solve.hpp, eq. 1-2) at a perfect unit on the rig as drawn: they hang
/// on the motion, on the encoders and on the noise, not on what is measured. A is a sum, so that a recording can be
/// exchanged without looking at the others. docs/theory/planning.md, eq. 1-4.

#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "trunnion/calibration/observability.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/positions/soak.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

/// Joint angles [rad], outer axis first, as functions of time [s].
struct PlannedMotion {
  std::function<std::array<double, 2>(double t)> angles;
  double duration = 0.0;  ///< s
  double begin = 0.0;     ///< s, of this motion in its recording: what a soak has reached then
};

struct PredictionOptions {
  TableSolveOptions solve;       ///< of the solve to come: model, noise, biases, clock
  double rate = 400.0;           ///< of the unit [Hz]
  double encoder_rate = 200.0;   ///< Hz
  double encoder_quantum = 0.0;  ///< rad; 0: exact
  double largest_rate = 1.0;     ///< rad/s, at which a nonlinearity is stated
  Soak soak;                     ///< of every recording, where the model has terms of temperature
};

/// Two entries that are hard to tell apart.
struct Entanglement {
  std::size_t entry = 0;
  std::size_t with = 0;
  double correlation = 0.0;
  double price = 1.0;  ///< sigma of the entry over what it would be were the other known
};

class Predictor {
 public:
  /// @param mounts index into Rig::mount of each recording. The rig must outlive it.
  /// @throws Error (input) for a model with terms of temperature where there is no soak
  Predictor(const Rig& rig, const Site& site, const std::vector<int>& mounts, const PredictionOptions& options);
  Predictor(const Predictor&) = delete;
  Predictor& operator=(const Predictor&) = delete;
  ~Predictor();

  /// J^T W J of recording @p r if it moves so, SI.
  [[nodiscard]] Eigen::MatrixXd information(std::size_t r, const PlannedMotion& motion) const;

  /// Eq. (1) of the sum of all recordings' information.
  [[nodiscard]] Observability conclude(const Eigen::MatrixXd& information) const;

  /// The covariance alone, without names: fast. Infinite where the information is singular.
  [[nodiscard]] Eigen::VectorXd sigmas(const Eigen::MatrixXd& information) const;

  [[nodiscard]] const std::vector<Parameter>& parameters() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The pair whose correlation costs an entry of the unit most. Among entries of @p covariance; gauge and rig count as
/// partners.
Entanglement worst_entanglement(const Eigen::MatrixXd& covariance, const std::vector<Parameter>& parameters);

}  // namespace trunnion::calibration
