// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fixed-point numbers on 32 bits whose products and sums are exact on 64.
///
///   Fixed<F>:  value = raw / 2^F,  raw a 32-bit integer: -2^(31-F) <= value < 2^(31-F)                ... (1)
///   Fixed<F> * Fixed<G> is a Wide<F + G>, exact; sums of Wide are exact while they fit 64 bits         ... (2)
///   rounded<G>(Wide<F>):   nearest multiple of 2^-G, a tie goes up; the caller knows that it fits      ... (3)
///   saturated<G>(Wide<F>): the same, and beyond the range its nearest end                              ... (4)
///
/// Nothing rounds but (3), (4) and the conversion from a real number; formats do not mix without a word. Why this and
/// no library: docs/decisions/2026-11-26-fixed-point.md.

#pragma once

#include <cstdint>
#include <limits>

#include "trunnion/core/inline.hpp"

namespace trunnion {

/// The nearest 32-bit integer, or the nearer end of the range.
TRUNNION_INLINE constexpr std::int32_t saturate(std::int64_t wide) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto low = static_cast<std::int32_t>(wide);
  return low == wide ? low : static_cast<std::int32_t>(wide < 0 ? -kMost - 1 : kMost);
}

/// wide / 2^shift to the nearest, a tie goes up; 0 <= shift < 63. Does not overflow.
TRUNNION_INLINE constexpr std::int64_t round_shift(std::int64_t wide, int shift) {
  return shift == 0 ? wide : (wide >> shift) + ((wide >> (shift - 1)) & 1);
}

namespace kernel {

/// wide / 2^32, rounded down: the upper word. By way of unsigned numbers: of a signed shift GCC remembers the 64 bits,
/// and multiplies by them.
TRUNNION_INLINE constexpr std::int32_t upper(std::int64_t wide) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(wide) >> 32U));
}

/// a b / 2^32, rounded down.
TRUNNION_INLINE constexpr std::int32_t upper(std::int32_t a, std::int32_t b) {
  return upper(static_cast<std::int64_t>(a) * b);
}

}  // namespace kernel

template <int F>
struct Fixed {
  static_assert(F >= 0 && F <= 31, "the point lies within the 32 bits");
  std::int32_t raw = 0;

  /// The nearest to @p value, a tie away from zero, saturated. NaN becomes zero.
  static constexpr Fixed nearest(double value) {
    const double scaled = value * static_cast<double>(std::int64_t{1} << F);
    if (!(scaled > -2147483648.0)) return {scaled == scaled ? std::numeric_limits<std::int32_t>::min() : 0};
    if (scaled >= 2147483647.0) return {std::numeric_limits<std::int32_t>::max()};
    const auto whole = static_cast<std::int64_t>(scaled);
    const double rest = scaled - static_cast<double>(whole);
    return {saturate(whole + (rest >= 0.5 ? 1 : rest <= -0.5 ? -1 : 0))};
  }
  [[nodiscard]] constexpr double value() const {
    return static_cast<double>(raw) / static_cast<double>(std::int64_t{1} << F);
  }
};

template <int F>
struct Wide {
  static_assert(F >= 0 && F <= 62, "the point lies within the 64 bits");
  std::int64_t raw = 0;

  TRUNNION_INLINE friend constexpr Wide operator+(Wide a, Wide b) { return {a.raw + b.raw}; }
  TRUNNION_INLINE friend constexpr Wide operator-(Wide a, Wide b) { return {a.raw - b.raw}; }
};

/// Eq. (2).
template <int F, int G>
TRUNNION_INLINE constexpr Wide<F + G> operator*(Fixed<F> a, Fixed<G> b) {
  return {static_cast<std::int64_t>(a.raw) * b.raw};
}

/// Eq. (3).
template <int G, int F>
TRUNNION_INLINE constexpr Fixed<G> rounded(Wide<F> wide) {
  static_assert(G <= F, "rounding takes digits away");
  return {static_cast<std::int32_t>(round_shift(wide.raw, F - G))};
}

/// Eq. (4).
template <int G, int F>
TRUNNION_INLINE constexpr Fixed<G> saturated(Wide<F> wide) {
  static_assert(G <= F, "rounding takes digits away");
  return {saturate(round_shift(wide.raw, F - G))};
}

}  // namespace trunnion
