// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "trunnion/calibration/allan_deviation.hpp"
#include "trunnion/calibration/channel.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr std::size_t kFewest = 1000;  // samples
constexpr double kMostMissing = 0.01;  // of the samples
constexpr double kTurningRate = 0.02;  // rad/s, of the mean over a second against that over all: no rest
constexpr std::array<const char*, 6> kAxis = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};

struct Options {
  std::string input;
  std::string output;
  std::string sheet;
  std::string model = "unit";
  std::string channel;
  int of_run = 0;
  std::string format = "text";
};

/// Readings at equal steps: what is missing stands between its neighbours.
class EvenSamples final : public SampleSink {
 public:
  explicit EvenSamples(std::string name) : name_(std::move(name)) {}

  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    const ChannelClock::Verdict verdict = calibration::judge_and_count(clock_, utime, name_, "IMU", figures_);
    if (verdict == ChannelClock::Verdict::kNextAndFirstWasStray) {
      stamps_.clear();
      for (auto& axis : readings_) axis.clear();
    } else if (verdict != ChannelClock::Verdict::kNext) {
      return;
    }
    stamps_.push_back(utime);
    for (std::size_t i = 0; i < 3; ++i) {
      readings_[i].push_back(sample.w(static_cast<int>(i)));
      readings_[i + 3].push_back(sample.f(static_cast<int>(i)));
    }
  }
  void encoder(std::int64_t, double, double) override {}

  /// @throws Error (input) for a recording that is short, has holes, or was not at rest
  void finish() {
    if (stamps_.size() < kFewest)
      throw Error(ExitCode::kInput, name_ + ": " + std::to_string(stamps_.size()) +
                                        " usable samples: an Allan deviation needs a thousand at least, and hours");
    std::vector<double> steps(stamps_.size() - 1);
    for (std::size_t k = 0; k + 1 < stamps_.size(); ++k)
      steps[k] = 1e-6 * static_cast<double>(stamps_[k + 1] - stamps_[k]);
    std::vector<double> sorted = steps;
    period_ = calibration::sample_period(sorted, name_);
    std::vector<std::size_t> holes(steps.size(), 0);
    std::size_t missing = 0;
    // stamps jitter: a hole is judged against where the samples should be by now
    for (std::size_t k = 0; k < steps.size(); ++k) {
      if (steps[k] < 1.5 * period_) continue;
      holes[k] = static_cast<std::size_t>(std::lround(steps[k] / period_)) - 1;
      missing += holes[k];
    }
    if (static_cast<double>(missing) > kMostMissing * static_cast<double>(stamps_.size()))
      throw Error(ExitCode::kInput, name_ + ": " + std::to_string(missing) + " samples are missing among " +
                                        std::to_string(stamps_.size()) + ": too many to fill in");
    missing_ = missing;
    if (missing > 0) {
      for (auto& axis : readings_) axis = filled(axis, holes, missing);
    }
    check_rest();
  }

  [[nodiscard]] const std::vector<double>& readings(std::size_t axis) const { return readings_[axis]; }
  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] std::size_t missing() const { return missing_; }

 private:
  static std::vector<double> filled(const std::vector<double>& axis, const std::vector<std::size_t>& holes,
                                    std::size_t missing) {
    std::vector<double> all;
    all.reserve(axis.size() + missing);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      all.push_back(axis[k]);
      for (std::size_t h = 1; k < holes.size() && h <= holes[k]; ++h) {
        const double share = static_cast<double>(h) / static_cast<double>(holes[k] + 1);
        all.push_back(axis[k] + share * (axis[k + 1] - axis[k]));
      }
    }
    return all;
  }
  void check_rest() const {
    const auto second = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / period_)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<double>& w = readings_[axis];
      double whole = 0.0;
      for (const double reading : w) whole += reading;
      whole /= static_cast<double>(w.size());
      for (std::size_t from = 0; from + second <= w.size(); from += second) {
        double mean = 0.0;
        for (std::size_t k = from; k < from + second; ++k) mean += w[k];
        mean /= static_cast<double>(second);
        if (std::abs(mean - whole) > kTurningRate)
          throw Error(ExitCode::kInput, name_ + ": " + kAxis[axis] + " turns by " +
                                            figure((mean - whole) / kRadPerDeg, 3) + " deg/s at " +
                                            figure(static_cast<double>(from) * period_, 6) +
                                            " s: an Allan deviation is of a unit at rest");
      }
    }
  }

  std::string name_;
  ChannelClock clock_;
  calibration::RecordingFigures figures_;
  std::vector<std::int64_t> stamps_;
  std::array<std::vector<double>, 6> readings_;
  double period_ = 0.0;
  std::size_t missing_ = 0;
};

