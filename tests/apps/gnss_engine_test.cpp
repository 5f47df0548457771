// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The engine of gnss_attitude on simulated receivers: gyros that run ahead of late phases, silent receivers,
/// smoothing.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "attitude/three_antennas.hpp"
#include "gnss_attitude/engine.hpp"
#include "trunnion/simulation/gnss_array.hpp"

namespace trunnion::app {
namespace {

using simulation::AttitudePath;
using simulation::Gaussian;
using simulation::GnssArray;
using simulation::GnssArrayOptions;

constexpr GpsTime kStart{2320, 116400.0};

GnssArrayOptions on_a_roof(std::uint64_t seed) {
  GnssArrayOptions options;
  options.seed = seed;
  options.orbits = simulation::walker_constellation(30, kStart);
  options.start = kStart;
  options.antennas = {Vec3<double>(0, 0, 0), Vec3<double>(1, 0, 0), Vec3<double>(0, 1, 0)};
  options.place = [](double) { return Vec3<double>(-3817680.98, 3562840.07, 3650158.45); };
  options.clocks = 1e-6;
  return options;
}

EngineOptions engine_options() {
  EngineOptions options;
  options.slaves = {Vec3<double>(1, 0, 0), Vec3<double>(0, 1, 0)};
  options.figure_sigma = 0.0005;
  return options;
}

ArrayEpoch epoch_of(const GnssArray::Epoch& seen) {
  ArrayEpoch epoch;
  epoch.utime = 1000000000 + std::llround(1e6 * seen.t);
  epoch.time = seen.antenna[0].time;
  epoch.antenna = seen.antenna;
  epoch.heard.assign(seen.antenna.size(), true);
  return epoch;
}

double degrees_off(const Solution& solution, const Quaternion<double>& truth) {
  return rotation_error(solution.attitude.q_nb, truth).norm() / kRadPerDeg;
}

/// Phases arrive 0.15 s after the gyros of their time: three degrees of this body's way.
TEST(Engine, TurnsByGyrosUpToTheEpochAndNoFurther) {
  constexpr double kNoise = 0.005 * kRadPerDeg;
  const Vec3<double> bias(0.002, -0.003, 0.001);
  const AttitudePath path = simulation::example_1_stand_in(simulation::PlatformMotion::kFast, 101.0);
  GnssArray array(on_a_roof(1), path);
  EngineOptions options = engine_options();
  options.driven = true;
  options.tracker.noise = {1e-5, std::numeric_limits<double>::infinity(), kNoise};
  options.tracker.slow_sigma = 0.01;
  const auto engine = Engine::make(options);
  Gaussian noise(1, 9);
  double square = 0.0;
  int count = 0;
  std::int64_t fed = 0;  // ms
  for (int k = 0; k < 100; ++k) {
    const auto& seen = array.next();
    for (; fed < 1000 * k + 150; fed += 10) {
      const double from = 1e-3 * static_cast<double>(fed) - 0.003;  // not in step with the epochs
      if (from < 0.0) continue;
      const Vec3<double> w = rotation_error(path.q_nb(from), path.q_nb(from + 0.01)) / 0.01 + bias +
                             kNoise * 10.0 * Vec3<double>(noise(), noise(), noise());
      engine->gyro(1000000000 + std::llround(1e6 * (from + 0.01)), 0.01, w);
    }
    const Solution solution = engine->add(epoch_of(seen));
    if (k < 30) continue;
    EXPECT_EQ(solution.status, AttitudeStatus::kFixed) << k;
    square += std::pow(degrees_off(solution, seen.q_nb), 2);
    ++count;
  }
  const double rms = std::sqrt(square / (3.0 * count));
  std::printf("[ FIGURE ] gyros at 100 Hz, phases of 2 mm 0.15 s late, up to 20 deg/s: %.4f deg an axis\n", rms);
  EXPECT_LT(rms, 0.06);
}

TEST(Engine, StartsAnewWhenGyrosFallSilent) {
  GnssArray array(on_a_roof(2), simulation::example_1_stand_in(simulation::PlatformMotion::kMedium, 60.0));
  EngineOptions options = engine_options();
  options.driven = true;
  const auto engine = Engine::make(options);
  for (int k = 0; k < 40; ++k) {
    const auto& seen = array.next();
    const Solution solution = engine->add(epoch_of(seen));  // and never a gyro
    EXPECT_EQ(solution.status, AttitudeStatus::kFixed);
    EXPECT_TRUE(solution.started);
    EXPECT_LT(degrees_off(solution, seen.q_nb), 2.0);
  }
}

TEST(Engine, SaysWhichReceiverIsSilentAndGoesOnWithTheOther) {
  GnssArray array(on_a_roof(3), AttitudePath([](double) { return Vec3<double>(Vec3<double>::Zero()); },
                                             quaternion_of_euler(0.1, -0.2, 2.0), 60.0));
  EngineOptions options = engine_options();
  options.tracker.noise.walk = 0.01 * kRadPerDeg;
  options.keep_records = true;
  const auto engine = Engine::make(options);
  std::vector<Solution> solutions;
  for (int k = 0; k < 60; ++k) {
    const auto& seen = array.next();
    ArrayEpoch epoch = epoch_of(seen);
    if (k >= 20 && k < 30) epoch.heard[2] = false;
    if (k >= 30 && k < 40) epoch.heard[0] = false;
    solutions.push_back(engine->add(epoch));
    const Solution& s = solutions.back();
    EXPECT_EQ(s.silent, k >= 20 && k < 40);
    EXPECT_EQ(s.status, k >= 30 && k < 40 ? AttitudeStatus::kPredicted : AttitudeStatus::kFixed) << k;
    EXPECT_EQ(s.has_baseline[1], !(k >= 20 && k < 40));
    EXPECT_LT(degrees_off(s, seen.q_nb), 1.5) << k;
  }
  std::vector<Solution> smoothed = solutions;
  engine->smooth(smoothed);
  const Quaternion<double> truth = quaternion_of_euler(0.1, -0.2, 2.0);
  double before = 0.0;
  double after = 0.0;
  for (std::size_t k = 0; k < smoothed.size(); ++k) {
    before += std::pow(degrees_off(solutions[k], truth), 2);
    after += std::pow(degrees_off(smoothed[k], truth), 2);
    EXPECT_LE(smoothed[k].attitude.covariance.trace(), 1.001 * solutions[k].attitude.covariance.trace()) << k;
  }
  EXPECT_LT(after, 0.7 * before);
}

/// A fix that the filter refuses is a record of nothing seen: the smoother is not led astray by the one before.
TEST(Engine, SmoothsAcrossARefusedFix) {
  const Quaternion<double> truth = quaternion_of_euler(0.1, -0.2, 2.0);
  GnssArray array(on_a_roof(5), AttitudePath([](double) { return Vec3<double>(Vec3<double>::Zero()); }, truth, 60.0));
  GnssArray elsewhere(on_a_roof(6), AttitudePath([](double) { return Vec3<double>(Vec3<double>::Zero()); },
                                                 quaternion_of_euler(0.1, -0.2, 1.0), 60.0));
  EngineOptions options = engine_options();
  options.tracker.noise.walk = 0.01 * kRadPerDeg;
  options.keep_records = true;
  const auto engine = Engine::make(options);
  std::vector<Solution> solutions;
  for (int k = 0; k < 40; ++k) {
    const auto& here = array.next();
    const auto& there = elsewhere.next();
    solutions.push_back(engine->add(epoch_of(k == 20 ? there : here)));
    EXPECT_EQ(solutions.back().refused, k == 20);
  }
  engine->smooth(solutions);
  double nees = 0.0;
  for (std::size_t k = 1; k < solutions.size(); ++k) {
    const Vec3<double> off = rotation_error(solutions[k].attitude.q_nb, truth);
    nees += off.dot(solutions[k].attitude.information * off) / 39.0;
    EXPECT_LT(degrees_off(solutions[k], truth), 0.6) << k;
  }
  EXPECT_LT(nees / 3.0, 4.0) << "errors of a smoother are one error";
}

TEST(Engine, SmoothsColouredErrorsThatBeginWithAHole) {
  GnssArray array(on_a_roof(7), simulation::example_1_stand_in(simulation::PlatformMotion::kSlow, 60.0));
  EngineOptions options = engine_options();
  options.tracker.noise = {0.1 * kRadPerDeg, std::numeric_limits<double>::infinity(), 0.0, 1.0, 30.0};
  options.keep_records = true;
  const auto engine = Engine::make(options);
  std::vector<Solution> solutions;
  for (int k = 0; k < 40; ++k) {
    ArrayEpoch epoch = epoch_of(array.next());
    if (k == 1) epoch.heard[2] = false;
    if (k == 2) epoch.heard[0] = false;
    solutions.push_back(engine->add(epoch));
  }
  ASSERT_NO_THROW(engine->smooth(solutions));
  for (const Solution& s : solutions) EXPECT_TRUE(s.attitude.covariance.allFinite());
}

TEST(Engine, OfThePaperFollowsToo) {
  const AttitudePath path = simulation::example_1_stand_in(simulation::PlatformMotion::kSlow, 60.0);
  GnssArray array(on_a_roof(4), path);
  EngineOptions options = engine_options();
  options.filter = AttitudeFilter::kPaper;
  options.tracker.noise.walk = 0.1 * kRadPerDeg;
  const auto engine = Engine::make(options);
  for (int k = 0; k < 60; ++k) {
    const auto& seen = array.next();
    const Solution solution = engine->add(epoch_of(seen));
    EXPECT_EQ(solution.status, AttitudeStatus::kFixed);
    EXPECT_LT(degrees_off(solution, seen.q_nb), 1.5) << k;
    EXPECT_GT(solution.attitude.covariance.trace(), 0.0);
  }
}

}  // namespace
}  // namespace trunnion::app
