// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The whole chain on simulated receivers: a constellation, clocks apart, slips, outages, a body that flies; what is
/// called fixed is right, and what is not seen is said.

#include "trunnion/interferometer/attitude_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "attitude/three_antennas.hpp"
#include "matchers/chi_square.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/gnss_array.hpp"

namespace trunnion {
namespace {

using simulation::AttitudePath;
using simulation::GnssArray;
using simulation::GnssArrayOptions;
using simulation::Outage;

constexpr GpsTime kStart{2320, 116400.0};
const Vec3<double> kPlace(-3817680.98, 3562840.07, 3650158.45);

GnssArrayOptions flying(std::uint64_t seed, double speed) {
  GnssArrayOptions options;
  options.seed = seed;
  options.orbits = simulation::walker_constellation(30, kStart);
  options.start = kStart;
  options.antennas = {Vec3<double>(0.3, -0.2, -1.0), Vec3<double>(1.3, -0.2, -1.0), Vec3<double>(0.3, 0.8, -1.0)};
  const Vec3<double> way = north_from_earth(kPlace).transpose() * Vec3<double>(0.8 * speed, 0.6 * speed, 0.0);
  options.place = [way](double t) { return Vec3<double>(kPlace + way * t); };
  return options;
}

RigidVectors<double, 2> figure_of(const GnssArrayOptions& options, double sigma) {
  Eigen::Matrix<double, 3, 2> b;
  b << options.antennas[1] - options.antennas[0], options.antennas[2] - options.antennas[0];
  return RigidVectors<double, 2>(b, sigma);
}

struct Tally {
  int fixed = 0, held = 0, predicted = 0, other = 0, wrong = 0, restarts = 0;
  double nees = 0.0;    ///< of fixed epochs alone
  double square = 0.0;  ///< of the filter [rad^2]
  double filter_nees = 0.0;
  int scored = 0;
};

template <class T>
Tally fly(GnssArrayOptions options, const AttitudePath& path, int epochs, double sigma) {
  const RigidVectors<double, 2> figure = figure_of(options, sigma);
  TrackerOptions<T> tracker_options;
  tracker_options.noise.walk = static_cast<T>(10.0 * kRadPerDeg);
  AttitudeTracker<T, 2, kMostSignals> tracker(
      RigidVectors<T, 2>(figure.b().cast<T>().eval(), static_cast<T>(figure.sigma())), tracker_options);
  GnssArray array(options, path);
  const SignalNoise noise{options.code_sigma, options.phase_sigma, options.mask};
  Tally tally;
  for (int k = 0; k < epochs; ++k) {
    const auto& seen = array.next();
    std::array<SingleDifferences<T, kMostSignals>, 2> sets;
    const auto place = antenna_place(seen.antenna[0]);
    if (place.ok()) {
      for (std::size_t s = 0; s < 2; ++s)
        sets[s] = single_differences<T>(seen.antenna[0], seen.antenna[s + 1], place.value(), noise).value();
    }
    const auto out = tracker.add(static_cast<T>(1), sets);
    const Vec3<double> off = quaternion_log<double>(out.attitude.q_nb.template cast<double>().conjugate() * seen.q_nb);
    const bool sure = out.status == AttitudeStatus::kFixed || out.status == AttitudeStatus::kHeld;
    tally.fixed += out.status == AttitudeStatus::kFixed;
    tally.held += out.status == AttitudeStatus::kHeld;
    tally.predicted += out.status == AttitudeStatus::kPredicted;
    tally.other += out.status < AttitudeStatus::kPredicted;
    const Mat3<double> P = out.attitude.covariance.template cast<double>();
    if (sure && out.attitude.observable == 3 && off.dot(P.inverse() * off) > 25.0) ++tally.wrong;  // five sigmas
    if (out.epoch.status == AttitudeStatus::kFixed && out.epoch.attitude.observable == 3) {
      const Vec3<double> alone =
          quaternion_log<double>(out.epoch.attitude.q_nb.template cast<double>().conjugate() * seen.q_nb);
      tally.nees += alone.dot(out.epoch.attitude.information.template cast<double>() * alone);
      ++tally.scored;
    }
  }
  tally.restarts = tracker.restarts();
  return tally;
}

TEST(AntennaPlace, IsFoundFromAnywhereAndItsVelocityToo) {
  GnssArrayOptions options = flying(1, 100.0);
  options.code_sigma = 0.5;
  GnssArray array(options, simulation::example_2_stand_in());
  for (int k = 0; k < 20; ++k) {
    const auto& seen = array.next();
    const auto place = antenna_place(seen.antenna[0]);
    ASSERT_TRUE(place.ok());
    EXPECT_LT((place.value().r - options.place(seen.t)).norm(), 8.0);
    EXPECT_NEAR(place.value().v.norm(), 100.0, 0.5);
    // one code that lies by 300 km is left out
    auto lying = seen.antenna[0];
    lying.at[2].code += 300000.0;
    const auto without = antenna_place(lying);
    ASSERT_TRUE(without.ok());
    EXPECT_EQ(without.value().used, place.value().used - 1);
    EXPECT_LT((without.value().r - options.place(seen.t)).norm(), 10.0);
  }
}

/// Codes that fit no place: refused, or a place near the Earth that explains them to a kilometre.
TEST(AntennaPlace, IsNotMadeUpOfCodesThatFitNone) {
  GnssArray array(flying(3, 0.0), simulation::example_2_stand_in());
  const auto& seen = array.next();
  simulation::Gaussian random(3, 7);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    auto lying = seen.antenna[0];
    lying.count = std::min(lying.count, 4 + trial % 3);
    for (int i = 0; i < lying.count; ++i) lying.at[static_cast<std::size_t>(i)].code += 2e7 * random();
    const auto place = antenna_place(lying);
    if (!place.ok()) {
      ++refused;
      EXPECT_TRUE(place.status() == Status::kInconsistent || place.status() == Status::kNotObservable);
      continue;
    }
    EXPECT_NEAR(place.value().r.norm(), kEarthRadius, 1e6);
    EXPECT_GE(place.value().used, 4);
  }
  EXPECT_GT(refused, 2500);
}

/// Without noise everything closes: the light's way, the clocks 1 ms apart, the vehicle's way between their times.
TEST(SingleDifferences, AreExactWhateverTheClocksAndTheSpeed) {
  for (const double speed : {0.0, 100.0, 250.0}) {
    GnssArrayOptions options = flying(2, speed);
    options.code_sigma = 1e-6;
    options.phase_sigma = 1e-6;
    const AttitudePath still([](double) { return Vec3<double>(Vec3<double>::Zero()); },
                             quaternion_of_euler(0.1, 0.2, 1.0), 20.0);
    GnssArray array(options, still);
    for (int k = 0; k < 10; ++k) {
      const auto& seen = array.next();
      const auto place = antenna_place(seen.antenna[0]);
      ASSERT_TRUE(place.ok());
      for (std::size_t s = 1; s < 3; ++s) {
        const auto set = single_differences<double>(seen.antenna[0], seen.antenna[s], place.value(), {});
        ASSERT_TRUE(set.ok());
        ASSERT_GE(set.value().count, 6);
        const Vec3<double> b = seen.q_nb * (options.antennas[s] - options.antennas[0]);
        const auto fix = resolve_baseline(set.value(), KnownLength<double>{1.0, 0.001});
        ASSERT_TRUE(fix.ok());
        // Doppler of 3 cm/s over 1 ms of clocks
        EXPECT_LT((fix.value().seen.value - b).norm(), 2e-4) << speed;
      }
    }
  }
}

TEST(SingleDifferences, RefuseReceiversWhoseTimesDoNotMeet) {
  GnssArray array(flying(3, 0.0), simulation::example_2_stand_in());
  auto seen = array.next();
  const auto place = antenna_place(seen.antenna[0]);
  seen.antenna[1].time = seen.antenna[1].time + 0.5;
  EXPECT_EQ(single_differences<double>(seen.antenna[0], seen.antenna[1], place.value(), {}).status(), Status::kTimeOut);
  seen.antenna[1].count = 0;
  seen.antenna[1].time = seen.antenna[0].time;
  EXPECT_EQ(single_differences<double>(seen.antenna[0], seen.antenna[1], place.value(), {}).value().count, 0);
  seen.antenna[0].count = 3;
  EXPECT_EQ(antenna_place(seen.antenna[0]).status(), Status::kNotObservable);
}

TEST(AttitudeTracker, FliesThroughSlipsAndOutagesAndIsRightWhenItSaysSo) {
  Tally sum;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    GnssArrayOptions options = flying(seed, 100.0);
    options.slips_per_hour = 60.0;
    options.half_slips_per_hour = 1.0;
    options.outages = {{2, 0, 30.0, 40.0}, {0, 0, 60.0, 63.0}, {1, 5, 0.0, 50.0}};
    const Tally tally = fly<double>(options, simulation::example_2_stand_in(), 110, 0.001);
    sum.wrong += tally.wrong;
    sum.restarts += tally.restarts;
    sum.fixed += tally.fixed;
    sum.held += tally.held;
    sum.predicted += tally.predicted;
    sum.other += tally.other;
    sum.nees += tally.nees;
    sum.scored += tally.scored;
  }
  std::printf(
      "[ FIGURE ] flight at 100 m/s, clocks 1 ms, a slip a minute and signal, outages: fixed %.1f %%, held %.1f, "
      "predicted %.1f, none %.1f; wrong %d of 1100, NEES/3 %.3f\n",
      sum.fixed / 11.0, sum.held / 11.0, sum.predicted / 11.0, sum.other / 11.0, sum.wrong,
      sum.nees / (3.0 * sum.scored));
  // half cycles that no receiver tells of, one an hour and signal: they stay until the signal is lost
  EXPECT_LE(sum.wrong, 1) << "one in a thousand";
  EXPECT_EQ(sum.restarts, 0);
  EXPECT_GT(sum.fixed, 900);
  EXPECT_GE(sum.predicted, 30 - 2) << "three seconds without a master, ten flights";
  // 1 ms of clocks while it turns by 15 deg/s is 0.015 deg of 0.1: that much is not in the covariance
  const ChiSquareBand band = chi_square_band(3.0 * sum.scored, 1e-3);
  EXPECT_GT(sum.nees, band.low);
  EXPECT_LT(sum.nees, 1.1 * band.high);
}

