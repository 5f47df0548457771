// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "../outputs.hpp"
#include "../program.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "result.hpp"
#include "trials_file.hpp"
#include "trunnion/calibration/share_out.hpp"
#include "trunnion/comparison/statistics.hpp"
#include "trunnion/comparison/trial.hpp"
#include "trunnion/core/chi_square.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using comparison::Method;

constexpr unsigned long long kMostSeeds = 999999;
constexpr int kGroups = 5;  // of the test of homogeneity

struct Options {
  std::vector<std::string> inputs;
  std::string seeds = "1-10";
  std::string methods = "all";
  std::string output;
  std::string csv;
  double mount_error_deg = 0.05;
  int navigations = 0;
  int jobs = 0;
  bool merge = false;
  std::string format = "text";
};

/// "7", "1-50"
std::pair<std::uint64_t, std::uint64_t> seeds_of(const std::string& text) {
  unsigned long long from = 0;
  unsigned long long to = 0;
  int used = 0;
  const int found = std::sscanf(text.c_str(), "%llu-%llu%n", &from, &to, &used);
  if (found == 1 && text.find_first_not_of("0123456789") == std::string::npos && from >= 1 && from <= kMostSeeds)
    return {1, from};
  if (found != 2 || static_cast<std::size_t>(used) != text.size() || from < 1 || to < from || to > kMostSeeds)
    throw Error(ExitCode::kUsage, "--seeds " + text + ": should be a number of seeds, or FROM-TO with 1 <= FROM <= TO");
  return {from, to};
}

std::vector<Method> methods_of(const std::string& text) {
  std::vector<Method> methods;
  std::string left = text == "all" ? "" : text;
  if (text == "all") {
    for (std::size_t i = 0; i < comparison::kMethodNames.size(); ++i) methods.push_back(static_cast<Method>(i));
  }
  while (!left.empty()) {
    const std::size_t comma = left.find(',');
    const std::string name = left.substr(0, comma);
    left = comma == std::string::npos ? "" : left.substr(comma + 1);
    const auto at = std::find(comparison::kMethodNames.begin(), comparison::kMethodNames.end(), name);
    if (at == comparison::kMethodNames.end()) {
      std::string known;
      for (const char* const one : comparison::kMethodNames) known += std::string(known.empty() ? "" : ", ") + one;
      throw Error(ExitCode::kUsage, "--methods: there is no '" + name + "'; there are " + known);
    }
    methods.push_back(static_cast<Method>(at - comparison::kMethodNames.begin()));
  }
  std::sort(methods.begin(), methods.end());
  methods.erase(std::unique(methods.begin(), methods.end()), methods.end());
  if (methods.empty()) throw Error(ExitCode::kUsage, "--methods: names none");
  return methods;
}

struct Setup {
  io::RunFile run;
  comparison::TrialSettings settings;
  Json described;  // what a result file must have in common with another to be merged
};

