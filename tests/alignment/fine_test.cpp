// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/alignment/fine.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <limits>

#include "matchers/chi_square.hpp"
#include "trunnion/alignment/swinging.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/simulation/rotating_platform.hpp"

namespace trunnion {
namespace {

using simulation::PathTruth;
using simulation::Pose;
using simulation::TimeJet;
using Wide = long double;

constexpr double kLatitude = 0.7;  // rad
constexpr double kPeriod = 0.01;   // s
constexpr double kMicroG = kMetresPerS2PerMicroG;
constexpr double kDegPerH = kRadPerSPerDegPerH;

/// A ship at her moorings: degrees of roll, pitch and yaw within seconds; or with @p size zero, at rest.
struct Mooring {
  double size = 1.0;
  template <class S>
  Pose<S> operator()(const S& t) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    const auto wave = [&](double degrees, double period, double phase) {
      return of(size * degrees * kRadPerDeg) * sin(of(2.0 * kPi / period) * t + of(phase));
    };
    return {of(kLatitude),
            of(0.2),
            of(10.0),
            of(0.05) + wave(3.0, 7.3, 0.4),
            of(-0.03) + wave(1.5, 5.1, 1.0),
            of(0.9) + wave(1.0, 9.7, 2.0)};
  }
};

const NavigationState<double> place = [] {
  NavigationState<double> state;
  state.latitude = kLatitude;
  state.longitude = 0.2;
  state.height = 10.0;
  return state;
}();

/// Gyros of 0.01 deg/h and accelerometers of 50 ug, as an aligning unit has them.
FineAlignmentNoise<double> navigation_grade(double velocity) {
  return {0.001 * kRadPerDeg / 60.0, 10.0 * kMicroG, 0.0, 0.0, velocity, 0.01, 0.05, 0.01,
          0.01 * kDegPerH,           50.0 * kMicroG};
}

/// Angle between two attitudes, as phi of the true against the found: Exp(phi) found = true.
Vec3<double> phi_of(const Quaternion<double>& truth, const Quaternion<double>& found) {
  return quaternion_log<double>((truth * found.conjugate()).normalized());
}

// With perfect sensors the computation adds less than a microradian, also on a base that swings.
TEST(SwingingAlignment, AddsLessThanAMicroradian) {
  const PathTruth<Mooring> truth(Mooring{0.0});
  SwingingAlignment<double> still(kLatitude, 120.0, kPeriod);
  const Increment<Wide> sample = truth.increment(0.0L, 0.01L);
  for (int i = 0; i < 12000; ++i)
    ASSERT_EQ(still.add({sample.angle.cast<double>(), sample.velocity.cast<double>()}), Status::kOk);
  const double at_rest = phi_of(truth.state(0.0L).attitude.cast<double>(), still.attitude().value()).norm();

  const PathTruth<Mooring> ship(Mooring{1.0});
  SwingingAlignment<double> swinging(kLatitude, 120.0, kPeriod);
  for (int i = 0; i < 12000; ++i) {
    const Increment<Wide> s = ship.increment(static_cast<Wide>(kPeriod) * i, static_cast<Wide>(kPeriod) * (i + 1));
    ASSERT_EQ(swinging.add({s.angle.cast<double>(), s.velocity.cast<double>()}), Status::kOk);
  }
  const double moored = phi_of(ship.state(120.0L).attitude.cast<double>(), swinging.attitude().value()).norm();
  std::printf("[ FIGURE   ] swinging alignment, perfect sensors, 120 s: %.1e rad at rest, %.1e rad swinging\n", at_rest,
              moored);
  EXPECT_LT(at_rest, 1e-6);
  EXPECT_LT(moored, 1e-6);
}

TEST(SwingingAlignment, RefusesWhatCannotBeKnown) {
  SwingingAlignment<double> early(kLatitude, 60.0, kPeriod);
  for (int i = 0; i < 4000; ++i) (void)early.add({Vec3<double>::Zero(), Vec3<double>(0.0, 0.0, -9.8 * kPeriod)});
  EXPECT_EQ(early.attitude().status(), Status::kNotObservable);
  Increment<double> bad;
  bad.velocity.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(early.add(bad), Status::kOutOfRange);
  SwingingAlignment<double> pole(1.5707, 60.0, kPeriod);
  Increment<double> sample;
  sample.velocity.z() = -9.8 * kPeriod;
  for (int i = 0; i < 1000; ++i) (void)pole.add(sample);
  EXPECT_EQ(pole.attitude().status(), Status::kNotObservable);
}

struct Errors {
  InertialSample<double> bias;
  simulation::Gaussian noise;
  FineAlignmentNoise<double> sheet;
  explicit Errors(std::uint64_t seed, const FineAlignmentNoise<double>& of) : noise(seed, 1), sheet(of) {
    for (int i = 0; i < 3; ++i) {
      bias.w(i) = sheet.first_gyro_bias * noise();
      bias.f(i) = sheet.first_accel_bias * noise();
    }
  }
  Increment<double> read(const Increment<Wide>& truth) {
    Increment<double> out{truth.angle.cast<double>() + kPeriod * bias.w,
                          truth.velocity.cast<double>() + kPeriod * bias.f};
    for (int i = 0; i < 3; ++i) {
      out.angle(i) += sheet.gyro * std::sqrt(kPeriod) * noise();
      out.velocity(i) += sheet.accel * std::sqrt(kPeriod) * noise();
    }
    return out;
  }
  NavigationState<double> start(const Quaternion<double>& truth) {
    NavigationState<double> state = place;
    const Vec3<double> phi(sheet.first_tilt * noise(), sheet.first_tilt * noise(), sheet.first_heading * noise());
    state.attitude = quaternion_exp<double>(-phi) * truth;
    for (int i = 0; i < 3; ++i) state.velocity(i) = sheet.first_velocity * noise();
    return state;
  }
};

// 80 alignments of two minutes at rest: the error against its covariance, 1 % two-sided; the heading's sigma is that of
// the east gyro bias, as theory has it.
TEST(FineAlignment, HasAnHonestCovariance) {
  constexpr int kRuns = 80;
  const PathTruth<Mooring> truth(Mooring{0.0});
  const Increment<Wide> sample = truth.increment(0.0L, 0.01L);
  const Quaternion<double> q_nb = truth.state(0.0L).attitude.cast<double>();
  double nees = 0.0;
  double heading = 0.0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Errors errors(seed, navigation_grade(1e-3));
    FineAlignment<PreviousSample<double>> alignment(errors.start(q_nb), kPeriod, 10, Vec3<double>::Zero(),
                                                    errors.sheet);
    simulation::Gaussian shake(seed, 9);
    for (int i = 0; i < 12000; ++i) {
      Increment<double> reading = errors.read(sample);
      ASSERT_EQ(alignment.add(reading), Status::kOk) << seed << ' ' << i << ' ' << alignment.strangeness();
    }
    const auto result = alignment.result();
    ASSERT_TRUE(result.ok());
    const Vec3<double> phi = phi_of(q_nb, result.value().q_nb);
    nees += phi.dot(result.value().covariance.inverse() * phi);
    heading = std::sqrt(result.value().covariance(2, 2));
  }
  const double theory = 0.01 * kDegPerH / (kEarthRate * std::cos(kLatitude));
  std::printf("[ FIGURE   ] fine alignment, 120 s: heading sigma %.3f mrad (east bias alone %.3f), NEES/3 %.2f\n",
              heading * 1e3, theory * 1e3, nees / (3.0 * kRuns));
  const ChiSquareBand band = chi_square_band(3.0 * kRuns, 0.01);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
  EXPECT_GT(heading, theory);
  EXPECT_LT(heading, 2.0 * theory);
}

