// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// GPS time, and the same moment on the clock of computers. IS-GPS-200, 20.3.3.3.1.1.
///
///   t = 315964800 s + 604800 s week + seconds                                                               ... (1)
///
/// since 1970-01-01. Leap seconds are not counted: t runs ahead of UTC by them.

#pragma once

#include <cmath>
#include <cstdint>

namespace trunnion {

inline constexpr double kSecondsPerWeek = 604800.0;
inline constexpr std::int64_t kGpsEpoch = 315964800;  // s, 1970-01-01 to 1980-01-06

/// GPS time: week since 1980-01-06 and seconds of it; 1e-10 s are told apart.
struct GpsTime {
  int week = 0;
  double seconds = 0.0;

  friend double operator-(const GpsTime& a, const GpsTime& b) {
    return (a.week - b.week) * kSecondsPerWeek + (a.seconds - b.seconds);
  }
  /// Seconds stay within the week.
  friend GpsTime operator+(const GpsTime& a, double s) {
    const double whole = a.seconds + s;
    const double weeks = std::floor(whole / kSecondsPerWeek);
    if (!(std::abs(weeks) < 1e6)) return {a.week, whole};
    return {a.week + static_cast<int>(weeks), whole - weeks * kSecondsPerWeek};
  }
};

/// Equation (1) in microseconds, rounded. @pre |seconds| < 1e9
inline std::int64_t utime_of(const GpsTime& time) {
  return (kGpsEpoch + std::int64_t{604800} * time.week) * 1000000 + std::llround(time.seconds * 1e6);
}

}  // namespace trunnion
