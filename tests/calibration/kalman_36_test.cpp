// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/kalman_36.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "calibration/nav_grade.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::calibration {
namespace {

// A perfect instrument is found to be one, and an imperfect one to what the literature's filter of this kind reaches
// without noise: 0.03 ppm, 0.03 arcsec.
TEST(Kalman36, NoiseFreeNineteenPositions) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
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
