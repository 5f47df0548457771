// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <ceres/ceres.h>

#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/core/units.hpp"
#include "turn_rotation.hpp"

namespace trunnion::calibration {

/// The unit that the scaled unknowns @p x describe.
template <class T>
InertialUnit<T> unit_from(const Layout& layout, const T* x, std::size_t recording) {
  const auto value = [&](int i) { return x[i] * T(layout.parameters[static_cast<std::size_t>(i)].scale); };
  InertialUnit<T> unit;
  for (int i = 0; i < 3; ++i) {
    unit.gyro.bias(i) = value(layout.gyro_bias[recording] + i);
    unit.accel.bias(i) = value(layout.accel_bias[recording] + i);
    if (layout.gyro_cubic >= 0) unit.gyro.cubic(i) = value(layout.gyro_cubic + i);
    if (layout.accel_quadratic >= 0) unit.accel.quadratic(i) = value(layout.accel_quadratic + i);
    for (int j = 0; j < 3; ++j) {
      unit.gyro.M(i, j) = value(layout.gyro_matrix + 3 * i + j);
      if (layout.g_sensitivity >= 0) unit.g_sensitivity(i, j) = value(layout.g_sensitivity + 3 * i + j);
      if (layout.accel_matrix[i][j] >= 0) unit.accel.M(i, j) = value(layout.accel_matrix[i][j]);
    }
  }
  return unit;
}

/// Six residuals of a rest, force before rate: eq. (1) of multi_position_solve.hpp, over sigma_f, sigma_w.
struct RestResidual {
  const Layout* layout;
  const Rest* rest;
  std::size_t recording;
  Vec3<double> w_ie_u;
  double sigma_f;
  double sigma_w;

  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const InertialUnit<T> unit = unit_from(*layout, parameters[0], recording);
    const Eigen::Map<const Quaternion<T>> q_ub(parameters[1]);
    const T gravity =
        parameters[0][layout->gravity] * T(layout->parameters[static_cast<std::size_t>(layout->gravity)].scale);
    InertialSample<T> input;
    input.f = q_ub.conjugate() * Vec3<T>(T(0), T(0), gravity);
    input.w = q_ub.conjugate() * w_ie_u.cast<T>();
    const InertialSample<T> reading = unit.distort(input);
    const Vec3<T> r_f = (rest->mean.f.cast<T>() - reading.f) / T(sigma_f);
    const Vec3<T> r_w = (rest->mean.w.cast<T>() - reading.w) / T(sigma_w);
    for (int i = 0; i < 3; ++i) {
      residual[i] = r_f(i);
      residual[3 + i] = r_w(i);
    }
    return true;
  }
};

/// log((q_before turn exp(correction))^-1 q_after) / sigma
struct TurnResidual {
  const TurnRotation* rotation;
  double sigma;

  template <class T>
  bool operator()(const T* correction, const T* before, const T* after, T* residual) const {
    const Quaternion<T> predicted = Eigen::Map<const Quaternion<T>>(before) * rotation->q.cast<T>() *
                                    quaternion_exp<T>(Eigen::Map<const Vec3<T>>(correction));
    Eigen::Map<Vec3<T>> r(residual);
    r = quaternion_log<T>(Quaternion<T>(predicted.conjugate() * Eigen::Map<const Quaternion<T>>(after))) / T(sigma);
    return true;
  }
};

/// TurnResidual of correction = J (x - x0): differentiated by three corrections, not by all unknowns.
class TurnCost final : public ceres::CostFunction {
 public:
  TurnCost(const TurnRotation* rotation, const double* x0, double sigma)
      : rotation_(rotation), x0_(x0, rotation->J.cols()), by_correction_(new TurnResidual{rotation, sigma}) {
    set_num_residuals(3);
    *mutable_parameter_block_sizes() = {static_cast<int>(rotation->J.cols()), 4, 4};
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], x0_.size());
    const Vec3<double> correction = rotation_->J * (x - x0_);
    const double* blocks[] = {correction.data(), parameters[1], parameters[2]};
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> J;
    double* by[] = {J.data(), nullptr, nullptr};
    if (jacobians != nullptr) {
      by[1] = jacobians[1];
      by[2] = jacobians[2];
    }
    if (!by_correction_.Evaluate(blocks, residuals, jacobians != nullptr ? by : nullptr)) return false;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], 3, x0_.size()).noalias() =
          J * rotation_->J;
    }
    return true;
  }

 private:
  const TurnRotation* rotation_;
  Eigen::Map<const Eigen::VectorXd> x0_;
  ceres::AutoDiffCostFunction<TurnResidual, 3, 3, 4, 4> by_correction_;
};

/// (x - mean) / sigma of one scaled unknown.
struct UnknownPrior {
  int index;
  double mean;
  double sigma;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    residual[0] = (parameters[0][index] - T(mean)) / T(sigma);
    return true;
  }
};

constexpr double kFlatHeadingSigma = kPi / 1.7320508075688772;

/// Keeps the heading of a chain of rests within the circle: a flat prior as its standard deviation.
struct HeadingPrior {
  Quaternion<double> q0;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const Eigen::Map<const Quaternion<T>> q(parameters[0]);
    residual[0] = quaternion_log<T>(Quaternion<T>(q * q0.conjugate().cast<T>())).z() / T(kFlatHeadingSigma);
    return true;
  }
};

}  // namespace trunnion::calibration
