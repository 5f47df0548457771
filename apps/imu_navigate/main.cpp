// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "../outputs.hpp"
#include "../program.hpp"
#include "../terminal.hpp"
#include "output.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/whole_file.hpp"
#include "truth.hpp"

namespace trunnion::app {
namespace {

const std::map<std::string, Align> kAligns = {{"none", Align::kNone},
                                              {"level", Align::kLevel},
                                              {"compass", Align::kCompass},
                                              {"fine", Align::kFine},
                                              {"swinging", Align::kSwinging}};
const std::map<std::string, Modulation> kModulations = {{"none", Modulation::kNone},
                                                        {"index", Modulation::kIndex},
                                                        {"encoder", Modulation::kEncoder},
                                                        {"wheel", Modulation::kWheel}};

struct Options {
  RecordingSource source;
  std::string modulation = "none";
  std::string align = "level";
  double align_time = 10.0;
  double latitude = 0.0;  // deg
  double longitude = 0.0;
  double height = 0.0;
  double heading = 0.0;
  std::vector<double> lever_arm = {0.0, 0.0, 0.0};
  std::string sheet;
  std::string algorithm = "previous";
  double output_hz = 10.0;
  double delay = 0.0;
  double axial_range = 0.0;  // deg/s
  double wheel_radius = 0.0;
  std::string wheel_axle = "left";
  std::string truth;
  double truth_offset = 0.0;
  double truth_heading = 0.0;
  std::string output, log, kml, plots, summary;
  std::string format = "text";
};

nlohmann::ordered_json summary_of(const Options& o, const Recording& recording, const BodyMotionSeries& motion,
                                  const Track& track, const std::optional<Comparison>& against) {
  const Epoch& end = track.epoch.back();
  nlohmann::ordered_json tree = {
      {"schema", "trunnion/navigate/1"},
      {"tool", tool_name()},
      {"input", o.source.log},
      {"samples", recording.sample.size()},
      {"period_s", recording.period},
      {"duplicates", recording.duplicates},
      {"stray_stamps", recording.strays},
      {"filled", recording.filled},
      {"damaged_records", recording.damaged},
      {"start", {{"t_s", track.epoch.front().t}, {"heading_deg", track.heading_at_start / kRadPerDeg}}},
      {"end",
       {{"t_s", end.t},
        {"lat_deg", end.state.latitude / kRadPerDeg},
        {"lon_deg", end.state.longitude / kRadPerDeg},
        {"h_m", end.state.height},
        {"speed_m_s", end.state.velocity.norm()},
        {"heading_deg", euler_angles(end.state.attitude).z() / kRadPerDeg}}}};
  if (motion.turns > 0)
    tree["modulation"] = {{"turns", motion.turns},
                          {"missed_pulses", motion.missed_pulses},
                          {"stray_pulses", motion.stray_pulses},
                          {"saturated_turns", motion.saturated_turns}};
  if (track.heading_sigma > 0.0) tree["start"]["heading_sigma_deg"] = track.heading_sigma / kRadPerDeg;
  if (track.latitude_sigma > 0.0) {
    tree["start"]["latitude_seen_deg"] = track.latitude_seen / kRadPerDeg;
    tree["start"]["latitude_seen_sigma_deg"] = track.latitude_sigma / kRadPerDeg;
  }
  if (o.modulation == "wheel") tree["wheel"] = {{"distance_m", track.distance}, {"axle_scale", track.axle_scale}};
  if (against) {
    tree["truth"] = {{"compared_s", against->time},
                     {"distance_m", against->distance},
                     {"largest_horizontal_m", against->largest_horizontal},
                     {"end_horizontal_m", against->end_horizontal},
                     {"largest_vertical_m", against->largest_vertical}};
    if (against->moving) {
      tree["truth"]["largest_horizontal_percent"] = 100.0 * against->largest_horizontal / against->distance;
      tree["truth"]["heading_rms_deg"] = against->heading_rms / kRadPerDeg;
      tree["truth"]["heading_end_deg"] = against->heading_end / kRadPerDeg;
    }
  }
  if (against && against->moving &&
      track.distance > 0.0)  // a calibration of the radius, where the truth covers the whole way
    tree["wheel"]["radius_from_truth_m"] = o.wheel_radius * against->distance / track.distance;
  tree["warnings"] = recording.warnings;
  for (const std::string& warning : track.warnings) tree["warnings"].push_back(warning);
  return tree;
}

/// Options that are missing, that contradict each other, or that would do nothing.
void check(const CLI::App& app, const Options& o) {
  const auto given = [&app](const char* name) { return app.count(name) > 0; };
  const auto refuse = [](const std::string& what) { throw Error(ExitCode::kUsage, what); };
  for (const double value :
       {o.align_time, o.latitude, o.longitude, o.height, o.heading, o.lever_arm[0], o.lever_arm[1], o.lever_arm[2],
        o.output_hz, o.delay, o.axial_range, o.wheel_radius, o.truth_offset, o.truth_heading, o.source.longest_gap}) {
    if (!std::isfinite(value)) refuse("an option's number is not finite");
  }
  const bool wheel = o.modulation == "wheel";
  if (wheel && !given("--wheel-radius-m")) refuse("--modulation wheel needs --wheel-radius-m");
  if (!given("--truth") && !(given("--latitude-deg") && given("--longitude-deg")))
    refuse("where does it start? --latitude-deg and --longitude-deg, or --truth");
  if (!given("--truth")) {
    for (const char* name : {"--truth-offset-s", "--truth-heading-s"})
      if (given(name)) refuse(std::string(name) + " is of --truth");
  }
  if (!wheel) {
    for (const char* name : {"--wheel-radius-m", "--wheel-axle", "--truth-heading-s"})
      if (given(name)) refuse(std::string(name) + " is of --modulation wheel");
  } else {
    for (const char* name : {"--align", "--align-s", "--algorithm", "--lever-arm-m", "--axis"})
      if (given(name)) refuse(std::string(name) + " is not of --modulation wheel");
  }
  if (o.modulation == "none" && given("--axis")) refuse("--axis is of --modulation index or encoder");
  if (o.modulation != "encoder" && given("--delay-s")) refuse("--delay-s is of --modulation encoder");
  if (o.align != "fine" && given("--lever-arm-m")) refuse("--lever-arm-m is of --align fine");
  if (given("--heading-deg") && (o.align == "compass" || o.align == "fine" || o.align == "swinging"))
    refuse("--heading-deg: --align " + o.align + " finds it");
  if (given("--plot") && !given("--output")) refuse("--plot draws the table: give --output too");
  check_outputs({o.output, o.log, o.kml, o.summary},
                {o.source.log, o.source.axis, o.source.calibration, o.truth, o.sheet});
}

void run(const CLI::App& app, Options o) {
  check(app, o);
  const Modulation modulation = kModulations.at(o.modulation);
  std::optional<Truth> truth;
  if (!o.truth.empty()) truth.emplace(o.truth, o.truth_offset);
  Start start;
  const auto start_of = [&](const char* option, double given, double of_truth) {
    return truth && app.count(option) == 0 ? of_truth : given;
  };
  start.latitude = start_of("--latitude-deg", o.latitude * kRadPerDeg, truth ? truth->latitude() : 0.0);
  start.longitude = std::remainder(
      start_of("--longitude-deg", o.longitude * kRadPerDeg, truth ? truth->longitude() : 0.0), 2.0 * kPi);
  start.height = start_of("--height-m", o.height, truth ? truth->height() : 0.0);
  start.heading = o.heading * kRadPerDeg;
  start.align = kAligns.at(o.align);
  start.align_time = o.align_time;
  start.lever_arm = Vec3<double>(o.lever_arm[0], o.lever_arm[1], o.lever_arm[2]);
  if (!o.sheet.empty()) {
    const io::SensorSheet sheet = io::read_sensor_sheet(o.sheet);
    start.noise = sheet.noise;
    start.has_noise = sheet.has_noise;
    if (o.axial_range == 0.0) o.axial_range = sheet.gyro_range / kRadPerDeg;
  }
  o.source.needs_angle = modulation == Modulation::kEncoder;
  o.source.needs_pulses = modulation == Modulation::kIndex;
  const Recording recording = read_recording(o.source);
  for (const std::string& warning : recording.warnings)
    std::fprintf(stderr, "imu_navigate: warning: %s\n", warning.c_str());
  const BodyMotionSeries motion = body_motion(recording, modulation, o.axial_range * kRadPerDeg, o.delay);
  const AxleSide side = o.wheel_axle == "left" ? AxleSide::kLeft : AxleSide::kRight;
  Track track = modulation == Modulation::kWheel
                    ? reckon(motion, start, {o.wheel_radius, side, o.axial_range * kRadPerDeg, 0.01}, o.output_hz)
                    : navigate(motion, start, o.algorithm, o.output_hz);
  if (motion.saturated_turns > 0)
    track.warnings.push_back("the gyro about the axis was at its range in " + std::to_string(motion.saturated_turns) +
                             " turns: the rate about the axis is held over from the last good one");
  std::optional<Comparison> against;
  if (truth) {
    if (o.truth_heading > 0.0) turn_track(track, truth->heading_offset(track, o.truth_heading));
    against = truth->compare(track);
    const double whole = track.epoch.back().t - track.epoch.front().t;
    if (against->time < 0.9 * whole)
      track.warnings.push_back("the truth covers " + figure(against->time, 4) + " of the track's " + figure(whole, 4) +
                               " s");
    if (against->moving && against->heading_rms > 90.0 * kRadPerDeg)
      track.warnings.push_back("the track goes the other way: is --heading-deg, or --wheel-axle, right?");
  }
  if (!o.output.empty()) write_csv(o.output, track);
  if (!o.log.empty()) write_log(o.log, track);
  if (!o.kml.empty()) write_kml(o.kml, track);
  if (!o.plots.empty()) write_plots(o.plots, o.output, o.truth);
  const nlohmann::ordered_json tree = summary_of(o, recording, motion, track, against);
  const std::string json = json_text(tree);
  if (!o.summary.empty()) io::write_whole(o.summary, json);
  for (const std::string& warning : track.warnings)
    std::fprintf(stderr, "imu_navigate: warning: %s\n", warning.c_str());
  if (o.format == "json")
    std::fputs(json.c_str(), stdout);
  else
    print_summary(tree);
}

template <class V>
std::vector<std::string> names(const std::map<std::string, V>& values) {
  std::vector<std::string> keys;
  keys.reserve(values.size());
  for (const auto& [key, value] : values) keys.push_back(key);
  return keys;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option(
         "log", o.source.log,
         "A log of any format that is read (imu_calibrate convert --help); columns of another table: convert it first")
      ->required();
  app.add_option("--channel", o.source.channel,
                 "Of the unit in a log: channel or topic; default IMU in an LCM log, else the only one");
  app.add_flag("--increments", o.source.increments, "The values are increments: rad and m/s a sample");
  app.add_option("--calibration", o.source.calibration, "Calibration file to correct the samples with");
  app.add_option("--sheet", o.sheet, "Sensor sheet: noise and range");
  app.add_option("--longest-gap-s", o.source.longest_gap, "Longer gaps are refused, shorter ones bridged")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 60.0));

