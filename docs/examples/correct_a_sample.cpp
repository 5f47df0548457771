// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "trunnion/model.hpp"

int main() {
  const trunnion::Vec3<float> rate(0.101F, -0.2F, 0.05F);
  const trunnion::Vec3<float> force(0.3F, 0.1F, 9.82F);
  // shown in README: begin
  trunnion::InertialUnit<float> unit;      // float, double, long double; no heap, no exceptions
  unit.gyro.bias << 1e-3F, -2e-3F, 5e-4F;  // rad/s
  unit.gyro.M(0, 0) = 2000e-6F;            // scale error of x
  unit.gyro.M(0, 1) = 3.5e-3F;             // y leaks into x, rad
  unit.accel.bias.z() = 0.02F;             // m/s^2
  const trunnion::UnitCorrection<float> correction(unit);
  const auto input = correction.correct({rate, force});  // w_ib_b [rad/s], f_b [m/s^2]
  // shown in README: end
  return std::abs(input.f.z() - 9.8F) < 1e-5F && std::abs(input.w.y() + 0.198F) < 1e-6F ? 0 : 1;
}
