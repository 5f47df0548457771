// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Angles as 32-bit fractions of a turn, which wrap by themselves, and their sine and cosine in Q31.
///
///   angle = 2 pi a / 2^32,   a = 2^30 q + r,   -2^29 <= r < 2^29,   t = r / 2^29                  ... (1)
///   sin(pi t / 4) = t P(t^2),   cos(pi t / 4) = 1 - t^2 Q(t^2),  then by the quadrant q            ... (2)
///
/// P has five and Q four coefficients, least in the largest error over |t| <= 1 (3e-12 and 2e-10); with the rounding of
/// 32-bit products sine and cosine are within 1.2e-9, as tests/core/binary_angle_test.cpp shows. 1 is held as 1 -
/// 2^-31. Cody & Waite, Software Manual for the Elementary Functions (1980), ch. 8, for the reduction.

#pragma once

#include <cstdint>

#include "trunnion/core/fixed.hpp"

namespace trunnion {

/// 2^32 is a turn.
using BinaryAngle = std::uint32_t;

/// Sine and cosine; together the phasor exp(i angle).
struct SinCos {
  Fixed<31> sine;
  Fixed<31> cosine;
};

/// Eq. (2). No table, no branch, no library; the same bits everywhere.
TRUNNION_INLINE constexpr SinCos sin_cos(BinaryAngle angle) {
  using kernel::upper;
  // coefficients of t^2k times 4^k, since each product with t^2 in Q30 is taken down by 2^32; those of Q in Q32
  constexpr std::int32_t kP0 = Fixed<31>::nearest(7.85398163394057e-01).raw;
  constexpr std::int32_t kP1 = Fixed<31>::nearest(-8.07455120185652e-02 * 4.0).raw;
  constexpr std::int32_t kP2 = Fixed<31>::nearest(2.49039321125299e-03 * 16.0).raw;
  constexpr std::int32_t kP3 = Fixed<31>::nearest(-3.65723943543127e-05 * 64.0).raw;
  constexpr std::int32_t kP4 = Fixed<31>::nearest(3.08997548086650e-07 * 256.0).raw;
  constexpr std::int32_t kQ0 = Fixed<31>::nearest(3.08425137344008e-01 * 2.0).raw;
  constexpr std::int32_t kQ1 = Fixed<31>::nearest(-1.58543381553911e-02 * 8.0).raw;
  constexpr std::int32_t kQ2 = Fixed<31>::nearest(3.25961401826194e-04 * 32.0).raw;
  constexpr std::int32_t kQ3 = Fixed<31>::nearest(-3.54196703426898e-06 * 128.0).raw;
  const BinaryAngle quadrant = (angle + (BinaryAngle{1} << 29)) >> 30;
  const auto t = static_cast<std::int32_t>(angle << 2);  // Q31: the quadrant is what falls out
  const std::int32_t t2 = upper(t, t);                   // Q30
  const std::int32_t p = kP0 + upper(kP1 + upper(kP2 + upper(kP3 + upper(kP4, t2), t2), t2), t2);
  const std::int32_t q = kQ0 + upper(kQ1 + upper(kQ2 + upper(kQ3, t2), t2), t2);
  const auto s = static_cast<std::int32_t>((static_cast<std::int64_t>(t) * p + (std::int64_t{1} << 30)) >> 31);
  const auto c = static_cast<std::int32_t>(std::int64_t{std::numeric_limits<std::int32_t>::max()} -
                                           ((static_cast<std::int64_t>(t2) * q) >> 31));
  const bool odd = (quadrant & 1U) != 0;
  const std::int32_t sign = -static_cast<std::int32_t>((quadrant >> 1U) & 1U);
  const std::int32_t sine = odd ? c : s;
  const std::int32_t cosine = odd ? -s : c;
  return {{(sine ^ sign) - sign}, {(cosine ^ sign) - sign}};
}

}  // namespace trunnion
