// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "matchers/chi_square.hpp"
#include "trunnion/alignment/coarse.hpp"
#include "trunnion/alignment/gyrocompass.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

constexpr double kLatitude = 0.7;

/// What a perfect unit of attitude @p q_nb feels at rest.
template <class T>
InertialSample<T> at_rest(const Quaternion<T>& q_nb, T latitude) {
  const Vec3<T> rate(T(kEarthRate) * std::cos(latitude), T(0), -T(kEarthRate) * std::sin(latitude));
  return {q_nb.conjugate() * rate, q_nb.conjugate() * Vec3<T>(T(0), T(0), T(-9.8))};
}

template <class T>
Quaternion<T> any_attitude(simulation::Gaussian& gaussian) {
  Eigen::Matrix<T, 4, 1> q;
  for (int i = 0; i < 4; ++i) q(i) = static_cast<T>(gaussian());
  q.normalize();
  return Quaternion<T>(q(0), q(1), q(2), q(3));
}

// The law: with perfect sensors only rounding is left; a microradian is asked, a thousandth of that is kept.
TEST(CoarseAlign, IsExactForPerfectSensors) {
  simulation::Gaussian gaussian(1, 1);
  for (int i = 0; i < 1000; ++i) {
    const Quaternion<double> truth = any_attitude<double>(gaussian);
    const auto found = coarse_align<double>(at_rest(truth, kLatitude), {}, kLatitude);
    ASSERT_TRUE(found.ok());
    EXPECT_LT(found.value().q_nb.angularDistance(truth), 1e-12);
    const auto latitude = latitude_from_rest<double>(at_rest(truth, kLatitude), {});
    ASSERT_TRUE(latitude.ok());
    EXPECT_NEAR(latitude.value().latitude, kLatitude, 1e-12);
  }
}

TEST(CoarseAlign, FloatKeepsAMicroradianOfTilt) {
  simulation::Gaussian gaussian(1, 2);
  for (int i = 0; i < 100; ++i) {
    const auto truth = any_attitude<float>(gaussian);
    const auto found = coarse_align<float>(at_rest(truth, 0.7F), {}, 0.7F);
    ASSERT_TRUE(found.ok());
    EXPECT_LT(found.value().q_nb.angularDistance(truth), 2e-6F);
  }
}

// NEES of the three angles over 2000 draws, gyros and accelerometers both in error, within its band of 1e-3.
TEST(CoarseAlign, SigmasAreTrue) {
  simulation::Gaussian gaussian(7, 3);
  const MeanSigma<double> sigma{2e-8, 3e-4};
  double nees = 0.0;
  constexpr int kDraws = 2000;
  for (int i = 0; i < kDraws; ++i) {
    const Quaternion<double> truth = any_attitude<double>(gaussian);
    InertialSample<double> mean = at_rest(truth, kLatitude);
    for (int k = 0; k < 3; ++k) {
      mean.w(k) += sigma.w * gaussian();
      mean.f(k) += sigma.f * gaussian();
    }
    const auto found = coarse_align<double>(mean, sigma, kLatitude);
    ASSERT_TRUE(found.ok());
    const Vec3<double> phi = quaternion_log<double>(truth * found.value().q_nb.conjugate());
    nees += phi.dot(found.value().covariance.inverse() * phi);
  }
  const ChiSquareBand band = chi_square_band(3.0 * kDraws, 1e-3);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

TEST(CoarseAlign, RefusesWhatCannotBeKnown) {
  const Quaternion<double> q = Quaternion<double>::Identity();
  EXPECT_EQ(coarse_align<double>(at_rest(q, 1.5707), {2e-8, 1e-4}, 1.5707).status(), Status::kNotObservable);
  EXPECT_EQ(coarse_align<double>(at_rest(q, kLatitude), {5e-5, 1e-4}, kLatitude).status(), Status::kNotObservable);
  EXPECT_EQ(coarse_align<double>({}, {}, kLatitude).status(), Status::kOutOfRange);
  InertialSample<double> nan = at_rest(q, kLatitude);
  nan.w.x() = std::nan("");
  EXPECT_FALSE(coarse_align<double>(nan, {1e-8, 1e-4}, kLatitude).ok());
}

// Biases a thousand times the Earth's rate cancel; so do they at unequal turns and on a tilted base.
TEST(Gyrocompass, CancelsTheBiases) {
  simulation::Gaussian gaussian(3, 4);
  const Vec3<double> bias(0.05, -0.08, 0.03);
  for (const int rests : {2, 3, 4, 7}) {
    const double heading = kPi * gaussian.uniform();
    Gyrocompass<double> compass;
    for (int k = 0; k < rests; ++k) {
      const double turn = k * (2.0 * kPi / rests) + 0.1 * k;
      const Quaternion<double> q_nb = quaternion_exp<double>(Vec3<double>(0, 0, heading + turn)) *
                                      quaternion_exp<double>(Vec3<double>(0, 0.03, 0)) *
                                      quaternion_exp<double>(Vec3<double>(-0.05, 0, 0));
      InertialSample<double> mean = at_rest(q_nb, kLatitude);
      mean.w += bias;
      ASSERT_EQ(compass.add(mean, turn), Status::kOk);
    }
    const auto north = compass.solve(1e-9);
    ASSERT_TRUE(north.ok());
    EXPECT_NEAR(std::remainder(north.value().heading - heading, 2.0 * kPi), 0.0, 1e-9) << rests;
    EXPECT_NEAR(north.value().horizontal / (kEarthRate * std::cos(kLatitude)), 1.0, 1e-9);
  }
}

// Pulls over 2000 draws of four rests: their sum of squares within its band of 1e-3.
TEST(Gyrocompass, SigmaIsTrue) {
  simulation::Gaussian gaussian(3, 5);
  constexpr int kDraws = 2000;
  constexpr double kSigma = 2e-7;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double heading = kPi * (2.0 * gaussian.uniform() - 1.0);
    Gyrocompass<double> compass;
    for (int k = 0; k < 4; ++k) {
      InertialSample<double> mean =
          at_rest(quaternion_exp<double>(Vec3<double>(0, 0, heading + 0.5 * kPi * k)), kLatitude);
      for (int axis = 0; axis < 3; ++axis) mean.w(axis) += kSigma * gaussian();
      ASSERT_EQ(compass.add(mean, 0.5 * kPi * k), Status::kOk);
    }
    const auto north = compass.solve(kSigma);
    ASSERT_TRUE(north.ok());
    squares += std::pow(std::remainder(north.value().heading - heading, 2.0 * kPi) / north.value().sigma, 2);
  }
  const ChiSquareBand band = chi_square_band(kDraws, 1e-3);
  EXPECT_GT(squares, band.low);
  EXPECT_LT(squares, band.high);
}

