// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The size effect along a stream of samples: accelerometers that do not sit in one place (inertial_unit.hpp, eq. 6).
///
///   w' = (w_k - w_m) / (t_k - t_m),   m: an earlier sample, span to twice the span back                ... (1)
///
/// The angular acceleration is of the recent past, so that a stream can be corrected as it comes: it lags by half of
/// (1)'s span, and its noise is that of a rate times sqrt(2) / span. Until there is so much past, after a start or a
/// gap of half a second, it is taken for zero.

#pragma once

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

template <class T>
class SizeEffect {
 public:
  explicit SizeEffect(const InertialUnit<T>& unit, const T& span = T(0.02)) : unit_(unit), span_(span) {}

  [[nodiscard]] bool is_zero() const { return unit_.accel_place.isZero(T(0)); }

  /// e [m/s^2] at @p t [s] for the true angular rate @p w [rad/s]: take it from the reading, and correct that.
  [[nodiscard]] Vec3<T> next(double t, const Vec3<T>& w) {
    if (!kernel::is_finite(kernel::triple(w))) return Vec3<T>::Zero();  // it is no past for those that come
    // after a gap, or when time ran back, there is no recent past
    if (!(t - recent_.t >= 0.0) || t - recent_.t > kGap) past_ = recent_ = {t, w};
    if (t - recent_.t >= static_cast<double>(span_)) {
      past_ = recent_;
      recent_ = {t, w};
    }
    const T dt = static_cast<T>(t - past_.t);
    const Vec3<T> w_dot = dt >= span_ ? Vec3<T>((w - past_.w) / dt) : Vec3<T>::Zero();
    return unit_.size_effect(w, w_dot);
  }

 private:
  static constexpr double kGap = 0.5;  // s
  struct Moment {
    double t = -std::numeric_limits<double>::infinity();
    Vec3<T> w = Vec3<T>::Zero();
  };
  InertialUnit<T> unit_;
  T span_;
  Moment past_;    // span to twice the span ago
  Moment recent_;  // less than that
};

}  // namespace trunnion
