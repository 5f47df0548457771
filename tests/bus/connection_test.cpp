// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/bus/connection.hpp"
#include "matchers/log_request.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/bus/replay.hpp"
#include "trunnion/calibration/compress.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::bus {
namespace {

constexpr const char* kMemory = "memq://";

struct Received {
  void take(const io::LcmEvent& event) {
    channels.emplace_back(event.channel);
    data.emplace_back(event.data);
    numbers.push_back(event.number);
    stamps.push_back(event.timestamp);
    EXPECT_EQ(event.byte, -1);
  }
  std::vector<std::string> channels;
  std::vector<std::string> data;
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> stamps;
};

TEST(Connection, DeliversWhatIsPublishedToMemberFunctions) {
  Connection bus(kMemory);
  Received received;
  bus.subscribe("A", &Received::take, received);
  for (int i = 0; i < 1000; ++i) bus.publish("A", std::string(1, static_cast<char>('a' + i % 26)));
  while (bus.handle(0)) continue;
  ASSERT_EQ(received.data.size(), 1000U);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(received.numbers[static_cast<std::size_t>(i)], i);
    EXPECT_EQ(received.data[static_cast<std::size_t>(i)], std::string(1, static_cast<char>('a' + i % 26)));
  }
  EXPECT_GT(received.stamps.front(), 1600000000000000);
}

TEST(Connection, AChannelIsItsNameAndNoPattern) {
  Connection bus(kMemory);
  Received received;
  for (const char* channel : {"IMU.1", "a+b", "x#sensor_msgs.Imu", "(y)", "[z]", "a|b", "^$", "\\d"})
    bus.subscribe(channel, &Received::take, received);
  for (const char* channel :
       {"IMU.1", "IMU_1", "aab", "a+b", "x#sensor_msgs.Imu", "y", "(y)", "z", "[z]", "a", "a|b", "^$", "", "\\d", "3"})
    bus.publish(channel, "m");
  while (bus.handle(0)) continue;
  EXPECT_EQ(received.channels,
            (std::vector<std::string>{"IMU.1", "a+b", "x#sensor_msgs.Imu", "(y)", "[z]", "a|b", "^$", "\\d"}));
}

TEST(Connection, WhatAHandlerThrowsLeavesHandle) {
  Connection bus(kMemory);
  int calls = 0;
  bus.subscribe("A", [&](const io::LcmEvent&) {
    ++calls;
    if (calls == 2) throw Error(ExitCode::kInput, "from the handler");
  });
  for (int i = 0; i < 3; ++i) bus.publish("A", "m");
  EXPECT_TRUE(bus.handle(0));
  EXPECT_REFUSES(ExitCode::kInput, "from the handler", bus.handle(0));
  EXPECT_TRUE(bus.handle(0));
  EXPECT_FALSE(bus.handle(0));
  EXPECT_EQ(calls, 3);
}

TEST(Connection, RefusesAddressesThatWouldGoSomewhereElse) {
  EXPECT_REFUSES(ExitCode::kTransport, "'no.such.host' should be an address like 127.0.0.1",
                 Connection("tcpq://no.such.host:7712"));
  EXPECT_REFUSES(ExitCode::kTransport, "'localhost' should be an address", Connection("tcpq://localhost"));
  EXPECT_REFUSES(ExitCode::kTransport, "no connection", Connection("gopher://"));
  EXPECT_REFUSES(ExitCode::kTransport, "tcpq://127.0.0.1:1: no", Connection("tcpq://127.0.0.1:1"));
}