Setup setup_of(const Options& o) {
  Setup s;
  s.run = io::read_run_file(o.inputs.front());
  if (s.run.rig.empty() || !s.run.sheet.has_noise)
    throw Error(ExitCode::kInput, o.inputs.front() + ": a campaign needs a rig, and a sheet that states the noise");
  const io::RigFile rig = io::read_rig(s.run.rig, s.run.outer_axis, s.run.inner_axis, mounts_of(s.run));
  if (rig.limits[kPitch].endless())
    throw Error(ExitCode::kInput, s.run.rig + ": joint '" + s.run.inner_axis +
                                      "' has no limits: the design run and the "
                                      "experiment swing within them");
  for (int m = 0; m < rig.rig.mounts; ++m) {
    simulation::check_limits(simulation::experiment(rig.limits[kPitch].lowest, rig.limits[kPitch].highest, m),
                             rig.limits, s.run.rig + ": the experiment");
  }
  simulation::check_limits(simulation::design_run(rig.limits[kPitch]), rig.limits, s.run.rig + ": the design run");
  comparison::TrialSettings& t = s.settings;
  t.table = rig.rig;
  t.limits = rig.limits;
  t.gimbal = io::read_rig(shared_file("level_gimbal.urdf"), "azimuth", "pitch").rig;
  t.site = s.run.site;
  t.height = s.run.height;
  if (o.navigations > 0) t.site.gravity = normal_gravity(t.site.latitude, t.height);
  t.run.noise = s.run.sheet.noise;
  if (s.run.sheet.rate_hz > 0.0) t.run.rate = s.run.sheet.rate_hz;
  t.run.mount_error = o.mount_error_deg * kRadPerDeg;
  t.navigations = o.navigations;
  std::vector<std::string> names;
  for (const Method method : methods_of(o.methods))
    names.emplace_back(comparison::kMethodNames[static_cast<std::size_t>(method)]);
  s.described = {{"tool", tool_name()},
                 {"rig_sha256", io::sha256(io::read_whole(s.run.rig))},
                 {"sheet_sha256", io::sha256(io::read_whole(s.run.sheet_path))},
                 {"mounts", mounts_of(s.run)},
                 {"latitude_deg", t.site.latitude / kRadPerDeg},
                 {"height_m", t.height},
                 {"gravity_m_s2", t.site.gravity},
                 {"gravity_sigma_m_s2", t.site.gravity_sigma},
                 {"mount_error_deg", o.mount_error_deg},
                 {"methods", names},
                 {"navigations", o.navigations}};
  return s;
}

Json tree_of(const comparison::Trial& trial) {
  Json tree = {{"seed", trial.seed}, {"methods", Json::object()}};
  for (const auto& [method, outcome] : trial.methods) {
    Json one;
    const auto add = [&](const char* name, double value) {
      if (value >= 0.0) one[name] = value;
    };
    if (!outcome.failure.empty()) one["failure"] = outcome.failure;
    add("table_s", outcome.seconds);
    add("installation_deg", outcome.installation_deg);
    add("aligned_deg", outcome.aligned_deg);
    add("gyro_scale_ppm", outcome.gyro_scale_ppm);
    add("accel_scale_ppm", outcome.accel_scale_ppm);
    add("accel_aligned_deg", outcome.accel_aligned_deg);
    add("squared_pulls", outcome.squared_pulls);
    if (outcome.parameters > 0) one["parameters"] = outcome.parameters;
    tree["methods"][comparison::kMethodNames[static_cast<std::size_t>(method)]] = one;
  }
  for (const comparison::NavigationOutcome& navigation : trial.navigations) {
    const auto error = [](const comparison::NavigationOutcome::Error& e) {
      return Json{{"position_m", e.position_m}, {"velocity_m_s", e.velocity_m_s}, {"attitude_deg", e.attitude_deg}};
    };
    tree["navigations"].push_back({{"raw", error(navigation.raw)},
                                   {"calibrated", error(navigation.calibrated)},
                                   {"floor", error(navigation.floor)}});
  }
  return tree;
}

void sort_trials(Json& tree) {
  std::vector<Json> trials(tree["trials"].begin(), tree["trials"].end());
  std::sort(trials.begin(), trials.end(), [](const Json& a, const Json& b) {
    return a["seed"].get<std::uint64_t>() < b["seed"].get<std::uint64_t>();
  });
  tree["trials"] = trials;
}

/// Several result files in one. @throws Error (input) where settings differ or a seed is there twice
Json merged(const std::vector<std::string>& paths) {
  Json all;
  std::map<std::uint64_t, std::string> from;
  for (const std::string& path : paths) {
    const Json one = read_trials(path);
    if (all.is_null()) {
      all = one;
      all["trials"] = Json::array();
    } else if (all["settings"] != one["settings"]) {
      throw Error(ExitCode::kInput, path + ": its settings are not those of " + paths.front());
    }
    for (const Json& trial : one["trials"]) {
      const auto seed = trial["seed"].get<std::uint64_t>();
      const auto [at, fresh] = from.emplace(seed, path);
      if (!fresh)
        throw Error(ExitCode::kInput, path + ": seed " + std::to_string(seed) + " is in " + at->second + " too");
      all["trials"].push_back(trial);
    }
  }
  sort_trials(all);
  return all;
}

