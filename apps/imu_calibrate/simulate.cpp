// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <filesystem>
#include <memory>

#include "../terminal.hpp"
#include "command.hpp"
#include "result.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"
#include "trunnion/simulation/table_run.hpp"

namespace trunnion::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeedOfRepeat = 1000000007;  // of the noise

struct Options {
  std::string run;
  std::string output;
  std::string sheet = shared_file("3dm-cv7.yaml");
  std::string rig = shared_file("two_axis_table.urdf");
  std::uint64_t seed = 1;
  double latitude_deg = 43.88;
  double height_m = 220.0;
  double gravity_sigma = 1e-5;
  double outliers_percent = 0.0;
  double dropped_percent = 0.0;
  int thermal_order = 3;
  double asymmetry_ppm = 0.0;
  double places_mm = 0.0;
  int batch = 1;
  int repeat = 0;
  bool noise_free = false;
  bool rest_only = false;
  bool no_sheet = false;
};

/// Samples into messages of one, or of several.
class ImuMessages {
 public:
  ImuMessages(int batch, io::LcmLogWriter& log) : batch_(static_cast<std::size_t>(batch)), log_(log) {}
  void temperature(double celsius) { celsius_ = celsius; }
  void add(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample) {
    if (batch_ == 1) {
      io::encode_imu(utime, sequence, sample, message_, celsius_);
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
    io::encode_imu_batch(first_, utime_, samples_, message_, celsius_);
    log_.write(utime_.back(), "IMU", message_);
    utime_.clear();
    samples_.clear();
  }

 private:
  std::size_t batch_;
  io::LcmLogWriter& log_;
  double celsius_ = std::numeric_limits<double>::quiet_NaN();
  std::int64_t first_ = 0;
  std::vector<std::int64_t> utime_;
  std::vector<InertialSample<double>> samples_;
  std::string message_;
};

/// What is simulated: a bench, a unit, and the moves of each recording.
struct Bench {
  io::SensorSheet sheet;
  io::RigFile rig;
  Site site;
  io::TableMoves moves;
  Soak soak;
  std::vector<int> mount;         // of each recording
  std::vector<std::string> logs;  // names within the folder
  std::string serial;
  std::vector<std::pair<std::string, std::string>> copies;  // file, and its name within the folder
};

Bench bench_of_options(const Options& o, std::string& run) {
  Bench bench;
  bench.sheet = io::read_sensor_sheet(o.sheet);
  bench.rig = io::read_rig(o.rig, "azimuth", "pitch");
  const AxisLimits& pitch = bench.rig.limits[kPitch];
  if (pitch.endless())
    throw Error(ExitCode::kInput, o.rig +
                                      ": joint 'pitch' has no limits to plan the swings by: write a plan, and "
                                      "simulate its run file");
  bench.site.latitude = o.latitude_deg * kRadPerDeg;
  bench.site.gravity = normal_gravity(bench.site.latitude, o.height_m);
  bench.site.gravity_sigma = o.gravity_sigma;
  bench.serial = "simulated, seed " + std::to_string(o.seed);
  bench.copies = {{o.rig, "rig.urdf"}, {o.sheet, "sheet.yaml"}};
  run = "format: trunnion-run/1\n";
  run += "site:  {latitude_deg: " + figure(o.latitude_deg, 12) + ", height_m: " + figure(o.height_m, 12) +
         ", gravity_m_s2: " + figure(bench.site.gravity, 12) + ", gravity_sigma_m_s2: " + figure(o.gravity_sigma, 6) +
         "}\n";
  run += "rig:   rig.urdf\n";
  if (!o.no_sheet) run += "sheet: sheet.yaml\n";
  run += "serial: \"" + bench.serial + "\"\nrecordings:\n";
  for (int m = 0; m < bench.rig.rig.mounts; ++m) {
    bench.moves.push_back(o.rest_only ? simulation::rest_only(pitch.lowest, pitch.highest)
                                      : simulation::experiment(pitch.lowest, pitch.highest, m));
    simulation::check_limits(bench.moves.back(), bench.rig.limits,
                             o.rig + ": the moves in " + bench.rig.mounts[static_cast<std::size_t>(m)]);
    bench.mount.push_back(m);
    bench.logs.push_back("position_" + std::to_string(m + 1) + ".lcm");
    run += "  - {mount: " + bench.rig.mounts[static_cast<std::size_t>(m)] + ", log: " + bench.logs.back() + "}\n";
  }
  return bench;
}

/// Of a run file with moves, as `plan` writes it: its files lie beside it, its logs are the ones to be made.
Bench bench_of_run(const std::string& path, std::string& text) {
  const io::RunFile run = io::read_run_file(path);
  if (run.rig.empty() || run.moves.empty() || run.sheet_path.empty())
    throw Error(ExitCode::kInput, path + ": to be simulated, a run needs a rig, a sheet and moves");
  Bench bench;
  bench.sheet = run.sheet;
  const std::vector<std::string> mounts = mounts_of(run);
  bench.rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, mounts);
  bench.site = run.site;
  bench.moves = io::read_table_moves(run.moves, run.recordings.size());
  bench.serial = run.serial;
  bench.soak = run.soak;
  const fs::path folder = fs::path(path).parent_path();
  const auto beside = [&](const std::string& file) {
    std::string name = fs::path(file).lexically_relative(folder.empty() ? fs::path(".") : folder).string();
    if (name.empty() || name.rfind("..", 0) == 0)
      throw Error(ExitCode::kInput, path + ": to be simulated, a run has its files in its own folder, not " + file);
    return name;
  };
  for (const std::string& file : {run.rig, run.sheet_path, run.moves}) bench.copies.emplace_back(file, beside(file));
  for (std::size_t r = 0; r < run.recordings.size(); ++r) {
    const io::RecordingFiles& files = run.recordings[r];
    if (files.log.empty())
      throw Error(ExitCode::kInput, path + ": to be simulated, a recording has one LCM log: " + files.name());
    bench.logs.push_back(beside(files.log));
    bench.mount.push_back(static_cast<int>(std::find(mounts.begin(), mounts.end(), files.mount) - mounts.begin()));
    simulation::check_limits(bench.moves[r], bench.rig.limits, run.moves + ": recording " + std::to_string(r + 1));
  }
  text = io::read_whole(path);
  return bench;
}

