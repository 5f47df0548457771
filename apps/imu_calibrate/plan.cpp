// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "bench.hpp"
#include "command.hpp"
#include "result.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"
#include "trunnion/planning/plan_search.hpp"

namespace trunnion::app {
namespace {

namespace fs = std::filesystem;

constexpr double kUsedRange = 0.9;      // of the gyros' range
constexpr double kMargin = 0.98;        // of a sigma wanted: a solve's own is within a hundredth of the predicted
constexpr double kLeastSoak = 10.0;     // K
constexpr double kLongestSoak = 86400;  // s
constexpr double kDwell = 40.0;         // s, of a position
constexpr double kSlowTurn = 10.0 * kRadPerDeg;

struct Options {
  std::string run;
  std::string output;
  std::string sheet = shared_file("3dm-cv7.yaml");
  std::string rig = shared_file("two_axis_table.urdf");
  std::vector<std::string> mounts;
  double latitude_deg = 43.88;
  double height_m = 220.0;
  double gravity_sigma = 3e-4;
  std::string preset;
  std::string as_good_as;
  std::vector<std::string> sigmas;
  double time = 0.0;
  double longest = 7200.0;
  double largest_rate_deg = 50.0;
  double acceleration_deg = 100.0;
  double encoder_rate = 200.0;
  int encoder_bits = 21;
  std::vector<double> temperatures = {-20.0, 60.0};  // degC
  double kelvin_per_minute = 1.0;
  int order = 3;
  std::string format = "text";
};

/// The bench as planning takes it, and what its run file is to say.
struct Setup {
  io::RunFile run;
  io::RigFile rig;
  std::vector<std::string> mounts;  // of the recordings
  planning::Bench bench;
};

std::unique_ptr<Setup> setup_of(const Options& o) {
  auto setup = std::make_unique<Setup>();
  Setup& s = *setup;
  std::vector<std::string> names;
  if (!o.run.empty()) {
    s.run = io::read_run_file(o.run);
    if (s.run.rig.empty()) throw Error(ExitCode::kInput, o.run + ": a plan needs a rig");
    names = mounts_of(s.run);
    s.rig = io::read_rig(s.run.rig, s.run.outer_axis, s.run.inner_axis, names);
    s.mounts = mounts_of_recordings(s.run);
  } else {
    s.run.rig = o.rig;
    s.run.sheet_path = o.sheet;
    s.run.sheet = io::read_sensor_sheet(o.sheet);
    s.run.site.latitude = o.latitude_deg * kRadPerDeg;
    s.run.site.gravity = normal_gravity(s.run.site.latitude, o.height_m);
    s.run.site.gravity_sigma = o.gravity_sigma;
    s.rig = io::read_rig(o.rig, s.run.outer_axis, s.run.inner_axis, o.mounts);
    names = s.mounts = s.rig.mounts;
  }
  if (o.preset == "soak") {
    s.run.soak = {o.temperatures[0], o.temperatures[1], o.kelvin_per_minute / 60.0};
    if (!(std::abs(s.run.soak.to - s.run.soak.from) >= kLeastSoak) || s.run.soak.duration() > kLongestSoak)
      throw Error(ExitCode::kUsage,
                  "--temperatures-deg-c, --k-per-min: a soak is of 10 K or more, and of a day or less");
    s.run.temperature = o.order;
  }
  if (!s.run.sheet.has_noise)
    throw Error(ExitCode::kInput, (s.run.sheet_path.empty() ? o.run : s.run.sheet_path) +
                                      ": a plan needs a sheet that states the noise: nothing is measured yet");
  s.bench = bench_of(s.run, s.rig, names, s.mounts);
  planning::Bench& b = s.bench;
  for (AxisLimits& axis : b.limits) {
    axis.acceleration = o.acceleration_deg * kRadPerDeg;
    axis.rate = std::min(axis.rate, std::max(o.largest_rate_deg, 1.0) * kRadPerDeg);
  }
  b.largest_rate = o.largest_rate_deg * kRadPerDeg;
  if (s.run.sheet.gyro_range > 0.0) b.largest_rate = std::min(b.largest_rate, kUsedRange * s.run.sheet.gyro_range);
  b.prediction.encoder_rate = o.encoder_rate;
  b.prediction.encoder_quantum = o.encoder_bits > 0 ? 2.0 * kPi / std::ldexp(1.0, o.encoder_bits) : 0.0;
  return setup;
}

/// A sequence that is known by name, in every mount.
std::vector<simulation::TableSequence> preset(const Setup& s, const std::string& name, const TableLimits& limits) {
  const AxisLimits& pitch = s.rig.limits[kPitch];
  std::vector<simulation::TableSequence> all;
  for (std::size_t r = 0; r < s.mounts.size(); ++r) {
    if (name == "experiment") {
      if (pitch.endless())
        throw Error(ExitCode::kInput, "the experiment swings within the limits of joint '" + s.run.inner_axis +
                                          "', which has none: take design_run or whole_turns");
      all.push_back(simulation::experiment(pitch.lowest, pitch.highest, static_cast<int>(r)));
    } else if (name == "design_run") {
      all.push_back(simulation::design_run(pitch));
    } else if (name == "soak") {
      all.push_back(simulation::soak(pitch, s.run.soak.duration(), static_cast<int>(r)));
    } else if (name == "sixteen_positions") {
      all.push_back(simulation::sixteen_positions(kDwell, kSlowTurn));
    } else if (name == "nineteen_positions") {
      all.push_back(simulation::nineteen_positions(kDwell, kSlowTurn));
    } else {
      all.push_back(simulation::whole_turns(kDwell, kSlowTurn));
    }
    simulation::check_limits(all.back(), limits, name + " in " + s.mounts[r]);
  }
  return all;
}

/// "gyro_cross_coupling_deg=0.0005"
void want(const std::string& text, planning::WantedSigmas& wanted) {
  const std::size_t equals = text.find('=');
  const std::string key = text.substr(0, equals);
  for (std::size_t i = 0; i < kEntryKinds.size(); ++i) {
    if (key != kEntryKinds[i].key || equals == std::string::npos) continue;
    char* end = nullptr;
    const double value = std::strtod(text.c_str() + equals + 1, &end);
    if (*end != '\0' || !(value > 0.0) || !std::isfinite(value))
      throw Error(ExitCode::kUsage, "--sigma " + text + ": the sigma should be a positive number");
    wanted[i] = value;
    return;
  }
  std::string known;
  for (const EntryKind& kind : kEntryKinds) known += std::string(known.empty() ? "" : ", ") + kind.key;
  throw Error(ExitCode::kUsage, "--sigma " + text + ": should be KIND=SIGMA, with one of " + known);
}

planning::WantedSigmas wanted_of(const Options& o, const Setup& s) {
  planning::WantedSigmas wanted = planning::nothing_wanted();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (s.run.limits[i].sigma > 0.0) wanted[i] = s.run.limits[i].sigma;
  }
  if (!o.as_good_as.empty()) {
    const planning::WantedSigmas theirs =
        planning::sigmas_of(planning::predict(s.bench, preset(s, o.as_good_as, s.rig.limits)));
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto kind = static_cast<Entry>(i);
      // a turn-on bias is another one at the next turn-on, and how well a mean over minutes knows it is the wander's
      // affair
      if (is_of_unit(kind) && kind != Entry::kGyroBias && kind != Entry::kAccelBias) wanted[i] = theirs[i];
    }
  }
  for (const std::string& one : o.sigmas) want(one, wanted);
  return wanted;
}

