// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/core/error.hpp"

#include <gtest/gtest.h>

#include <string>

namespace trunnion {
namespace {

TEST(Error, KeepsItsCodeAndItsWordsThroughItsBase) {
  for (const ExitCode code : {ExitCode::kUsage, ExitCode::kInput, ExitCode::kDefect}) {
    try {
      throw Error(code, std::string("run.yaml:3: mounts: ") + "is empty");
    } catch (const std::exception& base) {
      const auto* error = dynamic_cast<const Error*>(&base);
      ASSERT_NE(error, nullptr);
      EXPECT_EQ(error->code(), code);
      EXPECT_STREQ(base.what(), "run.yaml:3: mounts: is empty");
    }
  }
}

}  // namespace
}  // namespace trunnion
