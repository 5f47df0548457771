// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/strapdown/navigator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"

namespace trunnion {
namespace {

using simulation::PathTruth;
using simulation::Pose;
using Wide = long double;
using State = NavigationState<Wide>;

constexpr Wide kWidePi = 3.14159265358979323846264338327950288L;

struct Error {
  double horizontal = 0.0;  // m
  double up = 0.0;          // m
};

Error difference(const State& a, const State& b) {
  const Wide radius = static_cast<Wide>(kEarthRadius) + b.height;
  const auto north = static_cast<double>(radius * (a.latitude - b.latitude));
  const auto east =
      static_cast<double>(radius * std::cos(b.latitude) * std::remainder(a.longitude - b.longitude, 2.0L * kWidePi));
  return {std::hypot(north, east), static_cast<double>(std::abs(a.height - b.height))};
}

template <class T>
Increment<T> cast(const Increment<Wide>& increment) {
  return {increment.angle.cast<T>(), increment.velocity.cast<T>()};
}

/// Navigates the increments that sample(i) makes from the truth at zero. @return the largest error over the run
template <class Algorithm, class Sample, class Truth>
Error navigate(double rate_hz, double seconds, const Sample& sample, const Truth& truth) {
  using T = typename Algorithm::Scalar;
  const Wide period = 1.0L / static_cast<Wide>(rate_hz);
  Navigator<Algorithm> navigator(truth(0.0L), static_cast<T>(period));
  Error largest;
  const auto samples = static_cast<long long>(seconds * rate_hz);
  for (long long i = 0; i < samples; ++i) {
    if (navigator.add(cast<T>(sample(i))) != Status::kOk) return {1e9, 1e9};
    if (!navigator.updated() || (i + 1) % (1000 * Algorithm::kSamples) != 0) continue;
    const Error now = difference(navigator.template state<Wide>(), truth(period * static_cast<Wide>(i + 1)));
    largest.horizontal = std::max(largest.horizontal, now.horizontal);
    largest.up = std::max(largest.up, now.up);
  }
  return largest;
}

template <class S>
S wave(double amplitude, double period, double phase, const S& t) {
  return S(static_cast<Wide>(amplitude)) *
         sin(S(2.0L * kWidePi / static_cast<Wide>(period)) * t + S(static_cast<Wide>(phase)));
}

/// docs/theory/strapdown.md, table 2.
struct RockingFlight {
  template <class S>
  Pose<S> operator()(const S& t) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    return {of(45.0 * kRadPerDeg) + wave(6.28e-4, 180.0, 0.0, t),
            of(9.0 * kRadPerDeg) + wave(1.33e-3, 250.0, 0.0, t),
            of(1000.0) + wave(100.0, 120.0, 0.0, t),
            wave(10.0 * kRadPerDeg, 2.0, 0.0, t) + wave(0.5 * kRadPerDeg, 0.2, 0.0, t),
            wave(5.0 * kRadPerDeg, 3.3, 0.0, t) + wave(0.5 * kRadPerDeg, 0.2, 0.25 * kPi, t),
            wave(60.0 * kRadPerDeg, 40.0, 0.0, t)};
  }
};

/// Increments of a path, made once and navigated by several algorithms.
template <class Path>
class Recording {
 public:
  Recording(Path path, double rate_hz, double seconds) : truth_(path), rate_hz_(rate_hz), seconds_(seconds) {
    const auto samples = static_cast<long long>(seconds * rate_hz);
    for (long long i = 0; i < samples; ++i)
      increments_.push_back(truth_.increment(static_cast<Wide>(i) / static_cast<Wide>(rate_hz),
                                             static_cast<Wide>(i + 1) / static_cast<Wide>(rate_hz)));
  }

  template <class Algorithm>
  [[nodiscard]] Error navigate_with() const {
    return navigate<Algorithm>(
        rate_hz_, seconds_, [&](long long i) { return increments_[static_cast<std::size_t>(i)]; },
        [&](Wide t) { return truth_.state(t); });
  }

