// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "result.hpp"
#include "trunnion/calibration/verification.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/urdf.hpp"
#include "trunnion/io/whole_file.hpp"
#include "trunnion/positions/entry.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string calibration;
  std::string run;
  std::string output;
  double most_times_floor = 2.0;
  double most_sigmas = 5.0;
  std::string format = "text";
};

/// Place of a mount of the recording among those of the calibration.
std::size_t mount_in(const io::CalibrationFile& file, const std::string& path, const std::string& mount) {
  const auto at = std::find(file.mounts.begin(), file.mounts.end(), mount);
  if (at == file.mounts.end())
    throw Error(ExitCode::kInput, path + ": knows nothing of mount '" + mount + "': its own error there was not found");
  return static_cast<std::size_t>(at - file.mounts.begin());
}

ExitCode verify(const Options& o) {
  const io::CalibrationFile file = io::read_calibration_file(o.calibration);
  const io::RunFile run = io::read_run_file(o.run);
  if (run.rig.empty()) throw Error(ExitCode::kInput, o.run + ": a verification needs a rig with encoders");
  if (!file.record.has_rig)
    throw Error(ExitCode::kInput,
                o.calibration + ": was made by hand: it knows nothing of the table to hold it against");
  if (!run.sheet.has_noise)
    throw Error(ExitCode::kInput, o.run + ": a verification needs a sheet that states the noise: its floor");
  check_outputs({o.output}, files_of(run));
  check_outputs({o.output}, {o.calibration});
  const io::RigFile rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, file.mounts);
  if (!file.serial.empty() && !run.serial.empty() && file.serial != run.serial)
    throw Error(ExitCode::kInput,
                o.run + ": is of unit '" + run.serial + "', the calibration of '" + file.serial + "'");
  nlohmann::ordered_json tree;
  tree["format"] = "trunnion-verification/1";
  std::string csv = "recording,t_s";
  static constexpr std::array<const char*, 6> kAxis = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};
  for (const char* const when : {"before", "after"}) {
    for (std::size_t axis = 0; axis < 6; ++axis)
      csv += std::string(",") + kAxis[axis] + "_" + when + (axis < 3 ? "_deg_s" : "_m_s2");
  }
  csv += "\n";
  double worst = 0.0;
  int told = 0;
  std::vector<std::string> beyond;
  for (std::size_t r = 0; r < run.recordings.size(); ++r) {
    const io::RecordingFiles& files = run.recordings[r];
    const std::size_t mount = mount_in(file, o.calibration, files.mount);
    BeforeAndAfter both(compress_options(run, files), file.record.value.unit);
    {
      ProgressLine progress;
      std::vector<std::pair<std::string, std::string>> digests;
      io::read_recording(run, files, both, digests, [&](double fraction) {
        progress.show("reading " + files.name() + " " + std::to_string(static_cast<int>(100.0 * fraction)) + " %");
      });
      both.say_what_is_missing(file.record.value.unit, files.name());
      for (const auto& [path, digest] : digests) {
        for (const auto& [used, used_digest] : file.inputs) {
          if (digest == used_digest)
            throw Error(ExitCode::kInput, path + ": is " + used +
                                              " of the calibration itself: a verification needs data that "
                                              "were not used");
        }
      }
    }
    const calibration::Verification v =
        calibration::verify(both.before.finish(), both.after.finish(), static_cast<int>(mount), file.record.value,
                            rig.rig, run.site, run.sheet.noise);
    nlohmann::ordered_json one = {
        {"recording", files.name()}, {"mount", files.mount}, {"windows", v.windows}, {"window_s", v.window}};
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const calibration::AxisVerification& a = v.axis[axis];
      const double unit = axis < 3 ? kRadPerDeg : 1e3 * kMetresPerS2PerMicroG;
      one["axes"].push_back({{"axis", kAxis[axis]},
                             {"unit", axis < 3 ? "deg/s" : "mg"},
                             {"mean_before", a.mean_before / unit},
                             {"sd_before", a.before / unit},
                             {"mean_after", a.mean_after / unit},
                             {"sd_after", a.after / unit},
                             {"floor", a.floor / unit},
                             {"times_floor", a.after / a.floor}});
      worst = std::max(worst, a.after / a.floor);
    }
    for (std::size_t triad = 0; triad < 2; ++triad) {
      const Mat3<double>& of_calibration = triad == 0 ? file.record.sigma.unit.gyro.M : file.record.sigma.unit.accel.M;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const Entry kind = i == j ? (triad == 0 ? Entry::kGyroScale : Entry::kAccelScale)
                                    : (triad == 0 ? Entry::kGyroCrossCoupling : Entry::kAccelCrossCoupling);
          const EntryKind& k = kind_of(kind);
          if (!(v.left_sigma[triad](i, j) < run.refuse_above[static_cast<std::size_t>(kind)] * k.si)) continue;
          const double sigma = std::hypot(v.left_sigma[triad](i, j), of_calibration(i, j));
          const std::string sensor = triad == 0 ? "gyro " : "accelerometer ";
          const std::string name =
              i == j ? sensor + "xyz"[i] + " scale" : sensor + "xyz"[j] + " cross-coupling into " + "xyz"[i];
          one["left"].push_back({{"entry", name},
                                 {"value", v.left[triad](i, j) / k.si},
                                 {"sigma", sigma / k.si},
                                 {"unit", k.unit},
                                 {"sigmas", v.left[triad](i, j) / sigma}});
          ++told;
          if (!(std::abs(v.left[triad](i, j)) <= o.most_sigmas * sigma))
            beyond.push_back(files.mount + ": " + name + " " + figure(v.left[triad](i, j) / k.si, 3) + " " + k.unit +
                             ", " + figure(v.left[triad](i, j) / sigma, 2) + " sigmas");
        }
      }
    }
    tree["recordings"].push_back(one);
    for (const auto& row : v.course) {
      csv += std::to_string(r + 1);
      for (std::size_t i = 0; i < row.size(); ++i) {
        const bool gyro = (i >= 1 && i <= 3) || (i >= 7 && i <= 9);
        csv += "," + figure(gyro ? row[i] / kRadPerDeg : row[i], 9);
      }
      csv += "\n";
    }
  }
  tree["worst_times_floor"] = worst;
  tree["limit_times_floor"] = o.most_times_floor;
  tree["limit_sigmas"] = o.most_sigmas;
  tree["beyond"] = beyond;
  const bool within = worst <= o.most_times_floor && beyond.empty() && told > 0;
  tree["verdict"] = told == 0 ? "not_told" : within ? "within_limits" : "out_of_limits";
  if (!o.output.empty()) io::write_whole(o.output, csv);
  if (o.format == "json") {
    std::printf("%s", json_text(tree).c_str());
  } else {
    for (const auto& one : tree["recordings"]) {
      std::printf(
          "%s in %s, %lld windows of %s s: output minus what the table does\n%-8s %-6s %12s %12s %12s %12s %12s %7s\n",
          one["recording"].get<std::string>().c_str(), one["mount"].get<std::string>().c_str(),
          one["windows"].get<long long>(), figure(one["window_s"].get<double>(), 3).c_str(), "axis", "unit",
          "mean before", "sd before", "mean after", "sd after", "floor", "times");
      for (const auto& a : one["axes"]) {
        std::printf("%-8s %-6s", a["axis"].get<std::string>().c_str(), a["unit"].get<std::string>().c_str());
        for (const char* const name : {"mean_before", "sd_before", "mean_after", "sd_after", "floor"})
          std::printf(" %12s", figure(a[name].get<double>(), 4).c_str());
        std::printf(" %7s\n", figure(a["times_floor"].get<double>(), 3).c_str());
      }
    }
    std::printf("what is left of the matrices on these data, in sigmas of both: %d entries told, %zu beyond %s\n", told,
                beyond.size(), figure(o.most_sigmas, 3).c_str());
    for (const std::string& one : beyond) std::printf("  %s\n", one.c_str());
    std::printf("verdict: %s, worst standard deviation %s times its floor, limit %s\n",
                told == 0 ? "not told"
                : within  ? "within limits"
                          : "out of limits",
                figure(worst, 3).c_str(), figure(o.most_times_floor, 3).c_str());
  }
  if (told == 0) {
    std::fprintf(stderr,
                 "unobservable: these recordings turn too little to hold a scale or a cross-coupling against them\n");
    return ExitCode::kNumerics;
  }
  return within ? ExitCode::kDone : ExitCode::kOutOfLimits;
}

}  // namespace

void add_verify(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand(
      "verify",
      "Hold a calibration against recordings that it has not seen: output minus the table's rate, before and after");
  auto o = std::make_shared<Options>();
  command->add_option("calibration", o->calibration, "Calibration file of a table run")->required();
  command->add_option("run", o->run, "Run file of the other recordings")->required();
  command->add_option("-o,--output", o->output, "CSV of the differences to write, window by window");
  command
      ->add_option("--most-times-floor", o->most_times_floor,
                   "Verdict: the largest standard deviation after, over what noise and wander leave")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--most-sigmas", o->most_sigmas,
          "Verdict: the largest scale or cross-coupling that is left, in sigmas of the calibration and of these data")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--format", o->format, "Of the result on standard output")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->footer(
      "Example:\n  imu_calibrate verify calibration.yaml another/run.yaml\nThe turn-on bias is another one each time: "
      "it shows "
      "in the means, not in the deviations.");
  command->callback([o, &exit_code] { exit_code = verify(*o); });
}

}  // namespace trunnion::app
