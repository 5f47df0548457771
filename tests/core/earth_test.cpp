// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/earth.hpp"

#include <gtest/gtest.h>

#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

// NIMA TR8350.2, table 3.4: normal gravity at the equator and at the pole.
TEST(NormalGravity, MeetsThePublishedConstants) {
  EXPECT_NEAR(normal_gravity(0.0, 0.0), 9.7803253359, 1e-10);
  EXPECT_NEAR(normal_gravity(0.5 * kPi, 0.0), 9.8321849378, 1e-9);
}

TEST(NormalGravity, FallsByTheFreeAirGradient) {
  EXPECT_NEAR(normal_gravity(0.7, 1000.0) - normal_gravity(0.7, 0.0), -3.086e-3, 5e-6);
}

TEST(EarthRate, IsOfOneLengthAndPointsNorthAndUp) {
  for (const double latitude : {-1.5, -0.3, 0.0, 0.7, 1.5}) {
    const Vec3<double> w = earth_rate_enu(latitude);
    EXPECT_NEAR(w.norm(), kEarthRate, 1e-19);
    EXPECT_EQ(w.x(), 0.0);
    EXPECT_GT(w.y(), 0.0);
    EXPECT_EQ(w.z() > 0.0, latitude > 0.0);
  }
}

}  // namespace
}  // namespace trunnion
