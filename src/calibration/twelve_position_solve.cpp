// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/twelve_position_solve.hpp"

#include "table_problem.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::calibration {

Solution solve_table(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
                     const TableSolveOptions& options) {
  if (recordings.empty()) throw Error(ExitCode::kInput, "no recordings to solve");
  TableProblem problem(recordings, rig, site, options);
  return problem.solve();
}

}  // namespace trunnion::calibration