TEST(AttitudeTracker, InSinglePrecisionSaysTheSame) {
  GnssArrayOptions options = flying(7, 50.0);
  const Tally in_double = fly<double>(options, simulation::example_2_stand_in(), 110, 0.001);
  const Tally in_float = fly<float>(options, simulation::example_2_stand_in(), 110, 0.001);
  EXPECT_EQ(in_float.wrong, 0);
  EXPECT_GE(in_float.fixed, in_double.fixed - 5);
  EXPECT_NEAR(in_float.nees / in_double.nees, 1.0, 0.1);
}

TEST(AttitudeTracker, WithTwoAntennasSaysWhichAxisIsFree) {
  GnssArrayOptions options = flying(8, 0.0);
  options.antennas.pop_back();
  const AttitudePath path = simulation::example_1_stand_in(simulation::PlatformMotion::kMedium, 100.0);
  GnssArray array(options, path);
  TrackerOptions<double> tracker_options;
  tracker_options.noise.walk = 1.0 * kRadPerDeg;
  AttitudeTracker<double, 1, kMostSignals> tracker(RigidVectors<double, 1>(Vec3<double>(1, 0, 0), 0.002),
                                                   tracker_options);
  int fixed = 0;
  for (int k = 0; k < 100; ++k) {
    const auto& seen = array.next();
    const auto place = antenna_place(seen.antenna[0]).value();
    const auto out =
        tracker.add(1.0, {single_differences<double>(seen.antenna[0], seen.antenna[1], place, {}).value()});
    if (out.status != AttitudeStatus::kFixed) continue;
    ++fixed;
    EXPECT_EQ(out.attitude.observable, 2);
    EXPECT_NEAR(std::abs(out.attitude.free_axis.x()), 1.0, 1e-9);
    const Vec3<double> pointing = out.attitude.q_nb * Vec3<double>(1, 0, 0);
    EXPECT_LT(std::acos(std::min(1.0, pointing.dot(seen.q_nb * Vec3<double>(1, 0, 0)))), 2.0 * kRadPerDeg);
    // about the free axis it claims nothing
    if (k > 10) {
      EXPECT_GT(std::sqrt(tracker.filter().state().P(0, 0)), 10.0 * std::sqrt(tracker.filter().state().P(1, 1)));
    }
  }
  EXPECT_GT(fixed, 90);
}

