// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "trunnion/calibration/multi_position_solve.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr double kQuiet = 0.5;  // reduced chi-square

struct Options {
  std::string run;
  std::string output;
  std::string format = "text";
  int hold_out = 0;
};

/// Holds every entry against the limits of the run file.
void judge_limits(const io::RunFile& run, const calibration::Solution& solution, io::CalibrationFile& file) {
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const calibration::Parameter& p = solution.parameters[i];
    const io::EntryVerdict& limit = run.limits[static_cast<std::size_t>(p.kind)];
    if (p.unit != kind_of(p.kind).unit || p.name == "heading")
      continue;  // gravity and heading are no entries of a verdict
    const auto at = static_cast<Eigen::Index>(i);
    const double value = solution.x(at) * p.in_unit;
    const double sigma = std::sqrt(solution.observability.covariance(at, at)) * p.in_unit;
    if (limit.value >= 0.0 && std::abs(value) > limit.value) {
      file.out_of_limits.push_back(p.name + ": " + figure(value, 4) + " " + p.unit + ", limit " +
                                   figure(limit.value, 4));
    }
    if (limit.sigma >= 0.0 && sigma > limit.sigma) {
      file.out_of_limits.push_back(p.name + ": sigma " + figure(sigma, 3) + " " + p.unit + ", limit " +
                                   figure(limit.sigma, 4));
    }
  }
  file.within_limits = file.out_of_limits.empty();
}

void print_text(const calibration::Solution& solution, const io::CalibrationFile& file, bool sheet_noise) {
  std::printf("%-44s %14s %12s  %s\n", "entry", "value", "1 sigma", "unit");
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const calibration::Parameter& p = solution.parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(solution.observability.covariance(at, at)) * p.in_unit;
    const double value = solution.x(at) * p.in_unit;
    // as many digits as the sigma has to say
    const int decimals =
        sigma > 0.0 && std::isfinite(sigma) ? std::clamp(2 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9) : 3;
    std::printf("%-44s %14.*f %12.*f  %s\n", p.name.c_str(), decimals, value, decimals, sigma, p.unit.c_str());
  }
  std::printf("gauge:");
  for (const std::string& g : file.gauge) std::printf(" %s", g.c_str());
  const FitFigures& fit = file.record.fit;
  std::printf(
      "\nfit: %lld samples, %lld windows, %lld outliers, %lld records and %lld bytes lost, reduced chi-square %.4f, %d "
      "iterations\n",
      fit.samples, fit.windows, fit.outliers, fit.lost_records, fit.lost_bytes, fit.reduced_chi_square, fit.iterations);
  if (sheet_noise && fit.reduced_chi_square < kQuiet) {
    std::printf("the data are quieter than the sheet says: every sigma is too large by some %s; leave its noise out\n",
                figure(1.0 / std::sqrt(fit.reduced_chi_square), 2).c_str());
  }
  std::printf("verdict: %s\n", file.within_limits ? "within limits" : "out of limits");
  for (const std::string& entry : file.out_of_limits) std::printf("  %s\n", entry.c_str());
}

calibration::ModelTerms terms_of(const io::RunFile& run) { return {run.cubic, run.g_sensitivity, run.quadratic}; }

calibration::Solution solve_on_table(const io::RunFile& run, RunInputs& inputs, std::vector<std::string>& mounts) {
  for (const io::RecordingFiles& files : run.recordings) {
    if (std::find(mounts.begin(), mounts.end(), files.mount) == mounts.end()) mounts.push_back(files.mount);
  }
  const io::RigFile rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, mounts);
  std::vector<calibration::TableRecording> recordings = read_table_recordings(run, mounts, inputs);
  calibration::TableSolveOptions options;
  options.terms = terms_of(run);
  options.refuse_above = run.refuse_above;
  options.bias_per_recording = run.bias_per_recording;
  options.estimate_clock_offset = run.estimate_clock_offset;
  options.clock_offset = run.clock_offset;
  options.noise_from_data = !run.sheet.has_noise;
  options.noise = run.sheet.noise;
  options.mount_names = mounts;
  ProgressLine progress;
  options.progress = [&](const std::string& stage) { progress.show(stage); };
  return calibration::solve_table(recordings, rig.rig, run.site, options);
}

