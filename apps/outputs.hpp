// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where results go: files that are none of the inputs, and a summary for people.

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace trunnion::app {

/// Empty names are passed over. @throws Error (usage) for an output that is an input, or two that are one; (input) for
/// a folder that cannot be written
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// A record of figures as lines of name and value on standard output.
void print_summary(const nlohmann::ordered_json& tree);

/// As JSON text; what is no UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& tree);

}  // namespace trunnion::app
