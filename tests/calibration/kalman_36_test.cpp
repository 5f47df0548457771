// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/kalman_36.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstdio>

#include "calibration/experiment.hpp"
#include "calibration/gimbal.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kArcSecond = kRadPerDeg / 3600.0;

/// Largest errors of scales and cross-couplings in the frame of the accelerometers, and of the biases.
struct Errors {
  double gyro_scale = 0.0, gyro_cross = 0.0, accel_scale = 0.0, accel_cross = 0.0;  // -, rad
  double gyro_bias = 0.0, accel_bias = 0.0;
};

Errors errors_of(const InertialUnit<double>& found, const InertialUnit<double>& truth) {
  const InertialUnit<double> t = in_accelerometer_frame(truth);
  const InertialUnit<double> f = in_accelerometer_frame(found);
  Errors e;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double& gyro = i == j ? e.gyro_scale : e.gyro_cross;
      double& accel = i == j ? e.accel_scale : e.accel_cross;
      gyro = std::max(gyro, std::abs(f.gyro.M(i, j) - t.gyro.M(i, j)));
      accel = std::max(accel, std::abs(f.accel.M(i, j) - t.accel.M(i, j)));
    }
  }
  e.gyro_bias = (f.gyro.bias - t.gyro.bias).cwiseAbs().maxCoeff();
  e.accel_bias = (f.accel.bias - t.accel.bias).cwiseAbs().maxCoeff();
  return e;
}

void print(const char* what, const Errors& e, const Kalman36Result& result) {
  std::printf(
      "[ FIGURE   ] 36 states, %s: gyro %.3f ppm, %.3f arcsec, %.5f deg/h; accelerometer %.3f ppm, %.3f arcsec, %.3f "
      "ug; "
      "%d rounds, %d rests\n",
      what, 1e6 * e.gyro_scale, e.gyro_cross / kArcSecond, e.gyro_bias / kRadPerSPerDegPerH, 1e6 * e.accel_scale,
      e.accel_cross / kArcSecond, e.accel_bias / kMetresPerS2PerMicroG, result.rounds, result.rests);
}

simulation::TableRunSettings nav_grade() {
  simulation::TableRunSettings s;
  s.noise.gyro = {0.002 * kRadPerDeg / 60.0, 0.0, 1.0};
  s.noise.accel = {5.0 * kMetresPerS2PerMicroG, 0.0, 1.0};
  s.gyro_bias = 0.05 * kRadPerSPerDegPerH;
  s.gyro_turn_on_bias = 0.0;
  s.gyro_scale = 100e-6;
  s.gyro_cross_coupling = 60.0 * kArcSecond;
  s.gyro_cubic = 0.0;
  s.gyro_g_sensitivity = 0.0;
  s.accel_bias = 100.0 * kMetresPerS2PerMicroG;
  s.accel_turn_on_bias = 0.0;
  s.accel_scale = 100e-6;
  s.accel_cross_coupling = 60.0 * kArcSecond;
  s.lever_arm = 0.04;
  s.rate = 100.0;
  s.exact_gravity = true;
  return s;
}

struct Recorded {
  CalibrationValues truth;
  Kalman36 filter{"run"};
  TableRecording recording;
};

void record(const simulation::TableRunSettings& settings, const simulation::TableSequence& sequence, Recorded& run) {
  const Rig rig = level_gimbal();
  run.truth = simulation::draw_truth(settings, rig, bench(), 1);
  CompressOptions options;
  options.name = "run";
  Compressor compressor(options);
  simulation::run_table(settings, run.truth, rig, bench(), simulation::motion_of(sequence), 0, 0,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
                           run.filter.imu(t, s);
                           compressor.imu(t, s);
                         },
                         [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
  run.recording.data = compressor.finish();
}

Kalman36Result filtered(const Recorded& run) {
  Kalman36Options options;
  options.noise = nav_grade().noise;
  return run.filter.finish(bench(), options);
}

// A perfect instrument is found to be one, and an imperfect one to what the literature's filter of this kind reaches
// without noise: 0.03 ppm, 0.03 arcsec.
TEST(Kalman36, NoiseFreeNineteenPositions) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    simulation::TableRunSettings settings = nav_grade().noise_free();
    settings.seed = seed;
    Recorded run;
    record(settings, simulation::nineteen_positions(40.0, 10.0 * kRadPerDeg), run);
    ASSERT_GE(errors_of(InertialUnit<double>(), run.truth.unit).gyro_cross, 10.0 * kArcSecond);
    const Kalman36Result result = filtered(run);
    const Errors e = errors_of(result.unit, run.truth.unit);
    print("noise-free nineteen positions", e, result);
    EXPECT_EQ(result.rests, 19);
    EXPECT_LE(e.gyro_scale, 1e-7);
    EXPECT_LE(e.gyro_cross, 0.1 * kArcSecond);
    EXPECT_LE(e.accel_scale, 1e-7);
    EXPECT_LE(e.accel_cross, 0.1 * kArcSecond);
  }
}

