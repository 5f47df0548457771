// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "compare_methods.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "recordings.hpp"
#include "result.hpp"
#include "trunnion/calibration/kalman_36.hpp"
#include "trunnion/calibration/multi_position_solve.hpp"
#include "trunnion/calibration/rate_test.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/urdf.hpp"

namespace trunnion::app {
namespace {

/// What a method says of the gyros; what it does not determine is not a number.
struct Column {
  std::string method;
  std::string lacks;  ///< why there is none
  Mat3<double> M = Mat3<double>::Constant(std::nan(""));
  bool frame_of_the_case = true;
};

class Methods {
 public:
  explicit Methods(const std::string& path) : run_(io::read_run_file(path)) {
    if (run_.rig.empty())
      throw Error(ExitCode::kInput, path + ": the methods are compared on a table run: it has no rig");
    names_ = mounts_of(run_);
    rig_ = io::read_rig(run_.rig, run_.outer_axis, run_.inner_axis, names_);
    RunInputs inputs;
    recordings_ = read_table_recordings(run_, names_, inputs);
  }

  Column column(const std::string& method) {
    Column column;
    column.method = method;
    try {
      if (method == "traditional" || method == "rate_test") {
        const std::vector<calibration::TableRecording> used(
            recordings_.begin(), method == "traditional" ? recordings_.begin() + 1 : recordings_.end());
        const calibration::RateTestResult result = calibration::rate_test(used, rig_.rig, run_.site);
        for (int i = 0; i < 9; ++i) {
          if (result.determined(i / 3, i % 3)) column.M(i / 3, i % 3) = result.gyro.M(i / 3, i % 3);
        }
        if (!result.determined.any())
          column.lacks = "no run lies along a sensor: turn the azimuth with the pitch level";
      } else if (method == "twelve_position") {
        const calibration::Solution solution =
            calibration::solve_table(recordings_, rig_.rig, run_.site, table_options(run_, names_));
        column.lacks = calibration::describe(solution.observability);
        if (column.lacks.empty()) unit_ = solution.record.value.unit;
        if (column.lacks.empty()) column.M = unit_->gyro.M;
      } else if (method == "kalman_36") {
        // it knows one recording: each entry is of that which knows it best, and of none where all know no more than
        // before
        calibration::Kalman36Options options;
        options.noise = noise();
        Mat3<double> least = Mat3<double>::Constant(kUnknown * kUnknown);
        std::string why;
        column.frame_of_the_case = false;
        for (const io::RecordingFiles& files : run_.recordings) {
          calibration::Kalman36 filter(files.name());
          feed(files, filter);
          try {
            const calibration::Kalman36Result result = filter.finish(run_.site, options);
            const Mat3<double> M = calibration::in_accelerometer_frame(result.unit).gyro.M;
            for (int i = 0; i < 9; ++i) {
              double& variance = least(i / 3, i % 3);
              if (!(result.covariance(6 + i, 6 + i) < variance)) continue;
              variance = result.covariance(6 + i, 6 + i);
              column.M(i / 3, i % 3) = M(i / 3, i % 3);
            }
          } catch (const Error& e) {
            if (e.code() != ExitCode::kInput && e.code() != ExitCode::kNumerics) throw;
            why = e.what();
          }
        }
        if (column.M.array().isNaN().all()) column.lacks = why.empty() ? "no recording tells it anything" : why;
      } else {
        RunInputs inputs;
        calibration::HandSolveOptions options;
        options.has_noise = run_.sheet.has_noise;
        options.noise = run_.sheet.noise;
        options.terms = {false, run_.g_sensitivity, false};
        io::RunFile by_hand = run_;
        for (io::RecordingFiles& files : by_hand.recordings) files.mount.clear();
        const calibration::HandSolution hand =
            calibration::solve_by_hand(read_hand_recordings(by_hand, inputs), run_.site, options);
        column.lacks = calibration::describe(hand.solution.observability);
        if (column.lacks.empty()) take(hand.solution.record.value.unit, column);
      }
    } catch (const Error& e) {
      if (e.code() != ExitCode::kInput && e.code() != ExitCode::kNumerics) throw;
      column.lacks = e.what();
    }
    return column;
  }

  /// What twelve_position has found, in the frame that the methods without a table have.
  [[nodiscard]] std::optional<Column> aligned() const {
    if (!unit_) return std::nullopt;
    Column column;
    column.method = "twelve_position";
    take(*unit_, column);
    return column;
  }

 private:
  static constexpr double kUnknown = 0.01;  // 1 sigma of a scale or a cross-coupling

