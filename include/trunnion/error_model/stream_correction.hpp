// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// All that a calibration says of a unit, undone along a stream of its samples: with its temperature, and with the
/// size effect, which needs the rates of before.

#pragma once

#include "trunnion/error_model/size_effect.hpp"
#include "trunnion/error_model/thermal_correction.hpp"

namespace trunnion {

template <class T>
class StreamCorrection {
 public:
  explicit StreamCorrection(const InertialUnit<T>& unit, const UnitScale<T>& counts = UnitScale<T>())
      : correction_(unit, counts), size_effect_(unit), accel_scale_(counts.accel.scale) {}

  /// As ThermalCorrection::set_temperature().
  void set_temperature(const T& temperature) { correction_.set_temperature(temperature); }

  /// The true input for the reading at @p t [s]: SI, or raw counts where they were told.
  [[nodiscard]] InertialSample<T> correct(double t, const InertialSample<T>& reading) {
    InertialSample<T> first = correction_.correct(reading);
    if (size_effect_.is_zero()) return first;
    const Vec3<T> without = reading.f - accel_scale_ * size_effect_.next(t, first.w);
    return correction_.correct({reading.w, without});
  }

 private:
  ThermalCorrection<T> correction_;
  SizeEffect<T> size_effect_;
  T accel_scale_;
};

}  // namespace trunnion
