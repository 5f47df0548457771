// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Kalibr's model "scale-misalignment", in the axes i of its accelerometers:
//   measured f = M_a f_i + b_a,   measured w = M_g C_gi w_i + A (C_gi f_i) + b_g,
// M_a and M_g lower triangular, C_gi a rotation. The case's axes b are turned into i, so that nothing of a full matrix
// is lost: M_a Q = matrix of the accelerometers, and T_i_b holds Q. OpenVINS has a rotation for each triad, and its
// axes stay those of the case; its Tg acts on f in them, where Kalibr's A acts on f in the gyros'.

#include <Eigen/LU>
#include <cmath>

#include "export_formats.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

constexpr double kDouble = 1e-15;

/// Indented deeper than their key: OpenCV's reader, which OpenVINS has, wants it.
std::string rows(const Mat3<double>& M, const std::string& indent) {
  std::string text;
  for (int i = 0; i < 3; ++i) text += indent + "  - [" + listed(Vec3<double>(M.row(i).transpose())) + "]\n";
  return text;
}

std::string transform(const Mat3<double>& C, const std::string& indent) {
  std::string text;
  for (int i = 0; i < 3; ++i) text += indent + "  - [" + listed(Vec3<double>(C.row(i).transpose())) + ", 0.0]\n";
  return text + indent + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

/// Density and random walk [unit/s/rtHz] of a triad: the walk that a Gauss-Markov process is at first.
std::string noise(const std::string& name, const TriadNoise& noise) {
  return name + "_noise_density: " + exactly(noise.density) + "\n" + name +
         "_random_walk: " + exactly(noise.wander * std::sqrt(2.0 / noise.wander_correlation_time)) + "\n";
}

/// What both readers ask for first, @p indent before each line. A comment behind a name would be read as of it.
std::string common(const ExportRequest& request, const std::string& indent, std::vector<std::string>& advice) {
  std::string text;
  if (request.sheet.has_noise) {
    if (request.sheet.noise.accel.wander == 0.0 || request.sheet.noise.gyro.wander == 0.0)
      advice.emplace_back(
          "the sheet states no bias instability: its random walk is 0 in the file, and the reader refuses that");
    text += noise(indent + "accelerometer", request.sheet.noise.accel) +
            noise(indent + "gyroscope", request.sheet.noise.gyro);
  } else {
    advice.emplace_back("the noise is not in the file, and its reader wants it: name a --sheet that states it");
  }
  if (request.sheet.has_noise && !(request.sheet.rate_hz > 0.0))
    advice.emplace_back("the sheet states no rate_hz: the file has no update_rate, which its reader wants");
  if (request.sheet.rate_hz > 0.0) text += indent + "update_rate: " + exactly(request.sheet.rate_hz) + "\n";
  advice.emplace_back("rostopic is /imu0 in the file: write yours");
  return text + indent + "rostopic: /imu0\n" + indent + "time_offset: 0.0\n";
}

std::string biases(const ExportRequest& request) {
  return "# Turn-on biases of the calibration; the reader has no place for them, and estimates its own:\n"
         "#   gyro [rad/s]: [" +
         listed(request.unit.gyro.bias) + "]\n#   accelerometer [m/s^2]: [" + listed(request.unit.accel.bias) + "]\n";
}

Exported kalibr(const ExportRequest& request) {
  const InertialUnit<double>& unit = request.unit;
  const LowerAndRotation accel = lower_and_rotation(unit.accel);
  Triad<double> turned;  // the gyros' matrix for a rate in i
  turned.M = unit.gyro.matrix() * accel.Q.transpose() - Mat3<double>::Identity();
  const LowerAndRotation gyro = lower_and_rotation(turned);
  const Mat3<double> A = unit.g_sensitivity * accel.Q.transpose() * gyro.Q.transpose();
  Exported out;
  out.C_tb = accel.Q;
  out.text = commented(request, "#") + biases(request) +
             "# f = M_a^-1 (measured f - bias); w = C_gyro_i^T M_g^-1 (measured w - bias - A C_gyro_i f), both in the "
             "axes i\n# of the accelerometers; T_i_b turns the case's axes b into them.\n" +
             "model: scale-misalignment\n" + common(request, "", out.advice) + "T_i_b:\n" + transform(accel.Q, "") +
             "accelerometers:\n  M:\n" + rows(accel.L, "  ") + "gyroscopes:\n  M:\n" + rows(gyro.L, "  ") +
             "  C_gyro_i:\n" + rows(gyro.Q, "  ") + "  A:\n" + rows(A, "  ");
  out.correct = [unit, accel, gyro, A](const InertialSample<double>& y) {
    InertialSample<double> x;
    x.f = accel.L.inverse() * (y.f - unit.accel.bias);
    x.w = gyro.Q.transpose() * (gyro.L.inverse() * (y.w - unit.gyro.bias - A * (gyro.Q * x.f)));
    return x;
  };
  return out;
}

Exported openvins(const ExportRequest& request) {
  const InertialUnit<double>& unit = request.unit;
  const LowerAndRotation accel = lower_and_rotation(unit.accel);
  const LowerAndRotation gyro = lower_and_rotation(unit.gyro);
  Exported out;
  out.text = "%YAML:1.0\n" + commented(request, "#") + biases(request) +
             "# f = R_IMUtoACC^T Ta^-1 (measured f - bias); w = R_IMUtoGYRO^T Tw^-1 (measured w - bias - Tg f), in the "
             "case's axes.\n" +
             "imu0:\n  model: \"kalibr\"\n" + common(request, "  ", out.advice) + "  T_i_b:\n" +
             transform(Mat3<double>::Identity(), "  ") + "  Tw:\n" + rows(gyro.L, "  ") + "  R_IMUtoGYRO:\n" +
             rows(gyro.Q, "  ") + "  Ta:\n" + rows(accel.L, "  ") + "  R_IMUtoACC:\n" + rows(accel.Q, "  ") +
             "  Tg:\n" + rows(unit.g_sensitivity, "  ");
  out.correct = [unit, accel, gyro](const InertialSample<double>& y) {
    InertialSample<double> x;
    x.f = accel.Q.transpose() * (accel.L.inverse() * (y.f - unit.accel.bias));
    x.w = gyro.Q.transpose() * (gyro.L.inverse() * (y.w - unit.gyro.bias - unit.g_sensitivity * x.f));
    return x;
  };
  return out;
}

}  // namespace

const ExportFormat kKalibrExport = {
    "kalibr", "Kalibr's IMU file, scale-misalignment", ".yaml", kDouble, false, false, false, kalibr};
const ExportFormat kOpenVinsExport = {
    "openvins", "OpenVINS' kalibr_imu_chain.yaml", ".yaml", kDouble, false, false, false, openvins};

}  // namespace trunnion::io