 private:
  PathTruth<Path> truth_;
  double rate_hz_;
  double seconds_;
  std::vector<Increment<Wide>> increments_;
};

void print(const char* what, const Error& error) {
  std::printf("[ FIGURE   ] %s: %.4g m horizontal, %.4g m vertical\n", what, error.horizontal, error.up);
}

/// One sample and the one before, with half of theta x v for the whole rotation term: what is usual.
class HalfRotationTerm {
 public:
  using Scalar = double;
  static constexpr int kSamples = 1;

  BodyMotion<double> operator()(const std::array<Increment<double>, 1>& sample) {
    BodyMotion<double> motion = whole_(sample);
    const Increment<double>& s = sample[0];
    motion.velocity = s.velocity + 0.5 * s.angle.cross(s.velocity) +
                      (before_.angle.cross(s.velocity) + before_.velocity.cross(s.angle)) / 12.0;
    before_ = s;
    return motion;
  }

 private:
  PreviousSample<double> whole_;
  Increment<double> before_;
};

TEST(Navigator, FliesTheRockingFlightForAnHour) {
  const Recording<RockingFlight> slow(RockingFlight{}, 100.0, 3600.0);
  const Error six = slow.navigate_with<ExactSamples<double, 6>>();
  const Error eight = slow.navigate_with<ExactSamples<double, 8>>();
  const Error one = slow.navigate_with<PreviousSample<double>>();
  const Error in_float = slow.navigate_with<ExactSamples<float, 6>>();
  print("rocking flight, 1 h, 100 Hz, exact 6", six);
  print("rocking flight, 1 h, 100 Hz, exact 8", eight);
  print("rocking flight, 1 h, 100 Hz, 1 and previous", one);
  print("rocking flight, 1 h, 100 Hz, exact 6 in float", in_float);
  const Error half = slow.navigate_with<HalfRotationTerm>();
  print("rocking flight, 1 h, 100 Hz, 1 and previous with half the rotation term", half);
  EXPECT_LT(six.horizontal, 2.1);
  EXPECT_LT(six.up, 0.2);
  EXPECT_LT(eight.horizontal, 0.2);
  EXPECT_LT(one.up, 40.0);
  EXPECT_GT(half.up, 1000.0);  // so the flight is one that shows it
  EXPECT_LT(in_float.up, 100.0);
}

TEST(Navigator, FliesTheRockingFlightAtTwiceTheRate) {
  const Error six = Recording<RockingFlight>(RockingFlight{}, 200.0, 3600.0).navigate_with<ExactSamples<double, 6>>();
  print("rocking flight, 1 h, 200 Hz, exact 6", six);
  EXPECT_LT(six.horizontal, 0.02);
  EXPECT_LT(six.up, 0.1);
}

/// On a bench, a cone of 1 deg at 10 Hz about the northern x axis: pitch and yaw in quadrature.
struct Coning {
  template <class S>
  Pose<S> operator()(const S& t) const {
    const S zero(0.0L);
    return {S(static_cast<Wide>(45.0 * kRadPerDeg)),  zero, zero, zero, wave(1.0 * kRadPerDeg, 0.1, 0.0, t),
            wave(1.0 * kRadPerDeg, 0.1, 0.5 * kPi, t)};
  }
};

TEST(Navigator, StandsAConeForAnHour) {
  const Error six = Recording<Coning>(Coning{}, 400.0, 3600.0).navigate_with<ExactSamples<double, 6>>();
  print("cone of 1 deg at 10 Hz about north, 1 h, 400 Hz, exact 6", six);
  EXPECT_LT(six.horizontal, 1.7);
}

struct AtRest {
  template <class S>
  Pose<S> operator()(const S&) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    return {of(0.8), of(-2.0), of(300.0), of(10.0 * kRadPerDeg), of(20.0 * kRadPerDeg), of(30.0 * kRadPerDeg)};
  }
};

template <class Algorithm>
Error rest_for_an_hour() {
  const PathTruth<AtRest> truth(AtRest{});
  const Increment<Wide> increment = truth.increment(0.0L, 0.0025L);
  return navigate<Algorithm>(
      400.0, 3600.0, [&](long long) { return increment; }, [&](Wide) { return truth.state(0.0L); });
}

