// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Headers of other people's tables: which names, in which units, and what tells them apart.

#pragma once

#include <array>
#include <string>
#include <vector>

namespace trunnion::io {

struct HeaderSet {
  const char* title;
  const char* mark;  ///< that the lines above the data hold, or null: the names tell enough
  const char* time;
  const char* time_unit;
  const char* week;  ///< column of weeks that the time is of, or null
  double wraps_at;   ///< of the time's own numbers; zero: never
  std::array<const char*, 6> sensors;
  const char* rate_unit;
  const char* force_unit;
};

/// In the order in which they are tried.
const std::vector<HeaderSet>& header_sets();

}  // namespace trunnion::io
