// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Correction over temperature to any order, of the biases and of the scales (inertial_unit.hpp, eq. 3).
///
/// The unit as it is at a temperature is folded when the temperature moves: two inverses of three by three and their
/// products then; a sample in between costs what it costs without a temperature.

#pragma once

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

template <class T>
class ThermalCorrection {
 public:
  explicit ThermalCorrection(const InertialUnit<T>& unit, const UnitScale<T>& counts = UnitScale<T>())
      : unit_(unit), counts_(counts), temperature_(unit.thermal.reference), correction_(folded()) {}

  /// The next samples are of @p temperature [degC]; where it is not a number, that of before holds on.
  void set_temperature(const T& temperature) {
    if (temperature == temperature_ || !(temperature == temperature)) return;
    temperature_ = temperature;
    correction_ = folded();
  }

  /// The true input for a reading: eq. (5) of inertial_unit.hpp, without the size effect.
  [[nodiscard]] InertialSample<T> correct(const InertialSample<T>& reading) const {
    return correction_.correct(reading);
  }
  /// As UnitCorrection::checked().
  [[nodiscard]] Result<InertialSample<T>> checked(const InertialSample<T>& reading) const {
    return correction_.checked(reading);
  }

 private:
  [[nodiscard]] UnitCorrection<T> folded() const { return UnitCorrection<T>(unit_.at(temperature_), counts_); }

  InertialUnit<T> unit_;
  UnitScale<T> counts_;
  T temperature_;
  UnitCorrection<T> correction_;
};

}  // namespace trunnion