/// Four satellites: the phases alone decide nothing, and it says so; a filter that is sure leads them.
TEST(AttitudeTracker, HoldsWithFewSatellitesAndNeverGuesses) {
  GnssArrayOptions options = flying(9, 0.0);
  options.phase_sigma = 0.001;
  const AttitudePath still([](double) { return Vec3<double>(Vec3<double>::Zero()); },
                           quaternion_of_euler(0.1, 0.2, 1.0), 100.0);
  GnssArray array(options, still);
  TrackerOptions<double> tracker_options;
  tracker_options.noise.walk = 0.02 * kRadPerDeg;
  AttitudeTracker<double, 2, kMostSignals> tracker(figure_of(options, 0.001), tracker_options);
  AttitudeTracker<double, 2, kMostSignals> cold(figure_of(options, 0.001), tracker_options);
  int held = 0;
  int guessed = 0;
  for (int k = 0; k < 100; ++k) {
    auto seen = array.next();
    if (k >= 50) {  // a street canyon
      for (auto& antenna : seen.antenna) antenna.count = std::min(antenna.count, k < 75 ? 4 : 3);
    }
    const auto place = antenna_place(seen.antenna[0], kPlace);
    std::array<SingleDifferences<double, kMostSignals>, 2> sets;
    AntennaPlace there;
    there.r = place.ok() ? place.value().r : kPlace;
    for (std::size_t s = 0; s < 2; ++s)
      sets[s] = single_differences<double>(seen.antenna[0], seen.antenna[s + 1], there, {}).value();
    const auto out = tracker.add(1.0, sets);
    if (k >= 50 && k < 75) {
      held += out.status == AttitudeStatus::kHeld || out.status == AttitudeStatus::kFixed;
      guessed += cold.add(1.0, sets).status > AttitudeStatus::kFloat;
    }
    if (k >= 75) {
      EXPECT_LE(out.status, AttitudeStatus::kPredicted) << "three satellites are no baseline";
    }
    if (out.status >= AttitudeStatus::kPredicted) {
      EXPECT_LT(rotation_error(out.attitude.q_nb, seen.q_nb).norm(), 2.0 * kRadPerDeg);
    }
  }
  std::printf("[ FIGURE ] four satellites: %d of 25 epochs held by a sure filter, %d guessed without one\n", held,
              guessed);
  EXPECT_GT(held, 20);
  EXPECT_LE(guessed, 1);
}