/// Runs what is not there yet, and writes the file after each.
Json run_trials(const Options& o) {
  const Setup setup = setup_of(o);
  const auto [from, to] = seeds_of(o.seeds);
  const std::vector<Method> methods = methods_of(o.methods);
  if (o.navigations > 0 && std::find(methods.begin(), methods.end(), Method::kExperiment) == methods.end())
    throw Error(ExitCode::kUsage, "--navigations: it is the calibration of the experiment that is navigated by");
  Json all = {{"format", kTrialsFormat}, {"settings", setup.described}, {"trials", Json::array()}};
  std::set<std::uint64_t> done;
  if (!o.output.empty() && fs::exists(o.output)) {
    all = read_trials(o.output);
    if (all["settings"] != setup.described)
      throw Error(ExitCode::kInput, o.output + ": holds trials of other settings: name another file");
    for (const Json& trial : all["trials"]) done.insert(trial["seed"].get<std::uint64_t>());
  }
  std::vector<std::uint64_t> left;
  for (std::uint64_t seed = from; seed <= to; ++seed) {
    if (done.count(seed) == 0) left.push_back(seed);
  }
  std::mutex mutex;
  ProgressLine progress;
  std::size_t finished = 0;
  catch_interrupts();
  calibration::share_out(
      left.size(),
      [&](std::size_t i) {
        if (interrupted()) return;
        const Json tree = tree_of(comparison::run_trial(setup.settings, methods, left[i]));
        const std::lock_guard<std::mutex> lock(mutex);
        all["trials"].push_back(tree);
        ++finished;
        if (!o.output.empty()) {
          sort_trials(all);
          io::write_whole(o.output, json_text(all));
        }
        progress.show("trial " + std::to_string(finished) + " of " + std::to_string(left.size()));
      },
      static_cast<unsigned>(std::max(0, o.jobs)));
  sort_trials(all);
  return all;
}

/// The values of one figure of one method, by seed; those without it are left out.
std::vector<double> figures_of(const Json& all, const std::string& method, const char* name) {
  std::vector<double> values;
  for (const Json& trial : all["trials"]) {
    const auto at = trial["methods"].find(method);
    if (at != trial["methods"].end() && at->contains(name)) values.push_back((*at)[name].get<double>());
  }
  return values;
}

Json summary_tree(const comparison::Summary& s) {
  Json tree = {{"n", s.n}, {"mean", s.mean}};
  if (s.n > 1) tree.update({{"s", s.deviation}, {"low", s.low}, {"high", s.high}});  // one value says nothing of these
  return tree;
}

/// "1-4, 6-10"
std::string seeds_of(const Json& all) {
  std::string text;
  std::uint64_t last = 0;
  bool open = false;  // a range whose end is not written
  for (const Json& trial : all["trials"]) {
    const auto seed = trial["seed"].get<std::uint64_t>();
    if (!text.empty() && seed == last + 1) {
      open = true;
    } else {
      if (open) text += "-" + std::to_string(last);
      open = false;
      text += (text.empty() ? "" : ", ") + std::to_string(seed);
    }
    last = seed;
  }
  return open ? text + "-" + std::to_string(last) : text;
}

/// The values of two methods on the seeds that both have.
std::pair<std::vector<double>, std::vector<double>> pairs_of(const Json& all, const std::string& a,
                                                             const std::string& b, const char* name) {
  std::pair<std::vector<double>, std::vector<double>> pairs;
  for (const Json& trial : all["trials"]) {
    const Json& methods = trial["methods"];
    if (!methods.contains(a) || !methods.contains(b) || !methods[a].contains(name) || !methods[b].contains(name))
      continue;
    pairs.first.push_back(methods[a][name].get<double>());
    pairs.second.push_back(methods[b][name].get<double>());
  }
  return pairs;
}

