// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Deterministic errors of an inertial unit: a gyro triad that feels specific force, and an accelerometer triad.
///
///   y_g = (I + M_g) w + b_g + N w^o3 + Q_g w^o2 + G f                ... (1)
///   y_a = (I + M_a) f + b_a + Q f^o2 + N_a f^o3                      ... (2)
///   correction: f from (2) first, then w from y_g - G f              ... (3)
///
/// w = w_ib_b [rad/s], f = f_b [m/s^2], G: g-sensitivity of the gyros [(rad/s)/(m/s^2)].
/// IEEE Std 1554-2005; docs/theory/calibration.md, eq. 1-5.

#pragma once

#include "trunnion/error_model/triad.hpp"

namespace trunnion {

/// A pair of three-axis readings or inputs: angular rate [rad/s] and specific force [m/s^2].
template <class T>
struct InertialSample {
  Vec3<T> w = Vec3<T>::Zero();
  Vec3<T> f = Vec3<T>::Zero();
};

template <class T>
struct InertialUnit {
  Triad<T> gyro;
  Triad<T> accel;
  Mat3<T> g_sensitivity = Mat3<T>::Zero();

  /// What the unit reads for the true input, eq. (1) and (2).
  [[nodiscard]] InertialSample<T> distort(const InertialSample<T>& input) const {
    return {gyro.distort(input.w) + g_sensitivity * input.f, accel.distort(input.f)};
  }
};

/// Undoes an InertialUnit. Holds the two inverses, so that a sample costs no division.
template <class T>
class UnitCorrection {
 public:
  explicit UnitCorrection(const InertialUnit<T>& unit)
      : unit_(unit), gyro_inverse_(unit.gyro.matrix().inverse()), accel_inverse_(unit.accel.matrix().inverse()) {}

  /// The true input for a reading, eq. (3).
  [[nodiscard]] InertialSample<T> correct(const InertialSample<T>& reading) const {
    InertialSample<T> input;
    input.f = unit_.accel.correct(reading.f, accel_inverse_);
    input.w = unit_.gyro.correct(reading.w - unit_.g_sensitivity * input.f, gyro_inverse_);
    return input;
  }

 private:
  InertialUnit<T> unit_;
  Mat3<T> gyro_inverse_;
  Mat3<T> accel_inverse_;
};

}  // namespace trunnion
