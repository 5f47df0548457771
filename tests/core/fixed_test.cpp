// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/fixed.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace trunnion {
namespace {

__extension__ using Integer = __int128;  // every result below fits, so it is exact rational arithmetic over 2^F

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();

/// floor(a / 2^n + 1/2), exactly.
Integer round_exactly(Integer a, int n) {
  if (n == 0) return a;
  const Integer twice = 2 * a + (Integer{1} << n);
  const Integer divisor = Integer{1} << (n + 1);
  Integer q = twice / divisor;
  if (twice % divisor < 0) --q;
  return q;
}

/// Ends, neighbours of powers of two, and numbers at random.
class Draw {
 public:
  std::int32_t operator()() {
    const auto bits = static_cast<std::uint32_t>(engine_());
    switch (bits & 7U) {
      case 0:
        return kMost;
      case 1:
        return kLeast;
      case 2:
        return static_cast<std::int32_t>((std::uint32_t{1} << ((bits >> 3U) & 31U)) + (bits >> 30U) - 1U);
      default:
        return static_cast<std::int32_t>(engine_());
    }
  }

 private:
  std::mt19937_64 engine_{20261126};
};

TEST(Fixed, ProductsAreExact) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    const Fixed<30> a{draw()};
    const Fixed<23> b{draw()};
    const Wide<53> product = a * b;
    EXPECT_TRUE(Integer{product.raw} == Integer{a.raw} * b.raw);
  }
}

TEST(Fixed, RoundsToTheNearestAndTiesUp) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    const Wide<40> wide{static_cast<std::int64_t>(draw()) * 256 + (draw() & 255)};
    const Integer exact = round_exactly(wide.raw, 20);
    EXPECT_TRUE(Integer{rounded<20>(wide).raw} == exact);
  }
  EXPECT_EQ(rounded<0>(Wide<1>{3}).raw, 2);    // 1.5
  EXPECT_EQ(rounded<0>(Wide<1>{-3}).raw, -1);  // -1.5
  EXPECT_EQ(rounded<1>(Wide<1>{-3}).raw, -3);
}

TEST(Fixed, SaturatesAtTheNearestEnd) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    const Wide<60> wide = Fixed<30>{draw()} * Fixed<30>{draw()};
    const Integer exact = round_exactly(wide.raw, 60 - 31);
    const Integer expected = exact > kMost ? Integer{kMost} : exact < kLeast ? Integer{kLeast} : exact;
    EXPECT_TRUE(Integer{saturated<31>(wide).raw} == expected);
  }
  EXPECT_EQ(saturated<31>(Wide<62>{std::numeric_limits<std::int64_t>::max()}).raw, kMost);
  EXPECT_EQ(saturated<31>(Wide<62>{std::numeric_limits<std::int64_t>::min()}).raw, kLeast);
  EXPECT_EQ(saturate(std::int64_t{kMost} + 1), kMost);
  EXPECT_EQ(saturate(std::int64_t{kLeast} - 1), kLeast);
  EXPECT_EQ(saturate(-5), -5);
}

TEST(Fixed, TakesRealNumbersToTheNearest) {
  static_assert(Fixed<31>::nearest(0.5).raw == 1 << 30);
  static_assert(Fixed<31>::nearest(1.0).raw == kMost);
  static_assert(Fixed<31>::nearest(-1.0).raw == kLeast);
  static_assert(Fixed<0>::nearest(2.5).raw == 3);
  static_assert(Fixed<0>::nearest(-2.5).raw == -3);
  static_assert(Fixed<0>::nearest(0.49999999999999994).raw == 0);
  static_assert(Fixed<16>::nearest(1e300).raw == kMost);
  static_assert(Fixed<16>::nearest(-1e300).raw == kLeast);
  EXPECT_EQ(Fixed<16>::nearest(std::numeric_limits<double>::quiet_NaN()).raw, 0);
  EXPECT_EQ(Fixed<16>::nearest(std::numeric_limits<double>::infinity()).raw, kMost);
  Draw draw;
  for (int i = 0; i < 10000; ++i) {
    const std::int32_t raw = draw();
    EXPECT_EQ(Fixed<29>::nearest(Fixed<29>{raw}.value()).raw, raw);
  }
}

TEST(Fixed, TakesUpperWordsRoundedDown) {
  Draw draw;
  for (int i = 0; i < 100000; ++i) {
    const std::int32_t a = draw();
    const std::int32_t b = draw();
    const Integer product = Integer{a} * b;
    const Integer down = product >= 0 ? product >> 32 : -((-product + ((Integer{1} << 32) - 1)) >> 32);
    EXPECT_TRUE(Integer{kernel::upper(a, b)} == down);
  }
}

}  // namespace
}  // namespace trunnion
