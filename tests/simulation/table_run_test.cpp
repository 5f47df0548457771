// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/table_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/positions/twelve.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::simulation {
namespace {

struct Recorded {
  std::vector<std::int64_t> utime;
  std::vector<InertialSample<double>> samples;
  std::vector<std::array<double, 2>> encoders;
};

Rig cyclic_rig() {
  Rig rig;
  rig.mounts = kMounts;
  for (int m = 0; m < kMounts; ++m) rig.mount[static_cast<std::size_t>(m)].C_pb = cyclic_mount(m);
  return rig;
}

Recorded record(const TableRunSettings& settings, const TableMotion& motion) {
  const Rig rig = cyclic_rig();
  Site site;
  site.latitude = 0.766;
  const CalibrationValues truth = draw_truth(settings, rig, site, 1);
  Recorded run;
  run_table(settings, truth, rig, site, motion, 0, 0,
            {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
               run.utime.push_back(t);
               run.samples.push_back(s);
             },
             [&](std::int64_t, std::int64_t, double a, double p) {
               run.encoders.push_back({a, p});
             }});
  return run;
}

TEST(AxisCourse, AngleIsTheIntegralOfItsRamps) {
  AxisCourse course(0.2);
  course.ramp(1.0, 2.0, 0.5);
  course.ramp(10.0, 2.0, 0.0);
  EXPECT_DOUBLE_EQ(course.angle(0.5), 0.2);
  // the ramp loses half its duration, at both ends
  EXPECT_NEAR(course.angle(20.0), 0.2 + 0.5 * 9.0, 1e-14);
  EXPECT_NEAR((course.angle(6.001) - course.angle(5.999)) / 0.002, 0.5, 1e-10);
}

TEST(Experiment, KeepsThePitchWithinItsLimits) {
  for (int variant = 0; variant < 3; ++variant) {
    const TableMotion motion = motion_of(experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, variant));
    for (double t = 0.0; t < motion.duration; t += 0.05) {
      ASSERT_GE(motion.pitch.angle(t), -10.0001 * kRadPerDeg) << t;
      ASSERT_LE(motion.pitch.angle(t), 70.0001 * kRadPerDeg) << t;
    }
  }
}

TEST(RunTable, IsTheSameForTheSameSeedAndAnotherForAnother) {
  TableRunSettings settings;
  settings.seed = 5;
  const TableMotion motion = motion_of(rest_only(-0.1, 1.2));
  const Recorded a = record(settings, motion);
  const Recorded b = record(settings, motion);
  settings.seed = 6;
  const Recorded c = record(settings, motion);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  EXPECT_EQ(a.samples.back().w, b.samples.back().w);
  EXPECT_NE(a.samples.back().w, c.samples.back().w);
}

// Switching outliers and drops on leaves the noise of every other sample as it was.
TEST(RunTable, CausesHaveStreamsOfTheirOwn) {
  TableRunSettings settings;
  const TableMotion motion = motion_of(rest_only(-0.1, 1.2));
  const Recorded clean = record(settings, motion);
  settings.outlier_fraction = 0.01;
  settings.dropped_fraction = 0.02;
  const Recorded dirty = record(settings, motion);
  std::size_t matched = 0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < dirty.samples.size(); ++i) {
    while (clean.utime[j] != dirty.utime[i]) ++j;
    matched += clean.samples[j].w == dirty.samples[i].w ? 1U : 0U;
  }
  const auto offered = static_cast<double>(clean.samples.size());
  // binomial: 2 % and 1 % within five sigma, false alarm 1e-6
  EXPECT_NEAR(static_cast<double>(dirty.samples.size()) / offered, 0.98, 5.0 * std::sqrt(0.02 * 0.98 / offered));
  EXPECT_NEAR(static_cast<double>(matched) / static_cast<double>(dirty.samples.size()), 0.99,
              5.0 * std::sqrt(0.01 * 0.99 / offered));
}

// At rest a perfect unit reads the Earth's rate and gravity.
TEST(RunTable, APerfectUnitAtRestReadsTheEarth) {
  TableRunSettings settings = TableRunSettings().noise_free();
  settings.gyro_bias = settings.gyro_turn_on_bias = settings.gyro_scale = settings.gyro_cross_coupling = 0.0;
  settings.gyro_cubic = settings.gyro_g_sensitivity = 0.0;
  settings.accel_bias = settings.accel_turn_on_bias = settings.accel_scale = settings.accel_cross_coupling = 0.0;
  const Recorded run = record(settings, motion_of(rest_only(-0.1, 1.2)));
  EXPECT_NEAR(run.samples[1000].w.norm(), kEarthRate, 1e-11);
  EXPECT_NEAR(run.samples[1000].f.norm(), 9.80665, 2e-3);  // gravity is drawn about the site's
}

TEST(RunTable, QuantisesToWholeCounts) {
  TableRunSettings settings;
  settings.gyro_quantum = 1e-3;
  settings.accel_quantum = 1e-2;
  const Recorded run = record(settings, motion_of(rest_only(-0.1, 1.2)));
  for (std::size_t i = 0; i < run.samples.size(); i += 97) {
    const double counts = run.samples[i].w.x() / 1e-3;
    EXPECT_NEAR(counts, std::round(counts), 1e-9);
  }
}

// 40 seeds of 5000 draws: the mean of z^2 over the seeds' means lies in the chi-square band of 40 degrees of freedom
// with a false alarm of 1e-4.
TEST(Gaussian, HasZeroMeanAndUnitVarianceOverSeeds) {
  double z2_mean = 0.0;
  double z2_variance = 0.0;
  constexpr int kDraws = 5000;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Gaussian draw(seed, 7);
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = draw();
      sum += x;
      squares += x * x;
    }
    z2_mean += sum * sum / kDraws;
    z2_variance += std::pow((squares - kDraws) / std::sqrt(2.0 * kDraws), 2);
  }
  EXPECT_GT(z2_mean, 13.9);
  EXPECT_LT(z2_mean, 84.0);
  EXPECT_GT(z2_variance, 13.9);
  EXPECT_LT(z2_variance, 84.0);
}

}  // namespace
}  // namespace trunnion::simulation
