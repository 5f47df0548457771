// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What every command does around its work: parse, run, turn what is thrown into words and an exit code.

#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "trunnion/core/error.hpp"

namespace trunnion::app {

/// Parses @p arguments, without the program's name, then calls @p run. Exit codes as docs/reference/exit-codes.md says;
/// a result that standard output did not take is an error, too.
ExitCode run_program(CLI::App& app, std::vector<std::string> arguments, const std::function<ExitCode()>& run);

/// The body of main(): nothing leaves it.
int main_of(int argc, char** argv, const std::function<ExitCode(std::vector<std::string>)>& program);

/// From now on SIGINT and SIGTERM end no program but set interrupted().
void catch_interrupts();
/// ... and end it again, after what is not whole was removed. run_program() begins so.
void end_on_signals();
bool interrupted();

}  // namespace trunnion::app
