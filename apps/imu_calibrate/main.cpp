// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>
#include <exception>

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
  add_simulate(app, exit_code);
  add_inspect(app, exit_code);
  add_solve(app, exit_code);
  add_apply(app, exit_code);
  add_export(app, exit_code);
  add_compare(app, exit_code);
  add_demo(app, exit_code);
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // as CLI11 wants it
    app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? ExitCode::kDone : ExitCode::kUsage;
  } catch (const Error& e) {
    std::fprintf(stderr, "imu_calibrate: %s\n", e.what());
    return e.code();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "imu_calibrate: a defect of ours, please report it: %s\n", e.what());
    return ExitCode::kDefect;
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::fprintf(stderr, "imu_calibrate: cannot write the result to standard output\n");
    return ExitCode::kInput;
  }
  return exit_code;
}

}  // namespace trunnion::app

int main(int argc, char** argv) {
  try {
    return static_cast<int>(trunnion::app::run_command({argv + 1, argv + argc}));
  } catch (...) {
    return static_cast<int>(trunnion::ExitCode::kDefect);
  }
}
