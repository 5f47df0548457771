// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/table_sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "matchers/refuses.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/turntable/two_axis.hpp"

namespace trunnion::simulation {
namespace {

TableLimits limits() {
  TableLimits l;
  l[kAzimuth].rate = l[kPitch].rate = 2.0;
  l[kAzimuth].acceleration = l[kPitch].acceleration = 1.0;
  l[kPitch].lowest = -0.2;
  l[kPitch].highest = 1.2;
  return l;
}

/// Any sequence within the limits.
TableSequence random_sequence(std::uint64_t seed) {
  Gaussian random(seed, 1);
  const TableLimits l = limits();
  TableSequence moves = {{0.0, 1.0, {AxisCommand{0.3, 0, 0, 0}, AxisCommand{0.5, 0, 0, 0}}}};
  std::array<double, 2> angle = {0.3, 0.5};
  for (int i = 0; i < 20; ++i) {
    TableMove move;
    const double azimuth = 6.0 * random.uniform();
    const double pitch = -0.1 + 1.2 * random.uniform();
    move.axis[kAzimuth].angle = azimuth;
    move.axis[kPitch].angle = pitch;
    if (random.uniform() < 0.5) move.axis[kAzimuth].rate = random.uniform() - 0.5;
    if (random.uniform() < 0.5) {
      move.axis[kPitch].amplitude = std::min({pitch + 0.2, 1.2 - pitch, 0.3});
      move.axis[kPitch].frequency = 0.1 + 0.1 * random.uniform();
    }
    move.transition = std::max(transition_for(std::remainder(azimuth - angle[0], 2.0 * kPi), move.axis[0].rate, l[0]),
                               transition_for(pitch - angle[1], 0.0, l[1])) +
                      0.0;
    move.duration = 2.0 * move.transition + 5.0 * random.uniform();
    angle = {azimuth + move.axis[0].rate * (move.duration - move.transition), pitch};
    moves.push_back(move);
  }
  return moves;
}

TEST(TableSequence, IsWhereItsMovesSay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TableSequence moves = random_sequence(seed);
    const TableMotion motion = motion_of(moves, limits());
    EXPECT_NEAR(motion.duration, duration_of(moves), 1e-9);
    double t = 0.0;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const TableMove& move = moves[i];
      t += move.duration;
      const AxisCommand& azimuth = move.axis[kAzimuth];
      const double swept = move.duration > 0.0 ? azimuth.rate * (move.duration - move.transition) : 0.0;
      EXPECT_NEAR(std::remainder(motion.azimuth.angle(t) - azimuth.angle - swept, 2.0 * kPi), 0.0, 1e-9) << i;
      EXPECT_NEAR(motion.pitch.angle(t), move.axis[kPitch].angle, 1e-9) << i;
      EXPECT_NEAR(motion.azimuth.rate(t), 0.0, 1e-9) << i;
    }
  }
}

/// What check_limits() lets pass keeps the limits, looked at ten times as finely; and it does not refuse everything.
TEST(TableSequence, KeepsTheLimitsThatAreChecked) {
  TableLimits l = limits();
  l[kAzimuth].acceleration = l[kPitch].acceleration = 0.5;  // half of what they are made for
  int passed = 0;
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    TableSequence moves = random_sequence(seed);
    moves.resize(4);
    try {
      check_limits(moves, l, "moves");
    } catch (const Error&) {
      ++refused;
      continue;
    }
    ++passed;
    const TableMotion motion = motion_of(moves, l);
    for (double t = 0.0; t < motion.duration; t += 0.001) {
      const double h = 1e-4;
      for (const AxisCourse* course : {&motion.azimuth, &motion.pitch}) {
        ASSERT_LE(std::abs(course->rate(t)), 2.0 * 1.002) << seed << " at " << t;
        ASSERT_LE(std::abs(course->rate(t + h) - course->rate(t - h)) / (2.0 * h), 0.5 * 1.005) << seed << " at " << t;
      }
      ASSERT_GE(motion.pitch.angle(t), -0.2 - 0.002) << seed << " at " << t;
      ASSERT_LE(motion.pitch.angle(t), 1.2 + 0.002) << seed << " at " << t;
    }
  }
  EXPECT_GE(passed, 5);
  EXPECT_GE(refused, 1);
}

TEST(TableSequence, AStepAsksForTheRateAndAccelerationOfEquationOne) {
  const TableMotion motion =
      motion_of({{0.0, 1.0, {}}, {3.0, 2.0, {AxisCommand{1.0, 0, 0, 0}, AxisCommand{}}}}, TableLimits{});
  double rate = 0.0;
  double acceleration = 0.0;
  for (double t = 0.0; t < 2.0; t += 1e-4) {
    rate = std::max(rate, motion.azimuth.rate(t));
    acceleration = std::max(acceleration, (motion.azimuth.rate(t + 1e-4) - motion.azimuth.rate(t)) / 1e-4);
  }
  EXPECT_NEAR(rate, 15.0 / 8.0 / 2.0, 1e-6);
  EXPECT_NEAR(acceleration, 10.0 / std::sqrt(3.0) / 4.0, 1e-3);
}

TEST(TableSequence, NamesTheLimitThatIsBroken) {
  const auto refused = [](const TableMove& move, const TableLimits& l, const char* words) {
    const TableSequence moves = {{0.0, 1.0, {}}, move};
    EXPECT_REFUSES(ExitCode::kInput, words, check_limits(moves, l, "mount_1"));
  };
  const AxisCommand still{};
  refused({10.0, 3.0, {still, AxisCommand{1.3, 0, 0, 0}}}, limits(),
          "move 2: the pitch would reach 74.4845 deg, its limit is 68.7549");
  refused({10.0, 3.0, {still, AxisCommand{1.1, 0, 0.2, 0.1}}}, limits(), "pitch would reach");
  refused({10.0, 3.0, {still, AxisCommand{0.0, -0.2, 0, 0}}}, limits(), "pitch would reach");
  refused({10.0, 4.0, {AxisCommand{0.0, 2.1, 0, 0}, still}}, limits(), "azimuth would turn at");
  refused({10.0, 1.0, {AxisCommand{1.0, 0, 0, 0}, still}}, limits(), "azimuth would accelerate by");
  refused({10.0, 6.0, {AxisCommand{0.0, 0.1, 0, 0}, still}}, limits(), "no room for its transitions");
}

TEST(TableSequence, TheExperimentTakesThe705SecondsOfTheRebuiltOne) {
  EXPECT_DOUBLE_EQ(duration_of(experiment(-0.1, 1.2, 0)), 705.0);
  TableLimits l;
  l[kPitch].lowest = -10.0 * kRadPerDeg;
  l[kPitch].highest = 70.0 * kRadPerDeg;
  l[kAzimuth].rate = l[kPitch].rate = 2.0;
  for (int variant = 0; variant < 5; ++variant)
    EXPECT_NO_THROW(check_limits(experiment(l[kPitch].lowest, l[kPitch].highest, variant), l, "experiment"));
  EXPECT_NO_THROW(check_limits(design_run(l[kPitch]), l, "design run"));
  EXPECT_NO_THROW(check_limits(nineteen_positions(40.0, 10.0 * kRadPerDeg), TableLimits{}, "nineteen"));
  EXPECT_EQ(nineteen_positions(40.0, 0.2).size(), 20U);  // and where it stands first
  EXPECT_EQ(sixteen_positions(40.0, 0.2).size(), 17U);
}

}  // namespace
}  // namespace trunnion::simulation