/// What the trials say.
Json conclude(const Json& all) {
  Json tree;
  tree["trials"] = all["trials"].size();
  tree["seeds"] = seeds_of(all);
  // ours, that the others are held against: on the experiment, or on the log of the rate tests
  const std::string ours = figures_of(all, "experiment", "installation_deg").empty() ? "twelve_position" : "experiment";
  tree["against"] = ours;
  for (const char* const method : comparison::kMethodNames) {
    Json one;
    int failures = 0;
    double seconds = 0.0;
    for (const Json& trial : all["trials"]) {
      const auto at = trial["methods"].find(method);
      if (at == trial["methods"].end()) continue;
      failures += at->contains("failure") ? 1 : 0;
      seconds = std::max(seconds, at->value("table_s", 0.0));
    }
    if (seconds == 0.0 && failures == 0) continue;
    one["table_s"] = seconds;
    if (failures > 0) one["failures"] = failures;
    for (const char* const name :
         {"installation_deg", "aligned_deg", "gyro_scale_ppm", "accel_scale_ppm", "accel_aligned_deg"}) {
      const std::vector<double> values = figures_of(all, method, name);
      if (values.empty()) continue;
      one[name] = summary_tree(comparison::summarise(values));
      const auto [theirs, reference] = pairs_of(all, method, ours, name);
      if (method != ours && theirs.size() > 1) {
        one[name]["times_ours"] = comparison::summarise(theirs).mean / comparison::summarise(reference).mean;
        one[name]["paired_p"] = comparison::paired_t_test(theirs, reference);
      }
      if (name != std::string("installation_deg") ||
          (method != std::string("traditional") && method != std::string("rate_test")))
        continue;
      const auto [on_the_log, solved] = pairs_of(all, method, "twelve_position", name);
      if (on_the_log.size() > 1) {
        one[name]["times_on_its_log"] = comparison::summarise(on_the_log).mean / comparison::summarise(solved).mean;
        one[name]["paired_p_on_its_log"] = comparison::paired_t_test(on_the_log, solved);
      }
    }
    const std::vector<double> pulls = figures_of(all, method, "squared_pulls");
    if (!pulls.empty()) {
      double sum = 0.0;
      double freedom = 0.0;
      for (const double value : pulls) sum += value;
      for (const double count : figures_of(all, method, "parameters")) freedom += count;
      one["nees"] = {{"sum", sum},
                     {"parameters", freedom},
                     {"low", chi_square_quantile(freedom, -2.5758)},
                     {"high", chi_square_quantile(freedom, 2.5758)}};
    }
    const std::vector<double> homogeneous =
        figures_of(all, method, one.contains("installation_deg") ? "installation_deg" : "aligned_deg");
    if (homogeneous.size() >= 2 * kGroups) one["homogeneity_p"] = comparison::homogeneity(homogeneous, kGroups);
    tree["methods"][method] = one;
  }
  std::map<std::string, std::vector<double>> logarithm;  // of calibrated over raw, by seed
  std::map<std::string, std::array<double, 3>> squares;
  double count = 0.0;
  for (const Json& trial : all["trials"]) {
    if (!trial.contains("navigations")) continue;
    std::map<std::string, std::array<double, 2>> of_seed;
    for (const Json& navigation : trial["navigations"]) {
      for (const char* const name : {"position_m", "velocity_m_s", "attitude_deg"}) {
        const double raw = navigation["raw"][name].get<double>();
        const double calibrated = navigation["calibrated"][name].get<double>();
        const double floor = navigation["floor"][name].get<double>();
        of_seed[name][0] += raw * raw;
        of_seed[name][1] += calibrated * calibrated;
        squares[name][0] += raw * raw;
        squares[name][1] += calibrated * calibrated;
        squares[name][2] += floor * floor;
      }
      count += 1.0;
    }
    for (const auto& [name, sums] : of_seed) logarithm[name].push_back(0.5 * std::log(sums[1] / sums[0]));
  }
  for (const auto& [name, values] : logarithm) {
    const comparison::Summary s = comparison::summarise(values);
    tree["navigation"][name] = {{"rms_raw", std::sqrt(squares[name][0] / count)},
                                {"rms_calibrated", std::sqrt(squares[name][1] / count)},
                                {"rms_floor", std::sqrt(squares[name][2] / count)},
                                {"reduction",
                                 {{"n", s.n},
                                  {"mean", 1.0 - std::exp(s.mean)},
                                  {"low", 1.0 - std::exp(s.high)},
                                  {"high", 1.0 - std::exp(s.low)}}},
                                {"reduction_of_rms", 1.0 - std::sqrt(squares[name][1] / squares[name][0])},
                                {"times_floor", std::sqrt(squares[name][1] / squares[name][2])}};
  }
  return tree;
}