/// The turn-on biases of the run that is repeated for the @p repeat -th time; unit and table are as they were.
CalibrationValues repeated(CalibrationValues truth, int recordings, int repeat) {
  truth.unit.gyro.bias.setZero();
  truth.unit.accel.bias.setZero();
  for (int r = 0; r < recordings; ++r) {
    const InertialSample<double> bias = truth.recording_bias[static_cast<std::size_t>(r + repeat * recordings)];
    truth.recording_bias[static_cast<std::size_t>(r)] = bias;
    truth.unit.gyro.bias += bias.w / recordings;
    truth.unit.accel.bias += bias.f / recordings;
  }
  return truth;
}

void simulate(const Options& o) {
  std::string run;
  const Bench bench = o.run.empty() ? bench_of_options(o, run) : bench_of_run(o.run, run);
  simulation::TableRunSettings settings;
  settings.seed = o.seed;
  if (bench.sheet.rate_hz > 0.0) settings.rate = bench.sheet.rate_hz;
  if (bench.sheet.has_noise) settings.noise = bench.sheet.noise;
  settings.soak = bench.soak;
  settings.thermal_order = o.thermal_order;
  settings.gyro_asymmetry = settings.accel_asymmetry = 1e-6 * o.asymmetry_ppm;
  settings.accel_place = 1e-3 * o.places_mm;
  settings.outlier_fraction = 0.01 * o.outliers_percent;
  settings.dropped_fraction = 0.01 * o.dropped_percent;
  if (o.noise_free) settings = settings.noise_free();
  const auto recordings = static_cast<int>(bench.logs.size());
  if (recordings * (o.repeat + 1) > kMaxRecordings)
    throw Error(ExitCode::kUsage, "--repeat " + std::to_string(o.repeat) + ": the unit is powered on for " +
                                      std::to_string(kMaxRecordings) + " recordings at most");
  const CalibrationValues truth = repeated(
      simulation::draw_truth(settings, bench.rig.rig, bench.site, recordings * (o.repeat + 1)), recordings, o.repeat);
  settings.seed += kSeedOfRepeat * static_cast<std::uint64_t>(o.repeat);

  std::error_code error;
  fs::create_directories(o.output, error);
  if (error) throw Error(ExitCode::kInput, o.output + ": cannot make the folder: " + error.message());
  const fs::path folder(o.output);
  for (const std::string& log : bench.logs) {
    if (fs::exists(folder / log) && !fs::exists(folder / "truth.yaml"))
      throw Error(ExitCode::kUsage,
                  (folder / log).string() + ": is there, and no simulation made it: choose another folder");
  }
  ProgressLine progress;
  for (std::size_t r = 0; r < bench.logs.size(); ++r) {
    progress.show("simulating " + bench.logs[r]);
    io::LcmLogWriter log((folder / bench.logs[r]).string());
    std::string message;
    ImuMessages imu(o.batch, log);
    simulation::TableSinks sinks;
    sinks.imu = [&](std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample) {
      imu.add(utime, sequence, sample);
    };
    sinks.temperature = [&](double celsius) { imu.temperature(celsius); };
    sinks.encoder = [&](std::int64_t utime, std::int64_t sequence, double azimuth, double pitch) {
      io::encode_encoder(utime, sequence, azimuth, pitch, message);
      log.write(utime, "ENCODER", message);
    };
    const simulation::TableMotion motion = simulation::motion_of(bench.moves[r], bench.rig.limits);
    simulation::run_table(settings, truth, bench.rig.rig, bench.site, motion, bench.mount[r], static_cast<int>(r),
                          sinks);
    imu.finish();
    log.commit();
  }

  io::CalibrationFile file;
  file.model = bench.sheet.model;
  file.serial = bench.serial;
  file.record.value = truth;
  file.record.has_rig = true;
  file.record.mounts = bench.rig.rig.mounts;
  file.record.recordings = recordings;
  for (std::size_t r = 0; r < bench.mount.size(); ++r) file.record.recording_mount[r] = bench.mount[r];
  file.mounts = bench.rig.mounts;
  file.gauge = {"pitch_encoder_zero", bench.rig.mounts.front() + "_datum"};
  file.tool = tool_name() + " simulate";
  file.run = "run.yaml";
  file.seed = static_cast<long long>(o.seed);
  io::write_whole((folder / "truth.yaml").string(), io::to_yaml(file));
  for (const auto& [from, name] : bench.copies) {
    std::error_code same;
    if (!fs::equivalent(from, folder / name, same)) io::write_whole((folder / name).string(), io::read_whole(from));
  }
  io::write_whole((folder / "run.yaml").string(), run);
}

}  // namespace