/// A filter that goes wrong is not believed for ever, and says that it started again.
TEST(AttitudeTracker, StartsAgainWhenTheFixesInsist) {
  GnssArrayOptions options = flying(10, 0.0);
  // the body is turned by a hand, at once, by 40 deg
  const AttitudePath path(
      [](double t) { return Vec3<double>(0.0, 0.0, t > 30.0 && t < 31.0 ? 40.0 * kRadPerDeg : 0.0); },
      Quaternion<double>::Identity(), 60.0);
  GnssArray array(options, path);
  TrackerOptions<double> tracker_options;
  tracker_options.noise.walk = 0.001 * kRadPerDeg;
  AttitudeTracker<double, 2, kMostSignals> tracker(figure_of(options, 0.001), tracker_options);
  int refused = 0;
  for (int k = 0; k < 60; ++k) {
    const auto& seen = array.next();
    const auto place = antenna_place(seen.antenna[0]).value();
    std::array<SingleDifferences<double, kMostSignals>, 2> sets;
    for (std::size_t s = 0; s < 2; ++s)
      sets[s] = single_differences<double>(seen.antenna[0], seen.antenna[s + 1], place, {}).value();
    const auto out = tracker.add(1.0, sets);
    refused += out.refused;
    if (out.refused) {
      EXPECT_EQ(out.status, AttitudeStatus::kPredicted);
    }
    if (k > 40) {
      EXPECT_LT(rotation_error(out.attitude.q_nb, seen.q_nb).norm(), 2.0 * kRadPerDeg);
    }
  }
  EXPECT_EQ(tracker.restarts(), 1);
  EXPECT_EQ(refused, 2);
}

