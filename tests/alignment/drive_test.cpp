// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A real drive: a consumer's unit on a car, aligned in motion by the velocity of an RTK receiver, then left alone for a
// minute at a time.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "trunnion/alignment/fine.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

struct Fix {
  double t;  // s of the day
  double latitude, longitude, height;
  Vec3<double> velocity;  // north-east-down
};

struct Sample {
  double t;  // s of the day, of its end
  InertialSample<double> mean;
};

// stamps of the unit to the receiver's time: where the turn rates of the two agree best (correlation 0.99)
constexpr double kClockOffset = 70199.993;  // s

std::vector<Fix> read_fixes(const std::string& path) {
  std::vector<Fix> fixes;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '%') continue;
    std::istringstream row(line);
    std::string date;
    double v = 0.0;
    char colon = ':';
    double hours = 0.0;
    double minutes = 0.0;
    double seconds = 0.0;
    row >> date >> hours >> colon >> minutes >> colon >> seconds;
    std::vector<double> values;
    while (row >> v) values.push_back(v);
    if (values.size() < 16) continue;
    fixes.push_back({3600.0 * hours + 60.0 * minutes + seconds, values[0] * kRadPerDeg, values[1] * kRadPerDeg,
                     values[2], Vec3<double>(values[13], values[14], -values[15])});
  }
  return fixes;
}

std::vector<Sample> read_samples(const std::string& path) {
  std::vector<Sample> samples;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double ax = 0.0, ay = 0.0, az = 0.0, gx = 0.0, gy = 0.0, gz = 0.0, t = 0.0;
    if (!(row >> ax >> ay >> az >> gx >> gy >> gz >> t)) continue;
    // the unit's axes point back, right and up
    samples.push_back({1e-3 * t + kClockOffset,
                       {Vec3<double>(-gx, gy, -gz) * kRadPerDeg, Vec3<double>(-ax, ay, -az) * kStandardGravity}});
  }
  return samples;
}

TEST(RealDrive, DriftsFreelyForAMinute) {
  const std::string folder = std::string(TRUNNION_DATA) + "/gnss_imu_drive/drive_0708/";
  if (!std::filesystem::exists(folder + "imu_1934.csv"))
    GTEST_SKIP() << "no real recordings: " << folder << " is absent";
  const std::vector<Fix> fixes = read_fixes(folder + "gnss_1934_sf.pos");
  const std::vector<Sample> samples = read_samples(folder + "imu_1934.csv");
  ASSERT_GT(fixes.size(), 2000U);
  ASSERT_GT(samples.size(), 50000U);
  constexpr double kPeriod = 0.01;
  constexpr double kRest = 25.0;    // s at the start, engine running
  constexpr double kWindow = 60.0;  // s

  // tilt and gyro bias at rest, heading from the course of the first straight
  InertialSample<double> mean;
  const auto rest = static_cast<std::size_t>(kRest / kPeriod);
  for (std::size_t i = 0; i < rest; ++i) {
    mean.w += samples[i].mean.w / static_cast<double>(rest);
    mean.f += samples[i].mean.f / static_cast<double>(rest);
  }
  const auto moving = std::find_if(fixes.begin(), fixes.end(), [](const Fix& f) { return f.velocity.norm() > 3.0; });
  double heading = std::atan2(moving->velocity.y(), moving->velocity.x());
  for (std::size_t i = rest; i < samples.size() && samples[i].t < moving->t; ++i)
    heading -= (samples[i].mean.w.z() - mean.w.z()) * kPeriod;
  NavigationState<double> start;
  start.latitude = fixes.front().latitude;
  start.longitude = fixes.front().longitude;
  start.height = fixes.front().height;
  start.attitude = Quaternion<double>(Eigen::AngleAxisd(heading, Vec3<double>::UnitZ()) *
                                      Eigen::AngleAxisd(std::atan2(mean.f.x(), -mean.f.z()), Vec3<double>::UnitY()) *
                                      Eigen::AngleAxisd(std::atan2(-mean.f.y(), -mean.f.z()), Vec3<double>::UnitX()));
  FineAlignment<PreviousSample<double>> alignment(start, kPeriod, 25, Vec3<double>::Zero(),
                                                  {2e-3, 0.02, 2e-6, 2e-4, 0.1, 0.02, 0.2, 0.1, 0.01, 0.3});

  struct Free {
    Navigator<PreviousSample<double>> navigator;
    Vec3<double> gyro_bias, accel_bias;
    double from;
    double north, east;  // from where the receiver was
  };
  std::vector<Free> windows;
  std::vector<double> drift;
  std::size_t fix = 0;
  double next = samples[rest].t + 150.0;
  const double metres = kEarthRadius;
  for (std::size_t i = rest; i < samples.size(); ++i) {
    const double t = samples[i].t;
    while (fix + 2 < fixes.size() && fixes[fix + 1].t < t) ++fix;
    const double share = std::clamp((t - fixes[fix].t) / (fixes[fix + 1].t - fixes[fix].t), 0.0, 1.0);
    const auto between = [share](double a, double b) { return a + share * (b - a); };
    const double latitude = between(fixes[fix].latitude, fixes[fix + 1].latitude);
    const double longitude = between(fixes[fix].longitude, fixes[fix + 1].longitude);
    alignment.move(fixes[fix].velocity + share * (fixes[fix + 1].velocity - fixes[fix].velocity));
    Increment<double> increment = increment_of(samples[i].mean, kPeriod);
    increment.angle -= kPeriod * mean.w;
    (void)alignment.add(increment);
    for (Free& window : windows) {
      const Increment<double> corrected{increment.angle - kPeriod * window.gyro_bias,
                                        increment.velocity - kPeriod * window.accel_bias};
      ASSERT_EQ(window.navigator.add(corrected), Status::kOk);
      if (std::abs(t - window.from - kWindow) > 0.5 * kPeriod) continue;
      const NavigationState<double> state = window.navigator.state();
      drift.push_back(std::hypot(metres * (state.latitude - latitude) - window.north,
                                 metres * std::cos(latitude) * (state.longitude - longitude) - window.east));
    }
    if (t < next || t + kWindow > samples.back().t) continue;
    next = t + 20.0;
    const NavigationState<double> state = alignment.navigator().state();
    windows.push_back({alignment.navigator(), alignment.gyro_bias(), alignment.accel_bias(), t,
                       metres * (state.latitude - latitude),
                       metres * std::cos(latitude) * (state.longitude - longitude)});
  }
  ASSERT_GT(drift.size(), 12U);
  double squares = 0.0;
  for (const double d : drift) squares += d * d / static_cast<double>(drift.size());
  std::sort(drift.begin(), drift.end());
  std::printf(
      "[ FIGURE   ] real drive, left alone for 60 s, %zu windows: drift %.1f m rms, median %.1f m, largest %.1f m; "
      "heading sigma %.2f deg\n",
      drift.size(), std::sqrt(squares), drift[drift.size() / 2], drift.back(),
      std::sqrt(alignment.covariance()(2, 2)) / kRadPerDeg);
  EXPECT_LT(std::sqrt(squares), 400.0);  // uncalibrated: 0.1 m/s^2 of anything is 180 m
}

}  // namespace
}  // namespace trunnion
