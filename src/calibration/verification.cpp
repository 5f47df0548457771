// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/verification.hpp"

#include <cmath>
#include <string>

#include "recording_model.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

/// Differences of one recording from the input of a perfect unit on the calibrated table, by window and sensor.
std::vector<std::array<double, 6>> differences(const CompressedRecording& data, int mount,
                                               const CalibrationValues& rig_values, const Rig& rig, const Site& site,
                                               std::vector<double>& t) {
  TableRecording recording{data, mount};
  LayoutRequest request;
  request.terms = {false, false, false};
  for (int m = 0; m < rig.mounts; ++m) {
    request.mounts.push_back("mount_" + std::to_string(m + 1));
    request.mount_used.push_back(m == mount);
  }
  const Layout layout(request);
  RecordingModel model(recording, 0, rig, site, layout, rig_values.clock_offset);
  UnitNoise unit_weights;
  unit_weights.gyro.density = unit_weights.accel.density = 1.0;
  model.set_noise(unit_weights);
  std::vector<std::array<double, 6>> all(model.windows());
  model.residuals(rig_values, [&](std::size_t k, int row, double residual, double) {
    all[k][static_cast<std::size_t>(row)] = residual;
  });
  t.clear();
  for (std::size_t k = 0; k < model.windows(); ++k) t.push_back(model.window(k).t);
  return all;
}

double floor_of(const TriadNoise& noise, double window, double duration) {
  const double u = noise.wander_correlation_time / duration;
  const double share = 1.0 - 2.0 * u * (1.0 - u * (1.0 - std::exp(-1.0 / u)));
  return std::sqrt(noise.density * noise.density / window + noise.wander * noise.wander * std::max(0.0, share));
}

}  // namespace

Verification verify(const CompressedRecording& before, const CompressedRecording& after, int mount,
                    const CalibrationValues& values, const Rig& rig, const Site& site, const UnitNoise& noise) {
  // the table as calibrated, a unit without errors
  CalibrationValues table = values;
  table.unit = InertialUnit<double>();
  for (auto& bias : table.recording_bias) bias = {};
  table.gravity = site.gravity;  // a calibration does not keep its own
  std::vector<double> t;
  std::vector<double> t_after;
  const std::vector<std::array<double, 6>> d_before = differences(before, mount, table, rig, site, t);
  const std::vector<std::array<double, 6>> d_after = differences(after, mount, table, rig, site, t_after);
  if (t.empty()) throw Error(ExitCode::kInput, before.name + ": the encoders and the IMU do not overlap in time");
  if (t != t_after) throw Error(ExitCode::kInput, before.name + ": its corrected samples make other windows");
  Verification v;
  v.windows = static_cast<long long>(t.size());
  v.window = 2.0 * before.windows.front().half_width;
  const auto n = static_cast<double>(t.size());
  for (std::size_t axis = 0; axis < 6; ++axis) {
    AxisVerification& one = v.axis[axis];
    for (std::size_t k = 0; k < t.size(); ++k) {
      one.mean_before += d_before[k][axis] / n;
      one.mean_after += d_after[k][axis] / n;
    }
    for (std::size_t k = 0; k < t.size(); ++k) {
      one.before += std::pow(d_before[k][axis] - one.mean_before, 2.0) / n;
      one.after += std::pow(d_after[k][axis] - one.mean_after, 2.0) / n;
    }
    one.before = std::sqrt(one.before);
    one.after = std::sqrt(one.after);
    one.floor = floor_of(axis < 3 ? noise.gyro : noise.accel, v.window, before.figures.duration);
  }
  for (std::size_t k = 0; k < t.size(); ++k) {
    v.course.emplace_back();
    v.course.back()[0] = t[k];
    for (std::size_t axis = 0; axis < 6; ++axis) {
      v.course.back()[1 + axis] = d_before[k][axis];
      v.course.back()[7 + axis] = d_after[k][axis];
    }
  }
  return v;
}

}  // namespace trunnion::calibration
