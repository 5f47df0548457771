// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which terms of the error model the data pay for.
///
///   take the term with the largest   (chi^2 - chi^2_with) / (k ln n),   while it is above one            ... (1)
///
/// k: its parameters, n: residuals; (1) is the Bayesian information criterion. A term must also lower the chi-square of
/// windows that were left out of both fits, blocks of five seconds, every fifth: what fits noise does not. Schwarz,
/// Ann. Stat. 6 (1978), 461; docs/theory/calibration.md, eq. 34.

#pragma once

#include <string>
#include <vector>

#include "trunnion/calibration/twelve_position_solve.hpp"

namespace trunnion::calibration {

/// What was found of one term.
struct TermVerdict {
  std::string term;  ///< as a run file names it
  bool taken = false;
  int parameters = 0;
  double gain = 0.0;           ///< chi-square less with it; infinite where there is no fit without it
  double asked = 0.0;          ///< k ln n
  double held_out_gain = 0.0;  ///< chi-square less in the windows left out; zero where (1) had refused the term
  std::string why;             ///< where it could not be tried
};

struct ModelChoice {
  ModelTerms terms;
  Solution solution;  ///< with these terms
  std::vector<TermVerdict> verdicts;
};

/// Begins with bias and matrix alone. @throws as solve_table()
ModelChoice choose_model(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
                         TableSolveOptions options);

}  // namespace trunnion::calibration