/// As data sheets state it.
struct Unit {
  const char* name;
  double si;
};
constexpr Unit kGyroUnit = {"deg/h", kRadPerSPerDegPerH};
constexpr Unit kAccelUnit = {"ug", kMetresPerS2PerMicroG};

TriadNoise rms(const std::array<TriadNoise, 6>& axis, std::size_t from) {
  TriadNoise mean;
  double logarithm = 0.0;
  int wandering = 0;
  for (std::size_t i = from; i < from + 3; ++i) {
    mean.density += axis[i].density * axis[i].density / 3.0;
    mean.wander += axis[i].wander * axis[i].wander / 3.0;
    if (axis[i].wander > 0.0) {
      logarithm += std::log(axis[i].wander_correlation_time);
      ++wandering;
    }
  }
  return {std::sqrt(mean.density), std::sqrt(mean.wander), wandering > 0 ? std::exp(logarithm / wandering) : 1.0};
}

std::string sheet_text(const Options& o, const std::array<TriadNoise, 6>& axis, double period) {
  const TriadNoise gyro = rms(axis, 0);
  const TriadNoise accel = rms(axis, 3);
  const auto triad = [](const TriadNoise& noise, const char* density, const char* wander, const Unit& unit) {
    return std::string("{") + density + ": " + figure(noise.density / unit.si, 5) + ", " + wander + ": " +
           figure(noise.wander / unit.si, 5) +
           ", bias_correlation_time_s: " + figure(noise.wander_correlation_time, 4) + "}\n";
  };
  // a string of JSON is one of YAML, whatever it holds
  return "format: trunnion-sheet/1\nmodel: " +
         nlohmann::json(o.model).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) +
         "\nrate_hz: " + figure(1.0 / period, 8) +
         "\ngyroscope:     " + triad(gyro, "noise_deg_per_h_per_rt_hz", "bias_instability_deg_per_h", kGyroUnit) +
         "accelerometer: " + triad(accel, "noise_ug_per_rt_hz", "bias_instability_ug", kAccelUnit);
}

