// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "../terminal.hpp"
#include "command.hpp"
#include "compare_methods.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string first;
  std::string second;
  std::string methods;
  std::string format = "text";
  double most_sigmas = 5.0;
};

struct Difference {
  std::string entry;
  double first, second, sigma;
  std::string unit;
  [[nodiscard]] double sigmas() const { return (first - second) / sigma; }
};

/// Entries that at least one side estimated, in people's units.
std::vector<Difference> differences(const io::CalibrationFile& a, const io::CalibrationFile& b) {
  std::vector<Difference> all;
  const auto add = [&](const std::string& entry, double va, double vb, double sa, double sb, const char* unit,
                       double in_unit) {
    const double sigma = std::hypot(sa, sb);
    if (sigma > 0.0) all.push_back({entry, va * in_unit, vb * in_unit, sigma * in_unit, unit});
  };
  constexpr double kDegPerH = 1.0 / kRadPerSPerDegPerH;
  constexpr double kDeg = 1.0 / kRadPerDeg;
  constexpr double kMicroG = 1.0 / kMetresPerS2PerMicroG;
  constexpr const char* kName[3] = {"x", "y", "z"};
  const CalibrationValues& va = a.record.value;
  const CalibrationValues& sa = a.record.sigma;
  const CalibrationValues& vb = b.record.value;
  const CalibrationValues& sb = b.record.sigma;
  const auto vector = [&](const std::string& entry, const Vec3<double>& x, const Vec3<double>& y,
                          const Vec3<double>& sx, const Vec3<double>& sy, const char* unit, double in_unit) {
    for (int i = 0; i < 3; ++i) add(entry + " " + kName[i], x(i), y(i), sx(i), sy(i), unit, in_unit);
  };
  const auto matrix = [&](const std::string& sensor, const Mat3<double>& x, const Mat3<double>& y,
                          const Mat3<double>& sx, const Mat3<double>& sy) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const std::string entry =
            i == j ? sensor + " " + kName[i] + " scale" : sensor + " " + kName[j] + " cross-coupling into " + kName[i];
        add(entry, x(i, j), y(i, j), sx(i, j), sy(i, j), i == j ? "ppm" : "deg", i == j ? 1e6 : kDeg);
      }
    }
  };
  // about two temperatures, biases, scales and polynomials are of different things
  const bool same_reference = (va.unit.thermal.order() == 0 && vb.unit.thermal.order() == 0) ||
                              va.unit.thermal.reference == vb.unit.thermal.reference;
  if (!same_reference)
    std::fprintf(stderr, "biases, matrices and their polynomials are about %s and %s degC: they are not compared\n",
                 figure(va.unit.thermal.reference, 4).c_str(), figure(vb.unit.thermal.reference, 4).c_str());
  if (same_reference) matrix("gyro", va.unit.gyro.M, vb.unit.gyro.M, sa.unit.gyro.M, sb.unit.gyro.M);
  if (same_reference)
    vector("gyro bias", va.unit.gyro.bias, vb.unit.gyro.bias, sa.unit.gyro.bias, sb.unit.gyro.bias, "deg/h", kDegPerH);
  vector("gyro cubic", va.unit.gyro.cubic, vb.unit.gyro.cubic, sa.unit.gyro.cubic, sb.unit.gyro.cubic, "ppm/(rad/s)^2",
         1e6);
  for (int i = 0; i < 3; ++i) {
    vector(std::string("gyro ") + kName[i] + " g-sensitivity to", va.unit.g_sensitivity.row(i).transpose(),
           vb.unit.g_sensitivity.row(i).transpose(), sa.unit.g_sensitivity.row(i).transpose(),
           sb.unit.g_sensitivity.row(i).transpose(), "deg/h/g", kDegPerH * kStandardGravity);
  }
  if (same_reference) matrix("accelerometer", va.unit.accel.M, vb.unit.accel.M, sa.unit.accel.M, sb.unit.accel.M);
  if (same_reference)
    vector("accelerometer bias", va.unit.accel.bias, vb.unit.accel.bias, sa.unit.accel.bias, sb.unit.accel.bias, "ug",
           kMicroG);
  vector("accelerometer quadratic", va.unit.accel.quadratic, vb.unit.accel.quadratic, sa.unit.accel.quadratic,
         sb.unit.accel.quadratic, "ppm/(m/s^2)", 1e6);
  vector("gyro asymmetry", va.unit.gyro.asymmetry, vb.unit.gyro.asymmetry, sa.unit.gyro.asymmetry,
         sb.unit.gyro.asymmetry, "ppm", 1e6);
  vector("accelerometer asymmetry", va.unit.accel.asymmetry, vb.unit.accel.asymmetry, sa.unit.accel.asymmetry,
         sb.unit.accel.asymmetry, "ppm", 1e6);
  for (int i = 1; i < 3; ++i)
    vector(std::string("accelerometer ") + kName[i] + "'s place along", va.unit.accel_place.col(i),
           vb.unit.accel_place.col(i), sa.unit.accel_place.col(i), sb.unit.accel_place.col(i), "mm", 1e3);
  const auto thermal = [&](const char* entry, std::size_t k, ThermalErrors<double>::Orders ThermalErrors<double>::*of,
                           Vec3<double> InertialSample<double>::*sensor, const char* unit, double in_unit) {
    vector(std::string(entry) + " by temperature^" + std::to_string(k + 1), (va.unit.thermal.*of)[k].*sensor,
           (vb.unit.thermal.*of)[k].*sensor, (sa.unit.thermal.*of)[k].*sensor, (sb.unit.thermal.*of)[k].*sensor,
           (unit + std::string(k == 0 ? "/K" : "/K^" + std::to_string(k + 1))).c_str(), in_unit);
  };
  if (same_reference) {
    using Thermal = ThermalErrors<double>;
    for (std::size_t k = 0; k < Thermal::kMostOrder; ++k) {
      thermal("gyro bias", k, &Thermal::bias, &InertialSample<double>::w, "deg/h", kDegPerH);
      thermal("accelerometer bias", k, &Thermal::bias, &InertialSample<double>::f, "ug", kMicroG);
      thermal("gyro scale", k, &Thermal::scale, &InertialSample<double>::w, "ppm", 1e6);
      thermal("accelerometer scale", k, &Thermal::scale, &InertialSample<double>::f, "ppm", 1e6);
    }
  }
  if (a.record.has_rig && b.record.has_rig) {
    add("base tilt about east", va.rig.tilt_x, vb.rig.tilt_x, sa.rig.tilt_x, sb.rig.tilt_x, "deg", kDeg);
    add("base tilt about north", va.rig.tilt_y, vb.rig.tilt_y, sa.rig.tilt_y, sb.rig.tilt_y, "deg", kDeg);
    add("heading", va.rig.heading, va.rig.heading + std::remainder(vb.rig.heading - va.rig.heading, 2.0 * kPi),
        sa.rig.heading, sb.rig.heading, "deg", kDeg);
    add("axis non-orthogonality", va.rig.nonorthogonality, vb.rig.nonorthogonality, sa.rig.nonorthogonality,
        sb.rig.nonorthogonality, "deg", kDeg);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::string stage = axis == 0 ? "azimuth" : "pitch";
      add(stage + " encoder eccentricity, cosine", va.rig.eccentricity[axis].cosine, vb.rig.eccentricity[axis].cosine,
          sa.rig.eccentricity[axis].cosine, sb.rig.eccentricity[axis].cosine, "deg", kDeg);
      add(stage + " encoder eccentricity, sine", va.rig.eccentricity[axis].sine, vb.rig.eccentricity[axis].sine,
          sa.rig.eccentricity[axis].sine, sb.rig.eccentricity[axis].sine, "deg", kDeg);
    }
    add("IMU-to-encoder clock offset", va.clock_offset, vb.clock_offset, sa.clock_offset, sb.clock_offset, "ms", 1e3);
    for (std::size_t m = 0; m < a.mounts.size(); ++m) {
      for (std::size_t n = 0; n < b.mounts.size(); ++n) {
        if (a.mounts[m] != b.mounts[n]) continue;
        vector(a.mounts[m] + " about its", va.mount_error[m], vb.mount_error[n], sa.mount_error[m], sb.mount_error[n],
               "deg", kDeg);
        vector("lever arm in " + a.mounts[m] + " along", va.lever_arm[m], vb.lever_arm[n], sa.lever_arm[m],
               sb.lever_arm[n], "mm", 1e3);
      }
    }
  }
  return all;
}

