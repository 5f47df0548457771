// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <deque>
#include <limits>

#include "trunnion/core/units.hpp"
#include "trunnion/modulation/demodulator.hpp"
#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/modulation/slow_states.hpp"
#include "trunnion/simulation/axis_motion.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/simulation/rotating_platform.hpp"

namespace trunnion {
namespace {

using simulation::AxisCourse;
using simulation::TimeJet;
using Wide = long double;

constexpr double kPeriod = 0.01;  // s

/// A body that feels the same all the time, a platform about its z, and a unit on it with biases.
struct Bench {
  AxisCourse course;
  InertialSample<double> body;
  InertialSample<double> bias;
  double axial_scale = 0.0;

  [[nodiscard]] InertialSample<double> sample(long long i) const {
    const auto felt = [this](Wide) { return InertialSample<Wide>{body.w.cast<Wide>(), body.f.cast<Wide>()}; };
    const auto angle = [this](Wide t) {
      const auto at = static_cast<double>(t);
      return TimeJet<Wide>(static_cast<Wide>(course.angle(at)), static_cast<Wide>(course.rate(at)), 0.0L);
    };
    const simulation::RotatingPlatform platform(felt, angle, Mat3<Wide>::Identity(), Vec3<Wide>::UnitZ(),
                                                Vec3<Wide>::Zero());
    const Wide from = static_cast<Wide>(i) * static_cast<Wide>(kPeriod);
    const auto sum = simulation::integrate<Wide>(platform, from, from + static_cast<Wide>(kPeriod));
    InertialSample<double> mean{sum.angle.cast<double>() / kPeriod + bias.w,
                                sum.velocity.cast<double>() / kPeriod + bias.f};
    mean.w.z() *= 1.0 + axial_scale;
    return mean;
  }
  [[nodiscard]] double angle(long long i) const { return course.angle(static_cast<double>(i) * kPeriod); }
  /// Whether the index, at angle zero, passes within sample i, and the share of the sample before it.
  [[nodiscard]] bool pulse(long long i, double& before) const {
    const double from = angle(i) / (2.0 * kPi);
    const double to = angle(i + 1) / (2.0 * kPi);
    if (std::floor(from) == std::floor(to)) return false;
    const double mark = std::max(std::floor(from), std::floor(to));
    double low = 0.0;
    double high = 1.0;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      const double at = course.angle((static_cast<double>(i) + middle) * kPeriod) / (2.0 * kPi);
      ((at < mark) == (from < mark) ? low : high) = middle;
    }
    before = low;
    return true;
  }
};

Bench bench(double turns_per_second) {
  Bench bench;
  bench.course = AxisCourse(-0.3);
  bench.course.ramp(0.0, 1.0, 2.0 * kPi * turns_per_second);
  bench.body = {{0.02, -0.05, 0.03}, {9.7, -1.2, 0.4}};
  return bench;
}

// The law of an index pulse: the body's motion comes back, the unit's bias does not reach it, whichever way the
// platform turns and however badly the axial gyro counts.
TEST(IndexDemodulator, FindsTheBodyOfEveryTurn) {
  for (const double turns : {0.497, -0.497, 3.987, -3.987}) {
    for (const double scale : {0.0, 0.01, -0.01}) {
      Bench unit = bench(turns);
      unit.bias = {{0.1, -0.2, 0.0}, {0.3, 0.1, 0.02}};
      unit.axial_scale = scale;
      IndexDemodulator<double> demodulator(kPeriod, 0.0, 0.0);
      int seen = 0;
      for (long long i = 200; i < 2000; ++i) {
        double before = 0.0;
        if (!unit.pulse(i, before)) {
          demodulator.add(unit.sample(i));
          continue;
        }
        if (demodulator.add_with_pulse(unit.sample(i), before) != Pulse::kTurn || ++seen < 3) continue;
        const TurnMean<double>& turn = demodulator.turn();
        EXPECT_EQ(turn.turns, 1);
        EXPECT_NEAR(turn.rate, 2.0 * kPi * turns, 1e-9);
        EXPECT_NEAR((turn.body.w - unit.body.w).head<2>().norm(), 0.0, 2e-5) << turns << ' ' << scale;
        EXPECT_NEAR((turn.body.f - unit.body.f).head<2>().norm(), 0.0, 2e-3) << turns << ' ' << scale;
        EXPECT_NEAR(turn.body.w.z(), unit.body.w.z() + scale * (turn.rate + unit.body.w.z()), 1e-6);
      }
      EXPECT_GT(seen, 5);
    }
  }
}

// A pulse that has no business there, at any part of the turn but the quarters next to its ends, is passed over; a
// sample that is not a number breaks the turn off and spoils no later one.
TEST(IndexDemodulator, PassesOverAStrayPulse) {
  Bench unit = bench(0.5);
  for (const int late : {60, 100, 140}) {  // samples of the 200 of a turn
    IndexDemodulator<double> demodulator(kPeriod, 0.0, 0.0);
    long long stray = -1;
    int seen = 0;
    for (long long i = 200; i < 3000; ++i) {
      double before = 0.0;
      const bool pulse = unit.pulse(i, before);
      if (pulse && seen == 3) stray = i + late;
      if (i == 2500) {
        InertialSample<double> bad = unit.sample(i);
        bad.f.y() = std::numeric_limits<double>::quiet_NaN();
        demodulator.add(bad);
      } else if (i == stray) {
        EXPECT_EQ(demodulator.add_with_pulse(unit.sample(i), 0.3), Pulse::kBounce);
      } else if (!pulse) {
        demodulator.add(unit.sample(i));
      } else if (demodulator.add_with_pulse(unit.sample(i), before) == Pulse::kTurn) {
        ++seen;
        EXPECT_NEAR(demodulator.turn().rate, kPi, 1e-9);
        EXPECT_NEAR((demodulator.turn().body.f - unit.body.f).head<2>().norm(), 0.0, 2e-3);
        EXPECT_FALSE(demodulator.turn().unsteady);
      }
    }
    EXPECT_GT(seen, 10);
  }
}

// A platform that swings about its speed by a third within every turn: the axial gyro follows it.
// A number that is none in the very sample of the pulse: the turn before it is lost, and the next is whole.
TEST(IndexDemodulator, LosesOneTurnToAPulseWithoutASample) {
  Bench unit = bench(0.5);
  IndexDemodulator<double> demodulator(kPeriod, 0.0, 0.0);
  int pulses = 0;
  int seen = 0;
  for (long long i = 200; i < 3000; ++i) {
    double before = 0.0;
    if (!unit.pulse(i, before)) {
      demodulator.add(unit.sample(i));
      continue;
    }
    InertialSample<double> sample = unit.sample(i);
    if (++pulses == 5) sample.w.x() = std::numeric_limits<double>::quiet_NaN();
    const Pulse pulse = demodulator.add_with_pulse(sample, before);
    EXPECT_EQ(pulse == Pulse::kTurn, pulses != 1 && pulses != 5 && pulses != 6) << pulses;
    if (pulse != Pulse::kTurn) continue;
    ++seen;
    EXPECT_NEAR((demodulator.turn().body.f - unit.body.f).head<2>().norm(), 0.0, 2e-3);
  }
  EXPECT_GT(seen, 8);
}

TEST(IndexDemodulator, FollowsUnevenSpeed) {
  Bench unit = bench(0.497);
  unit.course.oscillate(1.0, 30.0, 0.33, 0.497, 1.0);
  IndexDemodulator<double> demodulator(kPeriod, 0.0, 0.4);
  int seen = 0;
  for (long long i = 300; i < 2500; ++i) {
    double before = 0.0;
    if (!unit.pulse(i, before)) {
      demodulator.add(unit.sample(i));
      continue;
    }
    if (demodulator.add_with_pulse(unit.sample(i), before) != Pulse::kTurn || ++seen < 3) continue;
    const Vec3<double> turned = turn_about_z(std::sin(0.4), std::cos(0.4), unit.body.f);
    EXPECT_NEAR((demodulator.turn().body.f - turned).head<2>().norm(), 0.0, 2e-3);
  }
  EXPECT_GT(seen, 5);
}

// A wheel too fast for the axial gyro: it reads its range, the pulses tell the turns, and it is said.
TEST(IndexDemodulator, TurnsOnWithASaturatedAxis) {
  Bench unit = bench(6.3);
  const double range = 2000.0 * kRadPerDeg;
  IndexDemodulator<double> demodulator(kPeriod, range, 0.0);
  int seen = 0;
  for (long long i = 0; i < 2000; ++i) {
    InertialSample<double> sample = unit.sample(i);
    sample.w.z() = std::min(sample.w.z(), range);
    double before = 0.0;
    if (!unit.pulse(i, before)) {
      demodulator.add(sample);
      continue;
    }
    if (demodulator.add_with_pulse(sample, before) != Pulse::kTurn || i < 300) continue;
    ++seen;
    EXPECT_TRUE(demodulator.turn().saturated);
    EXPECT_EQ(demodulator.turn().turns, 1);
    EXPECT_NEAR(demodulator.turn().rate, 2.0 * kPi * 6.3, 1e-6);
    EXPECT_NEAR((demodulator.turn().body.f - unit.body.f).head<2>().norm(), 0.0, 0.05);
  }
  EXPECT_GT(seen, 90);
}

// The law of an encoder: every sample gives the body, whatever the speed does.
TEST(Demodulator, FindsTheBodyInEverySample) {
  Bench unit = bench(3.987);
  Demodulator<double, 256> demodulator(0.0);
  double worst = 0.0;
  for (long long i = 200; i < 800; ++i) {
    const Status status = demodulator.add(unit.sample(i), std::remainder(unit.angle(i + 1), 2.0 * kPi), kPeriod);
    if (i == 200) {
      EXPECT_EQ(status, Status::kNotObservable);
      continue;
    }
    ASSERT_EQ(status, Status::kOk);
    worst = std::max(worst, (demodulator.body().f - unit.body.f).norm());
    EXPECT_NEAR((demodulator.body().w - unit.body.w).norm(), 0.0, 1e-9);
  }
  EXPECT_LT(worst, 1e-7);
}

// 5 ms late at 4 turns/s is 7 deg of phase: with the delay given it is gone.
TEST(Demodulator, TakesTheUnitsDelayOut) {
  Bench unit = bench(3.987);
  Demodulator<double, 256> given(0.005);
  Demodulator<double, 256> ignored(0.0);
  for (long long i = 200; i < 400; ++i) {
    // what the unit says at a stamp is what it felt 5 ms before
    Bench then = unit;
    then.course = AxisCourse(unit.angle(i) - 2.0 * kPi * 3.987 * 0.005);
    then.course.ramp(0.0, 1e-9, 2.0 * kPi * 3.987);
    const InertialSample<double> sample = then.sample(0);
    (void)given.add(sample, unit.angle(i + 1), kPeriod);
    (void)ignored.add(sample, unit.angle(i + 1), kPeriod);
    if (i == 200) continue;
    EXPECT_NEAR((given.body().f - unit.body.f).norm(), 0.0, 1e-5);
    EXPECT_NEAR((ignored.body().f - unit.body.f).norm() / unit.body.f.head<2>().norm(), 2.0 * kPi * 3.987 * 0.005,
                1e-3);
  }
}

// The sliding turn against eq. (2) over the window afresh, for noise and a body across the axis, at an uneven speed
// over 200 turns; and in float.
template <class T>
double worst_of_sliding_turn() {
  simulation::Gaussian noise(11, 1);
  Demodulator<T, 512> demodulator(T(0));
  struct Entry {
    std::complex<double> m, phasor;
    double step;
  };
  std::deque<Entry> window;
  double angle = 0.0;
  double worst = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double step = 0.05 * (1.0 + 0.5 * std::sin(0.003 * i));
    angle += step;
    const std::complex<double> m(9.8 + noise(), noise());
    InertialSample<T> sample;
    sample.f.x() = static_cast<T>(m.real());
    sample.f.y() = static_cast<T>(m.imag());
    (void)demodulator.add(sample, static_cast<T>(std::remainder(angle, 2.0 * kPi)), static_cast<T>(kPeriod));
    if (i == 0) continue;
    window.push_back({m, std::polar(sinc_correction(step), angle - 0.5 * step), step});
    double size = 0.0;
    for (const Entry& s : window) size += s.step;
    while (size - window.front().step >= 2.0 * kPi) {
      size -= window.front().step;
      window.pop_front();
    }
    const auto turn = demodulator.whole_turn();
    EXPECT_EQ(turn.ok(), size >= 2.0 * kPi);
    if (!turn.ok()) continue;
    const double out = (size - 2.0 * kPi) / window.front().step;
    std::complex<double> A;
    std::complex<double> B;
    std::complex<double> E;
    double time = -out;
    for (const Entry& s : window) {
      const double share = &s == &window.front() ? 1.0 - out : 1.0;
      A += share * s.m;
      B += share * s.m * s.phasor;
      E += share * s.phasor;
      time += 1.0;
    }
    const std::complex<double> b = (A - std::conj(E / time) * B) / time / (1.0 - std::norm(E / time));
    const std::complex<double> found(static_cast<double>(turn.value().f.x()), static_cast<double>(turn.value().f.y()));
    worst = std::max(worst, std::abs(found - b));
  }
  return worst;
}

