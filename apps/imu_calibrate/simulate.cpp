// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <memory>

#include "../terminal.hpp"
#include "command.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"
#include "trunnion/simulation/table_run.hpp"

namespace trunnion::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string output;
  std::string sheet = shared_file("3dm-cv7.yaml");
  std::string rig = shared_file("two_axis_table.urdf");
  std::uint64_t seed = 1;
  double latitude_deg = 43.88;
  double height_m = 220.0;
  double gravity_sigma = 1e-5;
  double outliers_percent = 0.0;
  double dropped_percent = 0.0;
  int batch = 1;
  bool noise_free = false;
  bool rest_only = false;
  bool no_sheet = false;
};

/// Samples into messages of one, or of several.
class ImuMessages {
 public:
  ImuMessages(int batch, io::LcmLogWriter& log) : batch_(static_cast<std::size_t>(batch)), log_(log) {}
  void add(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample) {
    if (batch_ == 1) {
      io::encode_imu(utime, sequence, sample, message_);
      log_.write(utime, "IMU", message_);
      return;
    }
    // a batch has consecutive numbers: what was lost stands between two
    if (!utime_.empty() && sequence != first_ + static_cast<std::int64_t>(utime_.size())) finish();
    if (utime_.empty()) first_ = sequence;
    utime_.push_back(utime);
    samples_.push_back(sample);
    if (utime_.size() == batch_) finish();
  }
  void finish() {
    if (utime_.empty()) return;
    io::encode_imu_batch(first_, utime_, samples_, message_);
    log_.write(utime_.back(), "IMU", message_);
    utime_.clear();
    samples_.clear();
  }

 private:
  std::size_t batch_;
  io::LcmLogWriter& log_;
  std::int64_t first_ = 0;
  std::vector<std::int64_t> utime_;
  std::vector<InertialSample<double>> samples_;
  std::string message_;
};

