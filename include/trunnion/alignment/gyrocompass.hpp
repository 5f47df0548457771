// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// North by turning: rests at two or more headings whose differences are known, so that the gyros' biases cancel.
///
/// In the level frame of each rest (roll and pitch from gravity, heading as it stands), with D_k the turn since the
/// first rest, clockwise from above:
///
///   w_x,k =  h_x cos D_k + h_y sin D_k + b_x
///   w_y,k = -h_x sin D_k + h_y cos D_k + b_y,        h = W cos L (cos psi, -sin psi)              ... (1)
///
/// linear in (h, b): least squares, psi = atan2(-h_y, h_x). |h| is not used, so it tells whether to believe psi.
/// IEEE Std 1559; Titterton & Weston, 2nd ed., sec. 10.4.2 ("two-position").

#pragma once

#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/linear.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

template <class T>
struct NorthByTurning {
  T heading = T(0);     ///< of the first rest [rad], in (-pi, pi]
  T sigma = T(0);       ///< rad
  T horizontal = T(0);  ///< |h| [rad/s]: should be W cos L
  T bias_x = T(0);      ///< rad/s, level frame
  T bias_y = T(0);
};

template <class T>
class Gyrocompass {
 public:
  /// @param mean over a rest; @param turn since the first rest [rad], heading of this one minus heading of that one
  /// @return kOutOfRange, and nothing taken, without a specific force
  Status add(const InertialSample<T>& mean, const T& turn) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const T force = mean.f.norm();
    const T across = sqrt(mean.f.y() * mean.f.y() + mean.f.z() * mean.f.z());
    if (!(force > T(0)) || !(across > T(0))) return Status::kOutOfRange;
    // C_lb of roll atan2(-f_y, -f_z) and pitch atan2(f_x, |f_yz|)
    const T sr = -mean.f.y() / across;
    const T cr = -mean.f.z() / across;
    const T sp = mean.f.x() / force;
    const T cp = across / force;
    const T level = sr * mean.w.y() + cr * mean.w.z();
    const T x = cp * mean.w.x() + sp * level;
    const T y = cr * mean.w.y() - sr * mean.w.z();
    const T c = cos(turn);
    const T s = sin(turn);
    ++rests_;
    sum_c_ += c;
    sum_s_ += s;
    sum_x_ += x;
    sum_y_ += y;
    turned_x_ += c * x - s * y;
    turned_y_ += s * x + c * y;
    return Status::kOk;
  }

  /// @param sigma_w of each mean rate, noise only [rad/s]
  /// @return kNotObservable where the headings do not differ, or the Earth's rate drowns in three sigmas
  [[nodiscard]] Result<NorthByTurning<T>> solve(const T& sigma_w) const {
    using std::atan2;
    using std::sqrt;
    if (rests_ < 2) return Status::kNotObservable;
    const T n = T(rests_);
    const T information = n - (sum_c_ * sum_c_ + sum_s_ * sum_s_) / n;  // of each component of h, in 1 / sigma_w^2
    if (!(information > T(1e-6) * n)) return Status::kNotObservable;
    const T h_x = (turned_x_ - (sum_c_ * sum_x_ - sum_s_ * sum_y_) / n) / information;
    const T h_y = (turned_y_ - (sum_s_ * sum_x_ + sum_c_ * sum_y_) / n) / information;
    NorthByTurning<T> north;
    north.horizontal = sqrt(h_x * h_x + h_y * h_y);
    const T sigma_h = sigma_w / sqrt(information);
    if (!(north.horizontal > T(3) * sigma_h)) return Status::kNotObservable;
    north.heading = atan2(-h_y, h_x);
    north.sigma = sigma_h / north.horizontal;
    north.bias_x = (sum_x_ - (h_x * sum_c_ + h_y * sum_s_)) / n;
    north.bias_y = (sum_y_ - (h_y * sum_c_ - h_x * sum_s_)) / n;
    return north;
  }

 private:
  int rests_ = 0;
  T sum_c_ = T(0);
  T sum_s_ = T(0);
  T sum_x_ = T(0);
  T sum_y_ = T(0);
  T turned_x_ = T(0);  // sum of R(D_k)^T (x, y)
  T turned_y_ = T(0);
};

}  // namespace trunnion