  [[nodiscard]] UnitNoise noise() const {
    if (!run_.sheet.has_noise) throw Error(ExitCode::kInput, "a sheet that states the noise is missing");
    return run_.sheet.noise;
  }
  void feed(const io::RecordingFiles& files, SampleSink& sink) const {
    io::RecordingFiles unit_only = files;
    unit_only.mount.clear();
    unit_only.encoder.clear();
    std::vector<std::pair<std::string, std::string>> digests;
    io::read_recording(run_, unit_only, sink, digests);
  }
  static void take(const InertialUnit<double>& unit, Column& column) {
    column.M = calibration::in_accelerometer_frame(unit).gyro.M;
    column.frame_of_the_case = false;
  }

  io::RunFile run_;
  std::vector<std::string> names_;
  io::RigFile rig_;
  std::vector<calibration::TableRecording> recordings_;
  std::optional<InertialUnit<double>> unit_;
};

}  // namespace

const std::vector<std::string>& methods_of_a_run() {
  static const std::vector<std::string> kMethods = {"traditional", "rate_test", "kalman_36", "by_hand",
                                                    "twelve_position"};
  return kMethods;
}

ExitCode compare_methods(const std::string& run, const std::string& methods, bool json) {
  std::vector<std::string> wanted;
  for (std::size_t from = 0; methods != "all" && from <= methods.size();) {
    const std::size_t comma = std::min(methods.find(',', from), methods.size());
    wanted.push_back(methods.substr(from, comma - from));
    from = comma + 1;
    if (std::find(methods_of_a_run().begin(), methods_of_a_run().end(), wanted.back()) == methods_of_a_run().end()) {
      std::string known;
      for (const std::string& one : methods_of_a_run()) known += (known.empty() ? "" : ", ") + one;
      throw Error(ExitCode::kUsage, "--methods: there is no '" + wanted.back() + "' for one run; there are " + known);
    }
  }
  const bool by_name = !wanted.empty();
  if (!by_name) wanted = methods_of_a_run();
  Methods all(run);
  std::vector<Column> columns;
  for (const std::string& method : wanted) {
    columns.push_back(all.column(method));
    if (by_name && !columns.back().lacks.empty())
      throw Error(ExitCode::kInput, run + ": " + method + " lacks what it needs: " + columns.back().lacks);
  }
  if (std::any_of(columns.begin(), columns.end(),
                  [](const Column& c) { return !c.frame_of_the_case && c.lacks.empty(); })) {
    if (const std::optional<Column> aligned = all.aligned()) columns.push_back(*aligned);
  }
  constexpr const char* kName = "xyz";
  nlohmann::ordered_json tree = {{"format", "trunnion-methods/1"}, {"run", run}};
  for (const Column& column : columns) {
    nlohmann::ordered_json one = {{"method", column.method}};
    if (!column.lacks.empty()) {
      one["lacks"] = column.lacks;
    } else {
      one["frame"] = column.frame_of_the_case ? "case" : "accelerometers";
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const std::string entry = i == j ? std::string("gyro ") + kName[i] + " scale ppm"
                                           : std::string("gyro ") + kName[j] + " into " + kName[i] + " deg";
          if (std::isfinite(column.M(i, j)))
            one["entries"][entry] = i == j ? 1e6 * column.M(i, j) : column.M(i, j) / kRadPerDeg;
        }
      }
    }
    tree["methods"].push_back(one);
  }
  if (json) {
    std::printf("%s", json_text(tree).c_str());
    return ExitCode::kDone;
  }
  std::printf("%-22s", "entry");
  for (const Column& column : columns)
    std::printf(" %16s", (column.method + (column.frame_of_the_case ? "" : " *")).c_str());
  std::printf("\n");
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      std::printf("%-22s", (i == j ? std::string("gyro ") + kName[i] + " scale ppm"
                                   : std::string("gyro ") + kName[j] + " into " + kName[i] + " deg")
                               .c_str());
      for (const Column& column : columns) {
        const double value = i == j ? 1e6 * column.M(i, j) : column.M(i, j) / kRadPerDeg;
        std::printf(" %16s", std::isfinite(value) ? figure(value, 6).c_str() : "-");
      }
      std::printf("\n");
    }
  }
  std::printf("* in the frame of the accelerometers: a method without a table has no other\n");
  for (const Column& column : columns) {
    if (!column.lacks.empty()) std::printf("%s: %s\n", column.method.c_str(), column.lacks.c_str());
  }
  return ExitCode::kDone;
}

}  // namespace trunnion::app