bool any(const planning::WantedSigmas& wanted) {
  return std::any_of(wanted.begin(), wanted.end(), [](double sigma) { return std::isfinite(sigma); });
}

/// As a run file says it.
std::string model_of(const io::RunFile& run) {
  std::string terms;
  for (const auto& [name, chosen] : {std::pair{"cubic", run.cubic}, std::pair{"g_sensitivity", run.g_sensitivity},
                                     std::pair{"quadratic", run.quadratic}, std::pair{"asymmetry", run.asymmetry},
                                     std::pair{"size_effect", run.size_effect}}) {
    if (chosen) terms += std::string(terms.empty() ? "" : ", ") + name;
  }
  if (run.temperature > 0)
    terms += std::string(terms.empty() ? "" : ", ") + "temperature: " + std::to_string(run.temperature);
  return "model: [" + terms + "]\n";
}

/// What imu_live is to see of each mount.
std::string live_plan(const planning::Plan& plan) {
  double rest = 0.0;
  std::vector<double> rates;
  for (const TableMove& move : plan.recordings.front()) {
    if (move.is_rest()) rest += std::max(0.0, move.duration - move.transition);
    const double rate = std::round(std::abs(move.axis[kAzimuth].rate) / kRadPerDeg * 10.0) / 10.0;
    if (rate >= 0.5 && std::find(rates.begin(), rates.end(), rate) == rates.end() &&
        rates.size() < static_cast<std::size_t>(PlanRequest::kMostRates))
      rates.push_back(rate);
  }
  std::sort(rates.begin(), rates.end());
  std::string text =
      "plan: {rests: {zones: 2, seconds: " + figure(std::clamp(std::floor(0.2 * rest), 1.0, 3600.0), 4) + "}";
  if (!rates.empty()) {
    text += ", turns: {rates_deg_per_s: [";
    for (std::size_t i = 0; i < rates.size(); ++i) text += (i == 0 ? "" : ", ") + figure(rates[i], 4);
    text += "], seconds: 5}";
  }
  return text + "}\n";
}

