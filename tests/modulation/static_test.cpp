// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The static test of docs/theory/modulation.md, section 4: 300 s at rest, half a turn a second, 50 seeds.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/modulation/demodulator.hpp"
#include "trunnion/modulation/flip.hpp"
#include "trunnion/simulation/axis_motion.hpp"
#include "trunnion/simulation/flicker.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/simulation/rotating_platform.hpp"

namespace trunnion {
namespace {

using simulation::AxisCourse;
using simulation::Flicker;
using simulation::Gaussian;
using simulation::TimeJet;
using Wide = long double;

constexpr double kPeriod = 0.01;     // s
constexpr double kDuration = 300.0;  // s
constexpr int kSeeds = 50;
constexpr double kMilliG = 1e-3 * kStandardGravity;
constexpr double kDegPerH = kRadPerSPerDegPerH;

/// Noise of a triad pair: white [unit/sqrt(Hz)] and the flat of the Allan deviation.
struct Sheet {
  double gyro_white, gyro_flat, accel_white, accel_flat;
};
constexpr Sheet kMain = {0.007 * kRadPerDeg, 10.0 * kDegPerH, 0.12 * kMilliG, 0.03 * kMilliG};
constexpr Sheet kAuxiliary = {0.01 * kRadPerDeg, 20.0 * kDegPerH, 0.15 * kMilliG, 0.1 * kMilliG};

/// White and 1/f noise and constant errors of one unit.
class Unit {
 public:
  Unit(const Sheet& sheet, std::uint64_t seed, std::uint64_t stream) : sheet_(sheet), white_(seed, stream) {
    for (std::uint64_t i = 0; i < 3; ++i) {
      const auto level = [](double flat) { return flat * flat / (2.0 * std::log(2.0)); };
      flicker_.emplace_back(level(sheet.gyro_flat), kPeriod, kDuration, seed, stream + 1 + 2 * i);
      flicker_.emplace_back(level(sheet.accel_flat), kPeriod, kDuration, seed, stream + 2 + 2 * i);
    }
  }
  InertialSample<double> read(const InertialSample<double>& input) {
    InertialSample<double> out{input.w + gyro_matrix * input.w + bias.w, input.f + accel_matrix * input.f + bias.f};
    const double root = 1.0 / std::sqrt(kPeriod);
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out.w(i) += sheet_.gyro_white * root * white_() + flicker_[2 * k]();
      out.f(i) += sheet_.accel_white * root * white_() + flicker_[2 * k + 1]();
    }
    return out;
  }
  InertialSample<double> bias;
  Mat3<double> gyro_matrix = Mat3<double>::Zero();  // what a calibration left: scale and misalignment
  Mat3<double> accel_matrix = Mat3<double>::Zero();

 private:
  Sheet sheet_;
  Gaussian white_;
  std::vector<Flicker> flicker_;
};

/// The paper's turn-on biases: its static row, of which Y does not close, by what its velocity implies. Scale 200 ppm
/// and misalignment 0.02 deg, 1 sigma, as a calibration leaves them.
Unit main_unit(std::uint64_t seed) {
  Unit unit(kMain, seed, 100);
  unit.bias = {Vec3<double>(196.0, -155.0, 67.0) * kDegPerH, Vec3<double>(-1.6, 1.2, -2.4) * kMilliG};
  Gaussian left(seed, 200);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      unit.gyro_matrix(i, j) = left() * (i == j ? 200e-6 : 0.02 * kRadPerDeg);
      unit.accel_matrix(i, j) = left() * (i == j ? 200e-6 : 0.02 * kRadPerDeg);
    }
  }
  return unit;
}

Unit auxiliary_unit(std::uint64_t seed) {
  Unit unit(kAuxiliary, seed, 300);
  Gaussian left(seed, 400);
  unit.bias = {Vec3<double>(left(), left(), left()) * (0.5 * kRadPerDeg),
               Vec3<double>(left(), left(), left()) * (20.0 * kMilliG)};
  return unit;
}