void add_simulate(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("simulate", "Record a simulated run: logs, run file, sheet, rig, and the truth");
  auto o = std::make_shared<Options>();
  command->add_option("-o,--output", o->output, "Folder to write, made if it is not there")->required();
  CLI::Option* run = command->add_option(
      "run", o->run, "Run file with moves, as plan writes it; without one, the experiment in every mount of the rig");
  command->add_option("--seed", o->seed, "Of every random number")
      ->capture_default_str()
      ->check(CLI::Range(0, 2147483647));
  command->add_option("--sheet", o->sheet, "Sensor sheet of the unit")->excludes(run);
  command->add_option("--rig", o->rig, "URDF of the table")->excludes(run);
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
  command->add_option("--outliers-percent", o->outliers_percent, "Samples off by 1 rad/s and 5 m/s^2")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  command->add_option("--dropped-percent", o->dropped_percent, "Samples that are lost")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 99.0));
  command->add_option("--thermal-order", o->thermal_order, "Of a run with a soak: of biases and scales in temperature")
      ->capture_default_str()
      ->check(CLI::Range(1, ThermalErrors<double>::kMostOrder))
      ->needs(run);
  command->add_option("--asymmetry-ppm", o->asymmetry_ppm, "1 sigma of every sensor's")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e5));
  command->add_option("--places-mm", o->places_mm, "1 sigma of where accelerometers y and z sit, off x")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--batch", o->batch, "Samples a message: imu_t, or imu_batch_t")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--repeat", o->repeat,
                   "The run again, for the n-th time: the same unit and table, other turn-on biases and noise")
      ->capture_default_str()
      ->check(CLI::Range(0, kMaxRecordings));
  command->add_flag("--noise-free", o->noise_free, "No noise, no wander, exact encoders");
  command->add_flag("--rest-only", o->rest_only, "The table never turns: a run that cannot be solved")->excludes(run);
  command->add_flag("--no-sheet", o->no_sheet, "Leave the sheet out of the run file")->excludes(run);
  command->footer("Example:\n  imu_calibrate simulate --seed 7 -o run7 && imu_calibrate solve run7/run.yaml");
  command->callback([o, &exit_code] {
    simulate(*o);
    std::printf("%s\n", (fs::path(o->output) / "run.yaml").string().c_str());
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
