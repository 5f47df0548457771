// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/rotation.hpp"

#include <gtest/gtest.h>

#include <random>

#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

Vec3<double> any_vector(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = uniform(rng);
  const double y = uniform(rng);
  const double z = uniform(rng);
  return {x, y, z};
}

// The law of (2): half a turn twice is a whole one, for every direction.
TEST(QuaternionExp, HalfATurnTwiceIsAFullTurn) {
  std::mt19937_64 rng(20260801);
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> phi = kPi * any_vector(rng).normalized();
    const Quaternion<double> twice = quaternion_exp<double>(phi) * quaternion_exp<double>(phi);
    EXPECT_NEAR(std::abs(twice.w()), 1.0, 1e-14);
  }
}

// Log undoes Exp below pi, also where the series takes over: 1e-12 of the length, both sides of the switch.
TEST(QuaternionLog, UndoesExp) {
  std::mt19937_64 rng(20260802);
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> phi = any_vector(rng) * std::pow(10.0, -(i % 12)) * 1.8;
    EXPECT_LT((quaternion_log<double>(quaternion_exp<double>(phi)) - phi).norm(), 2e-15 + 1e-13 * phi.norm())
        << phi.transpose();
  }
}

TEST(RotationExp, IsOrthonormalAndFollowsRodrigues) {
  std::mt19937_64 rng(20260803);
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> phi = any_vector(rng);
    const Mat3<double> C = rotation_exp<double>(phi);
    EXPECT_LT((C * C.transpose() - Mat3<double>::Identity()).norm(), 1e-14);
    const double theta = phi.norm();
    const Mat3<double> K = skew<double>(phi / theta);
    EXPECT_LT((C - (Mat3<double>::Identity() + std::sin(theta) * K + (1.0 - std::cos(theta)) * K * K)).norm(), 1e-14);
  }
}

TEST(RightJacobian, AgreesWithDifferences) {
  std::mt19937_64 rng(20260805);
  for (int i = 0; i < 300; ++i) {
    const Vec3<double> phi = std::pow(10.0, -(i % 8)) * any_vector(rng);
    const Mat3<double> J = right_jacobian(phi);
    constexpr double kStep = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3<double> d = kStep * Vec3<double>::Unit(axis);
      const Quaternion<double> from = quaternion_exp<double>(phi - d);
      const Quaternion<double> to = quaternion_exp<double>(phi + d);
      EXPECT_LT((quaternion_log<double>(from.conjugate() * to) / (2.0 * kStep) - J.col(axis)).norm(), 1e-9);
    }
  }
}

TEST(EulerAngles, ComeBackWhereTheyAreUnique) {
  std::mt19937_64 rng(20260806);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> angles(3.14 * any(rng), 1.57 * any(rng), 3.14 * any(rng));
    EXPECT_LT((euler_angles(quaternion_of_euler(angles.x(), angles.y(), angles.z())) - angles).norm(), 1e-10);
  }
  // straight up and down: finite, and the same attitude
  for (const double pitch : {1.5707963267948966, -1.5707963267948966}) {
    const Quaternion<double> q = quaternion_of_euler(0.3, pitch, 1.0);
    const Vec3<double> angles = euler_angles(q);
    ASSERT_TRUE(angles.allFinite());
    EXPECT_NEAR(angles.y(), pitch, 1e-7);
    const Quaternion<double> back = quaternion_of_euler(angles.x(), angles.y(), angles.z());
    EXPECT_LT(quaternion_log<double>(back.conjugate() * q).norm(), 1e-7);
  }
}

TEST(Turn, AgreesWithTheMatrixAboutEachAxis) {
  std::mt19937_64 rng(20260804);
  for (int i = 0; i < 100; ++i) {
    const double angle = 3.0 * any_vector(rng).x();
    const Vec3<double> v = any_vector(rng);
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    EXPECT_LT((turn_about_x<double>(s, c, v) - rotation_exp<double>(Vec3<double>(angle, 0, 0)) * v).norm(), 1e-15 * 8);
    EXPECT_LT((turn_about_y<double>(s, c, v) - rotation_exp<double>(Vec3<double>(0, angle, 0)) * v).norm(), 1e-15 * 8);
    EXPECT_LT((turn_about_z<double>(s, c, v) - rotation_exp<double>(Vec3<double>(0, 0, angle)) * v).norm(), 1e-15 * 8);
  }
}

}  // namespace
}  // namespace trunnion