TEST(Demodulator, SlidesAWholeTurnAlong) {
  EXPECT_LT(worst_of_sliding_turn<double>(), 1e-10);
  EXPECT_LT(worst_of_sliding_turn<float>(), 2e-3);  // angles of float: 5e-7 of 2 pi shift its edge
}

// Gravity across the axis and a speed that swings by a third within the turn: the bias is the unit's all the same.
TEST(Demodulator, TellsBiasFromGravityAtAnUnevenSpeed) {
  Bench unit = bench(0.497);
  unit.course.oscillate(1.0, 30.0, 0.33, 0.497, 1.0);
  unit.bias = {Vec3<double>(0.01, -0.02, 0.0), Vec3<double>(0.1, 0.05, 0.02)};
  Demodulator<double, 512> demodulator(0.0);
  for (long long i = 300; i < 2500; ++i) {
    (void)demodulator.add(unit.sample(i), unit.angle(i + 1), kPeriod);
    const auto turn = demodulator.whole_turn();
    if (!turn.ok()) continue;
    EXPECT_NEAR((turn.value().f - unit.bias.f).head<2>().norm(), 0.0, 5e-3);
    EXPECT_NEAR((turn.value().w - unit.bias.w).head<2>().norm(), 0.0, 5e-5);
  }
  EXPECT_TRUE(demodulator.whole_turn().ok());
}

