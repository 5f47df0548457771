// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/rate_test.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "calibration/experiment.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::calibration {
namespace {

AxisLimits pitch_limits() {
  AxisLimits pitch;
  pitch.lowest = -10.0 * kRadPerDeg;
  pitch.highest = 70.0 * kRadPerDeg;
  return pitch;
}

struct Bench {
  CalibrationValues truth;
  std::vector<TableRecording> recordings;
};

Bench record(const simulation::TableRunSettings& settings, const simulation::TableSequence& sequence, int mounts) {
  Bench run;
  const Rig rig = cyclic_rig();
  run.truth = simulation::draw_truth(settings, rig, bench(), mounts);
  for (int m = 0; m < mounts; ++m) {
    CompressOptions options;
    options.name = "mount_" + std::to_string(m + 1);
    Compressor compressor(options);
    simulation::run_table(settings, run.truth, rig, bench(), simulation::motion_of(sequence), m, m,
                          {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) { compressor.imu(t, s); },
                           [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
    run.recordings.push_back({compressor.finish(), m});
  }
  return run;
}

/// A table as drawn and a unit that is linear and does not feel forces.
simulation::TableRunSettings textbook() {
  simulation::TableRunSettings s;
  s.tilt = s.nonorthogonality = s.mount_error = s.eccentricity = 0.0;
  s.lever_arm = 0.0;
  s.largest_clock_offset = 0.0;
  s.gyro_g_sensitivity = 0.0;
  s.gyro_cubic = 0.0;
  return s;
}

TEST(RateTest, FindsTheMatrixOnATableAsDrawn) {
  const Bench run = record(textbook().noise_free(), simulation::design_run(pitch_limits()), 3);
  const RateTestResult result = rate_test(run.recordings, cyclic_rig(), bench());
  EXPECT_TRUE(result.determined.all());
  const Mat3<double> error = result.gyro.M - run.truth.unit.gyro.M;
  std::printf("[ FIGURE   ] rate test, no noise, table as drawn: scale %.2f ppm, cross-coupling %.6f deg at most\n",
              1e6 * error.diagonal().cwiseAbs().maxCoeff(),
              (error - Mat3<double>(error.diagonal().asDiagonal())).cwiseAbs().maxCoeff() / kRadPerDeg);
  EXPECT_LE(error.diagonal().cwiseAbs().maxCoeff(), 20e-6);
  EXPECT_LE((error - Mat3<double>(error.diagonal().asDiagonal())).cwiseAbs().maxCoeff(), 0.001 * kRadPerDeg);
  for (const RateTestAxis& axis : result.axis) {
    EXPECT_TRUE(axis.excited);
    EXPECT_LE(axis.nonlinearity, 50e-6);
    EXPECT_LE(axis.asymmetry, 50e-6);
  }
}

TEST(RateTest, OneMountTellsTwoColumns) {
  const Bench run = record(textbook().noise_free(), simulation::design_run(pitch_limits()), 1);
  const RateTestResult result = rate_test(run.recordings, cyclic_rig(), bench());
  // azimuth along z, pitch along y
  EXPECT_FALSE(result.axis[0].excited);
  EXPECT_TRUE(result.axis[1].excited && result.axis[2].excited);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(result.determined(i, 0)) << i;
    EXPECT_EQ(result.gyro.M(i, 0), 0.0) << i;
    for (int j = 1; j < 3; ++j)
      EXPECT_NEAR(result.gyro.M(i, j), run.truth.unit.gyro.M(i, j), 0.002 * kRadPerDeg) << i << j;
  }
}

/// What it is blind to: the fixture's error is taken for the unit's.
TEST(RateTest, TakesTheFixtureForTheUnit) {
  simulation::TableRunSettings settings = textbook();
  settings.mount_error = 0.05 * kRadPerDeg;
  const Bench run = record(settings.noise_free(), simulation::design_run(pitch_limits()), 3);
  const RateTestResult result = rate_test(run.recordings, cyclic_rig(), bench());
  Mat3<double> error = result.gyro.M - run.truth.unit.gyro.M;
  error.diagonal().setZero();
  EXPECT_GE(error.norm(), 0.02 * kRadPerDeg);
}

TEST(RateTest, ShowsANonlinearScale) {
  simulation::TableRunSettings settings = textbook();
  settings.gyro_cubic = 0.02;  // s^2/rad^2: 3800 ppm at 25 deg/s
  const Bench run = record(settings.noise_free(), simulation::design_run(pitch_limits()), 3);
  const RateTestResult result = rate_test(run.recordings, cyclic_rig(), bench());
  EXPECT_GE(result.axis[2].nonlinearity, 100e-6);
}

TEST(RateTest, RefusesARunWithoutTurns) {
  const Bench run = record(textbook(), simulation::rest_only(0.0, 1.0), 1);
  EXPECT_REFUSES(ExitCode::kInput, "needs turns at constant rates",
                 (void)rate_test(run.recordings, cyclic_rig(), bench()));
}

}  // namespace
}  // namespace trunnion::calibration
