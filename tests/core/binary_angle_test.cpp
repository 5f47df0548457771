// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/binary_angle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace trunnion {
namespace {

constexpr BinaryAngle kQuarter = BinaryAngle{1} << 30;

/// Every 4999th angle of the turn, and all within 1000 of the eight borders of the series.
template <class Visit>
void for_many_angles(const Visit& visit) {
  for (std::uint64_t a = 0; a < (std::uint64_t{1} << 32); a += 4999) visit(static_cast<BinaryAngle>(a));
  for (BinaryAngle octant = 0; octant < 8; ++octant) {
    for (BinaryAngle off = 0; off < 2000; ++off) visit((octant << 29U) + off - 1000U);
  }
}

// The laws, for every angle: a quarter of a turn on, sine is cosine; back, it changes its sign.
TEST(SinCos, ObeysTheQuarterTurns) {
  for_many_angles([](BinaryAngle a) {
    const SinCos here = sin_cos(a);
    const SinCos on = sin_cos(a + kQuarter);
    ASSERT_EQ(on.sine.raw, here.cosine.raw);
    ASSERT_EQ(on.cosine.raw, -here.sine.raw);
  });
}

TEST(SinCos, IsWithinItsBound) {
  long double worst = 0.0L;
  long double length = 0.0L;
  constexpr long double kTurn = 2.0L * 3.14159265358979323846264338327950288L / 4294967296.0L;
  constexpr long double kOne = 2147483648.0L;
  for_many_angles([&](BinaryAngle a) {
    const SinCos found = sin_cos(a);
    const long double s = static_cast<long double>(found.sine.raw) / kOne;
    const long double c = static_cast<long double>(found.cosine.raw) / kOne;
    const long double angle = kTurn * static_cast<long double>(a);
    worst = std::max({worst, std::abs(s - std::sin(angle)), std::abs(c - std::cos(angle))});
    length = std::max(length, std::abs(s * s + c * c - 1.0L));
  });
  std::printf("[ FIGURE   ] sine and cosine in Q31: largest error %.2g\n", static_cast<double>(worst));
  EXPECT_LT(worst, 1.2e-9L);
  EXPECT_LT(length, 2.4e-9L);
}

TEST(SinCos, IsAConstantExpression) {
  static_assert(sin_cos(0).sine.raw == 0);
  static_assert(sin_cos(0).cosine.raw == 2147483647);
  static_assert(sin_cos(kQuarter).sine.raw == 2147483647);
  static_assert(sin_cos(2 * kQuarter).cosine.raw == -2147483647);
}

}  // namespace
}  // namespace trunnion