/// The paper's measure of what is left, eq. (1) of science: integrals of the residual rate and specific force.
struct Growth {
  Vec3<double> angle = Vec3<double>::Zero();     // rad
  Vec3<double> velocity = Vec3<double>::Zero();  // m/s
  Vec3<double> way = Vec3<double>::Zero();       // m
  void add(const InertialSample<double>& residual, double time) {
    way += velocity * time;
    velocity += (residual.f + kStandardGravity * (angle + 0.5 * time * residual.w)) * time;
    angle += residual.w * time;
  }
};

/// Root mean square over the seeds, x y together and z.
struct Figures {
  std::array<double, 3> across{};
  std::array<double, 3> along{};
  void add(const Growth& g) {
    const std::array<Vec3<double>, 3> kinds = {g.angle, g.velocity, g.way};
    for (std::size_t k = 0; k < 3; ++k) {
      across[k] += kinds[k].head<2>().squaredNorm() / (2.0 * kSeeds);
      along[k] += kinds[k].z() * kinds[k].z() / kSeeds;
    }
  }
  void print(const char* name) {
    for (std::size_t k = 0; k < 3; ++k) {
      across[k] = std::sqrt(across[k]);
      along[k] = std::sqrt(along[k]);
    }
    std::printf("[ FIGURE   ] %-34s across %7.3f deg %7.2f m/s %6.3f km, along %7.3f deg %7.2f m/s %6.3f km\n", name,
                across[0] / kRadPerDeg, across[1], across[2] / 1e3, along[0] / kRadPerDeg, along[1], along[2] / 1e3);
  }
};

/// What white noise of the gyros alone leaves after 300 s.
std::array<double, 3> floor_of_white_noise() {
  const double n = kMain.gyro_white;
  return {n * std::sqrt(kDuration), n * kStandardGravity * std::sqrt(std::pow(kDuration, 3) / 3.0),
          n * kStandardGravity * std::sqrt(std::pow(kDuration, 5) / 20.0)};
}

/// The base: at rest at 50 deg north, its z vertical or horizontal (north).
InertialSample<double> base_at_rest(bool vertical) {
  const double latitude = 50.0 * kRadPerDeg;
  const double north = kEarthRate * std::cos(latitude);
  const double down = -kEarthRate * std::sin(latitude);
  if (vertical) return {{north, 0.0, down}, {0.0, 0.0, -kStandardGravity}};
  return {{down, 0.0, north}, {-kStandardGravity, 0.0, 0.0}};
}

TimeJet<Wide> jet(const AxisCourse& course, Wide t) {
  const auto at = static_cast<double>(t);
  return {static_cast<Wide>(course.angle(at)), static_cast<Wide>(course.rate(at)), 0.0L};
}

struct Pulses {
  bool has = false;
  double before = 0.0;
};

Pulses pulse_in(const AxisCourse& course, int i) {
  const auto turns = [&course, i](double share) { return course.angle((i + share) * kPeriod) / (2.0 * kPi); };
  const double from = turns(0.0);
  const double to = turns(1.0);
  if (std::floor(from) == std::floor(to)) return {};
  const double mark = std::max(std::floor(from), std::floor(to));
  return {true, std::clamp((mark - from) / (to - from), 0.0, 1.0)};
}

/// A platform on the base, a flip on the platform, the unit 8 mm off the axis: true means of every sample.
std::vector<InertialSample<double>> true_samples(bool vertical, const AxisCourse& platform, const AxisCourse& flip,
                                                 double duration) {
  const InertialSample<double> rest = base_at_rest(vertical);
  const auto base = [rest](Wide) { return InertialSample<Wide>{rest.w.cast<Wide>(), rest.f.cast<Wide>()}; };
  const auto turn = [&platform](Wide t) { return jet(platform, t); };
  const auto tip = [&flip](Wide t) { return jet(flip, t); };
  const simulation::RotatingPlatform axis(base, turn, Mat3<Wide>::Identity(), Vec3<Wide>::UnitZ(),
                                          Vec3<Wide>(0.008L, 0.0L, 0.0L));
  const simulation::RotatingPlatform unit(axis, tip, Mat3<Wide>::Identity(), Vec3<Wide>::UnitX(), Vec3<Wide>::Zero());
  std::vector<InertialSample<double>> samples;
  for (int i = 0; i < static_cast<int>(duration / kPeriod); ++i) {
    const Wide from = static_cast<Wide>(kPeriod) * i;
    const auto sum = simulation::integrate<Wide>(unit, from, from + static_cast<Wide>(kPeriod));
    samples.push_back({sum.angle.cast<double>() / kPeriod, sum.velocity.cast<double>() / kPeriod});
  }
  return samples;
}

