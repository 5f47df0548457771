// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages of receivers to epochs: silent slaves, clocks that lie, logs that are played again.

#include <gtest/gtest.h>

#include "gnss_attitude/receivers.hpp"

namespace trunnion::app {
namespace {

class Bench {
 public:
  Bench()
      : receivers(2, {io::SignalName::parse("G1C")}, io::OrbitBook(), [this](const ArrayEpoch& epoch) {
          out.push_back(epoch);
          return true;
        }) {}
  void send(int antenna, double seconds, int week = 2320) {
    io::GnssRaw raw;
    raw.utime = static_cast<std::int64_t>(1e6 * seconds);
    raw.antenna = antenna;
    raw.epoch.time = {week, seconds};
    std::string message;
    io::encode_gnss_raw(raw, {}, message);
    io::LcmEvent event;
    event.data = message;
    ASSERT_TRUE(receivers.raw(event));
  }
  std::vector<ArrayEpoch> out;
  MessageReceivers receivers;
};

TEST(MessageReceivers, GivesAnEpochWhenAllHaveSpokenOrOneSpeaksOfALater) {
  Bench bench;
  bench.send(0, 1.0);
  EXPECT_TRUE(bench.out.empty()) << "the slave may still come";
  bench.send(1, 1.002);
  ASSERT_EQ(bench.out.size(), 1U);
  EXPECT_TRUE(bench.out[0].heard[1]);
  bench.send(1, 2.0);  // the slave first
  bench.send(0, 2.0);
  ASSERT_EQ(bench.out.size(), 2U);
  EXPECT_TRUE(bench.out[1].heard[1]);
  bench.send(0, 3.0);
  bench.send(0, 4.0);
  ASSERT_EQ(bench.out.size(), 3U) << "the slave has missed one";
  EXPECT_FALSE(bench.out[2].heard[1]);
  EXPECT_EQ(bench.out[2].utime, 3000000);
  bench.send(0, 4.0);
  EXPECT_EQ(bench.out.size(), 3U) << "twice the same is not a later one";
  EXPECT_TRUE(bench.receivers.finish());
  EXPECT_EQ(bench.out.size(), 4U);
}

TEST(MessageReceivers, IsNotSilencedByAClockThatLies) {
  Bench bench;
  for (int k = 1; k <= 100; ++k) {
    if (k == 10) bench.send(1, 11.0, 3344);  // the slave's week rolls over
    if (k == 50) bench.send(0, 51.0, 3344);  // and the master's
    bench.send(0, k);
    bench.send(1, k);
  }
  int whole = 0;
  for (const ArrayEpoch& epoch : bench.out) whole += epoch.heard[0] && epoch.heard[1];
  EXPECT_GE(whole, 98);
  EXPECT_EQ(bench.receivers.figures().warnings.size(), 1U) << "the master's step back";
}

TEST(MessageReceivers, BeginsAnewWhenALogIsPlayedAgain) {
  Bench bench;
  for (int pass = 0; pass < 2; ++pass) {
    for (int k = 1; k <= 30; ++k) {
      bench.send(0, k);
      bench.send(1, k);
    }
  }
  EXPECT_EQ(bench.out.size(), 60U);
  bench.send(7, 40.0);
  EXPECT_EQ(bench.receivers.strangers().count(7), 1U);
}

}  // namespace
}  // namespace trunnion::app
