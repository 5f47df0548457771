// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/fault.hpp"

#include <gtest/gtest.h>

namespace trunnion::io {
namespace {

TEST(Printable, KeepsTextAndNothingElse) {
  EXPECT_EQ(printable("/imu µ"), "/imu µ");
  EXPECT_EQ(printable("a\x1b[31m\n\x7f"), "a?[31m??");
  EXPECT_EQ(printable("Gr\xfc\xdf"), "Gr??") << "Latin-1";
  EXPECT_EQ(printable("\xe2\x82"), "??") << "cut within a character";
}

}  // namespace
}  // namespace trunnion::io