void allan(const Options& o) {
  const auto [run, files] = one_recording(o.input, o.channel, o.of_run);
  check_outputs({o.output, o.sheet}, files_of(run));
  check_outputs({o.output, o.sheet}, {o.input});
  EvenSamples samples(files.name());
  {
    ProgressLine progress;
    std::vector<std::pair<std::string, std::string>> digests;
    io::RecordingFiles unit_only = files;
    unit_only.mount.clear();  // encoders are not asked for
    unit_only.encoder.clear();
    io::read_recording(run, unit_only, samples, digests, [&](double fraction) {
      progress.show("reading " + std::to_string(static_cast<int>(100.0 * fraction)) + " %");
    });
    samples.finish();
  }
  nlohmann::ordered_json tree;
  tree["format"] = "trunnion-allan/1";
  tree["samples"] = samples.readings(0).size();
  tree["filled_in"] = samples.missing();
  tree["period_s"] = samples.period();
  std::string csv = "axis,tau_s,deviation,low,high,degrees_of_freedom,unit\n";
  std::array<TriadNoise, 6> noise;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const Unit& unit = axis < 3 ? kGyroUnit : kAccelUnit;
    const std::vector<calibration::AllanPoint> curve =
        calibration::allan_deviation(samples.readings(axis), samples.period());
    const calibration::NoiseTerms terms = calibration::fit_noise_terms(curve);
    noise[axis] = calibration::fit_sheet_noise(curve);
    if (!o.sheet.empty() && !(noise[axis].density > 0.0))
      throw Error(ExitCode::kInput,
                  o.input + ": " + kAxis[axis] + " shows no white noise: it is stuck, and there is no sheet of it");
    nlohmann::ordered_json one;
    one["axis"] = kAxis[axis];
    one["unit"] = unit.name;
    one["quantisation"] = terms.quantisation / unit.si;
    one["white"] = terms.white / unit.si;
    one["bias_instability"] = terms.bias_instability / unit.si;
    one["rate_random_walk"] = terms.rate_random_walk / unit.si;
    one["ramp"] = terms.ramp / unit.si;
    one["wander"] = noise[axis].wander / unit.si;
    one["correlation_time_s"] = noise[axis].wander_correlation_time;
    for (const calibration::AllanPoint& point : curve) {
      one["curve"].push_back({{"tau_s", point.tau},
                              {"deviation", point.deviation / unit.si},
                              {"low", point.low / unit.si},
                              {"high", point.high / unit.si},
                              {"degrees_of_freedom", point.freedom}});
      csv += std::string(kAxis[axis]) + "," + figure(point.tau, 10) + "," + figure(point.deviation / unit.si, 10) +
             "," + figure(point.low / unit.si, 6) + "," + figure(point.high / unit.si, 6) + "," +
             figure(point.freedom, 6) + "," + unit.name + "\n";
    }
    tree["axes"].push_back(one);
  }
  if (!o.output.empty()) io::write_whole(o.output, csv);
  if (!o.sheet.empty()) io::write_whole(o.sheet, sheet_text(o, noise, samples.period()));
  if (o.format == "json") {
    std::printf("%s\n", json_text(tree).c_str());
    return;
  }
  std::printf("%zu samples of %s s", samples.readings(0).size(), figure(samples.period(), 6).c_str());
  std::printf(samples.missing() > 0 ? ", %zu of them filled in\n" : "\n", samples.missing());
  std::printf("%-8s %-6s %12s %12s %12s %12s %12s %12s %8s\n", "axis", "unit", "quantisation", "white /rtHz",
              "instability", "walk /rt s", "ramp /s", "wander", "tau s");
  for (const auto& one : tree["axes"]) {
    std::printf("%-8s %-6s", one["axis"].get<std::string>().c_str(), one["unit"].get<std::string>().c_str());
    for (const char* term : {"quantisation", "white", "bias_instability", "rate_random_walk", "ramp", "wander"})
      std::printf(" %12s", figure(one[term].get<double>(), 4).c_str());
    std::printf(" %8s\n", figure(one["correlation_time_s"].get<double>(), 3).c_str());
  }
}

}  // namespace

void add_allan(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("allan", "Noise of a unit at rest: Allan deviation, its terms, and a sensor sheet");
  auto o = std::make_shared<Options>();
  command
      ->add_option("input", o->input,
                   "A log of any format that is read, or the run file of a recording, of a unit that lay still")
      ->required();
  command->add_option("-o,--output", o->output, "CSV of the curves to write, with 1 sigma limits");
  command->add_option("--sheet", o->sheet, "Sensor sheet to write: white noise and Gauss-Markov wander");
  command->add_option("--model", o->model, "Name of the unit in the sheet")->capture_default_str();
  command->add_option("--channel", o->channel, "IMU channel of the log; default IMU");
  command->add_option("--of-run", o->of_run, "Of a run file with several: the recording, from 1")
      ->check(CLI::Range(1, 1000));
  command->add_option("--format", o->format, "Of the result on standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->footer("Example:\n  imu_calibrate allan night.lcm --sheet sheet.yaml -o allan.csv");
  command->callback([o, &exit_code] {
    allan(*o);
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
