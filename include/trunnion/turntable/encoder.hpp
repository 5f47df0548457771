// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Angle encoder of one table axis, with the eccentricity of its disc.
///
///   reading = angle + c cos(angle) + s sin(angle)                           ... (1)
///
/// c, s [rad]. The zero of the frame is where the *angle* is zero, so that (1) reads c there.
/// docs/theory/calibration.md, eq. 9.

#pragma once

#include <cmath>

namespace trunnion {

/// Angle [rad] of a joint and its first two time derivatives.
template <class T>
struct AxisMotion {
  T angle = T(0);
  T rate = T(0);
  T acceleration = T(0);
};

template <class T>
struct EncoderEccentricity {
  T cosine = T(0);
  T sine = T(0);

  /// What the encoder reads at the true motion @p angle, eq. (1).
  [[nodiscard]] T distort(const T& angle) const {
    using std::cos;
    using std::sin;
    return angle + cosine * cos(angle) + sine * sin(angle);
  }

  /// True motion for a reading and its derivatives: (1) solved by two fixed-point steps after the first guess,
  /// which leave (c^2 + s^2)^(3/2): 1e-9 rad for 1 mrad.
  [[nodiscard]] AxisMotion<T> correct(const AxisMotion<T>& reading) const {
    using std::cos;
    using std::sin;
    T angle = reading.angle;
    for (int step = 0; step < 2; ++step) angle = reading.angle - cosine * cos(angle) - sine * sin(angle);
    const T ca = cos(angle);
    const T sa = sin(angle);
    const T slope = T(1) - cosine * sa + sine * ca;  // d reading / d angle
    const T rate = reading.rate / slope;
    const T acceleration = (reading.acceleration + rate * rate * (cosine * ca + sine * sa)) / slope;
    return {angle, rate, acceleration};
  }
};

}  // namespace trunnion
