// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A soak from -20 to 60 degC: the polynomials of biases and scales within their sigmas, and their order from the data.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <limits>

#include "experiment.hpp"
#include "matchers/refuses.hpp"
#include "trunnion/calibration/model_choice.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/error_model/thermal_correction.hpp"

namespace trunnion::calibration {
namespace {

constexpr AxisLimits kPitchLimits{-10.0 * kRadPerDeg, 70.0 * kRadPerDeg};

simulation::TableRunSettings soaked(std::uint64_t seed, int order, double kelvin_per_minute) {
  simulation::TableRunSettings settings;
  settings.seed = seed;
  settings.rate = 100.0;
  settings.soak = {-20.0, 60.0, kelvin_per_minute / 60.0};
  settings.thermal_order = order;
  return settings;
}

/// @param hold s, at the end of the ramp in every recording
Experiment run_soak(const simulation::TableRunSettings& settings, double hold = 0.0) {
  const Rig rig = cyclic_rig();
  Experiment experiment;
  experiment.truth = simulation::draw_truth(settings, rig, bench(), kMounts);
  for (int m = 0; m < kMounts; ++m) {
    Compressor compressor({});
    simulation::TableSinks sinks;
    sinks.imu = [&](std::int64_t t, std::int64_t, const InertialSample<double>& s) { compressor.imu(t, s); };
    sinks.encoder = [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); };
    sinks.temperature = [&](double celsius) { compressor.temperature(celsius); };
    simulation::run_table(settings, experiment.truth, rig, bench(),
                          simulation::motion_of(simulation::soak(kPitchLimits, settings.soak.duration() + hold, m)), m,
                          m, sinks);
    experiment.recordings.push_back({compressor.finish(), m});
  }
  return experiment;
}

TableSolveOptions options_for(const simulation::TableRunSettings& settings, int order) {
  TableSolveOptions options;
  options.noise = settings.noise;
  options.terms.temperature = order;
  return options;
}

/// Of the polynomials' coefficients in @p solution against the truth.
double thermal_nees(const Solution& solution, const CalibrationValues& truth, int order) {
  const int n = 12 * order;
  Eigen::VectorXd error(n);
  Eigen::MatrixXd covariance(n, n);
  int first = 0;
  while (solution.parameters[static_cast<std::size_t>(first)].kind != Entry::kGyroThermalBias) ++first;
  const ThermalErrors<double>& found = solution.record.value.unit.thermal;
  for (int k = 0; k < order; ++k) {
    const auto at = static_cast<std::size_t>(k);
    error.segment<3>(12 * k) = found.bias[at].w - truth.unit.thermal.bias[at].w;
    error.segment<3>(12 * k + 3) = found.bias[at].f - truth.unit.thermal.bias[at].f;
    error.segment<3>(12 * k + 6) = found.scale[at].w - truth.unit.thermal.scale[at].w;
    error.segment<3>(12 * k + 9) = found.scale[at].f - truth.unit.thermal.scale[at].f;
  }
  covariance = solution.observability.covariance.block(first, first, n, n);
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale(i) = 1.0 / std::sqrt(covariance(i, i));
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  error = scale.cwiseProduct(error);
  return error.dot(covariance.ldlt().solve(error));
}

ModelChoice chosen(const Experiment& experiment, const simulation::TableRunSettings& settings) {
  ModelChoice choice = choose_model(experiment.recordings, cyclic_rig(), bench(), options_for(settings, 0));
  for (const TermVerdict& v : choice.verdicts)
    std::printf("[ FIGURE   ] truth of order %d: %s %s: chi-square %.1f less, asked %.1f, held-out %.1f\n",
                settings.thermal_order, v.term.c_str(), v.taken ? "taken" : "left", v.gain, v.asked, v.held_out_gain);
  return choice;
}

TEST(Soak, RecoversAThirdOrderWithinItsSigmas) {
  constexpr int kSeeds = 5;
  double nees = 0.0;
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto settings = soaked(seed, 3, 1.0);
    const Experiment experiment = run_soak(settings);
    const Solution solution = solve_table(experiment.recordings, cyclic_rig(), bench(), options_for(settings, 3));
    ASSERT_TRUE(solution.observability.refused.empty()) << describe(solution.observability);
    const ThermalErrors<double>& thermal = solution.record.value.unit.thermal;
    EXPECT_EQ(thermal.order(), 3);
    EXPECT_EQ(thermal.reference, experiment.truth.unit.thermal.reference);
    nees += thermal_nees(solution, experiment.truth, 3);
    EXPECT_LT(solution.record.fit.reduced_chi_square, 1.05);
    // what it is for: the bias at the ends
    for (const double celsius : {-20.0, 60.0}) {
      const Vec3<double> off = thermal.at(celsius, thermal.bias).w -
                               experiment.truth.unit.thermal.at(celsius, experiment.truth.unit.thermal.bias).w;
      worst = std::max(worst, off.cwiseAbs().maxCoeff() / kRadPerSPerDegPerH);
    }
  }
  // 36 coefficients, 5 seeds: chi-square of 180, two-sided 1 %
  std::printf(
      "[ FIGURE   ] soak of third order: NEES %.1f of 180 (band 134.9 to 232.6), gyro bias at the ends off by "
      "%.2f deg/h at most\n",
      nees, worst);
  EXPECT_GT(nees, 134.9);
  EXPECT_LT(nees, 232.6);
  // five seeds, two ends, three axes at some 0.9 deg/h each: 4.5 sigmas
  EXPECT_LT(worst, 4.0);
}

