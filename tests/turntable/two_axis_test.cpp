// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/turntable/two_axis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

constexpr double kLatitude = 0.766;
constexpr double kGravity = 9.805;

/// A rig with nothing special about it: skewed axes, tilted frames, an offset pitch joint.
TwoAxisGeometry odd_rig() {
  const Mat3<double> C_ta = rotation_exp<double>(Vec3<double>(0.3, -0.2, 0.5));
  const Mat3<double> C_ap = rotation_exp<double>(Vec3<double>(-0.1, 0.7, 0.2));
  const Vec3<double> outer = Vec3<double>(0.2, -0.3, 0.9).normalized();
  const Vec3<double> inner = Vec3<double>(0.1, 0.95, 0.2).normalized();
  return TwoAxisGeometry::from_chain(C_ta, outer, C_ap, Vec3<double>(0.05, -0.02, 0.2), inner).value();
}

TwoAxisErrors<double> odd_errors() {
  TwoAxisErrors<double> errors;
  errors.tilt_x = 1e-3;
  errors.tilt_y = -2e-3;
  errors.heading = 1.1;
  errors.nonorthogonality = 3e-3;
  errors.eccentricity[0] = {2e-4, -1e-4};
  errors.eccentricity[1] = {-1e-4, 3e-4};
  return errors;
}

AxisMotion<double> azimuth_at(double t) {
  return {0.4 + 0.8 * t + 0.1 * std::sin(2 * t), 0.8 + 0.2 * std::cos(2 * t), -0.4 * std::sin(2 * t)};
}
AxisMotion<double> pitch_at(double t) { return {0.3 + 0.5 * std::sin(t), 0.5 * std::cos(t), -0.5 * std::sin(t)}; }

/// Readings of the true motion, with derivatives by the chain rule.
AxisMotion<double> reading_of(const EncoderEccentricity<double>& e, const AxisMotion<double>& m) {
  const double s = std::sin(m.angle);
  const double c = std::cos(m.angle);
  const double slope = 1.0 - e.cosine * s + e.sine * c;
  return {e.distort(m.angle), slope * m.rate, slope * m.acceleration - (e.cosine * c + e.sine * s) * m.rate * m.rate};
}

TEST(EncoderEccentricity, CorrectUndoesDistortWithItsDerivatives) {
  const EncoderEccentricity<double> e{2e-4, -3e-4};
  for (double t = 0.0; t < 10.0; t += 0.37) {
    const AxisMotion<double> m = azimuth_at(t);
    const AxisMotion<double> back = e.correct(reading_of(e, m));
    EXPECT_NEAR(back.angle, m.angle, 1e-10);  // (c^2 + s^2)^(3/2) = 5e-11
    EXPECT_NEAR(back.rate, m.rate, 1e-9);
    EXPECT_NEAR(back.acceleration, m.acceleration, 1e-9);
  }
}

// The rate model against differences of attitude: two routes to one quantity. The step is 1e-4 s, so a central
// difference errs by h^2/6 of the third derivative, some 1e-8.
TEST(TwoAxisTable, RateIsTheDerivativeOfAttitude) {
  const TwoAxisTable<double> table(odd_rig(), odd_errors(), kLatitude, kGravity);
  const Vec3<double> w_ie_u = earth_rate_enu(kLatitude);
  constexpr double h = 1e-4;
  for (double t = 0.0; t < 5.0; t += 0.31) {
    const TwoAxisErrors<double> errors = odd_errors();
    const auto attitude = [&](double s) {
      return Mat3<double>(rotation_exp<double>(w_ie_u * s) * table.attitude(azimuth_at(s).angle, pitch_at(s).angle));
    };
    const Quaternion<double> step(Mat3<double>(attitude(t - h).transpose() * attitude(t + h)));
    const Vec3<double> w = quaternion_log<double>(step) / (2.0 * h);
    const InertialSample<double> input =
        table.input(reading_of(errors.eccentricity[0], azimuth_at(t)), reading_of(errors.eccentricity[1], pitch_at(t)),
                    Vec3<double>::Zero());
    EXPECT_LT((input.w - w).norm(), 5e-8) << t;
  }
}

