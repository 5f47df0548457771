// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The ROS package imu_calib: corrected f = SM measured - bias, where bias is in corrected units. It has nothing for
// gyros: their mean at start-up is subtracted there.

#include <Eigen/LU>

#include "export_formats.hpp"

namespace trunnion::io {
namespace {

Exported ros(const ExportRequest& request) {
  const Mat3<double> A = request.unit.accel.matrix().inverse();
  const Vec3<double> bias = A * request.unit.accel.bias;
  Exported out;
  out.text = commented(request, "#") + "# corrected f [m/s^2] = SM * measured f - bias; SM by rows\nSM: [" + listed(A) +
             "]\nbias: [" + listed(bias) + "]\n";
  out.correct = [A, bias](const InertialSample<double>& y) { return InertialSample<double>{y.w, A * y.f - bias}; };
  out.advice.emplace_back("imu_calib has nothing for gyros but their mean at start-up");
  return out;
}

}  // namespace

const ExportFormat kRosExport = {"ros", "ROS imu_calib.yaml", ".yaml", 1e-15, false, false, true, ros};

}  // namespace trunnion::io