// A chamber that stays at its end: three quarters of the data are at one temperature. The weights keep them from
// carrying the fit, and the covariance is that of the weighted estimate: neither too small nor too large.
TEST(Soak, HasAnHonestCovarianceWhereTheRangeIsUneven) {
  constexpr int kSeeds = 5;
  double nees = 0.0;
  double optimistic = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto settings = soaked(100 + seed, 2, 8.0);
    const Experiment experiment = run_soak(settings, 1800.0);
    TableSolveOptions options = options_for(settings, 2);
    const Solution solution = solve_table(experiment.recordings, cyclic_rig(), bench(), options);
    ASSERT_TRUE(solution.observability.refused.empty()) << describe(solution.observability);
    EXPECT_LT(solution.record.fit.reduced_chi_square, 1.1);
    nees += thermal_nees(solution, experiment.truth, 2);
    options.even_temperatures = false;
    const Solution unweighted = solve_table(experiment.recordings, cyclic_rig(), bench(), options);
    const auto matrix_sigma = [](const Solution& s) { return std::sqrt(s.observability.covariance(0, 0)); };
    optimistic += matrix_sigma(solution) / matrix_sigma(unweighted) / kSeeds;
  }
  // 24 coefficients, 5 seeds: chi-square of 120, two-sided 1 %
  std::printf(
      "[ FIGURE   ] soak with a hold: NEES %.1f of 120 (band 83.9 to 163.6); the weights cost the gyro's scale a "
      "factor of %.2f\n",
      nees, optimistic);
  EXPECT_GT(nees, 83.9);
  EXPECT_LT(nees, 163.6);
  EXPECT_GT(optimistic, 1.2);  // with the weights' first powers in the middle it would be about one
}

// A unit that states the temperature of a room has no terms of it: neither a fit nor the choice of a model fails.
TEST(Soak, IsNotSeenInASteadyRoom) {
  simulation::TableRunSettings settings;
  settings.seed = 3;
  Experiment experiment = run_experiment(settings, bench());
  for (TableRecording& recording : experiment.recordings) {
    for (ObservationWindow& window : recording.data.windows)
      window.temperature = 25.0 + 0.2 * std::sin(0.01 * window.t);
  }
  const ModelChoice choice = chosen(experiment, settings);
  EXPECT_EQ(choice.terms.temperature, 0);
  EXPECT_EQ(choice.verdicts.back().term, "temperature");
  EXPECT_NE(choice.verdicts.back().why.find("too little"), std::string::npos);
  // nor does a thermometer that was on in one recording only
  for (ObservationWindow& window : experiment.recordings[1].data.windows)
    window.temperature = std::numeric_limits<double>::quiet_NaN();
  const ModelChoice again = chosen(experiment, settings);
  EXPECT_EQ(again.solution.record.fit.windows, choice.solution.record.fit.windows);
  EXPECT_NE(again.verdicts.back().why.find("states no temperature"), std::string::npos);
  EXPECT_REFUSES(ExitCode::kInput, "states no temperature",
                 solve_table(experiment.recordings, cyclic_rig(), bench(), options_for(settings, 1)));
}

// A wrong reading makes no range: the reference and the ends are those of the soak.
TEST(Soak, PassesOverAThermometersMistake) {
  const auto settings = soaked(7, 1, 8.0);
  Experiment experiment = run_soak(settings);
  auto& windows = experiment.recordings[0].data.windows;
  for (std::size_t k = 0; k < 4; ++k) windows[k].temperature = 125.0;
  windows[1000].temperature = 600.0;
  const Solution solution = solve_table(experiment.recordings, cyclic_rig(), bench(), options_for(settings, 1));
  const ThermalErrors<double>& thermal = solution.record.value.unit.thermal;
  EXPECT_EQ(thermal.reference, 20.0);
  EXPECT_NEAR(thermal.lowest, -20.0, 0.5);
  EXPECT_NEAR(thermal.highest, 60.0, 0.5);
  EXPECT_LT(thermal_nees(solution, experiment.truth, 1), 32.9);  // chi-square of 12 at 0.1 %
}

TEST(Soak, TheDataAskForTheOrderThatTheyHave) {
  for (const int order : {3, 5}) {
    const auto settings = soaked(static_cast<std::uint64_t>(10 + order), order, 5.0);
    const ModelChoice choice = chosen(run_soak(settings), settings);
    EXPECT_EQ(choice.terms.temperature, order);
    EXPECT_FALSE(choice.terms.asymmetry);
    EXPECT_FALSE(choice.terms.size_effect);
    EXPECT_FALSE(choice.terms.quadratic);
  }
}

}  // namespace
}  // namespace trunnion::calibration
