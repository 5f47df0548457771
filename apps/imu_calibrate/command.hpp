// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The subcommands: each adds itself to the parser and sets the exit code when it runs.

#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "trunnion/core/error.hpp"

namespace trunnion::app {

void add_allan(CLI::App& app, ExitCode& exit_code);
void add_trials(CLI::App& app, ExitCode& exit_code);
void add_verify(CLI::App& app, ExitCode& exit_code);
void add_report(CLI::App& app, ExitCode& exit_code);
void add_plan(CLI::App& app, ExitCode& exit_code);
void add_simulate(CLI::App& app, ExitCode& exit_code);
void add_inspect(CLI::App& app, ExitCode& exit_code);
void add_convert(CLI::App& app, ExitCode& exit_code);
void add_solve(CLI::App& app, ExitCode& exit_code);
void add_apply(CLI::App& app, ExitCode& exit_code);
void add_export(CLI::App& app, ExitCode& exit_code);
void add_compare(CLI::App& app, ExitCode& exit_code);
void add_demo(CLI::App& app, ExitCode& exit_code);

/// One whole command line, as if typed: parses, runs, prints errors. What main() and demo call.
ExitCode run_command(std::vector<std::string> arguments);

}  // namespace trunnion::app