ExitCode compare(const Options& o) {
  if (!o.methods.empty()) {
    if (!o.second.empty()) throw Error(ExitCode::kUsage, "--methods: of one run file, not of two calibrations");
    return compare_methods(o.first, o.methods, o.format == "json");
  }
  if (o.second.empty()) throw Error(ExitCode::kUsage, "two calibrations, or a run file and --methods");
  const io::CalibrationFile first = io::read_calibration_file(o.first);
  const io::CalibrationFile second = io::read_calibration_file(o.second);
  if (first.gauge != second.gauge) {
    throw Error(
        ExitCode::kInput,
        o.first + ", " + o.second +
            ": different gauges, so the same unit has other numbers in each: solve both with the same first mount");
  }
  const std::vector<Difference> all = differences(first, second);
  if (all.empty())
    throw Error(ExitCode::kInput,
                o.first + ", " + o.second + ": neither file has a sigma to measure the differences by");
  double squares = 0.0;
  const Difference* largest = &all.front();
  for (const Difference& d : all) {
    squares += d.sigmas() * d.sigmas();
    if (std::abs(d.sigmas()) > std::abs(largest->sigmas())) largest = &d;
  }
  const double rms = std::sqrt(squares / static_cast<double>(all.size()));
  const bool within = std::abs(largest->sigmas()) <= o.most_sigmas;
  if (o.format == "json") {
    nlohmann::ordered_json tree = {{"schema", "trunnion/compare/1"},
                                   {"first", o.first},
                                   {"second", o.second},
                                   {"rms_sigmas", rms},
                                   {"largest", largest->entry},
                                   {"largest_sigmas", largest->sigmas()},
                                   {"within", within}};
    for (const Difference& d : all) {
      tree["entries"].push_back({{"entry", d.entry},
                                 {"first", d.first},
                                 {"second", d.second},
                                 {"sigma", d.sigma},
                                 {"unit", d.unit},
                                 {"sigmas", d.sigmas()}});
    }
    std::printf("%s\n", tree.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  } else {
    std::printf("%-40s %14s %14s %12s %8s  %s\n", "entry", "first", "second", "1 sigma", "sigmas", "unit");
    for (const Difference& d : all) {
      std::printf("%-40s %14.6g %14.6g %12.3g %8.2f  %s\n", d.entry.c_str(), d.first, d.second, d.sigma, d.sigmas(),
                  d.unit.c_str());
    }
    std::printf("%zu entries, rms %.3f sigmas, largest %.2f: %s\n", all.size(), rms, largest->sigmas(),
                largest->entry.c_str());
  }
  return within ? ExitCode::kDone : ExitCode::kOutOfLimits;
}

}  // namespace

void add_compare(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "Hold two calibrations side by side in sigmas, one against the truth of a simulation, or the methods of a run");
  auto o = std::make_shared<Options>();
  command->add_option("first", o->first, "Calibration file; with --methods, a run file")->required();
  command->add_option("second", o->second, "Another, or truth.yaml");
  command->add_option(
      "--methods", o->methods,
      "Calibrate one run by several methods: all, or some of traditional, rate_test, kalman_36, by_hand, "
      "twelve_position");
  command->add_option("--format", o->format, "Of the result")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("--most-sigmas", o->most_sigmas, "Exit with 1 where an entry differs by more")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->footer("Example:\n  imu_calibrate compare calibration.yaml truth.yaml");
  command->callback([o, &exit_code] { exit_code = compare(*o); });
}

}  // namespace trunnion::app