InertialSample<double> minus(const InertialSample<double>& a, const InertialSample<double>& b) {
  return {a.w - b.w, a.f - b.f};
}

class StaticTest : public testing::TestWithParam<bool> {};

// Continuous turning, one axis: across it the white noise is all that is left, with a pulse a turn as with an encoder.
TEST_P(StaticTest, LeavesTheWhiteNoiseAcrossTheAxis) {
  AxisCourse platform(0.1);
  platform.ramp(0.0, 1e-6, 2.0 * kPi * 0.5);
  const auto truth = true_samples(GetParam(), platform, AxisCourse(), kDuration);
  const auto still = true_samples(GetParam(), AxisCourse(), AxisCourse(), kDuration);
  const InertialSample<double> rest = base_at_rest(GetParam());
  Figures at_rest;
  Figures index;
  Figures encoder;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Unit turned = main_unit(seed);
    Unit same = main_unit(seed);
    IndexDemodulator<double> by_index(kPeriod, 0.0, 0.0);
    Demodulator<double, 256> by_encoder(0.0);
    Growth of_rest;
    Growth of_index;
    Growth of_encoder;
    for (int i = 0; i < static_cast<int>(truth.size()); ++i) {
      const InertialSample<double> reading = turned.read(truth[static_cast<std::size_t>(i)]);
      of_rest.add(minus(same.read(still[static_cast<std::size_t>(i)]), rest), kPeriod);
      if (by_encoder.add(reading, platform.angle((i + 1) * kPeriod), kPeriod) == Status::kOk)
        of_encoder.add(minus(by_encoder.body(), rest), kPeriod);
      const Pulses pulse = pulse_in(platform, i);
      if (!pulse.has)
        by_index.add(reading);
      else if (by_index.add_with_pulse(reading, pulse.before) == Pulse::kTurn)
        of_index.add(minus(by_index.turn().body, rest), by_index.turn().period);
    }
    at_rest.add(of_rest);
    index.add(of_index);
    encoder.add(of_encoder);
  }
  std::printf("[ FIGURE   ] static test, axis %s\n", GetParam() ? "vertical" : "horizontal");
  at_rest.print("not turned");
  index.print("index pulse");
  encoder.print("encoder");
  const auto floor = floor_of_white_noise();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(index.across[k], 1.3 * floor[k]) << k;
    EXPECT_LT(encoder.across[k], 1.3 * floor[k]) << k;
    EXPECT_GT(at_rest.across[k], 10.0 * floor[k]) << k;
  }
}

