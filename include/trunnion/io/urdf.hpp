// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The rig from a URDF: root link, joint azimuth, joint pitch, fixed joints to the mounts (docs/reference/files.md).

#pragma once

#include <string>
#include <vector>

#include "trunnion/positions/table_move.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::io {

struct RigFile {
  Rig rig;                          ///< its mounts in the order of their names
  std::vector<std::string> mounts;  ///< names of the fixed joints that end in the unit's case
  TableLimits limits;               ///< of the two joints; a URDF states no acceleration
};

/// Reads a rig. Only the mounts in @p wanted are kept, in that order; empty: all of them.
/// @throws Error (input) for what urdfdom refuses and for what it lets through: limits upside down, a zero axis, a link
///         with two parents, a second robot, axes that are parallel, a mount that is not there or not fixed to the
///         pitch stage
RigFile read_rig(const std::string& path, const std::string& outer_axis, const std::string& inner_axis,
                 const std::vector<std::string>& wanted = {});

}  // namespace trunnion::io
