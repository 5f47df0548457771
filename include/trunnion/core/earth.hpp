// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The Earth at a laboratory bench: WGS 84 rate and normal gravity.
///
///   gamma(L) = gamma_e (1 + k sin^2 L) / sqrt(1 - e^2 sin^2 L)                             ... (1)  Somigliana
///   gamma(L, h) = gamma(L) (1 - 2 h (1 + f + m - 2 f sin^2 L) / a + 3 h^2 / a^2)           ... (2)
///
/// NIMA TR8350.2 (WGS 84), 3rd ed., eq. (4-1) and (4-3). Local gravity departs from the formula by 10-100 mGal.

#pragma once

#include <cmath>

#include "trunnion/core/linear.hpp"

namespace trunnion {

inline constexpr double kEarthRate = 7.292115e-5;  ///< rad/s, WGS 84

/// Normal gravity on and above the ellipsoid, eq. (2).
///
/// @param latitude geodetic latitude [rad], in [-pi/2, pi/2]
/// @param height height above the ellipsoid [m]; good to 1e-6 m/s^2 for |height| < 10 km
/// @return gravity along the ellipsoid normal [m/s^2], positive down
template <class T>
T normal_gravity(const T& latitude, const T& height) {
  using std::sin;
  using std::sqrt;
  constexpr double kA = 6378137.0;
  constexpr double kF = 1.0 / 298.257223563;
  constexpr double kE2 = kF * (2.0 - kF);
  constexpr double kGammaEquator = 9.7803253359;
  constexpr double kK = 0.00193185265241;
  constexpr double kM = 0.00344978650684;  // w^2 a^2 b / GM
  const T s2 = sin(latitude) * sin(latitude);
  const T surface = T(kGammaEquator) * (T(1) + T(kK) * s2) / sqrt(T(1) - T(kE2) * s2);
  return surface *
         (T(1) - T(2.0 / kA) * (T(1.0 + kF + kM) - T(2.0 * kF) * s2) * height + T(3.0 / (kA * kA)) * height * height);
}

/// Earth rate in east-north-up components [rad/s]; @p latitude geodetic [rad].
template <class T>
Vec3<T> earth_rate_enu(const T& latitude) {
  using std::cos;
  using std::sin;
  return Vec3<T>(T(0), T(kEarthRate) * cos(latitude), T(kEarthRate) * sin(latitude));
}

}  // namespace trunnion
