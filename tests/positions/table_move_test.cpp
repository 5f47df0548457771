// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/positions/table_move.hpp"

#include <gtest/gtest.h>

#include <array>

#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/positions/soak.hpp"

namespace trunnion {
namespace {

TEST(TableMove, RestsWhereNeitherAxisTurnsNorSwings) {
  TableMove move;
  move.axis[0].angle = 1.0;
  EXPECT_TRUE(move.is_rest());
  for (AxisCommand& axis : move.axis) {
    axis.rate = -1e-9;
    EXPECT_FALSE(move.is_rest());
    axis.rate = 0.0;
    axis.amplitude = 1e-9;
    EXPECT_FALSE(move.is_rest());
    axis.amplitude = 0.0;
  }
}

TEST(AxisLimits, AreEndlessWithoutTwoStops) {
  AxisLimits limits;
  EXPECT_TRUE(limits.endless());
  limits.lowest = -1.0;
  EXPECT_TRUE(limits.endless());
  limits.highest = 1.0;
  EXPECT_FALSE(limits.endless());
}

TEST(Soak, GoesEvenlyFromEndToEndAndStays) {
  for (const auto& [from, to] : {std::array<double, 2>{-20.0, 60.0}, std::array<double, 2>{60.0, -20.0}}) {
    const Soak soak{from, to, 0.02};
    EXPECT_TRUE(soak.is_known());
    EXPECT_DOUBLE_EQ(soak.duration(), 4000.0);
    EXPECT_EQ(soak.at(-1.0), from);
    EXPECT_EQ(soak.at(0.0), from);
    EXPECT_DOUBLE_EQ(soak.at(1000.0), from + 0.25 * (to - from));
    EXPECT_DOUBLE_EQ(soak.at(soak.duration()), to);
    EXPECT_DOUBLE_EQ(soak.at(1e9), to);
  }
  EXPECT_FALSE(Soak().is_known());
  EXPECT_FALSE((Soak{20.0, 20.0, 0.02}.is_known()));
}

// What was not estimated has no error and no sigma.
TEST(CalibrationValues, AreThoseOfAPerfectUnitAndTableUntilSomethingIsFound) {
  const CalibrationValues values;
  for (std::size_t i = 0; i < kMaxMounts; ++i)
    EXPECT_EQ(values.mount_error[i].norm() + values.lever_arm[i].norm(), 0.0) << i;
  const InertialSample<double> input{Vec3<double>(1, 2, 3), Vec3<double>(4, 5, 6)};
  EXPECT_EQ(values.unit.distort(input).w, input.w);
  EXPECT_EQ(values.unit.distort(input).f, input.f);
}

}  // namespace
}  // namespace trunnion
