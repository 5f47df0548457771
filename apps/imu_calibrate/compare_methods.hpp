// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One run, calibrated by several methods.

#pragma once

#include <string>
#include <vector>

#include "trunnion/core/error.hpp"

namespace trunnion::app {

/// traditional, rate_test, kalman_36, by_hand, twelve_position
const std::vector<std::string>& methods_of_a_run();

/// @param methods "all", or some of them with commas between; what one lacks is said in its place, and is an error
/// (input) where it was asked for by name
ExitCode compare_methods(const std::string& run, const std::string& methods, bool json);

}  // namespace trunnion::app
