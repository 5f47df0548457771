// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// EXPECT_REFUSES(code, what, statement): the statement throws an Error with this exit code whose message holds the
/// text.

#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "trunnion/core/error.hpp"

#define EXPECT_REFUSES(exit_code, what_text, ...)                 \
  try {                                                           \
    __VA_ARGS__;                                                  \
    ADD_FAILURE() << "not refused";                               \
  } catch (const ::trunnion::Error& refusal) {                    \
    EXPECT_EQ(refusal.code(), exit_code) << refusal.what();       \
    EXPECT_THAT(refusal.what(), ::testing::HasSubstr(what_text)); \
  }
