// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/run_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "channel_yaml.hpp"
#include "strict_yaml.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

std::string beside(const std::string& file, const std::string& path) {
  const std::filesystem::path p(path);
  return p.is_absolute() ? path : (std::filesystem::path(file).parent_path() / p).lexically_normal().string();
}

constexpr const char* kNoRig = "the run has no rig: name its URDF under rig, or leave mount and encoder out";

std::size_t entry_index(const StrictYaml& map, const std::string& key) {
  std::vector<std::string> known;
  known.reserve(kEntryKinds.size());
  for (const EntryKind& kind : kEntryKinds) known.emplace_back(kind.key);
  map.only(known);
  return static_cast<std::size_t>(std::find(known.begin(), known.end(), key) - known.begin());
}

ColumnMap read_columns(const StrictYaml& node) {
  ColumnMap columns;
  node.only({"t", "gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z", "azimuth", "pitch", "temperature"});
  for (const std::string& quantity : node.keys()) {
    const StrictYaml entry = node.at(quantity);
    entry.only({"column", "unit"});
    ColumnChoice choice;
    const StrictYaml column = entry.at("column");
    if (column.is_number()) {
      const long long index = column.integer();
      if (index < 0 || index > 10000) column.fail("should be an index from 0 to 10000");
      choice.index = static_cast<int>(index);
    } else {
      choice.name = column.text();
      if (choice.name.empty()) column.fail("is empty");
    }
    choice.unit = entry.at("unit").text();
    std::string expected;
    if (!unit_fits(quantity, choice.unit, expected))
      entry.at("unit").fail("'" + choice.unit + "' does not measure " + quantity + ": one of " + expected);
    columns[quantity] = choice;
  }
  return columns;
}

PlanRequest read_plan(const StrictYaml& node) {
  PlanRequest plan;
  node.only({"rests", "turns"});
  if (node.has("rests")) {
    const StrictYaml rests = node.at("rests");
    rests.only({"zones", "seconds"});
    if (rests.has("zones")) plan.rest_zones = static_cast<int>(rests.at("zones").number_in(1.0, TablePlan::kMostZones));
    if (rests.has("seconds")) plan.rest_seconds = rests.at("seconds").number_in(1.0, 3600.0);
  }
  if (node.has("turns")) {
    const StrictYaml turns = node.at("turns");
    turns.only({"rates_deg_per_s", "seconds"});
    if (turns.has("rates_deg_per_s")) {
      const StrictYaml rates = turns.at("rates_deg_per_s");
      if (rates.length() == 0 || rates.length() > PlanRequest::kMostRates)
        rates.fail("should be 1 to " + std::to_string(PlanRequest::kMostRates) + " rates, each turned both ways");
      plan.number_of_rates = static_cast<int>(rates.length());
      for (std::size_t i = 0; i < rates.length(); ++i) plan.rates[i] = rates.at(i).number_in(0.5, 2000.0) * kRadPerDeg;
    }
    if (turns.has("seconds")) plan.turn_seconds = turns.at("seconds").number_in(1.0, 3600.0);
  }
  return plan;
}

/// "cubic", or {temperature: 3}.
void read_term(const StrictYaml& node, RunFile& run) {
  if (node.is_map()) {
    node.only({"temperature"});
    const StrictYaml order = node.at("temperature");
    const long long n = order.integer();
    if (n < 1 || n > ThermalErrors<double>::kMostOrder)
      order.fail("should be an order from 1 to " + std::to_string(ThermalErrors<double>::kMostOrder));
    if (run.temperature > 0) node.fail("stands there twice");
    run.temperature = static_cast<int>(n);
    return;
  }
  const std::string term = node.text();
  if (term == "temperature") node.fail("has no order: write temperature: 3");
  bool* const chosen = term == "cubic"           ? &run.cubic
                       : term == "g_sensitivity" ? &run.g_sensitivity
                       : term == "quadratic"     ? &run.quadratic
                       : term == "asymmetry"     ? &run.asymmetry
                       : term == "size_effect"   ? &run.size_effect
                                                 : nullptr;
  if (chosen == nullptr)
    node.fail("unknown term '" + term + "'; did you mean '" +
              nearest(term, {"cubic", "g_sensitivity", "quadratic", "asymmetry", "size_effect", "temperature: 3"}) +
              "'?");
  *chosen = true;
}