void print(const Json& tree) {
  std::printf("trials of seeds %s; 95 %% intervals of means by Student's t; times and p (paired t-test): against %s\n",
              tree["seeds"].get<std::string>().c_str(), tree["against"].get<std::string>().c_str());
  const std::vector<std::pair<const char*, const char*>> figures = {
      {"installation_deg", "installation, frame of the case [deg]"},
      {"aligned_deg", "cross-coupling, frame of the accelerometers [deg]"},
      {"gyro_scale_ppm", "gyro scale [ppm]"},
      {"accel_scale_ppm", "accelerometer scale [ppm]"}};
  for (const auto& [name, title] : figures) {
    std::printf("\n%s\n%-18s %8s %4s %11s %11s %24s %9s %9s\n", title, "method", "table s", "n", "mean", "s",
                "interval", "times", "p");
    for (const auto& [method, one] : tree["methods"].items()) {
      if (!one.contains(name)) continue;
      const Json& s = one[name];
      std::printf(
          "%-18s %8.0f %4d %11s %11s %24s", method.c_str(), one["table_s"].get<double>(), s["n"].get<int>(),
          figure(s["mean"].get<double>(), 3).c_str(), s.contains("s") ? figure(s["s"].get<double>(), 3).c_str() : "-",
          s.contains("low")
              ? ("[" + figure(s["low"].get<double>(), 3) + ", " + figure(s["high"].get<double>(), 3) + "]").c_str()
              : "-");
      if (s.contains("times_ours"))
        std::printf(" %9s %9s", figure(s["times_ours"].get<double>(), 3).c_str(),
                    figure(s["paired_p"].get<double>(), 2).c_str());
      std::printf("\n");
    }
  }
  std::printf("\n");
  for (const auto& [method, one] : tree["methods"].items()) {
    if (one.contains("installation_deg") && one["installation_deg"].contains("times_on_its_log"))
      std::printf("%s: installation %s times twelve_position's on the same log, paired p = %s\n", method.c_str(),
                  figure(one["installation_deg"]["times_on_its_log"].get<double>(), 3).c_str(),
                  figure(one["installation_deg"]["paired_p_on_its_log"].get<double>(), 2).c_str());
    if (one.contains("failures"))
      std::printf("%s: no result in %d trials\n", method.c_str(), one["failures"].get<int>());
    if (one.contains("nees"))
      std::printf("%s: NEES %s of %s parameters, 99 %% band [%s, %s]\n", method.c_str(),
                  figure(one["nees"]["sum"].get<double>(), 5).c_str(),
                  figure(one["nees"]["parameters"].get<double>(), 6).c_str(),
                  figure(one["nees"]["low"].get<double>(), 5).c_str(),
                  figure(one["nees"]["high"].get<double>(), 5).c_str());
    if (one.contains("homogeneity_p"))
      std::printf("%s: homogeneity of %d groups of seeds (analysis of variance), p = %s\n", method.c_str(), kGroups,
                  figure(one["homogeneity_p"].get<double>(), 2).c_str());
  }
  if (!tree.contains("navigation")) return;
  std::printf(
      "\nan hour of navigation in the table's motions, biases taken anew at rest in every arm\n%-14s %11s %11s %11s "
      "%28s %12s\n",
      "at its end", "raw rms", "calibrated", "floor", "reduction, geometric mean", "times floor");
  for (const auto& [name, one] : tree["navigation"].items()) {
    const Json& r = one["reduction"];
    std::printf("%-14s %11s %11s %11s %28s %12s\n", name.c_str(), figure(one["rms_raw"].get<double>(), 4).c_str(),
                figure(one["rms_calibrated"].get<double>(), 4).c_str(),
                figure(one["rms_floor"].get<double>(), 4).c_str(),
                (figure(100.0 * r["mean"].get<double>(), 4) + " % [" + figure(100.0 * r["low"].get<double>(), 4) +
                 ", " + figure(100.0 * r["high"].get<double>(), 4) + "]")
                    .c_str(),
                figure(one["times_floor"].get<double>(), 4).c_str());
  }
}