// Flips and reversals, the auxiliary unit as reference: the axis too.
TEST_P(StaticTest, CuresTheAxisByFlipAndReversal) {
  // every 12.5 s a flip, every other one with a reversal: 50 s while the base aligns, then the 300 s that count
  constexpr double kAligning = 50.0;  // s
  struct Leg {
    double until;  // s
    UnitPosition position;
    int direction;
  };
  constexpr UnitPosition kOne = UnitPosition::kFirst;
  constexpr UnitPosition kTwo = UnitPosition::kSecond;
  std::vector<Leg> legs;
  for (int k = 0; k < 28; ++k) legs.push_back({12.5 * (k + 1), k % 2 == 0 ? kOne : kTwo, k / 2 % 2 == 0 ? 1 : -1});
  constexpr double kFlipTime = 1.0;
  constexpr double kRampTime = 1.0;
  AxisCourse platform(0.1);
  AxisCourse flip;
  platform.ramp(0.0, 1e-6, kPi);
  for (std::size_t k = 0; k + 1 < legs.size(); ++k) {
    const Leg& next = legs[k + 1];
    if (next.position != legs[k].position)
      flip.move(legs[k].until, kFlipTime, next.position == kTwo ? 0.5 * kPi : -0.5 * kPi);
    if (next.direction != legs[k].direction) platform.ramp(legs[k].until, kRampTime, kPi * next.direction);
  }
  const auto truth = true_samples(GetParam(), platform, flip, legs.back().until);
  const InertialSample<double> rest = base_at_rest(GetParam());
  Figures cured;
  Figures from_power_on;
  Figures at_rest;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Unit main = main_unit(seed);
    Unit auxiliary = auxiliary_unit(seed);
    const double walk =
        1.0 / std::sqrt(25.0);  // the flat of the Allan deviation from one stay in a position to the next
    TwoPositionModulation<double> modulation(
        kPeriod, 2000.0 * kRadPerDeg, 0.0, {2.0, 5.0, kRampTime},
        {kMain.gyro_white, kAuxiliary.gyro_white, kMain.gyro_flat * walk, kAuxiliary.gyro_flat * walk, 300.0 * kDegPerH,
         0.03 * kRadPerDeg, 300e-6, 2.0 * kRadPerDeg},
        {kMain.accel_white, kAuxiliary.accel_white, kMain.accel_flat * walk, kAuxiliary.accel_flat * walk,
         5.0 * kMilliG, 0.02, 0.0, 50.0 * kMilliG});
    Growth growth;
    Growth all;
    Growth still;
    std::size_t leg = 0;
    double time = 0.0;
    bool started = false;
    for (int i = 0; i < static_cast<int>(truth.size()); ++i) {
      const double t = i * kPeriod;
      if (leg + 1 < legs.size() && t >= legs[leg].until) {
        if (legs[leg + 1].direction != legs[leg].direction) modulation.reverse();
        ++leg;
      }
      FlipSample<double> sample;
      sample.main = main.read(truth[static_cast<std::size_t>(i)]);
      sample.auxiliary = auxiliary.read(rest);
      const Pulses pulse = pulse_in(platform, i);
      sample.has_pulse = pulse.has;
      sample.pulse_before = pulse.before;
      const double angle = flip.angle(t + kPeriod);
      sample.flip = angle < 1e-6               ? FlipSwitch::kFirst
                    : angle > 0.5 * kPi - 1e-6 ? FlipSwitch::kSecond
                                               : FlipSwitch::kBetween;
      if (!modulation.add(sample)) continue;
      // before the first whole turn the auxiliary unit's bias is anyone's guess
      started = started || modulation.interval().source == IntervalSource::kMain;
      const InertialSample<double> residual = minus(modulation.interval().body, rest);
      if (started && time < kDuration) all.add(residual, modulation.interval().duration);
      if (time >= kAligning) growth.add(residual, modulation.interval().duration);
      time += modulation.interval().duration;
      ASSERT_EQ(modulation.fault(), FlipFault::kNone) << t;
    }
    EXPECT_NEAR(time, legs.back().until, 2.01);
    Unit same = main_unit(seed);
    for (int i = 0; i < static_cast<int>(kDuration / kPeriod); ++i) still.add(minus(same.read(rest), rest), kPeriod);
    cured.add(growth);
    from_power_on.add(all);
    at_rest.add(still);
  }
  std::printf("[ FIGURE   ] static test with flips, axis %s\n", GetParam() ? "vertical" : "horizontal");
  at_rest.print("not turned");
  cured.print("flips and reversals");
  from_power_on.print("the same from power-on");
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(10.0 * cured.along[k], at_rest.along[k]) << k;
}

INSTANTIATE_TEST_SUITE_P(Axis, StaticTest, testing::Bool());

}  // namespace
}  // namespace trunnion