void write_plan(const Options& o, const Setup& s, const planning::Plan& plan, const planning::WantedSigmas& wanted) {
  std::error_code error;
  fs::create_directories(o.output, error);
  if (error) throw Error(ExitCode::kInput, o.output + ": cannot make the folder: " + error.message());
  const fs::path folder(o.output);
  std::error_code same;
  if (!o.run.empty() && fs::equivalent(o.run, folder / "run.yaml", same))
    throw Error(ExitCode::kUsage, o.output + ": holds the run file that is planned for: choose another folder");
  std::string run = "format: trunnion-run/1\nsite: {latitude_deg: " + figure(s.run.site.latitude / kRadPerDeg, 12) +
                    ", gravity_m_s2: " + figure(s.run.site.gravity, 12) +
                    ", gravity_sigma_m_s2: " + figure(s.run.site.gravity_sigma, 6) + "}\nrig: rig.urdf\n";
  if (s.run.outer_axis != "azimuth" || s.run.inner_axis != "pitch")
    run += "axes: [" + s.run.outer_axis + ", " + s.run.inner_axis + "]\n";
  run += "sheet: sheet.yaml\nmoves: moves.csv\n" + model_of(s.run) + live_plan(plan);
  if (!s.run.serial.empty()) run += "serial: " + nlohmann::json(s.run.serial).dump() + "\n";
  if (!s.run.bias_per_recording) run += "bias: shared\n";
  if (!s.run.estimate_clock_offset) run += "clock: {imu_to_encoder_offset: " + figure(s.run.clock_offset, 12) + "}\n";
  if (s.run.soak.is_known())
    run += "soak: {from_deg_c: " + figure(s.run.soak.from, 6) + ", to_deg_c: " + figure(s.run.soak.to, 6) +
           ", k_per_min: " + figure(60.0 * s.run.soak.rate, 6) + "}\n";
  if (s.run.channels.imu.map || s.run.channels.encoder.map || !s.run.columns.empty())
    std::fprintf(stderr,
                 "%s: its channels, lcm_types and columns are not taken over: add them to the plan's run file\n",
                 o.run.c_str());
  std::string limits;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double value = s.run.limits[i].value;
    if (!std::isfinite(wanted[i]) && !(value >= 0.0)) continue;
    limits += std::string(limits.empty() ? "" : ", ") + kEntryKinds[i].key + ": {";
    if (value >= 0.0) limits += "value: " + figure(value, 12) + (std::isfinite(wanted[i]) ? ", " : "");
    if (std::isfinite(wanted[i])) limits += "sigma: " + figure(wanted[i], 6);
    limits += "}";
  }
  if (!limits.empty()) run += "limits: {" + limits + "}\n";
  run += "recordings:\n";
  for (std::size_t r = 0; r < s.mounts.size(); ++r)
    run += "  - {mount: " + s.mounts[r] + ", log: position_" + std::to_string(r + 1) + ".lcm}\n";
  io::write_whole((folder / "moves.csv").string(), io::to_csv(plan.recordings));
  io::write_whole((folder / "rig.urdf").string(), io::read_whole(s.run.rig));
  io::write_whole((folder / "sheet.yaml").string(), io::read_whole(s.run.sheet_path));
  io::write_whole((folder / "run.yaml").string(), run);
}

