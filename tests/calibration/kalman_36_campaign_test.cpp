// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The 36-state filter over seeds. Prints its figures.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>

#include "calibration/nav_grade.hpp"
#include "matchers/chi_square.hpp"

namespace trunnion::calibration {
namespace {

/// Its covariance is true: NEES of all thirty parameters over 10 seeds within the band that chi-square leaves one time
/// in a hundred.
TEST(Kalman36, CovarianceIsTrue) {
  constexpr int kSeeds = 10;
  double nees = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    simulation::TableRunSettings settings = nav_grade();
    settings.seed = seed;
    Recorded run;
    record(settings, simulation::nineteen_positions(40.0, 10.0 * kRadPerDeg), run);
    const Kalman36Result result = filtered(run);
    const InertialUnit<double> t = in_accelerometer_frame(run.truth.unit);
    Eigen::Matrix<double, 30, 1> error;
    error.segment<3>(0) = result.unit.gyro.bias - t.gyro.bias;
    error.segment<3>(3) = result.unit.accel.bias - t.accel.bias;
    for (int i = 0; i < 9; ++i) error(6 + i) = result.unit.gyro.M(i / 3, i % 3) - t.gyro.M(i / 3, i % 3);
    int place = 15;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) error(place++) = result.unit.accel.M(i, j) - t.accel.M(i, j);
    }
    error.segment<3>(21) = result.unit.accel.quadratic;
    error.segment<3>(24) = result.lever[0];
    error.segment<3>(27) = result.lever[1];
    nees += error.dot(result.covariance.llt().solve(error));
  }
  const ChiSquareBand band = chi_square_band(30 * kSeeds, 0.01);
  std::printf("[ FIGURE   ] 36 states, nav grade, %d seeds: NEES %.1f in [%.1f, %.1f]\n", kSeeds, nees, band.low,
              band.high);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

/// The least-squares bound and the filter without encoder side by side: rms over 10 seeds and the entries.
TEST(Kalman36, NavigationGradeBesideTheBatchSolve) {
  Errors filter{};
  Errors batch{};
  double seconds = 0.0;
  constexpr int kSeeds = 10;
  const auto add_squares = [](Errors& sum, const InertialUnit<double>& found, const InertialUnit<double>& truth) {
    const InertialUnit<double> t = in_accelerometer_frame(truth);
    const InertialUnit<double> f = in_accelerometer_frame(found);
    const auto mean_square = [](const Mat3<double>& error, bool diagonal) {
      const double scales = error.diagonal().squaredNorm();
      return diagonal ? scales / 3.0 : (error.squaredNorm() - scales) / 6.0;
    };
    sum.gyro_scale += mean_square(f.gyro.M - t.gyro.M, true) / kSeeds;
    sum.gyro_cross += mean_square(f.gyro.M - t.gyro.M, false) / kSeeds;
    sum.accel_scale += mean_square(f.accel.M - t.accel.M, true) / kSeeds;
    sum.accel_cross += 2.0 * mean_square(f.accel.M - t.accel.M, false) / kSeeds;  // three of them are zero
  };
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    simulation::TableRunSettings settings = nav_grade();
    settings.seed = seed;
    settings.encoder_bits = 0;
    settings.largest_clock_offset = 0.0;
    const simulation::TableSequence sequence = simulation::whole_turns(62.7, 30.0 * kRadPerDeg);
    seconds = simulation::duration_of(sequence);
    Recorded run;
    record(settings, sequence, run);
    add_squares(filter, filtered(run).unit, run.truth.unit);
    TableSolveOptions options;
    options.terms = {false, false, false};
    options.noise = settings.noise;
    options.estimate_clock_offset = false;
    Site site = bench();
    site.gravity_sigma = 1e-7;
    const Solution solution = solve_table({run.recording}, level_gimbal(), site, options);
    EXPECT_TRUE(solution.observability.refused.empty()) << describe(solution.observability);
    add_squares(batch, solution.record.value.unit, run.truth.unit);
  }
  const auto show = [&](const char* what, const Errors& e) {
    std::printf(
        "[ FIGURE   ] nav grade, twelve positions with whole turns, %.0f s, %s: gyro %.2f ppm, %.2f arcsec; "
        "accelerometer %.2f ppm, %.2f arcsec\n",
        seconds, what, 1e6 * std::sqrt(e.gyro_scale), std::sqrt(e.gyro_cross) / kArcSecond,
        1e6 * std::sqrt(e.accel_scale), std::sqrt(e.accel_cross) / kArcSecond);
  };
  show("36 states without encoder", filter);
  show("batch solve, exact encoder, table estimated", batch);
  // the best that any estimator could do of three accelerometers' scales, all else known, with gravity shared evenly
  std::printf("[ FIGURE   ] least-squares bound of the accelerometers' scales: %.2f ppm\n",
              1e6 * nav_grade().noise.accel.density / kStandardGravity / std::sqrt(seconds / 3.0));
  // what the literature's best filter of this kind reaches: 1.2 ppm, 0.5 arcsec; 0.4 ppm, 0.7 arcsec
  EXPECT_LE(std::sqrt(filter.gyro_scale), 1.2e-6);
  EXPECT_LE(std::sqrt(filter.gyro_cross), 0.7 * kArcSecond);
  EXPECT_LE(std::sqrt(filter.accel_scale), 0.4e-6);
  EXPECT_LE(std::sqrt(filter.accel_cross), 0.7 * kArcSecond);
  EXPECT_LE(std::sqrt(batch.gyro_scale), 0.4e-6);
  EXPECT_LE(std::sqrt(batch.gyro_cross), 0.1 * kArcSecond);
  EXPECT_LE(std::sqrt(batch.accel_cross), 0.1 * kArcSecond);
  EXPECT_LE(std::sqrt(batch.gyro_scale), std::sqrt(filter.gyro_scale));
  EXPECT_LE(std::sqrt(batch.gyro_cross), std::sqrt(filter.gyro_cross));
}

}  // namespace
}  // namespace trunnion::calibration