TEST(Connection, SaysWhetherItDrops) { EXPECT_TRUE(Connection(kMemory).lossless()); }

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() {
    io::LcmLogWriter log(path_);
    std::string message;
    for (int i = 0; i < 400; ++i) {
      io::encode_imu(1000000 + 2500 * i, i, {Vec3<double>(0.01 * i, 1, 2), Vec3<double>(3, 4, 9.8)}, message);
      log.write(1000000 + 2500 * i, "IMU", message);
      if (i % 2 != 0) continue;
      io::encode_encoder(1000000 + 2500 * i, i / 2, 0.001 * i, 0.5, message);
      log.write(1000000 + 2500 * i, "ENCODER", message);
    }
    log.commit();
  }
  TemporaryFolder folder_;
  std::string path_ = folder_ / "a.lcm";
};

// A golden log through the bus is the log: windows and encoder course are the same to the last bit.
TEST_F(ReplayTest, ThroughTheBusALogIsWhatItIsInTheFile) {
  const auto window_bits = [](const calibration::CompressedRecording& r) {
    std::vector<double> bits;
    for (const ObservationWindow& w : r.windows) {
      bits.push_back(w.t);
      for (int i = 0; i < 3; ++i) bits.insert(bits.end(), {w.mean.w(i), w.mean.f(i)});
      bits.insert(bits.end(), w.weight.begin(), w.weight.end());
    }
    for (double t = r.course.begin(); t < r.course.end(); t += 0.01) bits.push_back(r.course.at(t)[0].angle);
    return bits;
  };
  calibration::Compressor from_file({});
  io::read_lcm_recording(io::log_request(path_, {}, true), from_file);

  Connection bus(kMemory);
  calibration::Compressor from_bus({});
  io::LcmDecoder decoder(bus.url(), from_bus);
  bus.subscribe("IMU", &io::LcmDecoder::imu, decoder);
  bus.subscribe("ENCODER", &io::LcmDecoder::encoder, decoder);
  io::LcmLogReader log(path_);
  ReplayOptions options;
  options.speed = 0.0;
  options.published = [&](const io::LcmEvent&) {
    while (bus.handle(0)) continue;
  };
  const ReplayFigures figures = replay(log, bus, options);
  EXPECT_EQ(figures.messages, 600);
  EXPECT_NEAR(figures.duration, 0.9975, 1e-9);
  EXPECT_EQ(decoder.imu_sequence().lost(), 0);
  EXPECT_EQ(window_bits(from_bus.finish()), window_bits(from_file.finish()));
}

TEST_F(ReplayTest, PlaysThePartAndTheChannelsThatAreChosen) {
  Connection bus(kMemory);
  Received received;
  bus.subscribe("IMU", &Received::take, received);
  bus.subscribe("ENCODER", &Received::take, received);
  io::LcmLogReader log(path_);
  ReplayOptions options;
  options.speed = 0.0;
  options.start = 0.5;
  options.end = 0.75;
  options.chosen = [](std::string_view channel) { return channel == "ENCODER"; };
  EXPECT_EQ(replay(log, bus, options).messages, 51);
  while (bus.handle(0)) continue;
  EXPECT_EQ(received.channels, std::vector<std::string>(51, "ENCODER"));
}

TEST_F(ReplayTest, EndsInAPauseWhenItIsTold) {
  io::LcmLogWriter gap(folder_ / "gap.lcm");
  gap.write(0, "A", "m");
  gap.write(std::numeric_limits<std::int64_t>::max(), "A", "m");  // in 292,000 years
  gap.commit();
  Connection bus(kMemory);
  io::LcmLogReader log(folder_ / "gap.lcm");
  ReplayOptions options;
  int asked = 0;
  options.goes_on = [&] { return ++asked < 3; };
  EXPECT_EQ(replay(log, bus, options).messages, 1);
}

TEST_F(ReplayTest, KeepsThePace) {
  Connection bus(kMemory);
  io::LcmLogReader log(path_);
  ReplayOptions options;
  options.speed = 4.0;
  const auto begin = std::chrono::steady_clock::now();
  replay(log, bus, options);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(took, 0.9975 / 4.0);  // never early; a busy machine may be late
}

}  // namespace
}  // namespace trunnion::bus
