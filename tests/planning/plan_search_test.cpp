// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/planning/plan_search.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "calibration/experiment.hpp"

namespace trunnion::planning {
namespace {

/// The usual table; what makes a search quick is how little is wanted.
Bench small_bench(const Rig& rig) {
  Bench b;
  b.rig = &rig;
  b.site = calibration::bench();
  b.mounts = {0, 1, 2};
  b.limits[kPitch].lowest = -10.0 * kRadPerDeg;
  b.limits[kPitch].highest = 70.0 * kRadPerDeg;
  for (AxisLimits& axis : b.limits) {
    axis.rate = 50.0 * kRadPerDeg;
    axis.acceleration = 50.0 * kRadPerDeg;
  }
  b.largest_rate = 50.0 * kRadPerDeg;
  b.prediction.solve.noise = simulation::TableRunSettings().noise;
  b.prediction.encoder_quantum = 2.0 * kPi / std::ldexp(1.0, 21);
  return b;
}

WantedSigmas wanted(double cross_coupling_deg) {
  WantedSigmas w = nothing_wanted();
  w[static_cast<std::size_t>(Entry::kGyroCrossCoupling)] = cross_coupling_deg;
  return w;
}

TEST(PlanSearch, KeepsTheTimeAndTheJoints) {
  const Rig rig = calibration::cyclic_rig();
  const Bench b = small_bench(rig);
  const Plan plan = search(b, wanted(0.001), 200.0, 7200.0);
  EXPECT_LE(plan.duration(), 200.0);
  EXPECT_GE(plan.duration(), 150.0);
  for (const TableSequence& sequence : plan.recordings)
    EXPECT_NO_THROW(simulation::check_limits(sequence, b.limits, "plan"));
  std::printf("[ FIGURE   ] best plan of 200 s: worst gyro cross-coupling %.5f deg\n",
              0.001 * plan.worst(wanted(0.001)));
  // what it predicts is what predict() says of its moves
  const Plan again = predict(b, plan.recordings);
  EXPECT_NEAR(again.worst(wanted(0.001)), plan.worst(wanted(0.001)), 1e-12);
}

TEST(PlanSearch, MoreTimeIsNoWorse) {
  const Rig rig = calibration::cyclic_rig();
  const Bench b = small_bench(rig);
  EXPECT_LE(search(b, wanted(0.001), 260.0, 7200.0).worst(wanted(0.001)),
            search(b, wanted(0.001), 180.0, 7200.0).worst(wanted(0.001)));
}

TEST(PlanSearch, TakesNoMoreTimeThanIsWanted) {
  const Rig rig = calibration::cyclic_rig();
  const Bench b = small_bench(rig);
  const Plan plan = search(b, wanted(0.0025), 0.0, 7200.0);
  EXPECT_LE(plan.worst(wanted(0.0025)), 1.0);
  EXPECT_LE(plan.duration(), 400.0);
}

TEST(PlanSearch, SaysSoWhenItIsNotReached) {
  const Rig rig = calibration::cyclic_rig();
  const Bench b = small_bench(rig);
  const Plan plan = search(b, wanted(1e-6), 0.0, 160.0);
  EXPECT_GT(plan.worst(wanted(1e-6)), 1.0);
  EXPECT_LE(plan.duration(), 160.0);
}

TEST(PlanSearch, AnAdditionHelps) {
  const Rig rig = calibration::cyclic_rig();
  const Bench b = small_bench(rig);
  std::vector<TableSequence> sequences;
  for (int m = 0; m < 3; ++m)
    sequences.push_back(simulation::experiment(b.limits[kPitch].lowest, b.limits[kPitch].highest, m));
  const Addition more = cheapest_addition(b, predict(b, sequences), nothing_wanted());
  EXPECT_LT(more.cost_after, more.cost_before);
  EXPECT_GT(more.seconds, 0.0);
  EXPECT_FALSE(more.what.empty());
}

}  // namespace
}  // namespace trunnion::planning
