// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/parameters.hpp"

#include <cmath>
#include <cstdio>

#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

const char* const kAxisName[3] = {"x", "y", "z"};

std::string axis(int i) { return kAxisName[i]; }

// sigma of a heading that may be anything: the information of a flat prior over the circle
constexpr double kFlatHeadingSigma = kPi / 1.7320508075688772;

}  // namespace

int Layout::add(const std::string& name, Entry kind) {
  const EntryKind& k = kind_of(kind);
  parameters.push_back(
      {name, kind, refuse_above_[static_cast<std::size_t>(kind)] * k.si, k.unit, 1.0 / k.si, k.refuse_above * k.si});
  return size() - 1;
}

Layout::Layout(const LayoutRequest& request) : refuse_above_(request.refuse_above) {
  const auto three = [&](const std::string& before, const std::string& after, Entry kind) {
    const int first = size();
    for (int i = 0; i < 3; ++i) add(before + axis(i) + after, kind);
    return first;
  };
  // from entry @p first on, what is stated at an argument whose power is @p at
  const auto stated_at = [&](int first, double at) {
    for (int i = first; i < size(); ++i) {
      parameters[static_cast<std::size_t>(i)].refuse_above /= at;
      parameters[static_cast<std::size_t>(i)].scale /= at;
      parameters[static_cast<std::size_t>(i)].in_unit *= at;
    }
  };
  const auto matrix_entry = [&](const std::string& sensor, int row, int column, Entry scale, Entry cross) {
    return row == column ? add(sensor + " " + axis(row) + " scale", scale)
                         : add(sensor + " " + axis(column) + " cross-coupling into " + axis(row), cross);
  };

  gyro_matrix = size();
  for (int i = 0; i < 9; ++i) matrix_entry("gyro", i / 3, i % 3, Entry::kGyroScale, Entry::kGyroCrossCoupling);
  if (request.terms.cubic) {
    gyro_cubic = three("gyro ", " cubic", Entry::kGyroCubic);
    stated_at(gyro_cubic, request.largest_rate * request.largest_rate);
  }
  if (request.terms.g_sensitivity) {
    g_sensitivity = size();
    for (int i = 0; i < 9; ++i)
      add("gyro " + axis(i / 3) + " g-sensitivity to " + axis(i % 3), Entry::kGyroGSensitivity);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      accel_matrix[i][j] = request.accel_upper_triangular && j < i
                               ? -1
                               : matrix_entry("accelerometer", i, j, Entry::kAccelScale, Entry::kAccelCrossCoupling);
    }
  }
  if (request.terms.quadratic) accel_quadratic = three("accelerometer ", " quadratic", Entry::kAccelQuadratic);
  if (request.terms.asymmetry) {
    gyro_asymmetry = three("gyro ", " asymmetry", Entry::kGyroAsymmetry);
    accel_asymmetry = three("accelerometer ", " asymmetry", Entry::kAccelAsymmetry);
  }
  if (request.terms.size_effect) {
    accel_place = three("accelerometer y's place along ", "", Entry::kAccelPlace);
    three("accelerometer z's place along ", "", Entry::kAccelPlace);
  }
  if (request.terms.temperature > 0) {
    thermal = size();
    thermal_order = request.terms.temperature;
    temperature = request.temperature;
    const char* const kPower[] = {"", " squared", " cubed", " to the 4th", " to the 5th"};
    for (int k = 1; k <= thermal_order; ++k) {
      const int first = size();
      const std::string by = std::string(" by temperature") + kPower[k - 1];
      three("gyro ", " bias" + by, Entry::kGyroThermalBias);
      three("accelerometer ", " bias" + by, Entry::kAccelThermalBias);
      three("gyro ", " scale" + by, Entry::kGyroThermalScale);
      three("accelerometer ", " scale" + by, Entry::kAccelThermalScale);
      stated_at(first, std::pow(request.temperature.reach(), k));
    }
  }
  const int biases = request.bias_per_recording ? request.recordings : 1;
  for (int r = 0; r < biases; ++r) {
    const std::string of = biases > 1 ? " in recording " + std::to_string(r + 1) : "";
    gyro_bias.push_back(three("gyro ", " bias" + of, Entry::kGyroBias));
    accel_bias.push_back(three("accelerometer ", " bias" + of, Entry::kAccelBias));
  }
  gyro_bias.resize(static_cast<std::size_t>(request.recordings), gyro_bias.front());
  accel_bias.resize(static_cast<std::size_t>(request.recordings), accel_bias.front());

  if (request.rig) {
    tilt = add("base tilt about east", Entry::kRigAngle);
    add("base tilt about north", Entry::kRigAngle);
    // in axes of the Earth, the tilt is as uncertain as the heading turns it
    for (int i = tilt; i < size(); ++i) parameters[static_cast<std::size_t>(i)].refuse_above *= 10.0;
    heading = add("heading", Entry::kRigAngle);
    // nobody's calibration: a prior holds it to the circle, and at a pole that is all there is
    parameters.back().refuse_above = 10.0 * kFlatHeadingSigma;
    parameters.back().scale = kFlatHeadingSigma;
    nonorthogonality = add("axis non-orthogonality", Entry::kRigAngle);
    eccentricity = size();
    for (const char* stage : {"azimuth", "pitch"}) {
      for (const char* part : {"cosine", "sine"})
        add(std::string(stage) + " encoder eccentricity, " + part, Entry::kRigAngle);
    }
    for (std::size_t m = 0; m < request.mounts.size(); ++m) {
      const bool used = request.mount_used[m];
      mount_error.push_back(used && m > 0 ? three(request.mounts[m] + " about its ", "", Entry::kRigAngle) : -1);
      lever_arm.push_back(used ? three("lever arm in " + request.mounts[m] + " along ", "", Entry::kLeverArm) : -1);
    }
    if (request.clock_offset) clock_offset = add("IMU-to-encoder clock offset", Entry::kClockOffset);
  }
  gravity = add("gravity", Entry::kAccelScale);
  parameters.back().refuse_above *= kStandardGravity;
  parameters.back().scale *= kStandardGravity;
  parameters.back().in_unit = 1e5;
  parameters.back().unit = "mGal";
}

