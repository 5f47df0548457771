// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a run file to the solver's options, and from its solution to a calibration file: the same for a batch and live.

#pragma once

#include <string>
#include <vector>

#include "recordings.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {

/// Mounts in the order of the run file; the first is the datum.
std::vector<std::string> mounts_of(const io::RunFile& run);

calibration::ModelTerms terms_of(const io::RunFile& run);
calibration::TableSolveOptions table_options(const io::RunFile& run, const std::vector<std::string>& mounts);

/// The calibration with its provenance, held against the limits of the run.
/// @throws Error (numerics) for a solution that has refused entries
io::CalibrationFile calibration_of(const io::RunFile& run, const calibration::Solution& solution,
                                   const RunInputs& inputs, const std::vector<std::string>& mounts);

/// To standard output. @param sheet_noise whether the noise is the sheet's
void print_calibration(const calibration::Solution& solution, const io::CalibrationFile& file, bool sheet_noise);

}  // namespace trunnion::app