TEST(Navigator, RestsForAnHour) {
  const Error in_double = rest_for_an_hour<PreviousSample<double>>();
  const Error six = rest_for_an_hour<ExactSamples<double, 6>>();
  const Error in_float = rest_for_an_hour<PreviousSample<float>>();
  print("at rest, 1 h, 400 Hz, 1 and previous", in_double);
  print("at rest, 1 h, 400 Hz, exact 6", six);
  print("at rest, 1 h, 400 Hz, 1 and previous in float", in_float);
  EXPECT_LT(in_double.horizontal, 1e-3);
  EXPECT_LT(in_double.up, 1e-3);
  EXPECT_LT(six.horizontal, 1e-3);
  EXPECT_LT(in_float.horizontal, 3.0);
  EXPECT_LT(in_float.up, 72.0);
}

struct AlongAParallel {
  template <class S>
  Pose<S> operator()(const S& t) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    // 250 m/s east at 45 deg, across the date line after 20 minutes
    return {of(45.0 * kRadPerDeg), of(176.0 * kRadPerDeg) + of(250.0 / 4.5178e6) * t, of(3000.0), of(0.0), of(0.0),
            of(90.0 * kRadPerDeg)};
  }
};

TEST(Navigator, FliesAlongAParallelAndOverTheDateLine) {
  const Recording<AlongAParallel> recording(AlongAParallel{}, 100.0, 3600.0);
  const Error one = recording.navigate_with<PreviousSample<double>>();
  const Error six = recording.navigate_with<ExactSamples<double, 6>>();
  print("250 m/s along a parallel, 1 h, 100 Hz, 1 and previous", one);
  print("250 m/s along a parallel, 1 h, 100 Hz, exact 6", six);
  EXPECT_LT(one.horizontal, 5e-3);
  EXPECT_LT(six.horizontal, 5e-3);
}

// Over the pole, along a meridian and down the other: the path's latitude passes 90 deg and comes out on the opposite
// meridian, heading south.
struct OverThePole {
  template <class S>
  Pose<S> operator()(const S& t) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    return {of(89.5 * kRadPerDeg) + of(250.0 / 6.4e6) * t, of(0.3), of(5000.0), of(0.05), of(0.02), of(0.0)};
  }
};

TEST(Navigator, FliesOverThePole) {
  const PathTruth<OverThePole> truth(OverThePole{});
  using Algorithm = ExactSamples<double, 4>;
  Navigator<Algorithm> navigator(truth.state(0.0L), 0.01);
  for (int i = 0; i < 60000; ++i)
    ASSERT_EQ(navigator.add(cast<double>(truth.increment(0.01L * i, 0.01L * (i + 1)))), Status::kOk);
  const State found = navigator.state<Wide>();
  const State past = truth.state(600.0L);  // latitude beyond pi/2
  EXPECT_GT(past.latitude, kWidePi / 2.0L);
  const Wide radius = static_cast<Wide>(kEarthRadius);
  EXPECT_LT(std::abs(found.latitude - (kWidePi - past.latitude)) * radius, 0.02L);
  EXPECT_LT(std::abs(std::remainder(found.longitude - (past.longitude + kWidePi), 2.0L * kWidePi)) *
                std::cos(found.latitude) * radius,
            0.02L);
  EXPECT_LT(std::abs(found.height - past.height), 0.02L);
  EXPECT_NEAR(static_cast<double>(found.velocity.x()), static_cast<double>(-past.velocity.x()), 1e-4);
}

