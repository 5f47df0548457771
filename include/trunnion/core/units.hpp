// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Customer's units at the border: inside, everything is SI and radians. in * factor is SI.

#pragma once

namespace trunnion {

inline constexpr double kPi = 3.141592653589793238462643383279502884;
inline constexpr double kRadPerDeg = kPi / 180.0;
inline constexpr double kRadPerSPerDegPerH = kRadPerDeg / 3600.0;
inline constexpr double kStandardGravity = 9.80665;  // m/s^2, exact: CGPM 1901
inline constexpr double kMetresPerS2PerMicroG = 1e-6 * kStandardGravity;

}  // namespace trunnion
