// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/sensor_sheet.hpp"

#include "strict_yaml.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

/// One triad of the sheet; keys carry the unit: noise_<noise_unit>, and so on.
bool read_triad(const StrictYaml& node, const std::string& range_key, double range_unit, const std::string& noise_key,
                double noise_unit, const std::string& wander_key, double wander_unit, const std::string& scale_key,
                double& range, TriadNoise& noise, NominalScale<double>& counts) {
  node.only({range_key, noise_key, wander_key, "bias_correlation_time_s", scale_key, "zero_counts"});
  if (node.has(range_key)) range = node.at(range_key).positive() * range_unit;
  if (node.has(scale_key)) counts.scale = node.at(scale_key).number();
  if (counts.scale == 0.0) node.at(scale_key).fail("should not be zero");
  counts.zero = node.number_or("zero_counts", 0.0);
  if (node.has(wander_key)) {
    noise.wander = node.at(wander_key).number_in(0.0, 1e9) * wander_unit;
    noise.wander_correlation_time = node.at("bias_correlation_time_s").positive();
  }
  if (!node.has(noise_key)) return false;
  noise.density = node.at(noise_key).positive() * noise_unit;
  return true;
}

}  // namespace

SensorSheet read_sensor_sheet(const std::string& path) {
  const StrictYaml root = StrictYaml::load(path, "trunnion-sheet/1");
  root.only({"format", "model", "rate_hz", "gyroscope", "accelerometer"});
  SensorSheet sheet;
  sheet.model = root.at("model").text();
  if (root.has("rate_hz")) sheet.rate_hz = root.at("rate_hz").number_in(10.0, 1e5);
  const bool gyro = read_triad(root.at("gyroscope"), "range_deg_per_s", kRadPerDeg, "noise_deg_per_h_per_rt_hz",
                               kRadPerSPerDegPerH, "bias_instability_deg_per_h", kRadPerSPerDegPerH,
                               "scale_counts_per_rad_s", sheet.gyro_range, sheet.noise.gyro, sheet.counts.gyro);
  const bool accel = read_triad(root.at("accelerometer"), "range_g", kStandardGravity, "noise_ug_per_rt_hz",
                                kMetresPerS2PerMicroG, "bias_instability_ug", kMetresPerS2PerMicroG,
                                "scale_counts_per_m_s2", sheet.accel_range, sheet.noise.accel, sheet.counts.accel);
  if (gyro != accel)
    root.at(gyro ? "accelerometer" : "gyroscope")
        .fail("states no noise, while the other triad does: state both or neither");
  sheet.has_noise = gyro;
  return sheet;
}

}  // namespace trunnion::io
