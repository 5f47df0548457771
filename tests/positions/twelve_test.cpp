// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/positions/twelve.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace trunnion {
namespace {

// The table of docs/theory/calibration.md, section 2: which case axis each position excites.
TEST(TwelvePositions, ExciteWhatTheTableSays) {
  const std::array<int, 12> expected = {3, -3, 2, -2, 1, -1, 3, -3, 2, -2, 1, -1};
  for (std::size_t i = 0; i < kTwelvePositions.size(); ++i) {
    const Position& position = kTwelvePositions[i];
    EXPECT_EQ(excited_axis(cyclic_mount(position.mount), position), expected[i]) << "position " << i + 1;
  }
}

TEST(TwelvePositions, MeetEachCaseAxisWithEachTableAxisBothWays) {
  std::map<int, std::set<int>> met;  // case axis -> table axes
  for (const Position& position : kTwelvePositions)
    met[excited_axis(cyclic_mount(position.mount), position)].insert(position.axis);
  for (const int axis : {-3, -2, -1, 1, 2, 3}) EXPECT_EQ(met[axis].size(), 2U) << axis;
}

TEST(CyclicMount, IsARotationAndThreeOfThemTheIdentity) {
  for (int mount = 0; mount < kMounts; ++mount) EXPECT_NEAR(cyclic_mount(mount).determinant(), 1.0, 1e-15);
  EXPECT_TRUE((cyclic_mount(1) * cyclic_mount(2)).isIdentity());
}

}  // namespace
}  // namespace trunnion
