// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/strapdown/two_speed_navigator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "strapdown/small_aircraft.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/strapdown/attitude.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion {
namespace {

using simulation::PathTruth;
using simulation::Pose;
using simulation::TimeJet;
using Wide = long double;
using Jet = PathJet;

template <class T>
Increment<T> cast(const Increment<Wide>& increment) {
  return {increment.angle.cast<T>(), increment.velocity.cast<T>()};
}

struct Difference {
  double horizontal;  // m
  double up;          // m
  double attitude;    // rad
};

template <class A, class B>
Difference difference(const NavigationState<A>& a, const NavigationState<B>& b) {
  const Wide radius = static_cast<Wide>(kEarthRadius) + static_cast<Wide>(b.height);
  const auto north = static_cast<double>(radius * (static_cast<Wide>(a.latitude) - static_cast<Wide>(b.latitude)));
  const Wide longitude = static_cast<Wide>(a.longitude) - static_cast<Wide>(b.longitude);
  const auto east = static_cast<double>(radius * std::cos(static_cast<Wide>(b.latitude)) *
                                        std::remainder(longitude, 2.0L * 3.14159265358979323846L));
  return {std::hypot(north, east),
          std::abs(static_cast<double>(static_cast<Wide>(a.height) - static_cast<Wide>(b.height))),
          static_cast<double>(a.attitude.template cast<Wide>().angularDistance(b.attitude.template cast<Wide>()))};
}

/// 250 m/s east at 45 deg, over the date line after ten minutes.
struct AlongAParallel {
  Pose<Jet> operator()(const Jet& t) const {
    return {of(45.0 * kRadPerDeg), of(178.0 * kRadPerDeg) + of(250.0 / 4.5178e6) * t, of(3000.0), of(0.0), of(0.0),
            of(90.0 * kRadPerDeg)};
  }
};

struct OverThePole {
  Pose<Jet> operator()(const Jet& t) const {
    return {of(89.8 * kRadPerDeg) + of(250.0 / 6.4e6) * t, of(0.3), of(5000.0), of(0.05), of(0.02), of(0.0)};
  }
};

/// @return the difference from the truth after @p seconds
template <class T, class Path>
Difference navigate(const Path& path, double rate_hz, double seconds, int updates) {
  const PathTruth<Path> truth(path);
  const Wide period = 1.0L / static_cast<Wide>(rate_hz);
  TwoSpeedNavigator<T> navigator(truth.state(0.0L), static_cast<T>(period), updates);
  const auto samples = static_cast<int>(seconds * rate_hz);
  for (int i = 0; i < samples; ++i)
    EXPECT_EQ(navigator.add(cast<T>(truth.increment(period * static_cast<Wide>(i), period * static_cast<Wide>(i + 1)))),
              Status::kOk);
  return difference(navigator.template state<Wide>(), truth.state(static_cast<Wide>(seconds)));
}

// Perfect samples along paths whose truth shares no equation with it. What is left at rest and along a parallel is of
// third order in the slow step; on the flight it is the two-sample algorithm's coning, as with Navigator.
TEST(TwoSpeedNavigator, FollowsPathsWhoseTruthIsKnown) {
  const Difference rest = navigate<double>(OnABench{}, 200.0, 600.0, 10);
  EXPECT_LT(rest.horizontal, 1e-4);
  EXPECT_LT(rest.up, 1e-3);
  const Difference parallel = navigate<double>(AlongAParallel{}, 200.0, 900.0, 10);
  std::printf("[ FIGURE   ] two-speed navigator, 250 m/s along a parallel, 15 min: %.3g m, %.3g m\n",
              parallel.horizontal, parallel.up);
  EXPECT_LT(parallel.horizontal, 0.005);
  EXPECT_LT(parallel.up, 0.001);
  EXPECT_LT(parallel.attitude, 1e-9);
}
TEST(TwoSpeedNavigator, FliesAsNavigatorDoes) {
  const PathTruth<SmallAircraft> truth(SmallAircraft{});
  constexpr int kSamples = 300 * 200;
  TwoSpeedNavigator<double> fast(truth.state(0.0L), 0.005, 10);
  Navigator<MultiSample<double, 2>> fine(truth.state(0.0L), 0.005);
  for (int i = 0; i < kSamples; ++i) {
    const Increment<double> increment = cast<double>(truth.increment(0.005L * i, 0.005L * (i + 1)));
    ASSERT_EQ(fast.add(increment), Status::kOk);
    ASSERT_EQ(fine.add(increment), Status::kOk);
  }
  const Difference from_truth = difference(fast.state<Wide>(), truth.state(300.0L));
  const Difference apart = difference(fast.state<Wide>(), fine.state<Wide>());
  std::printf(
      "[ FIGURE   ] two-speed navigator, flight of 300 s at 200 Hz: %.3g m from the truth, %.3g m from Navigator\n",
      std::hypot(from_truth.horizontal, from_truth.up), std::hypot(apart.horizontal, apart.up));
  EXPECT_LT(apart.horizontal, 1e-3);
  EXPECT_LT(apart.up, 1e-3);
  EXPECT_LT(apart.attitude, 1e-7);
}
TEST(TwoSpeedNavigator, FliesOverThePole) {
  const PathTruth<OverThePole> truth(OverThePole{});
  TwoSpeedNavigator<double> navigator(truth.state(0.0L), 0.01, 5);
  for (int i = 0; i < 20000; ++i)
    ASSERT_EQ(navigator.add(cast<double>(truth.increment(0.01L * i, 0.01L * (i + 1)))), Status::kOk);
  const auto found = navigator.state<Wide>();
  const auto past = truth.state(200.0L);
  ASSERT_GT(past.latitude, 0.5L * 3.14159265358979323846L);
  EXPECT_LT(std::abs(found.latitude - (3.14159265358979323846L - past.latitude)) * 6.4e6L, 0.02L);
  EXPECT_NEAR(static_cast<double>(found.velocity.x()), static_cast<double>(-past.velocity.x()), 1e-4);
}

// Between two slow steps the state is what it would be if one ended there.
TEST(TwoSpeedNavigator, HasAStateAtEveryUpdate) {
  const PathTruth<SmallAircraft> truth(SmallAircraft{});
  TwoSpeedNavigator<double> slow(truth.state(0.0L), 0.005, 20);
  TwoSpeedNavigator<double> every(truth.state(0.0L), 0.005, 1);
  for (int i = 0; i < 2 * 97; ++i) {
    const Increment<double> increment = cast<double>(truth.increment(0.005L * i, 0.005L * (i + 1)));
    ASSERT_EQ(slow.add(increment), Status::kOk);
    ASSERT_EQ(every.add(increment), Status::kOk);
    EXPECT_EQ(slow.updated(), i % 2 == 1);
    if (!slow.updated()) continue;
    const Difference apart = difference(slow.state<Wide>(), every.state<Wide>());
    ASSERT_LT(apart.horizontal, 1e-5) << i;
    ASSERT_LT(apart.up, 1e-5) << i;
    ASSERT_LT(apart.attitude, 1e-9) << i;
    ASSERT_LT((slow.velocity() - every.velocity()).norm(), 5e-3)
        << i;  // 1.5e-4 rad/s of 80 m/s and of the fall, for 0.2 s
  }
}

TEST(TwoSpeedNavigator, GoesOnFromAWanderState) {
  const PathTruth<SmallAircraft> truth(SmallAircraft{});
  TwoSpeedNavigator<double> first(truth.state(0.0L), 0.005, 10);
  const auto increment = [&](int i) { return cast<double>(truth.increment(0.005L * i, 0.005L * (i + 1))); };
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(first.add(increment(i)), Status::kOk);
  TwoSpeedNavigator<double> second(first.wander_state(), 0.005, 10);  // right after a slow step
  for (int i = 2000; i < 4000; ++i) {
    ASSERT_EQ(first.add(increment(i)), Status::kOk);
    ASSERT_EQ(second.add(increment(i)), Status::kOk);
  }
  const Difference apart = difference(first.state<Wide>(), second.state<Wide>());
  EXPECT_LT(apart.horizontal, 1e-6);
  EXPECT_LT(apart.up, 1e-6);
}

TEST(TwoSpeedNavigator, RefusesWhatIsNotFiniteAndGoesOn) {
  const PathTruth<OnABench> truth(OnABench{});
  const Increment<float> good = cast<float>(truth.increment(0.0L, 0.005L));
  TwoSpeedNavigator<float> plain(truth.state(0.0L), 0.005F, 10);
  TwoSpeedNavigator<float> troubled(truth.state(0.0L), 0.005F, 10);
  const float bad_values[] = {std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity(),
                              3e38F,
                              1e10F,
                              1e3F};
  for (int i = 0; i < 500; ++i) {
    for (int k = 0; k < 12 && i % 50 == 7; ++k) {
      for (const float bad : bad_values) {
        Increment<float> first = good;
        Increment<float> second = good;
        Increment<float>& hit = k < 6 ? first : second;
        (k % 6 < 3 ? hit.angle : hit.velocity)(k % 3) = bad;
        EXPECT_EQ(troubled.add(first, second), Status::kOutOfRange) << k << " " << bad;
      }
    }
    EXPECT_EQ(plain.add(good, good), Status::kOk);
    EXPECT_EQ(troubled.add(good, good), Status::kOk);
  }
  EXPECT_EQ(plain.state().latitude, troubled.state().latitude);
  EXPECT_EQ(plain.state().velocity, troubled.state().velocity);
}
// A state that is none says so ten times a second, however good the samples are.
TEST(TwoSpeedNavigator, SaysThatItsStateIsNone) {
  NavigationState<float> start;
  start.latitude = std::numeric_limits<float>::quiet_NaN();
  TwoSpeedNavigator<float> lost(start, 0.005F, 10);
  TwoSpeedNavigator<float> fast(WanderState<float>{}, 0.005F, 10);
  const Increment<float> push{Vec3<float>::Zero(), Vec3<float>(40.0F, 0.0F, 0.0F)};
  int lost_said = 0;
  int fast_said = 0;
  for (int i = 0; i < 4000; ++i) {
    lost_said += lost.add(Increment<float>{}, Increment<float>{}) == Status::kOutOfRange ? 1 : 0;
    fast_said += fast.add(push, push) == Status::kOutOfRange ? 1 : 0;
  }
  EXPECT_EQ(lost_said, 400);
  EXPECT_GT(fast_said, 200);
}
TEST(TwoSpeedNavigator, TakesNoSlowStepBeyondASecond) {
  const PathTruth<SmallAircraft> truth(SmallAircraft{});
  TwoSpeedNavigator<double> slow(truth.state(0.0L), 0.01, 100000);
  TwoSpeedNavigator<double> plain(truth.state(0.0L), 0.01, 50);
  for (int i = 0; i < 3000; ++i) {
    const Increment<double> increment = cast<double>(truth.increment(0.01L * i, 0.01L * (i + 1)));
    ASSERT_EQ(slow.add(increment), Status::kOk);
    ASSERT_EQ(plain.add(increment), Status::kOk);
  }
  EXPECT_EQ(slow.state().velocity, plain.state().velocity);
}
TEST(TwoSpeedNavigator, RefusesEverySampleWithoutATimeStep) {
  for (const float period :
       {0.0F, -0.01F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    TwoSpeedNavigator<float> navigator(NavigationState<float>{}, period, 10);
    EXPECT_EQ(navigator.add(Increment<float>{}, Increment<float>{}), Status::kOutOfRange) << period;
    Navigator<PreviousSample<float>> other(NavigationState<float>{}, period);
    EXPECT_EQ(other.add(Increment<float>{}), Status::kOutOfRange) << period;
  }
}

// A cone of 1 deg at 10 Hz for a minute: the drift that two samples leave, a^2 W (W h)^4 / 60, and no other.
TEST(Attitude, KeepsTheConeToItsClosedForm) {
  const double a = kRadPerDeg;
  const double w = 2.0 * kPi * 10.0;
  const double h = 1.0 / 400.0;
  const auto angle = [&](int i) {
    const double m = w * h * (i + 0.5);
    const double across = 2.0 * std::sin(a) * std::sin(0.5 * w * h);
    const double half = std::sin(0.5 * a);
    return Vec3<double>(-2.0 * w * half * half * h, -across * std::sin(m), across * std::cos(m));
  };
  Attitude<double> attitude(Quaternion<double>(std::cos(0.5 * a), 0.0, std::sin(0.5 * a), 0.0));
  constexpr int kSamples = 60 * 400;
  for (int i = 0; i < kSamples; i += 2) ASSERT_EQ(attitude.add(angle(i), angle(i + 1)), Status::kOk);
  const Vec3<double> off =
      quaternion_log(attitude.q() * Quaternion<double>(std::cos(0.5 * a), 0.0, -std::sin(0.5 * a), 0.0));
  const double drift = off.x() / 60.0;
  const double closed = a * a * w * std::pow(w * h, 4) / 60.0;
  EXPECT_NEAR(std::abs(drift), closed, 0.05 * closed);
  EXPECT_NEAR(attitude.q().norm(), 1.0, 1e-14);
}
TEST(Attitude, KeepsItsLengthInFloatAndRefuses) {
  Attitude<float> attitude(Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F));
  for (int i = 0; i < 1000000; ++i)
    ASSERT_EQ(attitude.add(Vec3<float>(0.1F, -0.2F, 0.05F), Vec3<float>(0.12F, -0.1F, 0.03F)), Status::kOk);
  EXPECT_NEAR(attitude.q().norm(), 1.0F, 3e-7F);
  const Quaternion<float> before = attitude.q();
  const Vec3<float> zero = Vec3<float>::Zero();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1.0F}) {
    EXPECT_EQ(attitude.add(Vec3<float>(0.0F, bad, 0.0F), zero), Status::kOutOfRange);
    EXPECT_EQ(attitude.add(zero, Vec3<float>(bad, 0.0F, 0.0F)), Status::kOutOfRange);
  }
  EXPECT_EQ(attitude.q().coeffs(), before.coeffs());
  Attitude<float> stretched(Quaternion<float>(1.0F, 1.0F, 1.0F, 0.0F));
  EXPECT_EQ(stretched.add(zero, zero), Status::kOk);
  EXPECT_NEAR(stretched.q().norm(), 1.0F, 3e-7F);
}

}  // namespace
}  // namespace trunnion
