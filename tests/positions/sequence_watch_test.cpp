// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/positions/sequence_watch.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace trunnion {
namespace {

TEST(SequenceWatch, CountsWhatIsMissing) {
  SequenceWatch watch;
  for (const std::int64_t n : {100, 101, 104, 105, 110}) EXPECT_TRUE(watch.add(n));
  EXPECT_EQ(watch.received(), 5);
  EXPECT_EQ(watch.lost(), 6);
  EXPECT_EQ(watch.late(), 0);
}

TEST(SequenceWatch, CountsBatchesByTheirSamples) {
  SequenceWatch watch;
  watch.add(0, 8);
  watch.add(8, 8);
  watch.add(24, 4);
  watch.add(28, 8);
  EXPECT_EQ(watch.received(), 28);
  EXPECT_EQ(watch.lost(), 8);
}

TEST(SequenceWatch, ARepeatIsNotNew) {
  SequenceWatch watch;
  watch.add(5);
  EXPECT_FALSE(watch.add(5));
  EXPECT_TRUE(watch.add(6));
  EXPECT_FALSE(watch.add(4));
  EXPECT_TRUE(watch.add(7));
  EXPECT_EQ(watch.late(), 2);
  EXPECT_EQ(watch.lost(), 0);
  EXPECT_EQ(watch.restarts(), 0);
}

TEST(SequenceWatch, APublisherThatBeganAgainIsFollowed) {
  SequenceWatch watch;
  for (int n = 500; n < 600; ++n) watch.add(n);
  for (int n = 0; n < 50; ++n) watch.add(n);
  EXPECT_EQ(watch.restarts(), 1);
  EXPECT_EQ(watch.lost(), 0);
  EXPECT_EQ(watch.received(), 149);  // the first of the new ones was not known for one yet
  EXPECT_FALSE(watch.two_publishers());
}

TEST(SequenceWatch, TwoPublishersAreTold) {
  SequenceWatch watch;
  for (int n = 0; n < 20; ++n) {
    watch.add(1000 + n);
    watch.add(n);
  }
  EXPECT_TRUE(watch.two_publishers());
  EXPECT_EQ(watch.restarts(), 0);
  SequenceWatch other;
  for (int n = 0; n < 20; ++n) {
    other.add(n);
    other.add(1000 + n);
  }
  EXPECT_TRUE(other.two_publishers());
}

TEST(SequenceWatch, ChannelsWithoutNumbersAreTold) {
  SequenceWatch watch;
  for (int i = 0; i < 10; ++i) watch.add(0);
  EXPECT_FALSE(watch.numbered());
  EXPECT_EQ(watch.lost(), 0);
}

TEST(SequenceWatch, TakesAnyNumber) {
  using Limits = std::numeric_limits<std::int64_t>;
  SequenceWatch watch;
  for (const std::int64_t n :
       {Limits::max(), Limits::min(), std::int64_t{0}, Limits::max(), std::int64_t{-1}, Limits::min()})
    watch.add(n, 8);
  EXPECT_LT(watch.lost(), SequenceWatch::kLongestGap);
}

}  // namespace
}  // namespace trunnion
