// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>
#include <filesystem>
#include <memory>

#include "command.hpp"

namespace trunnion::app {
namespace {

ExitCode demo(const std::string& folder, const std::string& seed) {
  const std::filesystem::path f(folder);
  const auto file = [&](const char* name) { return (f / name).string(); };
  const std::vector<std::vector<std::string>> steps = {
      {"simulate", "--seed", seed, "-o", folder},
      {"inspect", file("run.yaml")},
      {"solve", file("run.yaml"), "-o", file("calibration.yaml")},
      {"compare", file("calibration.yaml"), file("truth.yaml")},
      {"apply", file("calibration.yaml"), file("position_1.lcm"), "--recording", "1", "-o", file("corrected_1.lcm")},
  };
  for (const std::vector<std::string>& step : steps) {
    std::printf("\n$ imu_calibrate");
    for (const std::string& word : step) std::printf(" %s", word.c_str());
    std::printf("\n");
    std::fflush(stdout);
    const ExitCode code = run_command(step);
    if (code != ExitCode::kDone) return code;
  }
  return ExitCode::kDone;
}

}  // namespace

void add_demo(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand(
      "demo", "The main job from end to end on a simulated table: simulate, inspect, solve, compare, apply");
  auto folder = std::make_shared<std::string>("trunnion-demo");
  auto seed = std::make_shared<std::string>("1");
  command->add_option("-o,--output", *folder, "Folder to write")->capture_default_str();
  command->add_option("--seed", *seed, "Of the simulation")->capture_default_str()->check(CLI::Range(0, 2147483647));
  command->footer("Example:\n  imu_calibrate demo -o trunnion-demo");
  command->callback([folder, seed, &exit_code] { exit_code = demo(*folder, *seed); });
}

}  // namespace trunnion::app
