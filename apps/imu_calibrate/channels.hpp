// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Every channel of a log at a glance: type, rate, jitter, bandwidth, and what is missing.

#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "trunnion/io/lcm_type.hpp"

namespace trunnion::app {

/// Adds "channels", an object for each, and "lost" of the file.
void look_at_channels(const std::string& path, const io::LcmTypes& types, nlohmann::ordered_json& json);

/// As a table to standard output.
void print_channels(const nlohmann::ordered_json& json);

}  // namespace trunnion::app
