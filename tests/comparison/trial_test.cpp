// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/comparison/trial.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "calibration/experiment.hpp"
#include "calibration/gimbal.hpp"

namespace trunnion::comparison {
namespace {

TrialSettings settings() {
  TrialSettings s;
  s.table = calibration::cyclic_rig();
  s.limits[kPitch].lowest = -10.0 * kRadPerDeg;
  s.limits[kPitch].highest = 70.0 * kRadPerDeg;
  s.gimbal = calibration::level_gimbal();
  s.site = calibration::bench();
  s.height = 220.0;
  s.run.mount_error = 0.05 * kRadPerDeg;
  return s;
}

const Outcome& of(const Trial& trial, Method method) {
  for (const auto& [one, outcome] : trial.methods) {
    if (one == method) return outcome;
  }
  throw std::runtime_error("not there");
}

TEST(Trial, EveryMethodAnswersAndOursIsTheBest) {
  const Trial trial = run_trial(settings(),
                                {Method::kTraditional, Method::kRateTest, Method::kKalman36, Method::kByHand,
                                 Method::kThreeAxis, Method::kTwelvePosition, Method::kExperiment},
                                3);
  ASSERT_EQ(trial.methods.size(), 7U);
  for (const auto& [method, outcome] : trial.methods)
    EXPECT_TRUE(outcome.failure.empty()) << kMethodNames[static_cast<std::size_t>(method)] << ": " << outcome.failure;
  const Outcome& ours = of(trial, Method::kExperiment);
  EXPECT_LE(ours.installation_deg, 0.001);
  EXPECT_GE(of(trial, Method::kRateTest).installation_deg, 10.0 * ours.installation_deg);
  EXPECT_GE(of(trial, Method::kKalman36).aligned_deg, ours.aligned_deg);
  EXPECT_LE(of(trial, Method::kKalman36).aligned_deg, 0.02);  // no straw man
  EXPECT_LE(of(trial, Method::kByHand).accel_scale_ppm, 50.0);
  EXPECT_LT(of(trial, Method::kTraditional).aligned_deg, 0.0);  // it has no accelerometers
}

TEST(Trial, IsTheSameAgain) {
  const Trial a = run_trial(settings(), {Method::kTraditional}, 4);
  const Trial b = run_trial(settings(), {Method::kTraditional}, 4);
  EXPECT_EQ(of(a, Method::kTraditional).installation_deg, of(b, Method::kTraditional).installation_deg);
  EXPECT_NE(of(a, Method::kTraditional).installation_deg,
            of(run_trial(settings(), {Method::kTraditional}, 5), Method::kTraditional).installation_deg);
}

/// Without noise, wander and errors of the unit an hour of the table's motions ends where it began, in every arm.
TEST(Trial, NavigationOfAPerfectUnitStaysWhereItIs) {
  TrialSettings s = settings();
  s.run = s.run.noise_free();
  s.run.gyro_bias = s.run.gyro_turn_on_bias = s.run.gyro_scale = s.run.gyro_cross_coupling = s.run.gyro_cubic = 0.0;
  s.run.gyro_g_sensitivity = s.run.accel_bias = s.run.accel_turn_on_bias = s.run.accel_scale = 0.0;
  s.run.accel_cross_coupling = 0.0;
  // what the solve weighs by; the run has none
  s.navigations = 1;
  s.navigation_time = 600.0;
  s.run.noise.gyro.density = s.run.noise.accel.density = 1e-9;
  const Trial trial = run_trial(s, {Method::kExperiment}, 1);
  ASSERT_EQ(trial.navigations.size(), 1U) << trial.methods.front().second.failure;
  for (const auto* error : {&trial.navigations[0].raw, &trial.navigations[0].calibrated, &trial.navigations[0].floor}) {
    std::printf("[ FIGURE   ] perfect unit, 600 s of the table's motions: %.2f m, %.2e deg\n", error->position_m,
                error->attitude_deg);
    EXPECT_LT(error->position_m, 5.0);
    EXPECT_LT(error->attitude_deg, 1e-3);
  }
}

}  // namespace
}  // namespace trunnion::comparison
