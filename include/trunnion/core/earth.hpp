// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The Earth, WGS 84: its rate, its figure and its normal gravity.
///
///   gamma(L) = gamma_e (1 + k sin^2 L) / sqrt(1 - e^2 sin^2 L)                             ... (1)  Somigliana
///   gamma(L, h) = gamma(L) (1 - 2 h (1 + f + m - 2 f sin^2 L) / a + 3 h^2 / a^2)           ... (2)
///
///   R_E = a / sqrt(1 - e^2 sin^2 L),   R_N = a (1 - e^2) / (1 - e^2 sin^2 L)^(3/2)         ... (3)  radii of curvature
///
/// NIMA TR8350.2 (WGS 84), 3rd ed., eq. (4-1) and (4-3); Groves, 2nd ed., eq. (2.105), (2.106) for (3). Local gravity
/// departs from the formula by 10-100 mGal.

#pragma once

#include <cmath>

#include "trunnion/core/linear.hpp"

namespace trunnion {

inline constexpr double kEarthRate = 7.292115e-5;  ///< rad/s, WGS 84
inline constexpr double kEarthRadius = 6378137.0;  ///< a [m], equatorial
inline constexpr double kEarthFlattening = 1.0 / 298.257223563;
inline constexpr double kEarthEccentricity2 = kEarthFlattening * (2.0 - kEarthFlattening);  ///< e^2

inline constexpr double kEquatorGravity = 9.7803253359;  ///< gamma_e [m/s^2]

/// The ellipsoid at one latitude; without a trigonometric function, for those who have its sine already.
template <class T>
struct Ellipsoid {
  T east_radius;     ///< R_E [m], across the meridian
  T north_radius;    ///< R_N [m], along it
  T surface_excess;  ///< gamma(L) - gamma_e [m/s^2]
  T sine2;           ///< sin^2 L

  /// @param sin2 squared sine of the geodetic latitude, in [0, 1]
  explicit Ellipsoid(const T& sin2) : sine2(sin2) {
    using std::sqrt;
    constexpr double kK = 0.00193185265241;
    const T x = T(kEarthEccentricity2) * sin2;
    const T root = T(1) / sqrt(T(1) - x);
    const T root2 = root * root;
    east_radius = T(kEarthRadius) * root;
    north_radius = T(1.0 - kEarthEccentricity2) * east_radius * root2;
    // 1 / sqrt(1 - x) - 1 without cancellation: float keeps nine digits of gravity
    surface_excess = T(kEquatorGravity) * (T(kK) * sin2 * root + x * root2 / (T(1) + root));
  }

  /// gamma(L, h) - gamma_e [m/s^2], eq. (2); @p height above the ellipsoid [m], good to 1e-6 m/s^2 below 10 km
  [[nodiscard]] T gravity_excess(const T& height) const {
    constexpr double kM = 0.00344978650684;  // w^2 a^2 b / GM
    constexpr double kTwoOverA = 2.0 / kEarthRadius;
    return surface_excess -
           (T(kEquatorGravity) + surface_excess) * height *
               (T(kTwoOverA * (1.0 + kEarthFlattening + kM)) - T(2.0 * kEarthFlattening * kTwoOverA) * sine2 -
                T(3.0 / (kEarthRadius * kEarthRadius)) * height);
  }
};

/// Normal gravity on and above the ellipsoid, eq. (2).
///
/// @param latitude geodetic latitude [rad], in [-pi/2, pi/2]
/// @param height height above the ellipsoid [m]; good to 1e-6 m/s^2 for |height| < 10 km
/// @return gravity along the ellipsoid normal [m/s^2], positive down
template <class T>
T normal_gravity(const T& latitude, const T& height) {
  using std::sin;
  const T sine = sin(latitude);
  return T(kEquatorGravity) + Ellipsoid<T>(sine * sine).gravity_excess(height);
}

/// Earth rate in east-north-up components [rad/s]; @p latitude geodetic [rad].
template <class T>
Vec3<T> earth_rate_enu(const T& latitude) {
  using std::cos;
  using std::sin;
  return Vec3<T>(T(0), T(kEarthRate) * cos(latitude), T(kEarthRate) * sin(latitude));
}

}  // namespace trunnion