void simulate(const Options& o) {
  const io::SensorSheet sheet = io::read_sensor_sheet(o.sheet);
  const io::RigFile rig = io::read_rig(o.rig, "azimuth", "pitch");
  if (rig.pitch_lower == rig.pitch_upper)
    throw Error(ExitCode::kInput, o.rig + ": joint 'pitch' has no limits to plan the swings by");
  simulation::TableRunSettings settings;
  settings.seed = o.seed;
  if (sheet.rate_hz > 0.0) settings.rate = sheet.rate_hz;
  if (sheet.has_noise) settings.noise = sheet.noise;
  settings.outlier_fraction = 0.01 * o.outliers_percent;
  settings.dropped_fraction = 0.01 * o.dropped_percent;
  if (o.noise_free) settings = settings.noise_free();
  Site site;
  site.latitude = o.latitude_deg * kRadPerDeg;
  site.gravity = normal_gravity(site.latitude, o.height_m);
  site.gravity_sigma = o.gravity_sigma;
  const CalibrationValues truth = simulation::draw_truth(settings, rig.rig, site, rig.rig.mounts);

  std::error_code error;
  fs::create_directories(o.output, error);
  if (error) throw Error(ExitCode::kInput, o.output + ": cannot make the folder: " + error.message());
  const fs::path folder(o.output);
  ProgressLine progress;
  std::string run = "format: trunnion-run/1\n";
  run += "site:  {latitude_deg: " + figure(o.latitude_deg, 12) + ", height_m: " + figure(o.height_m, 12) +
         ", gravity_m_s2: " + figure(site.gravity, 12) + ", gravity_sigma_m_s2: " + figure(o.gravity_sigma, 6) + "}\n";
  run += "rig:   rig.urdf\n";
  if (!o.no_sheet) run += "sheet: sheet.yaml\n";
  run += "serial: \"simulated, seed " + std::to_string(o.seed) + "\"\nrecordings:\n";
  for (int m = 0; m < rig.rig.mounts; ++m) {
    const std::string name = "position_" + std::to_string(m + 1) + ".lcm";
    progress.show("simulating " + name);
    io::LcmLogWriter log((folder / name).string());
    std::string message;
    ImuMessages imu(o.batch, log);
    simulation::TableSinks sinks;
    sinks.imu = [&](std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample) {
      imu.add(utime, sequence, sample);
    };
    sinks.encoder = [&](std::int64_t utime, std::int64_t sequence, double azimuth, double pitch) {
      io::encode_encoder(utime, sequence, azimuth, pitch, message);
      log.write(utime, "ENCODER", message);
    };
    const simulation::TableMotion motion = o.rest_only ? simulation::rest_only(rig.pitch_lower, rig.pitch_upper)
                                                       : simulation::experiment(rig.pitch_lower, rig.pitch_upper, m);
    simulation::run_table(settings, truth, rig.rig, site, motion, m, m, sinks);
    imu.finish();
    log.commit();
    run += "  - {mount: " + rig.mounts[static_cast<std::size_t>(m)] + ", log: " + name + "}\n";
  }

  io::CalibrationFile file;
  file.model = sheet.model;
  file.serial = "simulated, seed " + std::to_string(o.seed);
  file.record.value = truth;
  file.record.has_rig = true;
  file.record.mounts = rig.rig.mounts;
  file.record.recordings = rig.rig.mounts;
  for (int m = 0; m < rig.rig.mounts; ++m) file.record.recording_mount[static_cast<std::size_t>(m)] = m;
  file.mounts = rig.mounts;
  file.gauge = {"pitch_encoder_zero", rig.mounts.front() + "_datum"};
  file.tool = tool_name() + " simulate";
  file.run = "run.yaml";
  file.seed = static_cast<long long>(o.seed);
  io::write_whole((folder / "truth.yaml").string(), io::to_yaml(file));
  io::write_whole((folder / "rig.urdf").string(), io::read_whole(o.rig));
  io::write_whole((folder / "sheet.yaml").string(), io::read_whole(o.sheet));
  io::write_whole((folder / "run.yaml").string(), run);
}

}  // namespace

void add_simulate(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("simulate", "Record a simulated run: logs, run file, sheet, rig, and the truth");
  auto o = std::make_shared<Options>();
  command->add_option("-o,--output", o->output, "Folder to write, made if it is not there")->required();
  command->add_option("--seed", o->seed, "Of every random number")
      ->capture_default_str()
      ->check(CLI::Range(0, 2147483647));
  command->add_option("--sheet", o->sheet, "Sensor sheet of the unit");
  command->add_option("--rig", o->rig, "URDF of the table");
  command->add_option("--latitude-deg", o->latitude_deg, "Of the bench")
      ->capture_default_str()
      ->check(CLI::Range(-90.0, 90.0));
  command->add_option("--height-m", o->height_m, "Of the bench")
      ->capture_default_str()
      ->check(CLI::Range(-500.0, 10000.0));
  command->add_option("--gravity-sigma-m-s2", o->gravity_sigma, "How well gravity is known there")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--outliers-percent", o->outliers_percent, "Samples off by 1 rad/s and 5 m/s^2")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--dropped-percent", o->dropped_percent, "Samples that are lost")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 99.0));
  command->add_option("--batch", o->batch, "Samples a message: imu_t, or imu_batch_t")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_flag("--noise-free", o->noise_free, "No noise, no wander, exact encoders");
  command->add_flag("--rest-only", o->rest_only, "The table never turns: a run that cannot be solved");
  command->add_flag("--no-sheet", o->no_sheet, "Leave the sheet out of the run file");
  command->footer("Example:\n  imu_calibrate simulate --seed 7 -o run7 && imu_calibrate solve run7/run.yaml");
  command->callback([o, &exit_code] {
    simulate(*o);
    std::printf("%s\n", (fs::path(o->output) / "run.yaml").string().c_str());
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
