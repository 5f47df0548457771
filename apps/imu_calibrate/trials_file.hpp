// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The result file of a campaign: read once, wherever it is used.

#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace trunnion::app {

inline constexpr const char* kTrialsFormat = "trunnion-trials/1";

/// Whole: every trial with its seed, every method's figures numbers, every navigation with its three arms.
/// @throws Error (input) naming the file and the trial
nlohmann::ordered_json read_trials(const std::string& path);

}  // namespace trunnion::app
