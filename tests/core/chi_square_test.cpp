// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/chi_square.hpp"

#include <gtest/gtest.h>

namespace trunnion {
namespace {

/// Against the tables' upper thousandth.
TEST(ChiSquareQuantile, IsAsHighAsItSays) {
  struct Entry {
    double n, upper, most;
  };
  for (const Entry& e :
       {Entry{1, 10.828, 0.031}, Entry{3, 16.266, 0.020}, Entry{10, 29.588, 0.0065}, Entry{30, 59.703, 0.003}}) {
    const double high = chi_square_quantile(e.n, kOneInThousand) / e.upper - 1.0;
    EXPECT_GT(high, 0.0) << e.n;
    EXPECT_LT(high, e.most) << e.n;
  }
}

}  // namespace
}  // namespace trunnion
