// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "strapdown/small_aircraft.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/strapdown/two_speed_navigator.hpp"

namespace trunnion {
namespace {

using simulation::Gaussian;
using simulation::PathTruth;
using simulation::Pose;
using Wide = long double;
using Jet = PathJet;

constexpr double kRate = 200.0;
constexpr int kSamples = 3600 * 200;
constexpr int kEvery = 200 * 60;  // the error is looked at once a minute

/// Noise of apps/share/3dm-cv7.yaml: 5 deg/h/rtHz and 1.5 deg/h over 200 s; 25 ug/rtHz and 20 ug over 200 s.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : dice_(seed, 1) {}
  Increment<double> operator()() {
    constexpr double kPeriod = 1.0 / kRate;
    const double keep = std::exp(-kPeriod / 200.0);
    const double kick = std::sqrt(1.0 - keep * keep);
    Increment<double> increment;
    for (int i = 0; i < 3; ++i) {
      wander_w_(i) = started_ ? keep * wander_w_(i) + kick * dice_() : dice_();
      wander_f_(i) = started_ ? keep * wander_f_(i) + kick * dice_() : dice_();
      increment.angle(i) =
          kPeriod * 1.5 * kRadPerSPerDegPerH * wander_w_(i) + std::sqrt(kPeriod) * 5.0 * kRadPerSPerDegPerH * dice_();
      increment.velocity(i) = kPeriod * 20.0 * kMetresPerS2PerMicroG * wander_f_(i) +
                              std::sqrt(kPeriod) * 25.0 * kMetresPerS2PerMicroG * dice_();
    }
    started_ = true;
    return increment;
  }

 private:
  Gaussian dice_;
  Vec3<double> wander_w_ = Vec3<double>::Zero();
  Vec3<double> wander_f_ = Vec3<double>::Zero();
  bool started_ = false;
};

using Track = std::vector<std::array<double, 3>>;  // latitude, longitude, height, once a minute

template <class T, class Source>
Track fly(const NavigationState<Wide>& start, const Source& source) {
  TwoSpeedNavigator<T> navigator(start, static_cast<T>(1.0 / kRate), 10);
  Track track;
  for (int i = 0; i < kSamples; ++i) {
    const Increment<double> increment = source(i);
    if (navigator.add(Increment<T>{increment.angle.template cast<T>(), increment.velocity.template cast<T>()}) !=
        Status::kOk)
      return {};
    if ((i + 1) % kEvery != 0) continue;
    const auto state = navigator.template state<double>();
    track.push_back({state.latitude, state.longitude, state.height});
  }
  return track;
}

struct Rms {
  double horizontal = 0.0;
  double up = 0.0;
};

Rms rms(const Track& a, const Track& b) {
  Rms sum;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double north = kEarthRadius * (a[i][0] - b[i][0]);
    const double east = kEarthRadius * std::cos(b[i][0]) * (a[i][1] - b[i][1]);
    sum.horizontal += north * north + east * east;
    sum.up += (a[i][2] - b[i][2]) * (a[i][2] - b[i][2]);
  }
  return {std::sqrt(sum.horizontal / static_cast<double>(a.size())), std::sqrt(sum.up / static_cast<double>(a.size()))};
}

template <class Path>
void hold_the_hour(const char* name, const Path& path) {
  const PathTruth<Path> truth(path);
  std::vector<Increment<double>> increments;
  for (int i = 0; i < kSamples; ++i) {
    const Increment<Wide> wide = truth.increment(static_cast<Wide>(i) / static_cast<Wide>(kRate),
                                                 static_cast<Wide>(i + 1) / static_cast<Wide>(kRate));
    increments.push_back({wide.angle.cast<double>(), wide.velocity.cast<double>()});
  }
  const auto plain = [&](int i) { return increments[static_cast<std::size_t>(i)]; };
  const NavigationState<Wide> start = truth.state(0.0L);
  const Track in_double = fly<double>(start, plain);
  const Track in_float = fly<float>(start, plain);
  ASSERT_EQ(in_double.size(), 60U);
  ASSERT_EQ(in_float.size(), 60U);
  const Rms own = rms(in_float, in_double);
  Rms caused;
  constexpr int kSeeds = 8;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const Track noisy = fly<double>(start, [&](int i) {
      const Increment<double> n = noise();
      const Increment<double>& p = increments[static_cast<std::size_t>(i)];
      return Increment<double>{p.angle + n.angle, p.velocity + n.velocity};
    });
    const Rms one = rms(noisy, in_double);
    caused.horizontal += one.horizontal * one.horizontal / kSeeds;
    caused.up += one.up * one.up / kSeeds;
  }
  caused = {std::sqrt(caused.horizontal), std::sqrt(caused.up)};
  std::printf(
      "[ FIGURE   ] golden hour, %s: float's own error %.2f m horizontal, %.2f m vertical; the sheet's noise causes "
      "%.0f m, %.0f m: %.3f %%, %.3f %%\n",
      name, own.horizontal, own.up, caused.horizontal, caused.up, 100.0 * own.horizontal / caused.horizontal,
      100.0 * own.up / caused.up);
  EXPECT_LT(own.horizontal, 0.01 * caused.horizontal);
  EXPECT_LT(own.up, 0.01 * caused.up);
}

TEST(GoldenHour, OfFlight) { hold_the_hour("flight", SmallAircraft{0.1}); }
TEST(GoldenHour, OfRest) { hold_the_hour("at rest", OnABench{}); }

}  // namespace
}  // namespace trunnion
