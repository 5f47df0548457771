// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a run file to what planning takes.

#pragma once

#include <string>
#include <vector>

#include "trunnion/io/run_file.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/planning/plan_search.hpp"

namespace trunnion::app {

/// Mounts of the recordings, one each.
std::vector<std::string> mounts_of_recordings(const io::RunFile& run);

/// @param names mounts of the rig, in its order; @param mounts of the recordings. Rates and accelerations are those of
/// the rig alone. The rig must outlive it.
planning::Bench bench_of(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& names,
                         const std::vector<std::string>& mounts);

}  // namespace trunnion::app
