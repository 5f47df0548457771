// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pictures by gnuplot, as SVG.

#pragma once

#include <string>
#include <vector>

#include "trunnion/report/document.hpp"

namespace trunnion::report {

/// Runs gnuplot on @p script, which has $blocks of data and plots; terminal and fonts are set before it. Without
/// gnuplot, or where it fails, the picture says so.
Picture gnuplot(const std::string& title, const std::string& script, int width = 760, int height = 420);

/// "$name << EOD ... EOD": rows of a data block. What is not finite becomes "NaN", which gnuplot passes over.
std::string data_block(const std::string& name, const std::vector<std::vector<double>>& rows);

/// In double quotes as gnuplot reads it.
std::string quoted(const std::string& text);

}  // namespace trunnion::report
