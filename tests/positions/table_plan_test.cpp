// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/positions/table_plan.hpp"

#include <gtest/gtest.h>

namespace trunnion {
namespace {

constexpr double kLowest = -10.0 * kRadPerDeg;
constexpr double kHighest = 70.0 * kRadPerDeg;

TEST(TablePlan, AsksForRestsOverTheRangeAndForTurnsBothWays) {
  const TablePlan plan(PlanRequest(), kLowest, kHighest);
  ASSERT_EQ(plan.size(), 5 + 10);
  EXPECT_DOUBLE_EQ(plan[0].pitch_from, kLowest);
  EXPECT_DOUBLE_EQ(plan[4].pitch_to, kHighest);
  for (int i = 1; i < 5; ++i) EXPECT_DOUBLE_EQ(plan[i].pitch_from, plan[i - 1].pitch_to);
  for (int i = 5; i < 15; i += 2) EXPECT_EQ(plan[i].rate, -plan[i + 1].rate);
}

TEST(TablePlan, IsDoneWhenEveryStepWasSeenLongEnough) {
  TablePlan plan(PlanRequest(), kLowest, kHighest);
  const auto see = [&](double seconds, double azimuth_rate, double pitch, double pitch_rate) {
    for (double t = 0.05; t < seconds; t += 0.1) plan.see(0.1, azimuth_rate, pitch, pitch_rate);
  };
  EXPECT_EQ(plan.next(), 0);
  see(30.0, 0.0, 0.0, 0.1);  // neither a rest nor a turn
  EXPECT_EQ(plan.next(), 0);
  EXPECT_EQ(plan[0].seen, 0.0);
  for (int i = 0; i < 5; ++i) see(10.1, 0.0, (-2.0 + 16.0 * i) * kRadPerDeg, 0.0);
  EXPECT_EQ(plan.next(), 5);
  for (int i = 5; i < plan.size(); ++i) {
    EXPECT_EQ(plan.next(), i);
    see(20.1, 0.9 * plan[i].rate, 0.5, 0.3);
  }
  EXPECT_EQ(plan.next(), -1);
}

TEST(TablePlan, ARestAtTheLimitOfThePitchCounts) {
  TablePlan plan(PlanRequest(), kLowest, kHighest);
  plan.see(1.0, 0.0, kHighest + 1e-4, 0.0);
  plan.see(1.0, 0.0, kLowest - 1e-4, 0.0);
  EXPECT_EQ(plan[4].seen, 1.0);
  EXPECT_EQ(plan[0].seen, 1.0);
}

}  // namespace
}  // namespace trunnion
