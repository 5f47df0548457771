// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/error_model/channel_watch.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace trunnion {
namespace {

constexpr std::int32_t kRange = 32760;

/// Counts that move in every channel.
UnitOutput<std::int32_t> moving(int i) { return {i % 7, 100 - i % 5, -i % 11, i % 3, 2000 + i % 13, i % 17}; }

TEST(ChannelWatch, IsContentWithASensorThatMoves) {
  ChannelWatch watch(kRange, kRange, 400);
  for (int i = 0; i < 20000; ++i) ASSERT_EQ(watch.look(moving(i)), Status::kOk);
}

TEST(ChannelWatch, NamesTheSaturatedChannels) {
  ChannelWatch watch(kRange, 16000, 400);
  for (std::size_t channel = 0; channel < 6; ++channel) {
    const std::int32_t range = channel < 3 ? kRange : 16000;
    for (const std::int32_t reading : {range, -range, -range - 1, std::numeric_limits<std::int32_t>::max(),
                                       std::numeric_limits<std::int32_t>::min()}) {
      UnitOutput<std::int32_t> y = moving(1);
      y[channel] = reading;
      EXPECT_EQ(watch.look(y), Status::kSaturated);
      EXPECT_EQ(watch.saturated(), 1U << channel);
    }
    for (const std::int32_t within : {range - 1, 1 - range}) {
      UnitOutput<std::int32_t> y = moving(1);
      y[channel] = within;
      EXPECT_EQ(watch.look(y), Status::kOk);
    }
  }
}

// Said after stuck_samples and not long before, for that channel alone, and taken back when it moves again.
TEST(ChannelWatch, NamesAStuckChannel) {
  for (std::size_t channel = 0; channel < 6; ++channel) {
    ChannelWatch watch(kRange, kRange, 400);
    int said = -1;
    for (int i = 0; i < 1000 && said < 0; ++i) {
      UnitOutput<std::int32_t> y = moving(i);
      y[channel] = 77;
      if (watch.look(y) == Status::kStuck) said = i;
    }
    EXPECT_GE(said, 400 - 16) << channel;
    EXPECT_LE(said, 400 + 32) << channel;
    EXPECT_EQ(watch.stuck(), 1U << channel);
    for (int i = 0; i < 16; ++i) (void)watch.look(moving(i));
    EXPECT_EQ(watch.look(moving(3)), Status::kOk);
  }
}

}  // namespace
}  // namespace trunnion
