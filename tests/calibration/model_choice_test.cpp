// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/model_choice.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "calibration/experiment.hpp"

namespace trunnion::calibration {
namespace {

ModelChoice chosen(const simulation::TableRunSettings& settings) {
  const Experiment experiment = run_experiment(settings, bench());
  TableSolveOptions options;
  options.noise = settings.noise;
  const Rig rig = cyclic_rig();
  ModelChoice choice = choose_model(experiment.recordings, rig, bench(), options);
  for (const TermVerdict& v : choice.verdicts)
    std::printf("[ FIGURE   ] seed %d, %s %s: chi-square %.1f less, asked %.1f, held-out %.1f\n",
                static_cast<int>(settings.seed), v.term.c_str(), v.taken ? "taken" : "left", v.gain, v.asked,
                v.held_out_gain);
  return choice;
}

/// Terms that the truth has well above what the data can tell are taken, one that it has not is left; over seeds.
TEST(ModelChoice, TakesWhatIsThere) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    simulation::TableRunSettings settings;
    settings.seed = seed;
    settings.gyro_cubic = 2e-3;
    settings.gyro_g_sensitivity = 50.0 * kRadPerSPerDegPerH / kStandardGravity;
    const ModelChoice choice = chosen(settings);
    EXPECT_TRUE(choice.terms.cubic);
    EXPECT_TRUE(choice.terms.g_sensitivity);
    EXPECT_FALSE(choice.terms.quadratic);
    EXPECT_TRUE(choice.solution.observability.refused.empty());
  }
}

TEST(ModelChoice, LeavesWhatIsNot) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    simulation::TableRunSettings settings;
    settings.seed = seed;
    settings.gyro_cubic = 0.0;
    settings.gyro_g_sensitivity = 0.0;
    settings.accel_quadratic = 1e-4;
    const ModelChoice choice = chosen(settings);
    EXPECT_FALSE(choice.terms.cubic);
    EXPECT_FALSE(choice.terms.g_sensitivity);
    EXPECT_TRUE(choice.terms.quadratic);
  }
}

}  // namespace
}  // namespace trunnion::calibration