nlohmann::ordered_json tree_of(const Setup& s, const planning::Plan& plan, const planning::WantedSigmas& wanted,
                               const planning::Addition& addition) {
  nlohmann::ordered_json tree;
  tree["format"] = "trunnion-plan/1";
  tree["duration_s"] = plan.duration();
  for (std::size_t r = 0; r < plan.recordings.size(); ++r)
    tree["recordings"].push_back({{"mount", s.mounts[r]},
                                  {"duration_s", simulation::duration_of(plan.recordings[r])},
                                  {"moves", plan.recordings[r].size() - 1}});
  for (std::size_t i = 0; i < plan.parameters.size(); ++i) {
    const calibration::Parameter& p = plan.parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    nlohmann::ordered_json entry = {
        {"entry", p.name}, {"sigma", std::sqrt(plan.predicted.covariance(at, at)) * p.in_unit}, {"unit", p.unit}};
    const double asked = wanted[static_cast<std::size_t>(p.kind)];
    if (calibration::has_verdict(p) && std::isfinite(asked)) entry["wanted"] = asked;
    tree["predicted"].push_back(entry);
  }
  tree["unobservable"] = plan.predicted.refused;
  for (const calibration::LostDirection& direction : plan.predicted.lost)
    tree["lost_directions"].push_back(direction.entries);
  const calibration::Entanglement worst = calibration::worst_entanglement(plan.predicted.covariance, plan.parameters);
  tree["worst_correlation"] = {{"entry", plan.parameters[worst.entry].name},
                               {"with", plan.parameters[worst.with].name},
                               {"correlation", worst.correlation},
                               {"sigma_times", worst.price}};
  if (!addition.what.empty())
    tree["cheapest_addition"] = {{"what", addition.what},
                                 {"recording", addition.recording + 1},
                                 {"mount", s.mounts[addition.recording]},
                                 {"seconds", addition.seconds},
                                 {"sigmas_times", addition.cost_after / addition.cost_before}};
  if (any(wanted)) tree["worst_over_wanted"] = plan.worst(wanted);
  return tree;
}

void print_plan(const nlohmann::ordered_json& tree) {
  for (const auto& recording : tree["recordings"])
    std::printf("%s: %d moves, %.1f s\n", recording["mount"].get<std::string>().c_str(), recording["moves"].get<int>(),
                recording["duration_s"].get<double>());
  std::printf("in all %.1f s\n\n%-44s %12s  %-22s %s\n", tree["duration_s"].get<double>(), "entry", "1 sigma", "unit",
              tree.contains("worst_over_wanted") ? "wanted" : "");
  for (const auto& entry : tree["predicted"]) {
    std::printf("%-44s %12s  %-22s", entry["entry"].get<std::string>().c_str(),
                figure(entry["sigma"].get<double>(), 3).c_str(), entry["unit"].get<std::string>().c_str());
    if (entry.contains("wanted")) {
      const bool reached = entry["sigma"].get<double>() <= entry["wanted"].get<double>() * (1.0 + 1e-9);
      std::printf(" %s%s", figure(entry["wanted"].get<double>(), 3).c_str(), reached ? "" : "  not reached");
    }
    std::printf("\n");
  }
  const auto& worst = tree["worst_correlation"];
  std::printf("\nhardest to tell apart: %s and %s, correlation %.3f: the sigma is %.2f times what it would be\n",
              worst["entry"].get<std::string>().c_str(), worst["with"].get<std::string>().c_str(),
              worst["correlation"].get<double>(), worst["sigma_times"].get<double>());
  if (tree.contains("cheapest_addition")) {
    const auto& more = tree["cheapest_addition"];
    std::printf("cheapest addition: in %s, %.0f s of %s: sigmas %s %% smaller\n",
                more["mount"].get<std::string>().c_str(), more["seconds"].get<double>(),
                more["what"].get<std::string>().c_str(),
                figure(100.0 * (1.0 - more["sigmas_times"].get<double>()), 2).c_str());
  }
}