template <class Visit>
void Layout::visit(CalibrationValues& v, Visit&& visit) const {
  const auto three = [&](int first, Vec3<double>& value) {
    for (int i = 0; first >= 0 && i < 3; ++i) visit(first + i, value(i));
  };
  const auto one = [&](int index, double& value) {
    if (index >= 0) visit(index, value);
  };
  for (int i = 0; i < 9; ++i) visit(gyro_matrix + i, v.unit.gyro.M(i / 3, i % 3));
  three(gyro_cubic, v.unit.gyro.cubic);
  for (int i = 0; g_sensitivity >= 0 && i < 9; ++i) visit(g_sensitivity + i, v.unit.g_sensitivity(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) one(accel_matrix[i][j], v.unit.accel.M(i, j));
  }
  three(accel_quadratic, v.unit.accel.quadratic);
  three(gyro_asymmetry, v.unit.gyro.asymmetry);
  three(accel_asymmetry, v.unit.accel.asymmetry);
  for (int i = 0; accel_place >= 0 && i < 6; ++i) visit(accel_place + i, v.unit.accel_place(i % 3, 1 + i / 3));
  for (int k = 0; k < thermal_order; ++k) {
    const auto at = static_cast<std::size_t>(k);
    three(thermal + 12 * k, v.unit.thermal.bias[at].w);
    three(thermal + 12 * k + 3, v.unit.thermal.bias[at].f);
    three(thermal + 12 * k + 6, v.unit.thermal.scale[at].w);
    three(thermal + 12 * k + 9, v.unit.thermal.scale[at].f);
  }
  for (std::size_t r = 0; r < gyro_bias.size(); ++r) {
    three(gyro_bias[r], v.recording_bias[r].w);
    three(accel_bias[r], v.recording_bias[r].f);
  }
  if (tilt >= 0) {
    visit(tilt, v.rig.tilt_x);
    visit(tilt + 1, v.rig.tilt_y);
    visit(heading, v.rig.heading);
    visit(nonorthogonality, v.rig.nonorthogonality);
    int place = eccentricity;
    for (auto& encoder : v.rig.eccentricity) {
      visit(place++, encoder.cosine);
      visit(place++, encoder.sine);
    }
  }
  for (std::size_t m = 0; m < mount_error.size(); ++m) {
    three(mount_error[m], v.mount_error[m]);
    three(lever_arm[m], v.lever_arm[m]);
  }
  one(clock_offset, v.clock_offset);
  one(gravity, v.gravity);
}

void Layout::write(const CalibrationValues& values, Eigen::VectorXd& x) const {
  x.resize(size());
  CalibrationValues copy = values;
  visit(copy, [&](int i, double& value) { x(i) = value; });
}

void Layout::read(const Eigen::VectorXd& x, CalibrationValues& values) const {
  visit(values, [&](int i, double& value) { value = x(i); });
  values.unit.gyro.bias.setZero();
  values.unit.accel.bias.setZero();
  const auto count = static_cast<double>(gyro_bias.size());
  for (std::size_t r = 0; r < gyro_bias.size(); ++r) {
    values.unit.gyro.bias += values.recording_bias[r].w / count;
    values.unit.accel.bias += values.recording_bias[r].f / count;
  }
}

CalibrationValues Layout::sigmas(const Eigen::MatrixXd& covariance) const {
  CalibrationValues sigma;
  visit(sigma, [&](int i, double& value) { value = std::sqrt(covariance(i, i)); });
  // the mean over the recordings: variance of a sum, with its covariances
  const auto mean_sigma = [&](const std::vector<int>& first, int i) {
    double variance = 0.0;
    for (const int a : first) {
      for (const int b : first) variance += covariance(a + i, b + i);
    }
    return std::sqrt(variance) / static_cast<double>(first.size());
  };
  for (int i = 0; i < 3; ++i) {
    sigma.unit.gyro.bias(i) = mean_sigma(gyro_bias, i);
    sigma.unit.accel.bias(i) = mean_sigma(accel_bias, i);
  }
  return sigma;
}

bool has_verdict(const Parameter& parameter) {
  return parameter.unit == kind_of(parameter.kind).unit && parameter.name != "heading";
}

std::string implausible(const std::vector<Parameter>& parameters, const Eigen::VectorXd& x) {
  std::string text;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    if (!has_verdict(p)) continue;
    const double value = x(static_cast<Eigen::Index>(i)) * p.in_unit;
    if (std::abs(value) <= kind_of(p.kind).largest) continue;
    char line[160];
    std::snprintf(line, sizeof line, "  %s: %.4g %s\n", p.name.c_str(), value, p.unit.c_str());
    text += line;
  }
  return text;
}

}  // namespace trunnion::calibration
