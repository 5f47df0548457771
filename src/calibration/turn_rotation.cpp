// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "turn_rotation.hpp"

#include <array>

#include "trunnion/core/linear.hpp"

namespace trunnion::calibration {
namespace {

/// Jacobian of Exp: Exp(phi + d) = Exp(phi) Exp(Jr d), second order in phi.
Mat3<double> right_jacobian(const Vec3<double>& phi) {
  const Mat3<double> S = skew(phi);
  return Mat3<double>::Identity() - 0.5 * S + S * S / 6.0;
}

}  // namespace

TurnRotation integrate(const Turn& turn, const InertialUnit<double>& unit, const Vec3<double>& w_ie_b,
                       const Layout* layout, std::size_t recording) {
  TurnRotation rotation;
  const UnitCorrection<double> correction(unit);
  const Mat3<double> K = unit.gyro.matrix();
  const Mat3<double> K_inverse = K.inverse();
  // sums of C_0k d(phi_k)/d(column i of bias) times what the column is multiplied with: 1, w_j, f_j, w_i^3
  Mat3<double> of_bias = Mat3<double>::Zero();
  Mat3<double> of_cubic = Mat3<double>::Zero();
  std::array<Mat3<double>, 3> of_rate = {of_bias, of_bias, of_bias};
  std::array<Mat3<double>, 3> of_force = of_rate;
  Vec3<double> before = Vec3<double>::Zero();
  for (const TurnStep& step : turn.steps) {
    const InertialSample<double> input = correction.correct(step.mean);
    const Vec3<double> angle = (input.w - rotation.q.conjugate() * w_ie_b) * step.dt;
    const Vec3<double> phi = angle + before.cross(angle) / 12.0;
    before = angle;
    const Quaternion<double> turned = quaternion_exp<double>(phi);
    rotation.q = rotation.q * turned;
    rotation.duration += step.dt;
    if (layout == nullptr) continue;
    // (K + 3 N w^2)^-1 to first order in N
    const Mat3<double> inverse =
        K_inverse - K_inverse * (3.0 * unit.gyro.cubic.cwiseProduct(input.w.cwiseAbs2())).asDiagonal() * K_inverse;
    const Mat3<double> gain = rotation.q.toRotationMatrix() * (right_jacobian(phi) * inverse) * -step.dt;
    of_bias += gain;
    of_cubic += gain * input.w.cwiseProduct(input.w.cwiseAbs2()).asDiagonal();
    for (std::size_t j = 0; j < 3; ++j) {
      of_rate[j] += gain * input.w(static_cast<Eigen::Index>(j));
      of_force[j] += gain * input.f(static_cast<Eigen::Index>(j));
    }
  }
  rotation.q.normalize();
  if (layout == nullptr) return rotation;
  rotation.J = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, layout->size());
  const Mat3<double> C_end = rotation.q.conjugate().toRotationMatrix();
  const auto set = [&](int place, const Vec3<double>& column) {
    rotation.J.col(place) = C_end * column * layout->parameters[static_cast<std::size_t>(place)].scale;
  };
  for (int i = 0; i < 3; ++i) {
    set(layout->gyro_bias[recording] + i, of_bias.col(i));
    if (layout->gyro_cubic >= 0) set(layout->gyro_cubic + i, of_cubic.col(i));
    for (int j = 0; j < 3; ++j) {
      set(layout->gyro_matrix + 3 * i + j, of_rate[static_cast<std::size_t>(j)].col(i));
      if (layout->g_sensitivity >= 0)
        set(layout->g_sensitivity + 3 * i + j, of_force[static_cast<std::size_t>(j)].col(i));
    }
  }
  return rotation;
}

}  // namespace trunnion::calibration
