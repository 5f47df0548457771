// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/gps_time.hpp"

#include <gtest/gtest.h>

namespace trunnion {
namespace {

TEST(GpsTime, SumsStayWithinTheWeek) {
  for (const double s : {-1e6, -604800.0, -0.5, 0.0, 0.5, 604799.5, 1e6}) {
    const GpsTime start{2200, 300.0};
    const GpsTime end = start + s;
    EXPECT_EQ(end - start, s);
    EXPECT_GE(end.seconds, 0.0);
    EXPECT_LT(end.seconds, kSecondsPerWeek);
  }
  EXPECT_EQ((GpsTime{5, 1.0} + 1e30).week, 5) << "no week of an int";
}

TEST(GpsTime, OnTheClockOfComputers) {
  EXPECT_EQ(utime_of({0, 0.0}), 315964800000000) << "1980-01-06";
  EXPECT_EQ(utime_of({2086, 259218.0}), 1577836818000000) << "2020-01-01 in UTC, and 18 leap seconds";
  EXPECT_EQ(utime_of({2086, 0.1234567}) - utime_of({2086, 0.0}), 123457);
  EXPECT_EQ(utime_of(GpsTime{2086, 604799.0} + 1.0), utime_of({2087, 0.0}));
}

}  // namespace
}  // namespace trunnion
