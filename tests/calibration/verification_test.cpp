// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/verification.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "experiment.hpp"
#include "matchers/refuses.hpp"
#include "trunnion/error_model/stream_correction.hpp"

namespace trunnion::calibration {
namespace {

/// Mount 1 of the experiment, as it is and corrected.
struct Held {
  CompressedRecording before, after;
  simulation::TableRunSettings settings;
  CalibrationValues truth;
};

Held held(const simulation::TableRunSettings& settings,
          const std::function<void(InertialUnit<double>&)>& mistake = {}) {
  const Rig rig = cyclic_rig();
  Site site = bench();
  Held result;
  result.settings = settings;
  result.truth = simulation::draw_truth(settings, rig, site, 1);
  InertialUnit<double> believed = result.truth.unit;
  if (mistake) mistake(believed);
  StreamCorrection<double> correction(believed);
  Compressor before({});
  Compressor after({});
  simulation::run_table(settings, result.truth, rig, site,
                        simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, 0)), 0, 0,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
                           before.imu(t, s);
                           after.imu(t, correction.correct(1e-6 * static_cast<double>(t), s));
                         },
                         [&](std::int64_t t, std::int64_t, double a, double p) {
                           before.encoder(t, a, p);
                           after.encoder(t, a, p);
                         }});
  result.before = before.finish();
  result.after = after.finish();
  return result;
}

Verification verified(const Held& held) {
  Site site = bench();
  site.gravity = held.truth.gravity;
  return verify(held.before, held.after, 0, held.truth, cyclic_rig(), site, held.settings.noise);
}

// A unit whose calibration is the truth: what is left is the noise, and nothing of the matrices.
TEST(Verify, OfTheTruthLeavesTheNoise) {
  simulation::TableRunSettings settings;
  settings.seed = 4;
  const Verification v = verified(held(settings));
  EXPECT_NEAR(v.window, 0.1, 1e-12);
  EXPECT_GT(v.windows, 7000);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    // 7050 windows: the white part of the deviation to 0.8 %, the wander of one recording to some 3 % of the whole
    EXPECT_NEAR(v.axis[axis].after / v.axis[axis].floor, 1.0, 0.05) << axis;
    EXPECT_GT(v.axis[axis].before, 2.0 * v.axis[axis].after) << axis;
  }
  for (std::size_t triad = 0; triad < 2; ++triad) {
    // eighteen entries at 3.5 sigmas: one false alarm in 120 seeds
    EXPECT_LT(v.left[triad].cwiseQuotient(v.left_sigma[triad]).cwiseAbs().maxCoeff(), 3.5);
  }
}

// Without noise, what is wrong with the calibration stands in the matrices.
TEST(Verify, FindsWhatIsLeftOfTheMatrices) {
  simulation::TableRunSettings settings;
  settings.gyro_cubic = 0.0;
  const UnitNoise noise = settings.noise;
  settings = settings.noise_free();
  Held one = held(settings, [](InertialUnit<double>& unit) {
    unit.gyro.M(2, 2) -= 200e-6;
    unit.gyro.M(2, 1) -= 1e-4;
    unit.accel.M(0, 0) -= 300e-6;
  });
  one.settings.noise = noise;
  const Verification v = verified(one);
  EXPECT_NEAR(v.left[0](2, 2), 200e-6, 1e-6);
  EXPECT_NEAR(v.left[0](2, 1), 1e-4, 1e-6);
  EXPECT_NEAR(v.left[0](0, 0), 0.0, 1e-6);
  EXPECT_NEAR(v.left[1](0, 0), 300e-6, 1e-6);
  EXPECT_NEAR(v.left[1](2, 2), 0.0, 1e-6);
  // one mount never has gravity along the pitch axis: of that it cannot speak
  EXPECT_GT(v.left_sigma[1](0, 1), 100.0 * v.left_sigma[1](0, 0));
}

TEST(Verify, RefusesAnotherRecording) {
  const Held one = held(simulation::TableRunSettings().noise_free());
  CompressedRecording other = one.after;
  other.windows.resize(other.windows.size() / 2);
  EXPECT_REFUSES(ExitCode::kInput, "its corrected samples make other windows",
                 verify(one.before, other, 0, one.truth, cyclic_rig(), bench(), UnitNoise{}));
}

}  // namespace
}  // namespace trunnion::calibration
