// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a turning triad does wrong across its axis, as slow states in its own frame, so that every sample can be put
/// right instead of every turn.
///
/// With m = x + i y across the axis, u the body's motion in body axes and phi the angle of the axis:
///
///   m = v + D conj(v) + b + delta r + noise,     v = exp(-i phi) u                                  ... (1)
///
/// b: bias; delta: response to the axial input r, of a gyro the tilt of its sensing plane against the axis times the
/// rate W, of an accelerometer at a lever arm W^2; D: half the difference of the two scale factors, and i times half
/// the error of the right angle between them (half their sum turns with v: no turning finds it). Over a turn at one
/// rate b and delta W are one number, and both vanish; when W changes within the turn they do not, and an average over
/// turns leaves them where (1) does not. A Kalman filter of eight states, u as a random walk.
/// docs/theory/modulation.md.

#pragma once

#include "trunnion/core/linear.hpp"

namespace trunnion {

template <class T>
struct SlowStateNoise {
  T sample;       ///< 1 sigma of a sample of one axis [output units]
  T body;         ///< random walk of u [output units/sqrt(s)]: how the body moves
  T bias;         ///< random walk of b [output units/sqrt(s)]
  T first_body;   ///< 1 sigma at the start
  T first_bias;   ///< 1 sigma at the start
  T first_delta;  ///< 1 sigma [output units per unit of r]
  T first_scale;  ///< 1 sigma of D
};

template <class T>
class SlowStates {
 public:
  enum State : int { kBody = 0, kBias = 2, kDelta = 4, kScale = 6 };
  using StateVector = Eigen::Matrix<T, 8, 1>;
  using StateMatrix = Eigen::Matrix<T, 8, 8>;
  using Plane = Eigen::Matrix<T, 2, 1>;

  explicit SlowStates(const SlowStateNoise<T>& noise) : noise_(noise) {
    StateVector first;
    first << noise.first_body, noise.first_body, noise.first_bias, noise.first_bias, noise.first_delta,
        noise.first_delta, noise.first_scale, noise.first_scale;
    P_ = first.cwiseAbs2().asDiagonal();
  }

  /// A sample.
  /// @param m output across the axis, divided by sinc (sinc_correction())
  /// @param sine of phi in its middle
  /// @param cosine of phi in its middle
  /// @param r the axial input
  /// @param period since the last sample [s], positive
  void add(const Plane& m, const T& sine, const T& cosine, const T& r, const T& period) {
    for (int i = 0; i < 2; ++i) {
      P_(kBody + i, kBody + i) += noise_.body * noise_.body * period;
      P_(kBias + i, kBias + i) += noise_.bias * noise_.bias * period;
    }
    const T dr = x_(kScale);
    const T di = x_(kScale + 1);
    const Plane v(cosine * x_(0) + sine * x_(1), cosine * x_(1) - sine * x_(0));
    const Plane expected(v.x() + dr * v.x() + di * v.y() + x_(kBias) + x_(kDelta) * r,
                         v.y() + di * v.x() - dr * v.y() + x_(kBias + 1) + x_(kDelta + 1) * r);
    Eigen::Matrix<T, 2, 8> H;
    H << (T(1) + dr) * cosine - di * sine, (T(1) + dr) * sine + di * cosine, T(1), T(0), r, T(0), v.x(), v.y(),
        (dr - T(1)) * sine + di * cosine, (T(1) - dr) * cosine + di * sine, T(0), T(1), T(0), r, -v.y(), v.x();
    const Eigen::Matrix<T, 8, 2> cross_covariance = P_ * H.transpose();
    Eigen::Matrix<T, 2, 2> S = H * cross_covariance;
    S.diagonal().array() += noise_.sample * noise_.sample;
    const Eigen::Matrix<T, 8, 2> K = cross_covariance * S.inverse();
    x_ += K * (m - expected);
    P_ -= K * cross_covariance.transpose();
    P_ = (T(0.5) * (P_ + P_.transpose())).eval();
  }

  /// b was read directly, at rest. @param sigma of @p bias
  void read_bias(const Plane& bias, const T& sigma) {
    for (int i = 0; i < 2; ++i) {
      x_(kBias + i) = bias(i);
      P_.row(kBias + i).setZero();
      P_.col(kBias + i).setZero();
      P_(kBias + i, kBias + i) = sigma * sigma;
    }
  }

  /// u of a sample [body axes], free of b, delta and D as they are known now: its noise is the sample's, not filtered.
  [[nodiscard]] Plane correct(const Plane& m, const T& sine, const T& cosine, const T& r) const {
    const T dr = x_(kScale);
    const T di = x_(kScale + 1);
    const T a = m.x() - x_(kBias) - x_(kDelta) * r;
    const T b = m.y() - x_(kBias + 1) - x_(kDelta + 1) * r;
    const T k = T(1) / (T(1) - dr * dr - di * di);
    const Plane v(k * ((T(1) - dr) * a - di * b), k * ((T(1) + dr) * b - di * a));
    return Plane(cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y());
  }

  [[nodiscard]] const StateVector& state() const { return x_; }
  [[nodiscard]] const StateMatrix& covariance() const { return P_; }

 private:
  SlowStateNoise<T> noise_;
  StateVector x_ = StateVector::Zero();
  StateMatrix P_;
};

}  // namespace trunnion
