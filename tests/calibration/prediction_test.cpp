// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/prediction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "calibration/experiment.hpp"

namespace trunnion::calibration {
namespace {

PredictionOptions options_of(const simulation::TableRunSettings& settings) {
  PredictionOptions options;
  options.solve.noise = settings.noise;
  options.rate = settings.rate;
  options.encoder_rate = settings.encoder_rate;
  options.encoder_quantum = 2.0 * kPi / std::ldexp(1.0, settings.encoder_bits);
  options.largest_rate = 50.0 * kRadPerDeg;
  return options;
}

PlannedMotion planned(const simulation::TableMotion& motion) {
  return {[motion](double t) {
            return std::array<double, 2>{motion.azimuth.angle(t), motion.pitch.angle(t)};
          },
          motion.duration};
}

simulation::TableMotion mount_motion(int mount) {
  return simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, mount));
}

/// Every sigma is that of the solve of a simulated run, whose unit and table are not perfect.
TEST(Prediction, IsTheCovarianceOfTheSolve) {
  simulation::TableRunSettings settings;
  settings.seed = 3;
  const Experiment experiment = run_experiment(settings, bench());
  TableSolveOptions solve;
  solve.noise = settings.noise;
  const Rig rig = cyclic_rig();
  const Solution solution = solve_table(experiment.recordings, rig, bench(), solve);
  const Predictor predictor(rig, bench(), {0, 1, 2}, options_of(settings));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(predictor.parameters().size()),
                                                      static_cast<Eigen::Index>(predictor.parameters().size()));
  const auto start = std::chrono::steady_clock::now();
  for (int m = 0; m < 3; ++m)
    information += predictor.information(static_cast<std::size_t>(m), planned(mount_motion(m)));
  std::printf("[ FIGURE   ] prediction of 2115 s of table time: %.2f s\n",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  const Observability predicted = predictor.conclude(information);
  EXPECT_TRUE(predicted.refused.empty()) << describe(predicted);
  const Eigen::VectorXd fast = predictor.sigmas(information);
  // the heading decides which horizontal axis sees the Earth turn: what hangs on it, and on the noise's estimate, may
  // differ by more
  const double inflation = std::sqrt(std::max(1.0, solution.record.fit.reduced_chi_square));
  double worst = 0.0;
  for (std::size_t i = 0; i < predictor.parameters().size(); ++i) {
    const Parameter& p = predictor.parameters()[i];
    ASSERT_EQ(p.name, solution.parameters[i].name);
    const auto at = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(predicted.covariance(at, at));
    EXPECT_NEAR(fast(at) / sigma, 1.0, 1e-6) << p.name;
    if (p.name.find("tilt") != std::string::npos || p.name == "heading") continue;
    const double ratio = std::sqrt(solution.observability.covariance(at, at)) / inflation / sigma;
    EXPECT_NEAR(ratio, 1.0, 0.02) << p.name;
    worst = std::max(worst, std::abs(ratio - 1.0));
  }
  std::printf("[ FIGURE   ] predicted sigmas against those of a solve: %.1f %% at most\n", 100.0 * worst);
}

TEST(Prediction, NamesWhatOneMountDoesNotTell) {
  const simulation::TableRunSettings settings;
  const Rig rig = cyclic_rig();
  const Predictor predictor(rig, bench(), {0}, options_of(settings));
  const Observability predicted = predictor.conclude(predictor.information(0, planned(mount_motion(0))));
  EXPECT_THAT(describe(predicted), testing::HasSubstr("accelerometer y scale"));
}

TEST(Prediction, ShowsThePairThatIsHardToTellApart) {
  const simulation::TableRunSettings settings;
  const Rig rig = cyclic_rig();
  const Predictor predictor(rig, bench(), {0, 1, 2}, options_of(settings));
  Eigen::MatrixXd information = predictor.information(0, planned(mount_motion(0)));
  for (int m = 1; m < 3; ++m)
    information += predictor.information(static_cast<std::size_t>(m), planned(mount_motion(m)));
  const Observability predicted = predictor.conclude(information);
  const Entanglement worst = worst_entanglement(predicted.covariance, predictor.parameters());
  // by its definition: what the sigma is once the other is known
  const auto a = static_cast<Eigen::Index>(worst.entry);
  const auto b = static_cast<Eigen::Index>(worst.with);
  const Eigen::MatrixXd& P = predicted.covariance;
  const double known = P(a, a) - P(a, b) * P(a, b) / P(b, b);
  EXPECT_NEAR(worst.price, std::sqrt(P(a, a) / known), 1e-6);
  EXPECT_GT(worst.price, 1.1);
  EXPECT_LT(worst.price, 100.0);
  std::printf("[ FIGURE   ] experiment: %s with %s, correlation %.3f, sigma %.2f times what it would be\n",
              predictor.parameters()[worst.entry].name.c_str(), predictor.parameters()[worst.with].name.c_str(),
              worst.correlation, worst.price);
}

}  // namespace
}  // namespace trunnion::calibration
