// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/compress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "matchers/refuses.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::calibration {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStart = 1700000000000000;

CompressOptions named() {
  CompressOptions options;
  options.name = "test.lcm";
  return options;
}

/// Feeds samples of white noise about a constant; change(i, sample) may spoil one, returning false drops it.
template <class Change>
CompressedRecording record(int samples, const CompressOptions& options, Change&& change) {
  Compressor compressor(options);
  simulation::Gaussian noise(3, 1);
  for (int i = 0; i < samples; ++i) {
    InertialSample<double> s;
    for (int k = 0; k < 3; ++k) {
      s.w(k) = 0.1 * k + 1e-3 * noise();
      s.f(k) = 3.0 * k + 1e-2 * noise();
    }
    if (change(i, s)) compressor.imu(kStart + 2500 * i, s);
  }
  return compressor.finish();
}

TEST(Compressor, MakesWindowsOfTheSamplesMeans) {
  const CompressedRecording r = record(4000, named(), [](int, InertialSample<double>&) { return true; });
  EXPECT_EQ(r.figures.samples, 4000);
  EXPECT_NEAR(r.figures.period, 0.0025, 1e-12);
  ASSERT_GE(r.windows.size(), 99U);
  for (const ObservationWindow& w : r.windows) {
    EXPECT_NEAR(w.mean.w.y(), 0.1, 6e-4 * 2);
    double sum = 0.0;
    for (const double weight : w.weight) sum += weight;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
  EXPECT_EQ(r.figures.outliers, 0);
}

TEST(Compressor, LeavesOutliersOutAndCountsThem) {
  const CompressedRecording r = record(4000, named(), [](int i, InertialSample<double>& s) {
    if (i % 500 == 123) s.w.x() += 1.0;
    if (i % 500 == 300) s.f.z() -= 5.0;
    return true;
  });
  EXPECT_EQ(r.figures.outliers, 16);
  for (const ObservationWindow& w : r.windows) {
    EXPECT_NEAR(w.mean.w.x(), 0.0, 1e-3);
    EXPECT_NEAR(w.mean.f.z(), 6.0, 1e-2);
  }
}

TEST(Compressor, CountsTheSamplesThatAreMissing) {
  const CompressedRecording r = record(4000, named(), [](int i, InertialSample<double>&) { return i % 100 != 50; });
  EXPECT_EQ(r.figures.missing, 40);
}

TEST(Compressor, DropsAndCountsStampsThatRepeatOrStepBack) {
  Compressor compressor(named());
  const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  for (int i = 0; i < 1000; ++i) {
    compressor.imu(kStart + 2500 * i, s);
    if (i == 500) compressor.imu(kStart + 2500 * i, s);
    if (i == 600) compressor.imu(kStart + 2500 * (i - 3), s);
    if (i == 700) compressor.imu(kStart + 4000000000000, s);
  }
  const CompressedRecording r = compressor.finish();
  EXPECT_EQ(r.figures.duplicates, 1);
  EXPECT_EQ(r.figures.stray, 2);
  EXPECT_EQ(r.figures.samples, 1000);
}

// One damaged stamp costs one message, be it the first or a leap ahead.
TEST(Compressor, SurvivesADamagedStamp) {
  for (const int damaged : {0, 500}) {
    Compressor compressor(named());
    const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
    for (int i = 0; i < 1000; ++i) compressor.imu(kStart + 2500 * i + (i == damaged ? 500000000 : 0), s);
    const CompressedRecording r = compressor.finish();
    EXPECT_GE(r.figures.samples, 998) << damaged;
    EXPECT_GE(r.figures.stray, 1) << damaged;
    EXPECT_NEAR(r.figures.duration, 2.5, 0.01) << damaged;
  }
}

// A pause of five seconds is a hole, not a reset: the first sample after it is what the doubt costs.
TEST(Compressor, TakesAPauseAsAHole) {
  Compressor compressor(named());
  const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  for (int i = 0; i < 1000; ++i) compressor.imu(kStart + 2500 * i + (i >= 500 ? 5000000 : 0), s);
  EXPECT_EQ(compressor.finish().figures.samples, 999);
}

TEST(Compressor, RefusesARateThatIsNotTheSheets) {
  CompressOptions options = named();
  options.period = 0.005;
  try {
    record(4000, options, [](int, InertialSample<double>&) { return true; });
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::kInput);
    EXPECT_THAT(e.what(), HasSubstr("the samples come at 400.000000 Hz, the sheet's rate_hz says 200"));
  }
}

TEST(Compressor, RefusesAClockThatWasReset) {
  Compressor compressor(named());
  const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  for (int i = 0; i < 1000; ++i) compressor.imu(kStart + 2500 * i, s);
  try {
    for (int i = 0; i < 1000; ++i) compressor.imu(2500 * i, s);
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::kInput);
    EXPECT_THAT(e.what(), HasSubstr("the clock of the IMU channel was reset"));
  }
}

TEST(Compressor, RefusesASaturatedRecordingAndSaysWhere) {
  CompressOptions options = named();
  options.range.gyro = 8.7;
  try {
    record(4000, options, [](int i, InertialSample<double>& s) {
      if (i >= 1000 && i < 1100) s.w.y() = 8.7;
      return true;
    });
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::kInput);
    EXPECT_THAT(e.what(), HasSubstr("saturated: 100 of 4000 samples"));
    EXPECT_THAT(e.what(), HasSubstr("first at 2.500000 s"));
  }
}

TEST(Compressor, RefusesTwoPublishersOnOneChannel) {
  const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  EXPECT_REFUSES(ExitCode::kInput, "do two units publish on one channel", {
    Compressor compressor(named());
    for (int i = 0; i < 4000; ++i) compressor.imu(kStart + 2500 * (i / 2) + i % 2, s);
  });
  EXPECT_REFUSES(ExitCode::kInput, "do two units publish on one channel", {
    Compressor compressor(named());  // the other unit starts later
    for (int i = 0; i < 4000; ++i) {
      compressor.imu(kStart + 2500 * i, s);
      if (i >= 2000) compressor.imu(kStart + 2500 * i + 1100, s);
    }
    static_cast<void>(compressor.finish());
  });
}

// Stamps in whole milliseconds, 2, 3, 2, 3 apart: 400 Hz from either phase.
TEST(Compressor, KnowsThePeriodOfCoarseStamps) {
  const InertialSample<double> s{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  for (const int phase : {0, 1}) {
    Compressor compressor(named());
    for (int i = phase; i < 4000; ++i) compressor.imu(kStart + (2500 * i) / 1000 * 1000, s);
    EXPECT_NEAR(compressor.finish().figures.period, 0.0025, 1e-5) << phase;
  }
  Compressor compressor(named());
  EXPECT_REFUSES(ExitCode::kInput, "the stamps are coarser than the samples", {
    for (int i = 0; i < 4000; ++i) compressor.imu(kStart + (2500 * i) / 10000 * 10000, s);
    static_cast<void>(compressor.finish());
  });
}

TEST(Compressor, RefusesARecordingOfNothing) {
  Compressor compressor(named());
  EXPECT_THROW(compressor.finish(), Error);
}

}  // namespace
}  // namespace trunnion::calibration