Soak read_soak(const StrictYaml& node) {
  node.only({"from_deg_c", "to_deg_c", "k_per_min"});
  Soak soak;
  soak.from = node.at("from_deg_c").number_in(-100.0, 300.0);
  soak.to = node.at("to_deg_c").number_in(-100.0, 300.0);
  soak.rate = node.at("k_per_min").number_in(1e-3, 100.0) / 60.0;
  if (soak.from == soak.to) node.at("to_deg_c").fail("is where the soak begins");
  return soak;
}

RecordingFiles read_files(const StrictYaml& node, const std::string& run, bool has_rig) {
  if (!has_rig && node.has("mount")) node.at("mount").fail(kNoRig);
  node.only(has_rig ? std::vector<std::string>{"mount", "log"} : std::vector<std::string>{"log"});
  RecordingFiles files;
  if (has_rig) files.mount = node.at("mount").text();
  const StrictYaml log = node.at("log");
  if (!log.is_map()) {
    files.log = beside(run, log.text());
  } else if (log.has("gyro") || log.has("accel")) {
    log.only({"gyro", "accel", "encoder"});
    files.gyro = beside(run, log.at("gyro").text());
    files.accel = beside(run, log.at("accel").text());
    if (log.has("encoder") && !has_rig) log.at("encoder").fail(kNoRig);
    if (has_rig) files.encoder = beside(run, log.at("encoder").text());
  } else {
    log.only({"imu", "encoder"});
    files.imu = beside(run, log.at("imu").text());
    if (log.has("encoder") && !has_rig) log.at("encoder").fail(kNoRig);
    if (has_rig) files.encoder = beside(run, log.at("encoder").text());
  }
  return files;
}

}  // namespace

bool is_run_file(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

RunFile read_run_file(const std::string& path) {
  const StrictYaml root = StrictYaml::load(path, "trunnion-run/1");
  root.only({"format", "site", "rig", "axes", "sheet", "serial", "clock", "bias", "model", "refuse_above", "recordings",
             "limits", "channels", "lcm_types", "columns", "plan", "moves", "soak"});
  RunFile run;
  run.path = path;

  const StrictYaml site = root.at("site");
  site.only({"latitude_deg", "height_m", "gravity_m_s2", "gravity_sigma_m_s2"});
  run.site.latitude = site.at("latitude_deg").number_in(-90.0, 90.0) * kRadPerDeg;
  if (site.has("height_m")) run.height = site.at("height_m").number_in(-500.0, 10000.0);
  run.site.gravity = site.has("gravity_m_s2") ? site.at("gravity_m_s2").number_in(9.7, 9.9)
                                              : normal_gravity(run.site.latitude, run.height);
  if (site.has("gravity_sigma_m_s2")) run.site.gravity_sigma = site.at("gravity_sigma_m_s2").positive();

  if (root.has("rig")) run.rig = beside(path, root.at("rig").text());
  if (root.has("axes")) {
    if (root.at("axes").length() != 2) root.at("axes").fail("should be two joint names, outer and inner");
    run.outer_axis = root.at("axes").at(0).text();
    run.inner_axis = root.at("axes").at(1).text();
  }
  if (root.has("sheet")) {
    run.sheet_path = beside(path, root.at("sheet").text());
    run.sheet = read_sensor_sheet(run.sheet_path);
  }
  if (root.has("serial")) run.serial = root.at("serial").text();
  if (root.has("clock")) {
    root.at("clock").only({"imu_to_encoder_offset"});
    const StrictYaml offset = root.at("clock").at("imu_to_encoder_offset");
    run.estimate_clock_offset = !offset.is_number() && offset.text() == "estimate";
    if (!run.estimate_clock_offset) run.clock_offset = offset.number_in(-1.0, 1.0);
  }
  if (root.has("bias")) {
    const std::string bias = root.at("bias").text();
    if (bias != "per_recording" && bias != "shared") root.at("bias").fail("should be per_recording or shared");
    run.bias_per_recording = bias == "per_recording";
  }
  run.cubic = !run.rig.empty();  // hand turns are too few and too short to tell a cubic from a scale
  if (root.has("model")) {
    run.cubic = run.g_sensitivity = false;
    const StrictYaml model = root.at("model");
    for (std::size_t i = 0; i < model.length(); ++i) read_term(model.at(i), run);
  }
  if (root.has("refuse_above")) {
    const StrictYaml refuse = root.at("refuse_above");
    for (const std::string& key : refuse.keys()) {
      const std::size_t i = entry_index(refuse, key);
      run.refuse_above[i] = refuse.at(key).positive();
    }
  }
  if (root.has("limits")) {
    const StrictYaml limits = root.at("limits");
    for (const std::string& key : limits.keys()) {
      const std::size_t i = entry_index(limits, key);
      limits.at(key).only({"value", "sigma"});
      if (limits.at(key).has("value")) run.limits[i].value = limits.at(key).at("value").positive();
      if (limits.at(key).has("sigma")) run.limits[i].sigma = limits.at(key).at("sigma").positive();
    }
  }
  const auto types = std::make_shared<LcmTypes>();
  if (root.has("lcm_types")) {
    const StrictYaml folders = root.at("lcm_types");
    for (std::size_t i = 0; i < folders.length(); ++i) {
      run.lcm_types.push_back(beside(path, folders.at(i).text()));
      try {
        types->add(run.lcm_types.back());
      } catch (const Error& e) {
        folders.at(i).fail(e.what());
      }
    }
  }
  run.channels.sheet = run.sheet;
  if (root.has("channels")) {
    const StrictYaml channels = root.at("channels");
    channels.only({"imu", "encoder"});
    if (channels.has("imu")) run.channels.imu = read_channel(channels.at("imu"), true, types, run.sheet);
    if (channels.has("encoder")) run.channels.encoder = read_channel(channels.at("encoder"), false, types, run.sheet);
  }
  if (root.has("plan")) run.plan = read_plan(root.at("plan"));
  if (root.has("soak")) run.soak = read_soak(root.at("soak"));
  if (root.has("moves")) run.moves = beside(path, root.at("moves").text());
  if (root.has("columns")) run.columns = read_columns(root.at("columns"));

  const StrictYaml recordings = root.at("recordings");
  if (recordings.length() == 0) recordings.fail("is empty");
  for (std::size_t i = 0; i < recordings.length(); ++i)
    run.recordings.push_back(read_files(recordings.at(i), path, !run.rig.empty()));
  return run;
}

namespace {

/// Passes on one of the two channels.
class OneChannel final : public SampleSink {
 public:
  OneChannel(SampleSink& sink, bool is_imu) : sink_(sink), is_imu_(is_imu) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    if (is_imu_) sink_.imu(utime, sample);
  }
  void temperature(double celsius) override {
    if (is_imu_) sink_.temperature(celsius);
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    if (!is_imu_) sink_.encoder(utime, azimuth, pitch);
  }

 private:
  SampleSink& sink_;
  bool is_imu_;
};

}  // namespace

