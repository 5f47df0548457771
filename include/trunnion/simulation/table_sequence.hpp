// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sequences of moves, and the motion of the two axes that they make.
///
/// Between two angles an axis moves as axis_motion.hpp says, so that a step d within a transition T asks for
///
///   rate (15/8) |d| / T,   acceleration (10/sqrt 3) |d| / T^2;   a change of rate r: (15/8) |r| / T        ... (1)

#pragma once

#include <string>
#include <vector>

#include "trunnion/positions/table_move.hpp"
#include "trunnion/simulation/axis_motion.hpp"

namespace trunnion::simulation {

using TableSequence = std::vector<TableMove>;

struct TableMotion {
  AxisCourse azimuth;
  AxisCourse pitch;
  double duration = 0.0;  ///< s
};

/// An axis without end goes the short way round. The first move may be of duration zero: where the table stands.
TableMotion motion_of(const TableSequence& sequence, const TableLimits& limits = {});

/// @throws Error (input) naming the first move, the axis and the limit that it breaks: angle, rate, acceleration, or a
/// transition that its duration has no room for. @param name of the sequence, for the message
void check_limits(const TableSequence& sequence, const TableLimits& limits, const std::string& name);

/// What one axis reaches during a move that begins at @p t [s].
struct AxisPeaks {
  double lowest = 0.0;  ///< rad
  double highest = 0.0;
  double rate = 0.0;  ///< rad/s
  double acceleration = 0.0;
};
AxisPeaks peaks_of(const AxisCourse& course, double t, const TableMove& move);

/// The shortest transition [s] in which an axis takes a step and a change of rate, eq. (1).
double transition_for(double step, double rate, const AxisLimits& limits);

[[nodiscard]] double duration_of(const TableSequence& sequence);

/// The experiment of the paper, in one mount: rests at pitch angles over the whole range, then for each of five rates
/// rest, forward, rest, backward, 30 s each, while the pitch swings about its middle. 705 s.
/// @param lowest, highest limits of the pitch joint [rad]; @param variant changes the order of the swings
TableSequence experiment(double lowest, double highest, int variant);

/// The design run of the paper, in one mount: 30 s at rest, azimuth at 5 to 25 deg/s both ways, 30 s each, the same of
/// the pitch as swings of those peak rates where its joint has limits, 30 s at rest.
TableSequence design_run(const AxisLimits& pitch);

/// For a unit whose temperature is driven through its range: rests over the pitch range and turns at 20 and 40 deg/s
/// while the pitch swings, repeated until @p duration [s] is over, so that every temperature sees all of them.
/// @param variant changes the order of the swings
TableSequence soak(const AxisLimits& pitch, double duration, int variant);

/// Rests only, at the middle of the pitch range: a run with too few turns.
TableSequence rest_only(double lowest, double highest);

/// Rests of @p dwell [s] between right-angled turns, as system-level calibration takes them: sixteen or
/// nineteen positions. They need joints without end, and an outer axis that is level.
TableSequence sixteen_positions(double dwell, double rate);
TableSequence nineteen_positions(double dwell, double rate);

/// Twelve right-angled positions, each with a whole turn of one axis, both ways in turn. For joints without end.
TableSequence whole_turns(double dwell, double rate);

}  // namespace trunnion::simulation
