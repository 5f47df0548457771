// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>
#include <utility>

#include "../program.hpp"
#include "../terminal.hpp"
#include "command.hpp"

namespace trunnion::app {

ExitCode run_command(std::vector<std::string> arguments) {
  CLI::App app("Finds out what an inertial unit does wrong by turning it on a two-axis table, or by hand.",
               "imu_calibrate");
  app.set_version_flag("--version", tool_name());
  app.set_help_all_flag("--help-all", "Help of every subcommand");
  app.require_subcommand(1);
  app.footer(
      "Example:\n  imu_calibrate demo -o trunnion-demo\n\nExit codes: 0 done, within limits; 1 done, out of limits; 2 "
      "usage; 3 input; 4 numerics; 70 defect.");
  ExitCode exit_code = ExitCode::kDone;
  add_plan(app, exit_code);
  add_simulate(app, exit_code);
  add_inspect(app, exit_code);
  add_solve(app, exit_code);
  add_apply(app, exit_code);
  add_convert(app, exit_code);
  add_export(app, exit_code);
  add_compare(app, exit_code);
  add_verify(app, exit_code);
  add_report(app, exit_code);
  add_allan(app, exit_code);
  add_trials(app, exit_code);
  add_demo(app, exit_code);
  const std::string command = arguments.empty() || arguments.front().rfind('-', 0) == 0 ? "" : arguments.front();
  const auto is_it = [&](const CLI::App* one) { return one->check_name(command); };
  if (!command.empty() && app.get_subcommands(is_it).empty()) {
    std::fprintf(stderr, "imu_calibrate: no command '%s'; --help lists them\n", command.c_str());
    return ExitCode::kUsage;
  }
  return run_program(app, std::move(arguments), [&] { return exit_code; });
}

}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_command); }