std::string csv_of(const Json& all) {
  std::string csv =
      "seed,method,table_s,installation_deg,aligned_deg,gyro_scale_ppm,accel_scale_ppm,accel_aligned_deg,failure\n";
  for (const Json& trial : all["trials"]) {
    for (const auto& [method, one] : trial["methods"].items()) {
      csv += std::to_string(trial["seed"].get<std::uint64_t>()) + "," + method;
      for (const char* const name :
           {"table_s", "installation_deg", "aligned_deg", "gyro_scale_ppm", "accel_scale_ppm", "accel_aligned_deg"})
        csv += "," + (one.contains(name) ? figure(one[name].get<double>(), 10) : std::string());
      csv += one.contains("failure") ? ",1\n" : ",\n";
    }
  }
  return csv;
}

ExitCode trials(const Options& o) {
  check_outputs({o.output, o.csv}, o.inputs);
  if (!o.merge && o.inputs.size() != 1) throw Error(ExitCode::kUsage, "one run file, or --merge and result files");
  const Json all = o.merge ? merged(o.inputs) : run_trials(o);
  if (o.merge && !o.output.empty() && fs::exists(o.output)) {
    // nothing that was there goes but what comes again
    std::set<std::uint64_t> seeds;
    for (const Json& trial : all["trials"]) seeds.insert(trial["seed"].get<std::uint64_t>());
    const Json before = read_trials(o.output);
    for (const Json& trial : before["trials"]) {
      const auto seed = trial["seed"].get<std::uint64_t>();
      if (seeds.count(seed) == 0)
        throw Error(ExitCode::kUsage,
                    o.output + ": has seed " + std::to_string(seed) +
                        ", which the files to be merged do not have: name it among them, or another output");
    }
  }
  if (!o.output.empty()) io::write_whole(o.output, json_text(all));
  if (!o.csv.empty()) io::write_whole(o.csv, csv_of(all));
  if (all["trials"].empty()) return interrupted() ? ExitCode::kInterrupted : ExitCode::kDone;
  const Json tree = conclude(all);
  if (o.format == "json")
    std::printf("%s", json_text(tree).c_str());
  else
    print(tree);
  if (!interrupted()) return ExitCode::kDone;
  std::fprintf(stderr, "interrupted; %s\n",
               o.output.empty() ? "without -o the trials are lost" : "the same command goes on from here");
  return ExitCode::kInterrupted;
}

}  // namespace

void add_trials(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand(
      "trials", "A campaign over seeds: simulate, calibrate by every method, navigate; means, intervals, tests");
  auto o = std::make_shared<Options>();
  command->add_option("run", o->inputs, "Run file: its rig, sheet and site; with --merge, result files")->required();
  CLI::Option* const merge = command->add_flag("--merge", o->merge, "Put result files of other seeds together");
  command->add_option("--seeds", o->seeds, "How many, or FROM-TO")->capture_default_str()->excludes(merge);
  command
      ->add_option(
          "--methods", o->methods,
          "all, or some of traditional, rate_test, kalman_36, by_hand, three_axis, twelve_position, experiment")
      ->capture_default_str()
      ->excludes(merge);
  command->add_option("--mount-error-deg", o->mount_error_deg, "1 sigma of the fixture's errors about each axis")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 5.0))
      ->excludes(merge);
  command->add_option("--navigations", o->navigations, "Hours of navigation a seed")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000))
      ->excludes(merge);
  command->add_option("-o,--output", o->output,
                      "Result file (JSON) to write; what is in it already is not run again, nor taken out by a merge");
  command->add_option("--csv", o->csv, "The same by seed and method, as CSV");
  command->add_option("-j,--jobs", o->jobs, "Seeds at a time; default as many as the machine has cores")
      ->check(CLI::Range(1, 1024))
      ->excludes(merge);
  command->add_option("--format", o->format, "Of the result on standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->footer("Example:\n  imu_calibrate trials run.yaml --seeds 50 -o trials.json");
  command->callback([o, &exit_code] { exit_code = trials(*o); });
}

}  // namespace trunnion::app