TEST(Demodulator, RefusesWhatItCannotUse) {
  Demodulator<double, 4> demodulator(0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  InertialSample<double> sample;
  EXPECT_EQ(demodulator.add(sample, 0.0, kPeriod), Status::kNotObservable);
  EXPECT_EQ(demodulator.add(sample, 0.1, kPeriod), Status::kOk);
  EXPECT_EQ(demodulator.add(sample, nan, kPeriod), Status::kOutOfRange);
  EXPECT_EQ(demodulator.add(sample, 0.2, kPeriod), Status::kNotObservable);
  EXPECT_EQ(demodulator.add(sample, 0.3, 0.0), Status::kOutOfRange);
  sample.w.x() = nan;
  EXPECT_EQ(demodulator.add(sample, 0.3, kPeriod), Status::kOutOfRange);
  sample.w.x() = 0.0;
  for (int i = 0; i < 100; ++i) (void)demodulator.add(sample, 0.1 * i, kPeriod);
  EXPECT_EQ(demodulator.whole_turn().status(), Status::kNotObservable);  // a turn is longer than the ring
}

// The wheel of docs/theory/modulation.md, table 3: 120 s, 1.1 deg/s of bias, 1.28 deg of tilt, speed by 60 % up and
// down within seconds, with and without turns of 20 deg/s. As states the two cost the heading next to nothing; a mean
// over whole turns keeps the tilt's half turns.
TEST(SlowStates, BeatAveragingWhenTheSpeedChanges) {
  constexpr double kStep = 0.005;
  constexpr double kMean = 33.0;  // rad/s
  const std::complex<double> bias = std::polar(1.1 * kRadPerDeg, 0.7);
  const std::complex<double> tilt = std::polar(1.28 * kRadPerDeg, -1.1);
  const std::complex<double> scale(0.004, -0.002);
  for (const double turning : {0.0, 20.0 * kRadPerDeg}) {
    SlowStates<double> states({1e-4, 0.3, 1e-6, 1.0, 0.1, 0.05, 0.01});
    simulation::Gaussian noise(3, 4);
    double phi = 0.0;
    double heading = 0.0;
    double truth = 0.0;
    double plain = 0.0;
    double end = 0.0;
    double peak = 0.0;
    double plain_peak = 0.0;
    for (int i = 0; i < static_cast<int>(120.0 / kStep); ++i) {
      const double t = kStep * i;
      const double w = kMean * (1.0 + 0.6 * std::sin(2.0 * kPi * t / 7.0));
      const double u = turning * std::sin(2.0 * kPi * t / 20.0);
      const std::complex<double> v = std::polar(u, -(phi + 0.5 * w * kStep));
      const std::complex<double> m =
          v + scale * std::conj(v) + bias + tilt * w + 1e-4 * std::complex<double>(noise(), noise());
      const double c = std::cos(phi + 0.5 * w * kStep);
      const double s = std::sin(phi + 0.5 * w * kStep);
      const SlowStates<double>::Plane plane(m.real(), m.imag());
      states.add(plane, s, c, w, kStep);
      phi += w * kStep;
      truth += u * kStep;
      heading += states.correct(plane, s, c, w).x() * kStep;
      plain += (c * m.real() - s * m.imag()) * kStep;
      if (t < 20.0) {  // the filter's start is not what is compared
        heading = plain = truth;
        continue;
      }
      end = std::abs(heading - truth);
      peak = std::max(peak, end);
      plain_peak = std::max(plain_peak, std::abs(plain - truth));
    }
    std::printf(
        "[ FIGURE   ] wheel, turns of %.0f deg/s: heading end %.4f peak %.4f deg, demodulated alone peak %.2f deg\n",
        turning / kRadPerDeg, end / kRadPerDeg, peak / kRadPerDeg, plain_peak / kRadPerDeg);
    EXPECT_LT(peak, 0.011 * kRadPerDeg);
    EXPECT_GT(plain_peak, 1.0 * kRadPerDeg);
    EXPECT_NEAR(states.state()(SlowStates<double>::kBias), bias.real(), 1e-3);
    EXPECT_NEAR(states.state()(SlowStates<double>::kDelta + 1), tilt.imag(), 1e-4);
  }
}

}  // namespace
}  // namespace trunnion