// A level error swings with the Schuler period: 84.4 minutes. Titterton & Weston, 2nd ed., sec. 12.3.
TEST(Navigator, SwingsWithTheSchulerPeriod) {
  const PathTruth<AtRest> truth(AtRest{});
  const Increment<double> increment = cast<double>(truth.increment(0.0L, 0.1L));
  State start = truth.state(0.0L);
  start.velocity.x() = 0.1L;
  Navigator<PreviousSample<double>> navigator(start, 0.1);
  double before = 0.1;
  double first = 0.0;
  double second = 0.0;
  for (int i = 1; i <= 90000 && second == 0.0; ++i) {
    ASSERT_EQ(navigator.add(increment), Status::kOk);
    const double now = navigator.state().velocity.x();
    if (before > 0.0 && now <= 0.0) (first == 0.0 ? first : second) = 0.1 * (i - now / (now - before));
    before = now;
  }
  std::printf("[ FIGURE   ] Schuler period: %.2f min\n", (second - first) / 60.0);
  EXPECT_NEAR((second - first) / 60.0, 84.4, 0.5);
}

TEST(Navigator, RefusesWhatIsNotFiniteAndGoesOn) {
  const PathTruth<AtRest> truth(AtRest{});
  const Increment<double> increment = cast<double>(truth.increment(0.0L, 0.01L));
  Navigator<ExactSamples<double, 4>> plain(truth.state(0.0L), 0.01);
  Navigator<ExactSamples<double, 4>> troubled(truth.state(0.0L), 0.01);
  for (int i = 0; i < 400; ++i) {
    if (i % 7 == 3) {
      Increment<double> bad = increment;
      (i % 2 == 0 ? bad.angle : bad.velocity)(i % 3) =
          i % 4 == 0 ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
      EXPECT_EQ(troubled.add(bad), Status::kOutOfRange);
      bad = increment;
      bad.angle(i % 3) = 100.0;
      EXPECT_EQ(troubled.add(bad), Status::kOutOfRange);
    }
    EXPECT_EQ(plain.add(increment), Status::kOk);
    EXPECT_EQ(troubled.add(increment), Status::kOk);
    EXPECT_EQ(plain.updated(), i % 4 == 3);
  }
  EXPECT_EQ(plain.state().latitude, troubled.state().latitude);
  EXPECT_EQ(plain.state().velocity, troubled.state().velocity);
}

// A minute at rest: float rounds every increment to 6e-8 of g, half a t^2 of which is a millimetre.
TEST(Navigator, InFloatStaysWhereDoubleStays) {
  const PathTruth<AtRest> truth(AtRest{});
  const Increment<double> increment = cast<double>(truth.increment(0.0L, 0.01L));
  const Increment<float> rounded = cast<float>(truth.increment(0.0L, 0.01L));
  Navigator<PreviousSample<double>> wide(truth.state(0.0L), 0.01);
  Navigator<PreviousSample<float>> narrow(truth.state(0.0L), 0.01F);
  for (int i = 0; i < 6000; ++i) {
    ASSERT_EQ(wide.add(increment), Status::kOk);
    ASSERT_EQ(narrow.add(rounded), Status::kOk);
  }
  const Error off = difference(narrow.state<Wide>(), wide.state<Wide>());
  EXPECT_LT(off.horizontal, 0.005);
  EXPECT_LT(off.up, 0.005);
}

// What goes in at the border comes out, at every latitude, in the digits of the wider scalar.
TEST(Navigator, KeepsTheStateItWasGiven) {
  for (const Wide latitude : {-1.5L, -0.7L, 0.0L, 0.9L, 1.57L}) {
    State start;
    start.latitude = latitude;
    start.longitude = 3.1L;
    start.height = 1234.5678L;
    start.velocity = Vec3<Wide>(12.3L, -45.6L, 0.789L);
    start.attitude = quaternion_exp<Wide>(Vec3<Wide>(0.3L, -1.2L, 2.0L));
    const Navigator<PreviousSample<float>> navigator(start, 0.01F);
    const State found = navigator.state<Wide>();
    EXPECT_LT(difference(found, start).horizontal, 1e-6) << static_cast<double>(latitude);
    EXPECT_LT(difference(found, start).up, 1e-6);
    EXPECT_LT(static_cast<double>((found.velocity - start.velocity).norm()), 1e-10);
    EXPECT_LT(found.attitude.angularDistance(start.attitude), 1e-9L);
  }
}

}  // namespace
}  // namespace trunnion
