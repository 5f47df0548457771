// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/modulation/turn_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

#include "matchers/chi_square.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/modulation/flip.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

using Errors = TurnErrors<double>;

constexpr TurnErrorNoise<double> kNoise = {1e-4, 2e-4, 1e-7, 1e-7, 1e-3, 5e-4, 3e-4, 1e-2};

/// A unit whose errors are drawn from its own first sigmas, and its turns: what the model of eq. (1), (2) says.
struct Turning {
  simulation::Gaussian noise;
  Errors::StateVector truth;
  explicit Turning(std::uint64_t seed) : noise(seed, 1) {
    for (int i = 0; i < Errors::kStates; ++i) truth(i) = noise();
    truth.head<3>() *= kNoise.first_bias;
    truth.segment<4>(Errors::kTilt) *= kNoise.first_tilt;
    truth.segment<2>(Errors::kScale) *= kNoise.first_scale;
    truth(Errors::kReference) *= kNoise.first_reference;
  }
  void turn(Errors& errors, UnitPosition position, double rate, double body) {
    const double period = 2.0 * kPi / std::abs(rate);
    const Vec3<double> bias = in_platform<double>(position, truth.head<3>());
    const int second = position == UnitPosition::kSecond ? 1 : 0;
    const auto sigma = [period](double density) { return density / std::sqrt(period); };
    Vec3<double> mean = bias;
    mean.x() += truth(Errors::kTilt + 2 * second) * rate + sigma(kNoise.density) * noise();
    mean.y() += truth(Errors::kTilt + 2 * second + 1) * rate + sigma(kNoise.density) * noise();
    mean.z() += truth(Errors::kScale + second) * rate + body + sigma(kNoise.density) * noise();
    errors.add_across(position, mean, rate, period);
    errors.add_along(position, mean.z(), rate, body + truth(Errors::kReference) + sigma(kNoise.reference) * noise(),
                     period);
  }
};

double sigma_of(const Errors& errors, int state) { return std::sqrt(errors.covariance()(state, state)); }

// What tells what from what, on a base that turns as it likes: reversing tells the scale factor from the bias, two
// rates do the same, and nothing but the flip finds the axial bias.
TEST(TurnErrors, LearnOnlyWhatTheTurningShows) {
  struct Plan {
    const char* name;
    bool flip;
    std::array<double, 2> rates;
    bool finds_scale;
  };
  for (const Plan& plan : {Plan{"one rate", false, {kPi, kPi}, false}, Plan{"reversal", false, {kPi, -kPi}, true},
                           Plan{"two rates", false, {kPi, 3.0 * kPi}, true}, Plan{"flip", true, {kPi, -kPi}, true}}) {
    Errors errors(kNoise);
    Turning unit(7);
    for (int k = 0; k < 400; ++k) {
      const auto position = plan.flip && k / 2 % 2 == 1 ? UnitPosition::kSecond : UnitPosition::kFirst;
      unit.turn(errors, position, plan.rates[static_cast<std::size_t>(k % 2)], 0.3 * std::sin(0.1 * k));
    }
    EXPECT_EQ(sigma_of(errors, Errors::kScale) < 0.1 * kNoise.first_scale, plan.finds_scale) << plan.name;
    EXPECT_EQ(sigma_of(errors, Errors::kBias + 2) < 0.1 * kNoise.first_bias, plan.flip) << plan.name;
    EXPECT_LT(std::abs(errors.along(UnitPosition::kFirst, 0.3 + unit.truth(2) + unit.truth(7) * kPi, kPi) - 0.3),
              3.0 * errors.along_sigma(UnitPosition::kFirst, kPi))
        << plan.name;
  }
}

// Honest sigmas: NEES of all ten states over 200 units, two-sided 1 %.
TEST(TurnErrors, HaveHonestCovariances) {
  double sum = 0.0;
  constexpr int kUnits = 200;
  for (std::uint64_t seed = 1; seed <= kUnits; ++seed) {
    Errors errors(kNoise);
    Turning unit(seed);
    for (int k = 0; k < 60; ++k)
      unit.turn(errors, k / 10 % 2 == 0 ? UnitPosition::kFirst : UnitPosition::kSecond, k / 5 % 2 == 0 ? kPi : -kPi,
                0.1);
    const Errors::StateVector e = errors.state() - unit.truth;
    sum += e.dot(errors.covariance().inverse() * e);
  }
  const ChiSquareBand band = chi_square_band(Errors::kStates * kUnits, 0.01);
  EXPECT_GT(sum, band.low);
  EXPECT_LT(sum, band.high);
}

