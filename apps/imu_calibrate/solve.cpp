// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "result.hpp"
#include "trunnion/calibration/model_choice.hpp"
#include "trunnion/calibration/multi_position_solve.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string run;
  std::string output;
  std::string format = "text";
  std::string model;
  int hold_out = 0;
};

/// What was tried, and what came of it, in words.
void say(const calibration::ModelChoice& choice) {
  for (const calibration::TermVerdict& v : choice.verdicts) {
    if (!v.why.empty()) {
      std::fprintf(stderr, "model: %s left out: %s\n", v.term.c_str(), v.why.substr(0, v.why.find('\n')).c_str());
      continue;
    }
    if (!std::isfinite(v.gain)) {
      std::fprintf(stderr, "model: %s %s: without it nothing fits\n", v.term.c_str(), v.taken ? "taken" : "left out");
      continue;
    }
    std::fprintf(stderr, "model: %s %s: chi-square %s less for %d entries, asked %s", v.term.c_str(),
                 v.taken ? "taken" : "left out", figure(v.gain, 4).c_str(), v.parameters, figure(v.asked, 3).c_str());
    std::fprintf(stderr, v.held_out_gain != 0.0 ? "; in windows held out %s less\n" : "\n",
                 figure(v.held_out_gain, 4).c_str());
  }
}

/// A polynomial of too low an order may hide in the chi-square of a million residuals: says so where the highest order
/// explains more of it than chance would (theory, eq. 34).
void look_for_higher_orders(const std::vector<calibration::TableRecording>& recordings, const Rig& rig,
                            const io::RunFile& run, calibration::TableSolveOptions options,
                            const calibration::Solution& solution) {
  constexpr int kMost = ThermalErrors<double>::kMostOrder;
  if (run.temperature == kMost) return;
  options.terms.temperature = kMost;
  const calibration::Solution higher = calibration::solve_table(recordings, rig, run.site, options);
  const auto chi_square = [](const calibration::Solution& s) {
    return s.record.fit.reduced_chi_square *
           (6.0 * static_cast<double>(s.record.fit.windows) - static_cast<double>(s.x.size()));
  };
  const double gain = chi_square(solution) - chi_square(higher);
  const double asked =
      12.0 * (kMost - run.temperature) * std::log(6.0 * static_cast<double>(solution.record.fit.windows));
  if (gain > asked)
    std::fprintf(
        stderr,
        "temperature: %d is too low an order: the %dth lowers chi-square by %s, asked %s (--model auto finds the "
        "order)\n",
        run.temperature, kMost, figure(gain, 4).c_str(), figure(asked, 3).c_str());
}

/// The Earth's rate about gravity, taken with the wrong sign of the latitude, is off by 2 W sin(latitude): to the gyros
/// a g-sensitivity that is alike on all axes.
void look_for_other_hemisphere(const io::RunFile& run, const CalibrationRecord& record) {
  const Vec3<double> found = record.value.unit.g_sensitivity.diagonal();
  const double sigma = record.sigma.unit.g_sensitivity.diagonal().maxCoeff();
  const double sought = -2.0 * kEarthRate * std::sin(run.site.latitude) / record.value.gravity;
  if (!(sigma > 0.0) || std::abs(sought) < 10.0 * sigma) return;
  if ((found.array() - sought).abs().maxCoeff() > 0.5 * std::abs(sought)) return;  // nearer to it than to none
  std::fprintf(stderr,
               "%s: site.latitude_deg: the gyros' g-sensitivity is alike on all axes, as the other sign of the "
               "latitude makes it: is it %s?\n",
               run.path.c_str(), figure(-run.site.latitude / kRadPerDeg, 6).c_str());
}

calibration::Solution solve_on_table(const io::RunFile& run, RunInputs& inputs, std::vector<std::string>& mounts,
                                     bool choose) {
  mounts = mounts_of(run);
  const io::RigFile rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, mounts);
  std::vector<calibration::TableRecording> recordings = read_table_recordings(run, mounts, inputs);
  calibration::TableSolveOptions options = table_options(run, mounts);
  ProgressLine progress;
  options.progress = [&](const std::string& stage) { progress.show(stage); };
  if (!choose) {
    calibration::Solution solution = calibration::solve_table(recordings, rig.rig, run.site, options);
    if (run.temperature > 0 && solution.observability.refused.empty())
      look_for_higher_orders(recordings, rig.rig, run, options, solution);
    return solution;
  }
  calibration::ModelChoice choice = calibration::choose_model(recordings, rig.rig, run.site, options);
  say(choice);
  return std::move(choice.solution);
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
  if (!o.model.empty() && run.rig.empty())
    throw Error(ExitCode::kUsage, "--model auto is for runs on a table: this run has no rig");
  check_outputs({o.output}, files_of(run));
  RunInputs inputs;
  io::CalibrationFile file;
  std::vector<double> held_out;
  calibration::Solution solution = run.rig.empty() ? solve_hand(run, inputs, o.hold_out, held_out)
                                                   : solve_on_table(run, inputs, file.mounts, o.model == "auto");
  say_losses(inputs.losses);
  look_for_other_hemisphere(run, solution.record);
  file = calibration_of(run, solution, inputs, file.mounts);
  if (!o.output.empty()) io::write_whole(o.output, io::to_yaml(file));
  if (o.format == "json") {
    std::fputs(io::to_json(file).c_str(), stdout);
  } else {
    print_calibration(solution, file, run.sheet.has_noise);
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
  command
      ->add_option("--model", o->model,
                   "auto: begin with bias and matrix, and add cubic, g_sensitivity, quadratic, asymmetry, size_effect "
                   "and orders of "
                   "temperature only where the data pay for them")
      ->check(CLI::IsMember({"auto"}));
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