calibration::Solution solve_hand(const io::RunFile& run, RunInputs& inputs, int hold_out,
                                 std::vector<double>& held_out) {
  const std::vector<calibration::HandRecording> recordings = read_hand_recordings(run, inputs);
  calibration::HandSolveOptions options;
  options.terms = terms_of(run);
  options.refuse_above = run.refuse_above;
  options.bias_per_recording = run.bias_per_recording;
  options.has_noise = run.sheet.has_noise;
  options.noise = run.sheet.noise;
  options.hold_out = hold_out;
  calibration::HandSolution hand = calibration::solve_by_hand(recordings, run.site, options);
  std::fprintf(stderr, "%d rests, %d turns; beyond white noise a rest scatters by %s m/s^2, a turn by %s deg\n",
               hand.rests, hand.turns, figure(hand.rest_scatter, 3).c_str(),
               figure(hand.turn_scatter / kRadPerDeg, 3).c_str());
  held_out = hand.held_out;
  if (hold_out > 0 && held_out.empty())
    throw Error(ExitCode::kUsage, "--hold-out " + std::to_string(hold_out) + " leaves no turn out: there are " +
                                      std::to_string(hand.turns));
  return std::move(hand.solution);
}

ExitCode solve(const Options& o) {
  const io::RunFile run = io::read_run_file(o.run);
  if (o.hold_out != 0 && !run.rig.empty())
    throw Error(ExitCode::kUsage, "--hold-out is for runs by hand: this run has a rig");
  keep_inputs(o.output, files_of(run));
  RunInputs inputs;
  io::CalibrationFile file;
  std::vector<double> held_out;
  calibration::Solution solution =
      run.rig.empty() ? solve_hand(run, inputs, o.hold_out, held_out) : solve_on_table(run, inputs, file.mounts);
  if (inputs.losses.bytes > 0) {
    std::fprintf(stderr, "%lld damaged records, %lld bytes passed over\n", inputs.losses.records, inputs.losses.bytes);
  }
  if (!solution.observability.refused.empty()) {
    const std::string beyond = calibration::implausible(solution.parameters, solution.x);
    throw Error(ExitCode::kNumerics,
                calibration::describe(solution.observability) +
                    (beyond.empty() ? "" : "and no unit has these: look at units, signs, mounts first\n" + beyond));
  }

  file.model = run.sheet.model;
  file.serial = run.serial;
  file.record = solution.record;
  file.record.fit.lost_records = inputs.losses.records;
  file.record.fit.lost_bytes = inputs.losses.bytes;
  file.gauge = solution.gauge;
  file.tool = tool_name();
  file.run = std::filesystem::path(o.run).filename().string();
  const std::filesystem::path folder = std::filesystem::path(o.run).parent_path();
  const auto near = [&](const std::string& path) {
    return std::filesystem::path(path).lexically_proximate(folder.empty() ? "." : folder).string();
  };
  for (const auto& [path, digest] : inputs.digests) file.inputs.emplace_back(near(path), digest);
  for (const std::string& path : {o.run, run.rig, run.sheet_path}) {
    if (!path.empty()) file.inputs.emplace_back(near(path), io::sha256(io::read_whole(path)));
  }
  judge_limits(run, solution, file);

  if (!o.output.empty()) io::write_whole(o.output, io::to_yaml(file));
  if (o.format == "json") {
    std::fputs(io::to_json(file).c_str(), stdout);
  } else {
    print_text(solution, file, run.sheet.has_noise);
    if (!held_out.empty()) {
      double squares = 0.0;
      for (const double error : held_out) squares += error * error;
      std::printf("held-out turns: %zu, gravity predicted to %.4f deg rms\n", held_out.size(),
                  std::sqrt(squares / static_cast<double>(held_out.size())) / kRadPerDeg);
    }
  }
  return file.within_limits ? ExitCode::kDone : ExitCode::kOutOfLimits;
}

}  // namespace

void add_solve(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("solve", "Calibrate: every error of the unit and of the table, a sigma beside each");
  auto o = std::make_shared<Options>();
  command->add_option("run", o->run, "Run file")->required();
  command->add_option("-o,--output", o->output, "Calibration file to write");
  command->add_option("--format", o->format, "Of the result on standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command
      ->add_option("--hold-out", o->hold_out,
                   "By hand: leave every n-th turn out of the fit and say how well it is predicted")
      ->check(CLI::Range(2, 1000));
  command->footer("Example:\n  imu_calibrate solve run.yaml -o calibration.yaml");
  command->callback([o, &exit_code] { exit_code = solve(*o); });
}

}  // namespace trunnion::app