TEST(Gyrocompass, RefusesOneHeading) {
  Gyrocompass<double> compass;
  const InertialSample<double> mean = at_rest(Quaternion<double>::Identity(), kLatitude);
  EXPECT_EQ(compass.solve(1e-9).status(), Status::kNotObservable);
  for (int k = 0; k < 3; ++k) ASSERT_EQ(compass.add(mean, 2.0 * kPi * k), Status::kOk);
  EXPECT_EQ(compass.solve(1e-9).status(), Status::kNotObservable);
  EXPECT_EQ(compass.add({}, 0.0), Status::kOutOfRange);
}

// A real ring-laser unit, parked, 1847 s: its quantised increments, against the site and a heading that its authors
// call inaccurate. The gyros' bias is not known: 0.1 deg/h, as |w| - W shows, is their sigma.
TEST(RealRingLaser, AlignsAndFindsItsLatitude) {
  const std::filesystem::path path = std::filesystem::path(TRUNNION_DATA) / "rlg_static" / "lasergyro.imu";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "no real recordings: " << path << " is absent";
  std::string line;
  std::array<std::array<double, 6>, 3> head{};
  int heads = 0;
  Vec3<double> angle = Vec3<double>::Zero();
  Vec3<double> velocity = Vec3<double>::Zero();
  long long samples = 0;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '%') continue;
    std::istringstream row(line);
    std::array<double, 6> v{};
    for (double& x : v) row >> x;
    if (heads < 3) {
      head[static_cast<std::size_t>(heads++)] = v;
      continue;
    }
    // right-forward-up to forward-right-down
    angle += Vec3<double>(v[1], v[0], -v[2]);
    velocity += Vec3<double>(v[4], v[3], -v[5]);
    ++samples;
  }
  const double period = 1e-3 * head[1][4];
  const double time = static_cast<double>(samples) * period;
  const double arcsec = kRadPerDeg / 3600.0;
  InertialSample<double> mean;
  for (int k = 0; k < 3; ++k) {
    const std::size_t column = k == 0 ? 1 : k == 1 ? 0 : 2;
    mean.w(k) = angle(k) * head[2][column] * arcsec / time;
    mean.f(k) = velocity(k) * head[2][3 + column] * kMetresPerS2PerMicroG / time;
  }
  const MeanSigma<double> sigma{0.1 * kRadPerSPerDegPerH, 100.0 * kMetresPerS2PerMicroG};
  const double truth = head[1][0] * kRadPerDeg;
  const auto latitude = latitude_from_rest(mean, sigma);
  const auto alignment = coarse_align(mean, sigma, truth);
  ASSERT_TRUE(latitude.ok() && alignment.ok());
  const Mat3<double> C = alignment.value().q_nb.toRotationMatrix();
  const double heading = std::atan2(C(1, 0), C(0, 0)) / kRadPerDeg;
  const double heading_sigma = std::sqrt(alignment.value().covariance(2, 2)) / kRadPerDeg;
  std::printf(
      "[ FIGURE   ] ring laser, %.0f s at rest: heading %.3f +- %.3f deg (stated, inaccurate: %.2f), latitude "
      "%.3f +- %.3f deg (true %.3f), |w| %.4f deg/h\n",
      time, heading, heading_sigma, -head[0][2], latitude.value().latitude / kRadPerDeg,
      latitude.value().sigma / kRadPerDeg, head[1][0], latitude.value().earth_rate / kRadPerSPerDegPerH);
  EXPECT_NEAR(latitude.value().latitude, truth, 3.0 * latitude.value().sigma);
  EXPECT_NEAR(heading, -head[0][2], 3.0 * heading_sigma + 1.0);
  EXPECT_NEAR(latitude.value().earth_rate, kEarthRate, 3.0 * sigma.w);
}

}  // namespace
}  // namespace trunnion
