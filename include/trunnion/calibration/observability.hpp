// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The gate: what the data cannot decide is refused by name.
///
/// It judges the joint posterior, not a rank. With the information matrix A in units of the limits u_i,
///
///   A = D J^T J D,  D = diag(u),   A = V diag(lambda) V^T,   sigma_i / u_i = sqrt(sum_j V_ij^2 / lambda_j)   ... (1)
///
/// an entry whose sigma passes its limit is refused, and the eigenvectors that carry its variance are named. An exact
/// loss of rank is lambda_j below 1e-15 of the largest: its entries pass every limit. docs/theory/calibration.md,
/// eq. 22.

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "trunnion/positions/entry.hpp"

namespace trunnion::calibration {

/// One unknown of a solve.
struct Parameter {
  std::string name;  ///< in the user's words: "gyro y cross-coupling into z"
  Entry kind = Entry::kGyroBias;
  double refuse_above = 1.0;  ///< 1 sigma beyond which the entry is not worth printing, SI
  std::string unit;           ///< in which a person reads it
  double in_unit = 1.0;       ///< SI value times this is the value in that unit
  double scale = 1.0;         ///< in the solver, SI: whatever the limits of a run, the numerics are the same
};

/// A direction in parameter space that the data do not fix.
struct LostDirection {
  std::vector<std::string> entries;  ///< the parameters that make it up, largest share first
  double sigma = 0.0;                ///< along it, in units of the limits; infinite where the rank is lost
};

struct Observability {
  Eigen::MatrixXd covariance;        ///< of the parameters, SI
  std::vector<std::string> refused;  ///< entries beyond their limit, with sigma and limit
  std::vector<LostDirection> lost;   ///< the directions to blame
};

/// @param information J^T J of the whitened residuals and priors, SI, n x n
/// @param parameters n of them
Observability judge(const Eigen::MatrixXd& information, const std::vector<Parameter>& parameters);

/// The refusal in words, one line an entry and one a direction; empty when nothing is refused.
std::string describe(const Observability& observability);

}  // namespace trunnion::calibration