/// Refuses (input) a plan in which the sensors would be at their range.
void hold_against_ranges(const Setup& s, const planning::Plan& plan) {
  const io::SensorSheet& sheet = s.run.sheet;
  const double rate = planning::largest_rate_of(plan);
  char text[160];
  if (sheet.gyro_range > 0.0 && rate >= sheet.gyro_range) {
    std::snprintf(text, sizeof text, ": the plan turns at %.4g deg/s, and the gyros' range is %.4g", rate / kRadPerDeg,
                  sheet.gyro_range / kRadPerDeg);
    throw Error(ExitCode::kInput, s.run.sheet_path + text);
  }
  if (sheet.accel_range > 0.0 && s.run.site.gravity >= sheet.accel_range) {
    std::snprintf(text, sizeof text, ": the accelerometers' range of %.4g g does not hold gravity",
                  sheet.accel_range / kStandardGravity);
    throw Error(ExitCode::kInput, s.run.sheet_path + text);
  }
}

ExitCode plan(const Options& o) {
  const std::unique_ptr<Setup> setup = setup_of(o);
  const planning::WantedSigmas wanted = wanted_of(o, *setup);
  planning::Plan plan;
  if (!o.preset.empty()) {
    plan = planning::predict(setup->bench, preset(*setup, o.preset, setup->bench.limits));
  } else if (!setup->run.moves.empty() && o.time == 0.0 && o.as_good_as.empty() && o.sigmas.empty()) {
    const io::TableMoves moves = io::read_table_moves(setup->run.moves, setup->mounts.size());
    for (std::size_t r = 0; r < moves.size(); ++r)
      simulation::check_limits(moves[r], setup->bench.limits,
                               setup->run.moves + ": recording " + std::to_string(r + 1));
    plan = planning::predict(setup->bench, moves);
  } else {
    if (!any(wanted))
      throw Error(ExitCode::kUsage,
                  "what for? state an accuracy (--sigma KIND=SIGMA, --as-good-as PRESET, limits of a run file), with "
                  "--time-s or without; or take a --preset");
    ProgressLine progress;
    planning::WantedSigmas aimed_at = wanted;
    for (double& sigma : aimed_at) sigma *= kMargin;
    plan = planning::search(setup->bench, aimed_at, o.time, o.longest, [&](double time, double worst) {
      progress.show("plan of " + figure(time, 4) + " s: worst sigma " + figure(worst, 3) + " times the wanted");
    });
    for (std::size_t r = 0; r < plan.recordings.size(); ++r)
      simulation::check_limits(plan.recordings[r], setup->bench.limits, "plan of " + setup->mounts[r]);
  }
  const nlohmann::ordered_json tree =
      tree_of(*setup, plan, wanted, planning::cheapest_addition(setup->bench, plan, wanted));
  hold_against_ranges(*setup, plan);
  if (!o.output.empty() && plan.predicted.refused.empty()) write_plan(o, *setup, plan, wanted);
  if (o.format == "json")
    std::printf("%s", json_text(tree).c_str());
  else
    print_plan(tree);
  if (!plan.predicted.refused.empty()) {
    std::fputs(calibration::describe(plan.predicted).c_str(), stderr);
    return ExitCode::kNumerics;
  }
  const double worst = plan.worst(wanted);
  if (!any(wanted) || worst <= 1.0 + 1e-9) return ExitCode::kDone;
  const bool capped = o.preset.empty() && o.time == 0.0;
  std::fprintf(stderr, "the worst sigma is %s times the wanted: %s\n", figure(worst, 3).c_str(),
               capped ? ("no plan was found within " + figure(o.longest, 6) + " s (--longest-s)").c_str()
                      : ("as sigmas go with the root of time, about " + figure(plan.duration() * worst * worst, 2) +
                         " s of such moves would do")
                            .c_str());
  return ExitCode::kOutOfLimits;
}

}  // namespace