LogRequest log_request(const RunFile& run, const std::string& path) {
  LogRequest request;
  request.path = path;
  request.channels = run.channels;
  request.columns = run.columns;
  request.joints = {run.outer_axis, run.inner_axis};
  return request;
}

LogLosses read_recording(const RunFile& run, const RecordingFiles& files, SampleSink& sink,
                         std::vector<std::pair<std::string, std::string>>& inputs, const Progress& progress) {
  LogLosses losses;
  const auto read = [&](const std::string& path, bool need_imu, bool need_encoder, SampleSink& into) {
    LogRequest request = log_request(run, path);
    request.need_imu = need_imu;
    request.need_encoder = need_encoder;
    request.progress = progress;
    Sha256 digest;
    request.digest = &digest;
    const LogLosses lost = read_log(request, into);
    losses.records += lost.records;
    losses.bytes += lost.bytes;
    losses.samples += lost.samples;
    if (!lost.note.empty()) losses.note += (losses.note.empty() ? "" : "; ") + lost.note;
    inputs.emplace_back(path, digest.finish());
  };
  if (!files.log.empty()) {
    read(files.log, true, !files.mount.empty(), sink);
    return losses;
  }
  if (!files.imu.empty()) {
    OneChannel only(sink, true);
    read(files.imu, true, false, only);
  } else {
    std::string digest;
    std::string accel_digest;
    read_split_csv(files.gyro, files.accel, run.columns, run.sheet, sink, digest, accel_digest);
    inputs.emplace_back(files.gyro, digest);
    inputs.emplace_back(files.accel, accel_digest);
  }
  if (!files.encoder.empty()) {
    OneChannel only(sink, false);
    read(files.encoder, false, true, only);
  }
  return losses;
}

}  // namespace trunnion::io
