// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The temperature of a unit in a chamber that is driven evenly through its range.

#pragma once

#include <algorithm>
#include <cmath>

namespace trunnion {

/// A ramp, held at its end. The default has none: the temperature is not known.
struct Soak {
  double from = 0.0;  ///< degC
  double to = 0.0;
  double rate = 0.0;  ///< K/s, positive also where the unit cools

  [[nodiscard]] bool is_known() const { return rate > 0.0 && from != to; }
  /// s, from one end to the other
  [[nodiscard]] double duration() const { return std::abs(to - from) / rate; }
  /// @p t s after its beginning [degC]
  [[nodiscard]] double at(double t) const {
    return from + std::copysign(std::min(rate * std::max(t, 0.0), std::abs(to - from)), to - from);
  }
};

}  // namespace trunnion