/// The ephemerides' formula against another way round: positions from a rotating ellipse, by Newton's own constants.
TEST(BroadcastOrbit, GoesRoundAsKeplerSays) {
  const auto orbits = simulation::walker_constellation(12, kStart);
  for (const BroadcastOrbit& orbit : orbits) {
    for (const double t : {-7000.0, -100.0, 0.0, 3000.0, 14000.0}) {
      const GpsTime time = kStart + t;
      const auto inertial = [&](double dt) {
        const Vec3<double> r = satellite_at(orbit, time + dt).value().r;
        const double turned = 7.2921151467e-5 * ((time + dt) - kStart);
        return turn_about_z<double>(std::sin(turned), std::cos(turned), r);
      };
      constexpr double kStep = 10.0;
      const Vec3<double> r = inertial(0.0);
      const Vec3<double> acceleration = (inertial(kStep) - 2.0 * r + inertial(-kStep)) / (kStep * kStep);
      const Vec3<double> gravity = -3.9860050e14 / std::pow(r.norm(), 3) * r;
      EXPECT_LT((acceleration - gravity).norm(), 1e-5 * gravity.norm());
    }
    EXPECT_EQ(satellite_at(orbit, kStart + 4.1 * 3600.0).status(), Status::kTimeOut);
    BroadcastOrbit bad = orbit;
    bad.e = 0.9;
    EXPECT_EQ(satellite_at(bad, kStart).status(), Status::kOutOfRange);
    bad = orbit;
    bad.m0 = std::nan("");
    EXPECT_EQ(satellite_at(bad, kStart).status(), Status::kOutOfRange);
  }
}

/// Codes of metres on baselines of a metre: no covariance of theirs would be true, so no attitude is told.
TEST(FloatAttitude, IsToldOnlyWhereItSaysSomething) {
  const RigidVectors<double, 2> figure = figure_of(flying(1, 0.0), 0.001);
  EpochAttitude<double, 2> epoch;
  epoch.seen.value = figure.seen_from(Mat3<double>::Identity());
  epoch.seen.information.setIdentity();
  epoch.seen.information /= 0.1 * 0.1;
  kernel::take_float(figure, epoch);
  EXPECT_EQ(epoch.status, AttitudeStatus::kFloat);
  EXPECT_EQ(epoch.attitude.observable, 3);
  EpochAttitude<double, 2> vague;
  vague.seen.value = epoch.seen.value;
  vague.seen.information.setIdentity();
  kernel::take_float(figure, vague);
  EXPECT_EQ(vague.status, AttitudeStatus::kFloat);
  EXPECT_EQ(vague.attitude.observable, 0);
}

/// BeiDou's plane is tilted and turned back: over one place on the equator a satellite of the Earth's own rate stands.
TEST(BroadcastOrbit, OfAGeostationarySatelliteStands) {
  constexpr double kRate = 7.292115e-5;
  constexpr double kLongitude = 110.5 * kRadPerDeg;
  BroadcastOrbit orbit;
  orbit.system = SatelliteSystem::kBeidou;
  orbit.toe = orbit.toc = kStart;
  orbit.toe_of_week = kStart.seconds;
  const double a = std::cbrt(3.986004418e14 / (kRate * kRate));
  orbit.sqrt_a = std::sqrt(a);
  orbit.i0 = 5.0 * kRadPerDeg;
  orbit.omega0 = kRate * orbit.toe_of_week + kPi;
  orbit.m0 = kLongitude - kPi;
  const Vec3<double> there = a * Vec3<double>(std::cos(kLongitude), std::sin(kLongitude), 0.0);
  for (const int number : {1, 5, 59, 61}) {
    orbit.number = number;
    for (const double t : {-14000.0, -100.0, 0.0, 3000.0, 14000.0})
      EXPECT_LT((satellite_at(orbit, kStart + t).value().r - there).norm(), 1e-5) << number << ' ' << t;
  }
  orbit.number = 6;  // one that goes round
  EXPECT_GT((satellite_at(orbit, kStart + 3000.0).value().r - there).norm(), 1e6);
}

}  // namespace
}  // namespace trunnion