// Specific force against second differences of position in inertial space, with lever arm and joint offset.
TEST(TwoAxisTable, ForceIsTheSecondDerivativeOfPosition) {
  const TwoAxisTable<double> table(odd_rig(), odd_errors(), kLatitude, kGravity);
  const Vec3<double> w_ie_u = earth_rate_enu(kLatitude);
  const Vec3<double> lever(0.03, -0.02, 0.05);
  constexpr double h = 1e-3;
  for (double t = 0.0; t < 5.0; t += 0.31) {
    const TwoAxisErrors<double> errors = odd_errors();
    const auto position = [&](double s) {
      return Vec3<double>(rotation_exp<double>(w_ie_u * s) *
                          table.position(azimuth_at(s).angle, pitch_at(s).angle, lever));
    };
    const Vec3<double> r_ddot = (position(t + h) - 2.0 * position(t) + position(t - h)) / (h * h);
    const Mat3<double> C_ip = rotation_exp<double>(w_ie_u * t) * table.attitude(azimuth_at(t).angle, pitch_at(t).angle);
    const Vec3<double> up_i = rotation_exp<double>(w_ie_u * t) * Vec3<double>::UnitZ();
    const Vec3<double> f = C_ip.transpose() * (r_ddot + kGravity * up_i);
    const InertialSample<double> input = table.input(reading_of(errors.eccentricity[0], azimuth_at(t)),
                                                     reading_of(errors.eccentricity[1], pitch_at(t)), lever);
    EXPECT_LT((input.f - f).norm(), 5e-7) << t;
  }
}

// Gravity is that on the azimuth axis, so the point is put there: elsewhere the Earth's turning adds 5e-9 a metre.
TEST(TwoAxisTable, AtRestItFeelsGravityAndTheEarth) {
  TwoAxisGeometry rig = odd_rig();
  rig.pitch_joint_o.setZero();
  const TwoAxisTable<double> table(rig, odd_errors(), kLatitude, kGravity);
  const InertialSample<double> input = table.input({1.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, Vec3<double>::Zero());
  EXPECT_NEAR(input.f.norm(), kGravity, 1e-13);
  EXPECT_NEAR(input.w.norm(), kEarthRate, 1e-18);
}

// Frames of docs/reference/notation.md: a level rig with axes z and y has canonical stages equal to its links.
TEST(TwoAxisGeometry, OfAxesZAndYIsTheIdentity) {
  const Result<TwoAxisGeometry> rig =
      TwoAxisGeometry::from_chain(Mat3<double>::Identity(), Vec3<double>::UnitZ(), Mat3<double>::Identity(),
                                  Vec3<double>::Zero(), Vec3<double>::UnitY());
  ASSERT_TRUE(rig.ok());
  EXPECT_TRUE(rig.value().C_to.isIdentity(1e-15));
  EXPECT_TRUE(rig.value().C_qp.isIdentity(1e-15));
  EXPECT_NEAR(rig.value().nonorthogonality, 0.0, 1e-15);
}

TEST(TwoAxisGeometry, RefusesParallelAxes) {
  const auto rig =
      TwoAxisGeometry::from_chain(Mat3<double>::Identity(), Vec3<double>::UnitZ(), Mat3<double>::Identity(),
                                  Vec3<double>::Zero(), Vec3<double>(0.05, 0.0, 1.0).normalized());
  EXPECT_EQ(rig.status(), Status::kNotObservable);
}

// Non-orthogonality turns the pitch axis about (pitch axis x azimuth axis), here x: towards the azimuth axis.
TEST(TwoAxisTable, NonorthogonalityLeansThePitchAxisTowardsTheAzimuthAxis) {
  TwoAxisErrors<double> errors;
  errors.nonorthogonality = 0.01;
  const TwoAxisTable<double> table(TwoAxisGeometry{}, errors, kLatitude, kGravity);
  const Vec3<double> pitch_axis_u = table.attitude(0.0, 0.4) * Vec3<double>::UnitY();
  EXPECT_NEAR(pitch_axis_u.z(), std::sin(0.01), 1e-15);
  EXPECT_NEAR(pitch_axis_u.x(), 0.0, 1e-15);
}

}  // namespace
}  // namespace trunnion