  app.add_option("--latitude-deg", o.latitude, "Of the start; default the truth's")->check(CLI::Range(-90.0, 90.0));
  app.add_option("--longitude-deg", o.longitude, "Of the start")->check(CLI::Range(-360.0, 360.0));
  app.add_option("--height-m", o.height, "Of the start, above the ellipsoid")->check(CLI::Range(-1e4, 1e6));
  app.add_option("--heading-deg", o.heading, "Of the start, clockwise from north")->check(CLI::Range(-360.0, 360.0));
  app.add_option("--align", o.align,
                 "none: level, heading as given; level: tilt and gyro bias at rest, heading as given; compass: heading "
                 "from the Earth's rate; fine: a filter after that; swinging: on a base that swings")
      ->capture_default_str()
      ->check(CLI::IsMember(names(kAligns)));
  app.add_option("--align-s", o.align_time, "Seconds of alignment at the start")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0));
  app.add_option("--lever-arm-m", o.lever_arm,
                 "Of --align fine: from the point at rest to the unit, in the unit's axes")
      ->expected(3);
  app.add_option("--algorithm", o.algorithm, "Coning and sculling: previous, 2, 3, 4 samples, exact4, exact6, exact8")
      ->capture_default_str()
      ->check(CLI::IsMember({"previous", "2", "3", "4", "exact4", "exact6", "exact8"}));

  app.add_option("--modulation", o.modulation,
                 "The unit turns about its z: with an index pulse, with an encoder, or on a wheel")
      ->capture_default_str()
      ->check(CLI::IsMember(names(kModulations)));
  app.add_option("--axis", o.source.axis,
                 "CSV of the axis: t_s,angle_rad of an encoder, t_s of the pulses; default the log's ENCODER (first "
                 "angle) or INDEX");
  app.add_option("--delay-s", o.delay, "Of the unit against the encoder")->check(CLI::Range(-1.0, 1.0));
  app.add_option("--axial-range-deg-per-s", o.axial_range,
                 "Where the gyro about the axis saturates; default the sheet's")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--wheel-radius-m", o.wheel_radius, "Rolling radius")->check(CLI::Range(0.01, 10.0));
  app.add_option("--wheel-axle", o.wheel_axle, "Where the unit's z points: left or right of the vehicle")
      ->capture_default_str()
      ->check(CLI::IsMember({"left", "right"}));

  app.add_option("--truth", o.truth, "CSV t_s,lat_deg,lon_deg,h_m to compare with, and to start from");
  app.add_option("--truth-offset-s", o.truth_offset, "To add to the log's stamps to get the truth's");
  app.add_option("--truth-heading-s", o.truth_heading,
                 "Take the start heading from the truth's course over the first seconds of motion")
      ->check(CLI::Range(0.0, 1e4));

  app.add_option("-o,--output", o.output, "CSV of the track");
  app.add_option("--output-hz", o.output_hz, "Rows a second")->capture_default_str()->check(CLI::Range(1e-3, 1e5));
  app.add_option("--log", o.log, "LCM log of navigation_t on channel NAVIGATION");
  app.add_option("--kml", o.kml, "The track for a map");
  app.add_option("--plot", o.plots, "Folder for pictures of the table (gnuplot)");
  app.add_option("--json", o.summary, "Summary");
  app.add_option("--format", o.format, "Of the summary on standard output: text or json")
      ->check(CLI::IsMember({"text", "json"}));
}

ExitCode run_navigate(std::vector<std::string> arguments) {
  CLI::App app("Navigates from the samples of an inertial unit: strapped down, on a turning platform, or on a wheel.",
               "imu_navigate");
  app.set_version_flag("--version", tool_name());
  app.footer(
      "Example:\n  imu_navigate drive.lcm --latitude-deg 48.1 --longitude-deg 11.6 --heading-deg 90 -o track.csv --kml "
      "track.kml\n\n"
      "Exit codes: 0 done; 2 usage; 3 input; 4 numerics; 70 defect.");
  Options o;
  add_options(app, o);
  return run_program(app, std::move(arguments), [&] {
    run(app, o);
    return ExitCode::kDone;
  });
}

}  // namespace
}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_navigate); }
