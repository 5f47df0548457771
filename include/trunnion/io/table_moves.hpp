// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The moves of a run as CSV: what a motion controller is told, and what a simulation turns by.
///
/// One row a move, recordings in the order of the run file, from 1: recording, duration_s, transition_s, and of each
/// axis (azimuth, pitch) _deg, _rate_deg_s, _swing_deg, _frequency_hz, as TableMove has them (_rad, ... are read too).

#pragma once

#include <string>
#include <vector>

#include "trunnion/positions/table_move.hpp"

namespace trunnion::io {

/// The moves of each recording.
using TableMoves = std::vector<std::vector<TableMove>>;

/// @throws Error (input) naming file, line and column; for recordings that are not numbered 1 to @p recordings in order
TableMoves read_table_moves(const std::string& path, std::size_t recordings);

std::string to_csv(const TableMoves& moves);

}  // namespace trunnion::io
