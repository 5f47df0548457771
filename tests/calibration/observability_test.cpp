// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/observability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace trunnion::calibration {
namespace {

using testing::HasSubstr;

std::vector<Parameter> three() {
  return {{"a", Entry::kGyroScale, 1e-3, "ppm", 1e6},
          {"b", Entry::kGyroScale, 1e-3, "ppm", 1e6},
          {"c", Entry::kGyroBias, 1.0, "deg/h", 1.0}};
}

TEST(Judge, GivesTheInverseOfTheInformation) {
  Eigen::MatrixXd J(4, 3);
  J << 2e4, 1e3, 0.5, -1e3, 3e4, 0.1, 500, 20, 40, 3, 5, 70;
  const Eigen::MatrixXd A = J.transpose() * J;
  const Observability o = judge(A, three());
  EXPECT_TRUE((o.covariance * A).isApprox(Eigen::MatrixXd::Identity(3, 3), 1e-9));
  EXPECT_TRUE(o.refused.empty());
  EXPECT_EQ(describe(o), "");
}

// a and b are only known by their sum: both are refused, and the direction to blame is theirs alone.
TEST(Judge, NamesAnExactLossOfRank) {
  Eigen::MatrixXd J(2, 3);
  J << 1e5, 1e5, 0.0, 0.0, 0.0, 10.0;
  const Observability o = judge(J.transpose() * J, three());
  ASSERT_EQ(o.refused.size(), 2U);
  EXPECT_THAT(o.refused[0], HasSubstr("a: undetermined"));
  ASSERT_EQ(o.lost.size(), 1U);
  EXPECT_THAT(o.lost[0].entries, testing::UnorderedElementsAre("a", "b"));
}

// However well the rest is known, an exact loss of rank is never let through.
TEST(Judge, RefusesAnExactLossOfRankHoweverStrongTheRest) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Constant(3, 3, 0.0);
  A.topLeftCorner(2, 2).setConstant(1e30);
  A(2, 2) = 1e8;
  const Observability o = judge(A, three());
  ASSERT_EQ(o.refused.size(), 2U);
  EXPECT_THAT(o.refused[0], HasSubstr("a: undetermined"));
}

// No rank is lost, but a sigma passes its limit: refused with the sigma and the limit.
TEST(Judge, RefusesASigmaBeyondItsLimit) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3) * 1e8;
  A(2, 2) = 0.25;
  const Observability o = judge(A, three());
  ASSERT_EQ(o.refused.size(), 1U);
  EXPECT_EQ(o.refused[0], "c: 1 sigma 2 deg/h, limit 1 deg/h");
}

TEST(Judge, AParameterWithoutAnyInformationIsUndetermined) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3);
  A(0, 0) = A(1, 1) = 1e8;
  const Observability o = judge(A, three());
  ASSERT_EQ(o.refused.size(), 1U);
  EXPECT_THAT(o.refused[0], HasSubstr("c: undetermined"));
}

}  // namespace
}  // namespace trunnion::calibration
