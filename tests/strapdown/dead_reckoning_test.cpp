// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/strapdown/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/axis_motion.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/simulation/rotating_platform.hpp"

namespace trunnion {
namespace {

using simulation::TimeJet;
using Wide = long double;

constexpr double kPeriod = 1.0 / 120.0;  // s
constexpr double kRadius = 0.29;         // m
constexpr int kSamples = 120 * 120;

/// Two minutes on a level road: a rest, bends, a stop in between.
struct Road {
  simulation::AxisCourse way;  // its angle is metres along the road
  simulation::AxisCourse yaw;
  Road() {
    way.ramp(3.0, 6.0, 9.0);
    way.ramp(30.0, 5.0, 4.0);
    way.ramp(50.0, 6.0, 0.0);
    way.ramp(62.0, 8.0, 11.0);
    way.ramp(105.0, 8.0, 0.0);
    for (const double t : {12.0, 24.0, 72.0}) yaw.move(t, 5.0, 1.5);
    for (const double t : {36.0, 86.0}) yaw.move(t, 4.0, -1.2);
  }
  [[nodiscard]] InertialSample<Wide> felt(Wide t) const {
    const auto at = static_cast<double>(t);
    const double slope = 0.5 * (way.rate(at + 1e-4) - way.rate(at - 1e-4)) / 1e-4;
    return {Vec3<Wide>(0.0L, 0.0L, static_cast<Wide>(yaw.rate(at))),
            Vec3<Wide>(static_cast<Wide>(slope), static_cast<Wide>(way.rate(at) * yaw.rate(at)),
                       static_cast<Wide>(-kStandardGravity))};
  }
};

struct Imperfection {
  InertialSample<double> bias;
  double axle_scale = 0.0;
  Vec3<double> tilt = Vec3<double>::Zero();       // of the gyros' plane against the axle
  Vec3<double> lever_arm = Vec3<double>::Zero();  // from the axle, m
  double gyro_noise = 0.0;
  double accel_noise = 0.0;
};

std::vector<InertialSample<double>> wheel_samples(const Road& road, AxleSide side, const Imperfection& wrong) {
  const double s = side == AxleSide::kLeft ? 1.0 : -1.0;
  Mat3<Wide> C_bp;  // x forward, z to the side
  C_bp << 1.0L, 0.0L, 0.0L, 0.0L, 0.0L, static_cast<Wide>(-s), 0.0L, static_cast<Wide>(s), 0.0L;
  const auto angle = [&road, s](Wide t) {
    const auto at = static_cast<double>(t);
    return TimeJet<Wide>(static_cast<Wide>(s * road.way.angle(at) / kRadius + 0.4),
                         static_cast<Wide>(s * road.way.rate(at) / kRadius), 0.0L);
  };
  const simulation::RotatingPlatform wheel([&road](Wide t) { return road.felt(t); }, angle, C_bp, Vec3<Wide>::UnitZ(),
                                           wrong.lever_arm.cast<Wide>());
  simulation::Gaussian noise(5, 6);
  std::vector<InertialSample<double>> samples;
  for (int i = 0; i < kSamples; ++i) {
    const Wide from = static_cast<Wide>(kPeriod) * i;
    const auto sum = simulation::integrate<Wide>(wheel, from, from + static_cast<Wide>(kPeriod));
    InertialSample<double> mean{sum.angle.cast<double>() / kPeriod, sum.velocity.cast<double>() / kPeriod};
    mean.w += wrong.tilt * mean.w.z() + wrong.bias.w;
    mean.w.z() *= 1.0 + wrong.axle_scale;
    mean.f += wrong.bias.f;
    for (int k = 0; k < 3; ++k) {
      mean.w(k) += wrong.gyro_noise * noise();
      mean.f(k) += wrong.accel_noise * noise();
    }
    samples.push_back(mean);
  }
  return samples;
}

struct Worst {
  double heading = 0.0;  // rad
  double way = 0.0;      // m, position
  double distance = 0.0;
};

template <class T>
Worst drive(const Road& road, AxleSide side, const std::vector<InertialSample<double>>& samples) {
  WheelDeadReckoning<T> reckoning({static_cast<T>(kRadius), side, T(0), T(0.003)}, T(0), static_cast<T>(kPeriod));
  Worst worst;
  double north = 0.0;
  double east = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const auto& s = samples[static_cast<std::size_t>(i)];
    EXPECT_EQ(reckoning.add({s.w.cast<T>(), s.f.cast<T>()}), Status::kOk);
    const double t = (i + 0.5) * kPeriod;
    north += road.way.rate(t) * std::cos(road.yaw.angle(t)) * kPeriod;
    east += road.way.rate(t) * std::sin(road.yaw.angle(t)) * kPeriod;
    worst.heading =
        std::max(worst.heading, std::abs(static_cast<double>(reckoning.heading()) - road.yaw.angle(t + 0.5 * kPeriod)));
    worst.way = std::max(worst.way, std::hypot(static_cast<double>(reckoning.north()) - north,
                                               static_cast<double>(reckoning.east()) - east));
  }
  worst.distance = static_cast<double>(reckoning.distance()) - road.way.angle(kSamples * kPeriod);
  return worst;
}

// A perfect unit: what the loop's dynamics leave.
TEST(WheelDeadReckoning, FollowsAPerfectWheel) {
  const Road road;
  for (const AxleSide side : {AxleSide::kLeft, AxleSide::kRight}) {
    const Worst worst = drive<double>(road, side, wheel_samples(road, side, {}));
    EXPECT_LT(worst.heading, 0.15 * kRadPerDeg);
    EXPECT_LT(worst.way, 1.0);
    EXPECT_LT(std::abs(worst.distance), 0.2);
  }
}

// The unit of a toy: 3 deg/s, 1 % of axle scale, 1 deg of tilt, 1 cm off the axle, noise. Unmodulated, 3 deg/s are 360
// deg.
TEST(WheelDeadReckoning, NeedsNoCalibration) {
  const Road road;
  Imperfection wrong;
  wrong.bias = {Vec3<double>(0.04, -0.03, 0.02), Vec3<double>(0.1, -0.05, 0.1)};
  wrong.axle_scale = -0.01;
  wrong.tilt = Vec3<double>(0.015, -0.01, 0.0);
  wrong.lever_arm = Vec3<double>(0.007, -0.008, 0.0);
  wrong.gyro_noise = 0.003;
  wrong.accel_noise = 0.05;
  for (const AxleSide side : {AxleSide::kLeft, AxleSide::kRight}) {
    const auto samples = wheel_samples(road, side, wrong);
    const Worst worst = drive<double>(road, side, samples);
    EXPECT_LT(worst.heading, 1.0 * kRadPerDeg);
    EXPECT_LT(worst.way, 0.01 * road.way.angle(kSamples * kPeriod));
    EXPECT_LT(std::abs(worst.distance), 0.002 * road.way.angle(kSamples * kPeriod));
    const Worst single = drive<float>(road, side, samples);
    EXPECT_NEAR(single.heading, worst.heading, 0.1 * kRadPerDeg);
    EXPECT_NEAR(single.way, worst.way, 0.5);
  }
}

TEST(WheelDeadReckoning, WaitsForRestAndSaysWhatItSees) {
  WheelDeadReckoning<double> reckoning({kRadius, AxleSide::kLeft, 30.0, 0.003}, 0.3, kPeriod);
  InertialSample<double> sample;
  sample.f.y() = -9.8;
  for (int i = 0; i < 600; ++i) {  // rolling from the start
    sample.w.z() = 0.2 * i;
    EXPECT_EQ(reckoning.add(sample), Status::kOk);
  }
  EXPECT_EQ(reckoning.state(), WheelState::kWaiting);
  EXPECT_EQ(reckoning.distance(), 0.0);
  for (int i = 0; i < 600; ++i) {  // evenly: gravity goes round
    sample.w.z() = 25.0;
    sample.f = Vec3<double>(9.8 * std::sin(25.0 * kPeriod * i), -9.8 * std::cos(25.0 * kPeriod * i), 0.0);
    (void)reckoning.add(sample);
  }
  EXPECT_EQ(reckoning.state(), WheelState::kWaiting);
  sample.w.z() = 0.0;
  sample.f = Vec3<double>(0.0, -9.8, 0.0);
  for (int i = 0; i < 130; ++i) (void)reckoning.add(sample);
  EXPECT_EQ(reckoning.state(), WheelState::kRest);
  sample.w.z() = 5.0;
  (void)reckoning.add(sample);
  EXPECT_EQ(reckoning.state(), WheelState::kRolling);
  sample.w.z() = 30.0;
  (void)reckoning.add(sample);
  EXPECT_EQ(reckoning.state(), WheelState::kSaturated);
  const double before = reckoning.heading();
  sample.f.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(reckoning.add(sample), Status::kOutOfRange);
  EXPECT_EQ(reckoning.heading(), before);
  sample.f.x() = 0.0;
  (void)reckoning.add(sample);
  EXPECT_TRUE(std::isfinite(reckoning.heading()));
}

}  // namespace
}  // namespace trunnion