void add_plan(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("plan", "Design the turns and predict every sigma, before anyone turns the table");
  auto o = std::make_shared<Options>();
  CLI::Option* run =
      command->add_option("run", o->run, "Run file: its rig, sheet, mounts, limits, and its moves if it has any");
  command->add_option("-o,--output", o->output, "Folder to write: run.yaml, moves.csv, rig.urdf, sheet.yaml");
  const std::vector<std::string> presets = {"experiment", "design_run", "sixteen_positions", "nineteen_positions",
                                            "whole_turns"};
  std::vector<std::string> sequences = presets;
  sequences.emplace_back("soak");
  CLI::Option* fixed = command->add_option("--preset", o->preset, "A known sequence instead of a designed one")
                           ->check(CLI::IsMember(sequences));
  command->add_option("--as-good-as", o->as_good_as, "Want the sigmas of this preset, of all but the turn-on biases")
      ->check(CLI::IsMember(presets));
  command->add_option("--sigma", o->sigmas,
                      "Want this: KIND=SIGMA, as gyro_cross_coupling_deg=0.0005; may be repeated");
  command->add_option("--time-s", o->time, "Design the best plan of this time, all mounts together")
      ->check(CLI::PositiveNumber)
      ->excludes(fixed);
  command->add_option("--longest-s", o->longest, "Where no time is given: no plan longer than this")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--sheet", o->sheet, "Sensor sheet of the unit")->excludes(run);
  command
      ->add_option("--rig", o->rig,
                   "URDF of the table: its limits and mounts; apps/share/level_gimbal.urdf has joints without end")
      ->excludes(run);
  command->add_option("--mounts", o->mounts, "Of the rig; all of them otherwise")->excludes(run);
  command->add_option("--latitude-deg", o->latitude_deg, "Of the bench")
      ->capture_default_str()
      ->check(CLI::Range(-90.0, 90.0))
      ->excludes(run);
  command->add_option("--height-m", o->height_m, "Of the bench")
      ->capture_default_str()
      ->check(CLI::Range(-500.0, 10000.0))
      ->excludes(run);
  command->add_option("--gravity-sigma-m-s2", o->gravity_sigma, "How well gravity is known there")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->excludes(run);
  command->add_option("--largest-rate-deg-per-s", o->largest_rate_deg, "Of the table, if its URDF states no less")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 5000.0));
  command->add_option("--acceleration-deg-per-s2", o->acceleration_deg, "Of the table's axes")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 50000.0));
  command->add_option("--encoder-rate-hz", o->encoder_rate, "Readings a second")
      ->capture_default_str()
      ->check(CLI::Range(10.0, 10000.0));
  command->add_option("--encoder-bits", o->encoder_bits, "Of a turn; 0: exact")
      ->capture_default_str()
      ->check(CLI::Range(0, 32));
  command->add_option("--temperatures-deg-c", o->temperatures, "Of a soak: from, to")
      ->capture_default_str()
      ->expected(2)
      ->check(CLI::Range(-100.0, 300.0))
      ->needs(fixed);
  command->add_option("--k-per-min", o->kelvin_per_minute, "Of a soak")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 100.0))
      ->needs(fixed);
  command->add_option("--order", o->order, "Of a soak: of the polynomials in temperature to be solved for")
      ->capture_default_str()
      ->check(CLI::Range(1, ThermalErrors<double>::kMostOrder))
      ->needs(fixed);
  command->add_option("--format", o->format, "Of the result on standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->footer(
      "Example:\n  imu_calibrate plan --as-good-as experiment --time-s 1050 -o plan && imu_calibrate simulate "
      "plan/run.yaml -o sim\nAccelerations do not stand in a URDF: state them.");
  command->callback([o, &exit_code] { exit_code = plan(*o); });
}

}  // namespace trunnion::app