/// A platform of 2 s a turn on a base at rest, gravity across the axis, sampled at 100 Hz without noise.
class TwoPosition : public testing::Test {
 protected:
  static constexpr double kStep = 0.01;
  static constexpr double kAuxiliaryBias = 0.01;
  TwoPositionModulation<double> modulation{kStep, 30.0, 0.0, {2.0, 5.0, 1.0}, kNoise, kNoise};
  FlipSample<double> sample;
  bool pulses = true;
  double out = 0.0;  // s of intervals
  int held = 0;

  bool step(FlipSwitch flip = FlipSwitch::kFirst) {
    const double from = kPi * kStep * tick_ - 0.1;
    const double middle = from + 0.5 * kPi * kStep;
    const Vec3<double> platform(9.8 * std::cos(middle), -9.8 * std::sin(middle), 0.0);
    sample.main = {Vec3<double>(0.0, 0.0, kPi), platform};
    if (flip == FlipSwitch::kSecond)
      sample.main = {Vec3<double>(0.0, kPi, 0.0), Vec3<double>(platform.x(), platform.z(), -platform.y())};
    sample.auxiliary = {Vec3<double>(kAuxiliaryBias, 0.0, 0.0), Vec3<double>(9.8, 0.0, 0.0)};
    sample.flip = flip;
    const double turns = from / (2.0 * kPi);
    const double mark = std::ceil(turns);
    sample.has_pulse = pulses && mark < turns + kStep / 2.0;
    sample.pulse_before = (mark - turns) / (kStep / 2.0);
    ++tick_;
    if (!modulation.add(sample)) return false;
    out += modulation.interval().duration;
    held += modulation.interval().source == IntervalSource::kHeld ? 1 : 0;
    return true;
  }
  void run(double seconds, FlipSwitch flip = FlipSwitch::kFirst) {
    for (int i = 0; i < static_cast<int>(seconds / kStep + 0.5); ++i) (void)step(flip);
  }
  [[nodiscard]] double time() const { return kStep * tick_; }

 private:
  int tick_ = 0;
};

TEST_F(TwoPosition, GoesThroughItsStates) {
  EXPECT_EQ(modulation.state(), FlipState::kSettling);
  run(1.0);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
  run(20.0);
  EXPECT_EQ(modulation.interval().source, IntervalSource::kMain);
  EXPECT_NEAR(modulation.interval().body.f.x(), 9.8, 1e-3);
  run(1.0, FlipSwitch::kBetween);
  EXPECT_EQ(modulation.state(), FlipState::kFlipping);
  EXPECT_EQ(modulation.interval().source, IntervalSource::kAuxiliary);
  EXPECT_NEAR(modulation.interval().body.w.x(), 0.0, 1e-6);  // its bias has been learnt
  run(0.01, FlipSwitch::kSecond);
  EXPECT_EQ(modulation.state(), FlipState::kSettling);
  run(20.0, FlipSwitch::kSecond);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
  EXPECT_EQ(modulation.position(), UnitPosition::kSecond);
  EXPECT_EQ(modulation.interval().source, IntervalSource::kMain);
  EXPECT_NEAR(modulation.interval().body.f.x(), 9.8, 1e-3);
  EXPECT_NEAR(modulation.interval().body.f.y(), 0.0, 1e-3);
  modulation.reverse();
  EXPECT_EQ(modulation.state(), FlipState::kReversing);
  run(4.0, FlipSwitch::kSecond);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
  EXPECT_EQ(modulation.fault(), FlipFault::kNone);
  EXPECT_NEAR(out, time(), 2.0);  // but for the open turn
}

TEST_F(TwoPosition, SaysWhenAFlipDoesNotEnd) {
  run(10.0);
  run(1.9, FlipSwitch::kBetween);
  EXPECT_EQ(modulation.fault(), FlipFault::kNone);
  run(60.0, FlipSwitch::kBetween);
  EXPECT_EQ(modulation.fault(), FlipFault::kFlipOverdue);
  EXPECT_EQ(modulation.interval().source, IntervalSource::kAuxiliary);
  EXPECT_NEAR(out, time(), 1e-6);
  run(5.0, FlipSwitch::kSecond);  // at last
  EXPECT_EQ(modulation.fault(), FlipFault::kNone);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
}

