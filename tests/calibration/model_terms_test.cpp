// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Asymmetry and size effect: exact without noise, within their sigmas with it, and taken where they are there.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>

#include "experiment.hpp"
#include "trunnion/calibration/model_choice.hpp"

namespace trunnion::calibration {
namespace {

constexpr int kEntries = 12;

simulation::TableRunSettings settings_of(std::uint64_t seed) {
  simulation::TableRunSettings settings;
  settings.seed = seed;
  settings.gyro_asymmetry = 200e-6;
  settings.accel_asymmetry = 100e-6;
  settings.accel_place = 0.01;
  return settings;
}

TableSolveOptions options_for(const simulation::TableRunSettings& settings) {
  TableSolveOptions options;
  options.noise = settings.noise;
  options.terms.asymmetry = options.terms.size_effect = true;
  return options;
}

/// The two terms of @p unit, in the order of their unknowns.
Eigen::Matrix<double, kEntries, 1> entries_of(const InertialUnit<double>& unit) {
  Eigen::Matrix<double, kEntries, 1> all;
  all << unit.gyro.asymmetry, unit.accel.asymmetry, unit.accel_place.col(1), unit.accel_place.col(2);
  return all;
}

TEST(ModelTerms, AreExactWithoutNoise) {
  simulation::TableRunSettings settings = settings_of(1);
  const UnitNoise noise = settings.noise;
  settings = settings.noise_free();
  const Experiment experiment = run_experiment(settings, bench());
  TableSolveOptions options = options_for(settings);
  options.noise = noise;
  const Solution solution = solve_table(experiment.recordings, cyclic_rig(), bench(), options);
  const InertialUnit<double>& found = solution.record.value.unit;
  const InertialUnit<double>& truth = experiment.truth.unit;
  const Eigen::Matrix<double, kEntries, 1> error = entries_of(found) - entries_of(truth);
  std::printf("[ FIGURE   ] without noise: asymmetry off by %.2g ppm, places by %.2g um\n",
              error.head<6>().cwiseAbs().maxCoeff() * 1e6, error.tail<6>().cwiseAbs().maxCoeff() * 1e6);
  EXPECT_LT(error.head<6>().cwiseAbs().maxCoeff(), 0.05e-6);
  EXPECT_LT(error.tail<6>().cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((found.accel.M - truth.accel.M).cwiseAbs().maxCoeff(), 0.05e-6);
}

TEST(ModelTerms, AreWithinTheirSigmas) {
  constexpr int kSeeds = 10;
  double nees = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const simulation::TableRunSettings settings = settings_of(seed);
    const Experiment experiment = run_experiment(settings, bench());
    const Solution solution = solve_table(experiment.recordings, cyclic_rig(), bench(), options_for(settings));
    ASSERT_TRUE(solution.observability.refused.empty()) << describe(solution.observability);
    const Eigen::Matrix<double, kEntries, 1> error =
        entries_of(solution.record.value.unit) - entries_of(experiment.truth.unit);
    int first = 0;
    while (solution.parameters[static_cast<std::size_t>(first)].kind != Entry::kGyroAsymmetry) ++first;
    Eigen::MatrixXd covariance = solution.observability.covariance.block(first, first, kEntries, kEntries);
    const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
    const Eigen::VectorXd scaled = scale.cwiseProduct(error);
    nees += scaled.dot(covariance.ldlt().solve(scaled));
  }
  // chi-square of 120, two-sided 1 %
  std::printf("[ FIGURE   ] asymmetry and size effect: NEES %.1f of 120 (band 83.9 to 163.6)\n", nees);
  EXPECT_GT(nees, 83.9);
  EXPECT_LT(nees, 163.6);
}

TEST(ModelTerms, AreTakenWhereTheyAreThere) {
  const simulation::TableRunSettings settings = settings_of(21);
  const Experiment experiment = run_experiment(settings, bench());
  const ModelChoice choice = choose_model(experiment.recordings, cyclic_rig(), bench(), options_for(settings));
  EXPECT_TRUE(choice.terms.asymmetry);
  EXPECT_TRUE(choice.terms.size_effect);
  EXPECT_FALSE(choice.terms.quadratic);
  EXPECT_EQ(choice.terms.temperature, 0);
}

}  // namespace
}  // namespace trunnion::calibration