/// Its sigmas are true: 27 parameters of 10 seeds, within the band that chi-square leaves one time in a hundred, each
/// seed's sum taken for as wide as if all its pulls were one.
TEST(Kalman36, SigmasAreTrue) {
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    simulation::TableRunSettings settings = nav_grade();
    settings.seed = seed;
    Recorded run;
    record(settings, simulation::nineteen_positions(40.0, 10.0 * kRadPerDeg), run);
    const Kalman36Result result = filtered(run);
    const InertialUnit<double> t = in_accelerometer_frame(run.truth.unit);
    const auto add = [&](double error, double sigma) {
      sum += error * error / (sigma * sigma);
      ++count;
    };
    for (int i = 0; i < 3; ++i) add(result.unit.gyro.bias(i) - t.gyro.bias(i), result.sigma(i));
    for (int i = 0; i < 3; ++i) add(result.unit.accel.bias(i) - t.accel.bias(i), result.sigma(3 + i));
    for (int i = 0; i < 9; ++i) add(result.unit.gyro.M(i / 3, i % 3) - t.gyro.M(i / 3, i % 3), result.sigma(6 + i));
    int place = 15;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) add(result.unit.accel.M(i, j) - t.accel.M(i, j), result.sigma(place++));
    }
    for (int i = 0; i < 3; ++i) add(result.unit.accel.quadratic(i), result.sigma(place++));
    for (int i = 0; i < 3; ++i) add(result.lever[0](i), result.sigma(place++));
  }
  std::printf("[ FIGURE   ] 36 states, nav grade, 10 seeds: mean squared pull %.3f\n", sum / count);
  EXPECT_GT(sum / count, 1.0 - 2.58 * std::sqrt(2.0 / 10.0));
  EXPECT_LT(sum / count, 1.0 + 2.58 * std::sqrt(2.0 / 10.0));
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

TEST(Kalman36, RefusesWhatItCannotUse) {
  Recorded run;
  record(nav_grade(), simulation::rest_only(0.0, 1.0), run);
  EXPECT_REFUSES(ExitCode::kInput, "1 rests", (void)filtered(run));
  const Kalman36 empty("empty.lcm");
  EXPECT_REFUSES(ExitCode::kInput, "empty.lcm: too few samples", (void)empty.finish(bench(), {}));
}

/// Turning the case about changes no reading that the rest of the world can see.
TEST(Kalman36, TheFrameOfTheAccelerometersIsUpperTriangular) {
  simulation::TableRunSettings settings;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    settings.seed = seed;
    settings.accel_cross_coupling = settings.gyro_cross_coupling = 0.2;  // far beyond any instrument
    const InertialUnit<double> unit = simulation::draw_truth(settings, cyclic_rig(), bench(), 1).unit;
    const InertialUnit<double> same = in_accelerometer_frame(unit);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(same.accel.matrix()(i, i), 0.0);
      for (int j = 0; j < i; ++j) EXPECT_NEAR(same.accel.M(i, j), 0.0, 1e-14);
    }
    const Mat3<double> turn = same.accel.matrix().inverse() * unit.accel.matrix();
    EXPECT_TRUE((turn * turn.transpose()).isIdentity(1e-12));
    EXPECT_TRUE((same.gyro.matrix() * turn).isApprox(unit.gyro.matrix(), 1e-12));
  }
}

}  // namespace
}  // namespace trunnion::calibration