const Vec3<double> kArm(1.5, -0.5, -1.0);    // m, from the point that stands still
const Vec3<double> kOnAxis(0.0, 0.0, -1.0);  // on the platform's axis: the same in the unit as on deck

/// Ten minutes on a moored ship, the unit on a platform that turns or not.
struct Outcome {
  Vec3<double> phi;
  Mat3<double> covariance;
  Status status = Status::kOk;
};

Outcome moored(std::uint64_t seed, const Vec3<double>& arm, const Vec3<double>& arm_told, double turns_per_second) {
  const PathTruth<Mooring> ship(Mooring{1.0});
  const auto angle = [turns_per_second](Wide t) {
    const Wide w = 2.0L * static_cast<Wide>(kPi * turns_per_second);
    return TimeJet<Wide>(w * t, w, 0.0L);
  };
  const auto fixed = [](Wide) { return TimeJet<Wide>(0.0L); };
  const simulation::RotatingPlatform deck([&ship](Wide t) { return ship.sample(t); }, fixed, Mat3<Wide>::Identity(),
                                          Vec3<Wide>::UnitZ(), arm.cast<Wide>());
  const simulation::RotatingPlatform unit(deck, angle, Mat3<Wide>::Identity(), Vec3<Wide>::UnitZ(), Vec3<Wide>::Zero());
  Errors errors(seed, navigation_grade(2e-3));
  FineAlignment<PreviousSample<double>> alignment(errors.start(ship.state(0.0L).attitude.cast<double>()), kPeriod, 10,
                                                  arm_told, errors.sheet);
  Outcome outcome;
  constexpr int kSamples = 60000;
  for (int i = 0; i < kSamples; ++i) {
    const Wide from = static_cast<Wide>(kPeriod) * i;
    const Status status =
        alignment.add(errors.read(simulation::integrate<Wide>(unit, from, from + static_cast<Wide>(kPeriod))));
    if (status != Status::kOk) outcome.status = status;
  }
  const Wide end = static_cast<Wide>(kPeriod) * kSamples;
  const Quaternion<double> turned(Eigen::AngleAxisd(static_cast<double>(angle(end).value), Vec3<double>::UnitZ()));
  const Quaternion<double> found = alignment.navigator().state().attitude * turned.conjugate();
  outcome.phi = phi_of(ship.state(end).attitude.cast<double>(), found);
  outcome.covariance = alignment.covariance().topLeftCorner<3, 3>();
  return outcome;
}

