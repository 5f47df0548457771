// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/encoder_course.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

double azimuth(double t) { return 1.0 + 0.9 * t + 0.2 * std::sin(1.3 * t); }
double pitch(double t) { return 0.5 + 0.35 * std::sin(2.0 * t); }

// A cubic is reproduced to rounding and the weight of the bridging term.
TEST(EncoderCourse, ReproducesACubic) {
  EncoderCourse course;
  const auto cubic = [](double t) { return 0.1 + t * (0.2 + t * (-0.03 + 0.004 * t)); };
  for (int i = 0; i < 1000; ++i) course.add(0.005 * i, cubic(0.005 * i), 0.0);
  course.finish();
  for (double t = 0.1; t < 4.9; t += 0.0137) {
    EXPECT_NEAR(course.at(t)[0].angle, cubic(t), 1e-9);
    EXPECT_NEAR(course.at(t)[0].rate, 0.2 - 0.06 * t + 0.012 * t * t, 1e-7);
    EXPECT_NEAR(course.at(t)[0].acceleration, -0.06 + 0.024 * t, 1e-5);
  }
}

TEST(EncoderCourse, UnwrapsAndFollowsSmoothMotion) {
  EncoderCourse course;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.005 * i;
    course.add(t, std::remainder(azimuth(t), 2.0 * kPi), pitch(t));
  }
  course.finish();
  for (double t = 0.1; t < 19.9; t += 0.0371) {
    EXPECT_NEAR(std::remainder(course.at(t)[0].angle - azimuth(t), 2.0 * kPi), 0.0, 2e-9);
    EXPECT_NEAR(course.at(t)[1].angle, pitch(t), 1e-8);
    EXPECT_NEAR(course.at(t)[1].rate, 0.7 * std::cos(2.0 * t), 2e-6);
  }
}

TEST(EncoderCourse, KnowsItsHoles) {
  EncoderCourse course;
  for (int i = 0; i < 4000; ++i) {
    if (i < 1000 || i > 1100) course.add(0.005 * i, 0.0, pitch(0.005 * i));
  }
  course.finish();
  EXPECT_TRUE(course.covers(1.0, 4.0));
  EXPECT_FALSE(course.covers(4.0, 6.0));
  EXPECT_TRUE(course.covers(6.0, 19.0));
  EXPECT_FALSE(course.covers(-1.0, 2.0));
  EXPECT_FALSE(course.covers(19.0, 21.0));
}

// A reading that departs from both neighbours is left out, also when it lies turns away.
TEST(EncoderCourse, LeavesAWildReadingOut) {
  EncoderCourse course;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.005 * i;
    const double wild = i == 1000 ? 1.0 : i == 2000 ? 1e6 : 0.0;
    course.add(t, azimuth(t) + wild, pitch(t));
  }
  course.finish();
  EXPECT_EQ(course.outliers(), 2);
  for (double t = 0.1; t < 19.9; t += 0.0371) {
    EXPECT_NEAR(std::remainder(course.at(t)[0].angle - azimuth(t), 2.0 * kPi), 0.0, 1e-7);
  }
  EXPECT_LT(course.reading_sigma(), 1e-6);
}

// The quantisation of 21 bits is 3 urad wide: uniform, 0.865 urad, and third differences see it.
TEST(EncoderCourse, TellsTheNoiseOfAReading) {
  const double quantum = 2.0 * kPi / 2097152.0;
  EncoderCourse course;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.005 * i;
    course.add(t, quantum * std::round(azimuth(t) / quantum), quantum * std::round(pitch(t) / quantum));
  }
  EXPECT_NEAR(course.reading_sigma(), quantum / std::sqrt(12.0), 0.1 * quantum);
}

TEST(EncoderCourse, SurvivesFewReadings) {
  for (int n = 0; n < 6; ++n) {
    EncoderCourse course;
    for (int i = 0; i < n; ++i) course.add(0.005 * i, 0.1, 0.2);
    course.finish();
    EXPECT_TRUE(std::isfinite(course.at(0.01)[0].angle)) << n;
  }
}

}  // namespace
}  // namespace trunnion::calibration
