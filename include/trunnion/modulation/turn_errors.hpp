// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bias, axis tilt and axial scale factor of a turning triad from its whole turns, also of the axis that no turning
/// modulates; no step assumes that the base stands still.
///
/// Frame p turns with the unit, z is the axis; the unit s sits in it in the first position as it is (C_ps = I), in the
/// second turned by 90 deg about x (s-y lies along the axis). A turn at rate W gives, in position p:
///
///   across: mean x, y of p = b_x,y + t_p,x,y r,   r = W of gyros, W^2 of accelerometers            ... (1)
///   along:  mean z - W - reference = b_z + s_p W - c                                               ... (2)
///
/// t: tilt of the sensing plane against the axis (gyros) or lever arm (accelerometers); s: axial scale error, zero for
/// accelerometers; c: what else the reference has. Whoever has an auxiliary unit on the base takes it for the
/// reference, and c is its bias; without one the reference is zero, -c is the body's own rate and the caller says how
/// it wanders. So **reversing** tells s from b - c by W's sign and **two rates** by its size, b from t likewise; only
/// the **flip** brings the axial sensor across the axis, where (1) tells b from c. What no turn has told yet keeps its
/// first sigma. A Kalman filter of ten states; docs/theory/modulation.md.

#pragma once

#include <cmath>
#include <cstdint>

#include "trunnion/core/linear.hpp"

namespace trunnion {

enum class UnitPosition : std::uint8_t { kFirst, kSecond };

/// @p v of the unit in frame p.
template <class T>
Vec3<T> in_platform(UnitPosition position, const Vec3<T>& v) {
  return position == UnitPosition::kFirst ? v : Vec3<T>(v.x(), -v.z(), v.y());
}

template <class T>
struct TurnErrorNoise {
  T density;          ///< of the unit's white noise [output units/sqrt(Hz)]
  T reference;        ///< of the reference's white noise; 0 without one
  T bias_walk;        ///< random walk of b [output units/sqrt(s)]
  T reference_walk;   ///< random walk of c: the auxiliary unit's bias, or the body's own motion along the axis
  T first_bias;       ///< 1 sigma at the start
  T first_tilt;       ///< 1 sigma of t: rad of gyros, m of accelerometers
  T first_scale;      ///< 1 sigma of s; 0 for accelerometers
  T first_reference;  ///< 1 sigma of c
};

template <class T>
class TurnErrors {
 public:
  /// Tilts: x, y of p in the first position, then in the second; scales: along the axis in the first, the second.
  enum State : int { kBias = 0, kTilt = 3, kScale = 7, kReference = 9, kStates = 10 };
  using StateVector = Eigen::Matrix<T, kStates, 1>;
  using StateMatrix = Eigen::Matrix<T, kStates, kStates>;

  explicit TurnErrors(const TurnErrorNoise<T>& noise) : noise_(noise) {
    StateVector first;
    first << noise.first_bias, noise.first_bias, noise.first_bias, noise.first_tilt, noise.first_tilt, noise.first_tilt,
        noise.first_tilt, noise.first_scale, noise.first_scale, noise.first_reference;
    P_ = first.cwiseAbs2().asDiagonal();
  }

  /// Time passes. @param dt [s]
  void propagate(const T& dt) {
    for (int i = 0; i < 3; ++i) P_(kBias + i, kBias + i) += noise_.bias_walk * noise_.bias_walk * dt;
    P_(kReference, kReference) += noise_.reference_walk * noise_.reference_walk * dt;
  }

  /// A turn across the axis, eq. (1). @param mean of the triad in p; @param r W of gyros, W^2 of accelerometers;
  /// @param period of the turn [s]
  void add_across(UnitPosition position, const Vec3<T>& mean, const T& r, const T& period) {
    const int first = position == UnitPosition::kFirst ? 0 : 2;
    for (int axis = 0; axis < 2; ++axis) {
      StateVector h = bias_row(position, axis);
      h(kTilt + first + axis) = r;
      update(h, mean(axis), noise_.density * noise_.density / period);
    }
  }

  /// A turn along the axis, eq. (2). @param mean_z of the triad in p, of gyros without W; @param rate W [rad/s];
  /// @param reference along the axis, 0 without one
  void add_along(UnitPosition position, const T& mean_z, const T& rate, const T& reference, const T& period) {
    StateVector h = axial_row(position, rate);
    h(kReference) = T(-1);
    update(h, mean_z - reference, (noise_.density * noise_.density + noise_.reference * noise_.reference) / period);
  }

  /// The body's motion along the axis, from the mean of a turn [p, of gyros without W]: (2) without c.
  [[nodiscard]] T along(UnitPosition position, const T& mean_z, const T& rate) const {
    return mean_z - axial_row(position, rate).dot(x_);
  }
  /// 1 sigma of what b and s leave in along(); the noise of the turn comes on top.
  [[nodiscard]] T along_sigma(UnitPosition position, const T& rate) const {
    using std::sqrt;
    const StateVector h = axial_row(position, rate);
    return sqrt(h.dot(P_ * h));
  }

  [[nodiscard]] const StateVector& state() const { return x_; }
  [[nodiscard]] const StateMatrix& covariance() const { return P_; }

 private:
  /// Which bias shows along an axis of p.
  static StateVector bias_row(UnitPosition position, int axis) {
    StateVector h = StateVector::Zero();
    for (int i = 0; i < 3; ++i) h(kBias + i) = in_platform<T>(position, Vec3<T>::Unit(i))(axis);
    return h;
  }
  static StateVector axial_row(UnitPosition position, const T& rate) {
    StateVector h = bias_row(position, 2);
    h(kScale + (position == UnitPosition::kFirst ? 0 : 1)) = rate;
    return h;
  }
  /// A value six sigmas off is none of this model's: a pulse that was none, a body that shook.
  void update(const StateVector& h, const T& value, const T& variance) {
    const StateVector cross_covariance = P_ * h;
    const T total = h.dot(cross_covariance) + variance;
    const T innovation = value - h.dot(x_);
    if (!(total > T(0)) || !(innovation * innovation <= T(36) * total)) return;
    const StateVector k = cross_covariance / total;
    x_ += k * innovation;
    P_ -= k * cross_covariance.transpose();
    P_ = (T(0.5) * (P_ + P_.transpose())).eval();
  }

  TurnErrorNoise<T> noise_;
  StateVector x_ = StateVector::Zero();
  StateMatrix P_;
};

}  // namespace trunnion