// The lever arm given, a swinging deck is as good as a still one; kept silent, the base is seen to move and refused.
TEST(FineAlignment, KnowsItsLeverArmOrRefuses) {
  const Outcome given = moored(3, kArm, kArm, 0.0);
  EXPECT_EQ(given.status, Status::kOk);
  EXPECT_LT(given.phi.dot(given.covariance.inverse() * given.phi), 16.3);  // 3 degrees of freedom, 0.1 %
  const Outcome silent = moored(3, kArm, Vec3<double>::Zero(), 0.0);
  EXPECT_EQ(silent.status, Status::kMovingBase);
}

// A vehicle that drives off, gently: refused, with what was seen.
TEST(FineAlignment, RefusesAMovingBase) {
  const PathTruth<Mooring> truth(Mooring{0.0});
  const Increment<Wide> sample = truth.increment(0.0L, 0.01L);
  NavigationState<double> start = place;
  start.attitude = truth.state(0.0L).attitude.cast<double>();
  FineAlignment<PreviousSample<double>> alignment(start, kPeriod, 10, Vec3<double>::Zero(), navigation_grade(1e-3));
  for (int i = 0; i < 6000; ++i)
    ASSERT_EQ(alignment.add({sample.angle.cast<double>(), sample.velocity.cast<double>()}), Status::kOk);
  EXPECT_LT(alignment.gyro_bias().norm(), 1e-9) << "of perfect sensors";
  EXPECT_LT(alignment.accel_bias().norm(), 1e-6);
  for (int i = 0; i < 500; ++i)
    (void)alignment.add(
        {sample.angle.cast<double>(), sample.velocity.cast<double>() + Vec3<double>(0.1 * kPeriod, 0.0, 0.0)});
  EXPECT_EQ(alignment.result().status(), Status::kMovingBase);
  EXPECT_GT(alignment.strangeness(), 3.0);
  EXPECT_GT(alignment.innovation().norm(), 2e-3);
  for (int i = 0; i < 20000; ++i)  // standing again does not undo it
    (void)alignment.add({sample.angle.cast<double>(), sample.velocity.cast<double>()});
  EXPECT_EQ(alignment.result().status(), Status::kMovingBase);
  Increment<double> bad;
  bad.angle.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(alignment.add(bad), Status::kOutOfRange);
  EXPECT_TRUE(alignment.navigator().state().attitude.coeffs().allFinite());
}

// Rotation-modulated self-alignment on the swinging deck, the axis through the point at rest: the turning unit's level
// gyro biases part from north.
TEST(FineAlignment, FindsNorthBetterOnATurningPlatform) {
  double still = 0.0;
  double turning = 0.0;
  double nees = 0.0;
  constexpr int kRuns = 6;
  Mat3<double> covariance_still;
  Mat3<double> covariance_turning;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const Outcome a = moored(seed, kArm, kArm, 0.0);
    const Outcome b = moored(seed, kOnAxis, kOnAxis, 0.05);
    still += a.phi.z() * a.phi.z() / kRuns;
    turning += b.phi.z() * b.phi.z() / kRuns;
    nees += b.phi.dot(b.covariance.inverse() * b.phi);
    covariance_still = a.covariance;
    covariance_turning = b.covariance;
  }
  std::printf(
      "[ FIGURE   ] swinging deck, 10 min: heading rms %.3f mrad still (sigma %.3f), %.3f mrad turning (sigma %.3f)\n",
      1e3 * std::sqrt(still), 1e3 * std::sqrt(covariance_still(2, 2)), 1e3 * std::sqrt(turning),
      1e3 * std::sqrt(covariance_turning(2, 2)));
  EXPECT_LT(covariance_turning(2, 2), covariance_still(2, 2) / 9.0);
  EXPECT_LT(turning, still / 4.0);
  const ChiSquareBand band = chi_square_band(3.0 * kRuns, 0.01);
  EXPECT_LT(nees, band.high);
}

}  // namespace
}  // namespace trunnion