// The main unit dead, and the flip stuck with it: both are told, the mechanics first, and no time is lost.
TEST_F(TwoPosition, SaysWhenTheMainUnitIsDead) {
  run(10.0);
  FlipSample<double> dead = sample;
  dead.has_pulse = false;
  dead.main.w.setConstant(std::numeric_limits<double>::quiet_NaN());
  double bridged = 0.0;
  for (int i = 0; i < 100; ++i) bridged += modulation.add(dead) ? modulation.interval().duration : 0.0;
  EXPECT_EQ(modulation.fault(), FlipFault::kMainSilent);
  dead.flip = FlipSwitch::kBetween;
  for (int i = 0; i < 500; ++i) bridged += modulation.add(dead) ? modulation.interval().duration : 0.0;
  EXPECT_EQ(modulation.fault(), FlipFault::kFlipOverdue);
  EXPECT_NEAR(out + bridged, time() + 6.0, 1e-6);
}

// A reversal told again starts its ramp again, and one told during a flip is not forgotten.
TEST_F(TwoPosition, WaitsForTheRamp) {
  run(10.0);
  modulation.reverse();
  run(0.9);
  modulation.reverse();
  run(0.9);
  EXPECT_EQ(modulation.state(), FlipState::kReversing);
  run(5.0);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
  run(0.1, FlipSwitch::kBetween);
  modulation.reverse();
  for (int i = 0; i < 99; ++i) {
    (void)step(FlipSwitch::kSecond);
    EXPECT_EQ(modulation.state(), FlipState::kSettling);
  }
}

TEST_F(TwoPosition, SaysWhenThePulseStops) {
  run(10.0);
  pulses = false;
  run(20.0);
  EXPECT_EQ(modulation.state(), FlipState::kSettling);
  EXPECT_EQ(modulation.fault(), FlipFault::kNoPulse);
  EXPECT_EQ(modulation.interval().source, IntervalSource::kAuxiliary);
  EXPECT_NEAR(out, time(), 1e-6);
}

TEST_F(TwoPosition, HoldsAndSaysSoWhenNobodySees) {
  run(10.0);
  const InertialSample<double> last = modulation.interval().body;
  sample.has_auxiliary = false;
  run(0.5, FlipSwitch::kBetween);
  EXPECT_EQ(modulation.fault(), FlipFault::kAuxiliarySilent);
  EXPECT_GT(held, 40);
  EXPECT_LT((modulation.interval().body.f - last.f).norm(), 1e-6);
  EXPECT_LT(modulation.interval().body.w.norm(), 0.02);
  EXPECT_NEAR(out, time(), 1e-6);
}

// The axial gyro at its end knows nothing of the body: the auxiliary unit is asked, and the filter is not told.
TEST_F(TwoPosition, TakesTheAuxiliaryRateWhenTheAxialGyroIsAtItsEnd) {
  TwoPositionModulation<double> at_the_end{kStep, kPi, 0.0, {2.0, 5.0, 1.0}, kNoise, kNoise};
  int turns = 0;
  for (int i = 0; i < 2000; ++i) {
    (void)step();
    FlipSample<double> turning = sample;
    turning.auxiliary.w.z() = 0.2;
    if (!at_the_end.add(turning) || at_the_end.interval().source != IntervalSource::kMain) continue;
    ++turns;
    EXPECT_EQ(at_the_end.fault(), FlipFault::kSaturated);
    EXPECT_NEAR(at_the_end.interval().body.w.z(), 0.2, 1e-9);
  }
  EXPECT_GT(turns, 5);
  EXPECT_EQ(at_the_end.gyro().state().norm(), 0.0);
}

TEST_F(TwoPosition, BridgesASampleThatIsNotANumber) {
  run(10.0);
  FlipSample<double> bad = sample;
  bad.main.w.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(modulation.add(bad));
  EXPECT_EQ(modulation.interval().source, IntervalSource::kAuxiliary);
  bad.auxiliary.f.x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(modulation.add(bad));
  EXPECT_EQ(modulation.interval().source, IntervalSource::kHeld);
  bad = sample;
  bad.has_pulse = true;
  bad.pulse_before = std::numeric_limits<double>::quiet_NaN();
  (void)modulation.add(bad);
  run(10.0);
  EXPECT_EQ(modulation.state(), FlipState::kTurning);
  EXPECT_TRUE(std::isfinite(modulation.interval().body.w.norm()));
  EXPECT_TRUE(modulation.gyro().state().allFinite());
}

}  // namespace
}  // namespace trunnion
