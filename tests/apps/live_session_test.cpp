// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a live session notices, and that it goes on: every kind of bad input on its bus.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include "live_bench.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::app {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kUtime = 8;  // where stamps and numbers stand in imu_t and encoder_t
constexpr std::size_t kSequence = 16;

std::int64_t number_at(const std::string& message, std::size_t at) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < 8; ++i) v = v << 8U | static_cast<unsigned char>(message[at + i]);
  return static_cast<std::int64_t>(v);
}

void put(std::string& message, std::size_t at, std::int64_t value) {
  for (std::size_t i = 0; i < 8; ++i)
    message[at + i] =
        static_cast<char>(static_cast<std::uint64_t>(value) >> (56U - 8U * static_cast<unsigned>(i)) & 0xffU);
}

class LiveSession : public testing::Test {
 protected:
  /// The first 100 s of a mount: rests, and the first turns.
  static const std::vector<BusMessage>& first_minutes(int mount) {
    static const LiveBench bench(1);
    static std::array<std::vector<BusMessage>, 3> messages;
    auto& m = messages[static_cast<std::size_t>(mount)];
    if (m.empty()) m = bench.messages(mount, 150.0);
    return m;
  }
  static std::vector<BusMessage> part(int mount, double from, double to) {
    const auto& all = first_minutes(mount);
    const auto at = [&](double t) {
      return all.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(all.size()) * std::min(1.0, t / 150.0));
    };
    return {at(from), at(to)};
  }
  static long long imu_messages(const std::vector<BusMessage>& messages) {
    return std::count_if(messages.begin(), messages.end(), [](const BusMessage& m) { return m.channel == "IMU"; });
  }
  /// Changes every IMU message.
  template <class Change>
  static std::vector<BusMessage> changed(std::vector<BusMessage> messages, Change&& change) {
    for (BusMessage& m : messages) {
      if (m.channel == "IMU") change(m.data);
    }
    return messages;
  }

  LiveBench bench_{1};
};

TEST_F(LiveSession, WaitsForTheOperatorAndLeadsThroughTheMounts) {
  LiveRun live(bench_);
  EXPECT_EQ(live.state.copy().phase, Phase::kWaiting);
  EXPECT_EQ(live.state.copy().guidance, "change to mount_1, press Enter");
  live.publish(part(0, 0.0, 1.0));  // nobody said that it is in place: not recorded
  live.press();
  EXPECT_EQ(live.state.copy().phase, Phase::kRecording);
  live.publish(part(0, 1.0, 20.0));
  live.idle(1.2);
  const LiveState s = live.state.copy();
  EXPECT_THAT(s.guidance, HasSubstr("rest with the pitch between"));
  EXPECT_GT(s.steps.at(0).seen, 5.0);
  EXPECT_FALSE(s.entries.empty());
  EXPECT_NEAR(s.duration, 19.0, 0.1);
  EXPECT_TRUE(live.press());
  EXPECT_EQ(live.state.copy().guidance, "change to mount_2, press Enter");
  EXPECT_THAT(live.notices(),
              HasSubstr("mount_1 is recorded: 7600 samples, 0 lost on the way, 0 missing between their stamps"));
}

TEST_F(LiveSession, AKilledSessionGoesOnToTheSameBits) {
  std::string unbroken;
  {
    LiveBench other(1);
    LiveRun live(other);
    live.press();
    live.publish(part(0, 0.0, 60.0));
    live.press();
    unbroken = io::read_whole(other.folder / "1.lcm");
  }
  {
    LiveRun live(bench_);
    live.press();
    live.publish(part(0, 0.0, 30.0));
    live.idle(0.1);
  }
  const std::string journal = io::LcmJournal::part_of(bench_.folder / "1.lcm");
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 13);  // the last record was cut off
  LiveRun live(bench_);
  EXPECT_EQ(live.state.copy().phase, Phase::kRecording);
  EXPECT_THAT(live.notices(), HasSubstr("going on with mount_1"));
  std::vector<BusMessage> rest = part(0, 0.0, 60.0);
  rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(part(0, 0.0, 30.0).size() - 1));
  live.publish(rest);
  live.press();
  // the times of arrival are others: what was measured is the same
  const auto content = [&](const std::string& name) {
    io::LcmLogReader log(name);
    io::LcmEvent event;
    std::string all;
    while (log.next(event)) all.append(event.channel).append(event.data);
    return all;
  };
  const TemporaryFolder folder;
  EXPECT_EQ(content(bench_.folder / "1.lcm"), content(folder.file("unbroken.lcm", unbroken)));
}

TEST_F(LiveSession, WhatIsRecordedAlreadyIsUsed) {
  {
    LiveRun live(bench_);
    live.press();
    live.publish(part(0, 0.0, 30.0));
    live.press();
  }
  LiveRun live(bench_);
  EXPECT_THAT(live.notices(), HasSubstr("1.lcm is recorded already and is used"));
  EXPECT_EQ(live.state.copy().guidance, "change to mount_2, press Enter");
  EXPECT_EQ(live.session.recordings().size(), 1U);
}

TEST_F(LiveSession, LeavesOutWhatIsMalformedForeignOrNoNumber) {
  std::vector<BusMessage> messages = part(0, 0.0, 10.0);
  std::string cut = messages[100].data;
  cut.resize(40);
  messages.insert(messages.begin() + 100, {"IMU", cut});
  messages.insert(messages.begin() + 200, {"IMU", "hello, this is no LCM message"});
  messages.insert(messages.begin() + 300, {"ENCODER", ""});
  std::string nan = messages[400].channel == "IMU" ? messages[400].data : messages[401].data;
  nan.replace(24, 8, std::string("\x7f\xf8\0\0\0\0\0\0", 8));
  messages.insert(messages.begin() + 400, {"IMU", nan});
  std::string other = nan;
  other[3] = static_cast<char>(other[3] ^ 0x40);  // the fingerprint of another version
  messages.insert(messages.begin() + 500, {"IMU", other});
  LiveRun live(bench_);
  live.press();
  live.publish(messages);
  live.idle(0.7);
  EXPECT_EQ(live.state.copy().imu.damaged, 4);
  EXPECT_EQ(live.state.copy().encoder.damaged, 1);
  EXPECT_THAT(live.notices(), HasSubstr("a message is left out: "));
  live.press();
  // the recording has none of it, so solve has nothing to refuse
  RunInputs inputs;
  io::RunFile one = bench_.run;
  one.recordings.resize(1);
  EXPECT_EQ(read_table_recordings(one, bench_.mounts, inputs).at(0).data.figures.samples,
            imu_messages(part(0, 0.0, 10.0)));
}

TEST_F(LiveSession, NoticesAPublisherThatDiedAndCameBack) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 20.0));
  std::int64_t n = 0;
  live.publish(changed(part(0, 20.5, 30.0), [&](std::string& m) { put(m, kSequence, n++); }));
  live.idle(0.1);
  EXPECT_THAT(live.notices(), HasSubstr("the unit's publisher began again"));
  EXPECT_THAT(live.notices(), Not(HasSubstr("two publishers")));
}

TEST_F(LiveSession, NoticesTwoPublishersOnOneChannel) {
  LiveRun live(bench_);
  live.press();
  std::vector<BusMessage> messages = part(0, 0.0, 10.0);
  live.publish(messages);
  std::vector<BusMessage> both;
  for (const BusMessage& m : part(0, 10.0, 12.0)) {
    both.push_back(m);
    if (m.channel != "IMU") continue;
    both.push_back(m);
    put(both.back().data, kSequence, number_at(m.data, kSequence) + 50000000);
  }
  live.publish(both);
  live.idle(0.1);
  EXPECT_THAT(live.notices(), HasSubstr("two publishers on channel IMU"));
}

TEST_F(LiveSession, TwoPublishersFromTheStartAreRefused) {
  LiveRun live(bench_);
  live.press();
  std::vector<BusMessage> both;
  for (const BusMessage& m : part(0, 0.0, 2.0)) {
    both.push_back(m);
    if (m.channel != "IMU") continue;
    both.push_back(m);
    put(both.back().data, kUtime, number_at(m.data, kUtime) + 60);
  }
  EXPECT_REFUSES(ExitCode::kInput, "do two units publish on one channel", live.publish(both));
}

TEST_F(LiveSession, LossesAreCountedAndSaid) {
  LiveRun live(bench_);
  live.press();
  std::vector<BusMessage> messages = part(0, 0.0, 20.0);
  int n = 0;
  messages.erase(std::remove_if(messages.begin(), messages.end(),
                                [&](const BusMessage& m) { return m.channel == "IMU" && ++n % 100 == 0; }),
                 messages.end());
  live.publish(messages);
  live.idle(0.7);
  EXPECT_THAT(live.notices(), HasSubstr("samples were lost on the way, and counting"));
  EXPECT_EQ(live.state.copy().imu.lost, 79);  // the eightieth was the last
}

TEST_F(LiveSession, AClockThatJumpsForAMomentIsSaid) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 10.0));
  live.publish(changed(part(0, 10.0, 10.01), [](std::string& m) { put(m, kUtime, number_at(m, kUtime) - 5000000); }));
  live.publish(part(0, 10.01, 12.0));
  live.idle(0.1);
  EXPECT_THAT(live.notices(), HasSubstr("a clock jumped"));
  EXPECT_THAT(live.notices(), Not(HasSubstr("begins again")));
}

TEST_F(LiveSession, AClockThatStaysElsewhereBeginsTheRecordingAgain) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 20.0));
  const auto later = [](std::string& m) { put(m, kUtime, number_at(m, kUtime) - 3600000000); };
  std::vector<BusMessage> moved = part(0, 20.0, 40.0);
  for (BusMessage& m : moved) later(m.data);
  live.publish(moved);
  live.idle(0.1);
  EXPECT_THAT(live.notices(), HasSubstr("the clock of the IMU channel was reset"));
  EXPECT_THAT(live.notices(), HasSubstr("the recording of mount_1 begins again, what there was is kept as"));
  EXPECT_TRUE(std::filesystem::exists(bench_.folder / "1.lcm.interrupted-1"));
  EXPECT_TRUE(live.press());
  EXPECT_NEAR(live.session.recordings().at(0).data.figures.duration, 19.9, 0.2);
}

TEST_F(LiveSession, NoticesTheWrongMount) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(2, 0.0, 15.0));
  live.idle(1.2);
  EXPECT_THAT(live.notices(), HasSubstr("wrong mount: the unit feels as in mount_3, not as in mount_1"));
}

TEST_F(LiveSession, NoticesSaturation) {
  LiveRun live(bench_);
  live.press();
  std::vector<BusMessage> messages = part(0, 0.0, 15.0);
  std::size_t k = messages.size() / 2;
  while (messages[k].channel != "IMU") ++k;
  std::string wild;
  io::encode_imu(number_at(messages[k].data, kUtime), number_at(messages[k].data, kSequence),
                 {Vec3<double>(9.0, 0, 0), Vec3<double>(0, 0, 9.8)}, wild);
  messages[k].data = wild;
  live.publish(messages);
  live.idle(0.7);
  EXPECT_THAT(live.notices(), HasSubstr("saturated: samples at or past the range"));
  EXPECT_EQ(live.state.copy().saturated, 1);
}

TEST_F(LiveSession, NoticesAUnitThatWasMoved) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 110.0));
  live.idle(0.8);
  EXPECT_THAT(live.notices(), Not(HasSubstr("was the unit moved")));
  // three degrees about its x axis: the fixture was knocked
  const Mat3<double> C = Eigen::AngleAxisd(3.0 * kRadPerDeg, Vec3<double>::UnitX()).toRotationMatrix();
  const auto turned = [&](std::string& m) {
    std::string out;
    std::vector<double> v;
    for (std::size_t i = 0; i < 6; ++i) {
      const std::int64_t bits = number_at(m, 24 + 8 * i);
      double x = 0.0;
      std::memcpy(&x, &bits, sizeof x);
      v.push_back(x);
    }
    io::encode_imu(number_at(m, kUtime), number_at(m, kSequence),
                   {C * Vec3<double>(v[0], v[1], v[2]), C * Vec3<double>(v[3], v[4], v[5])}, out);
    m = out;
  };
  for (int second = 110; second < 150; second += 8) {
    live.publish(changed(part(0, second, second + 8), turned));
    // the estimate comes when it comes
    for (int i = 0; i < 40 && !live.session.settled(); ++i) live.idle(0.6);
  }
  EXPECT_THAT(live.notices(), HasSubstr("was the unit moved in mount_1"));
}

TEST_F(LiveSession, NoticesALostChannelAndItsReturn) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 5.0));
  std::vector<BusMessage> imu_only;
  for (const BusMessage& m : part(0, 5.0, 8.0)) {
    if (m.channel == "IMU") imu_only.push_back(m);
  }
  for (int i = 0; i < 12; ++i) {
    live.publish({imu_only.begin() + 100 * i, imu_only.begin() + 100 * (i + 1)});
    live.idle(0.1);
  }
  EXPECT_THAT(live.notices(), HasSubstr("lost channel: no message of the encoders for"));
  EXPECT_THAT(live.notices(), Not(HasSubstr("no message of the unit")));
  live.publish(part(0, 8.0, 8.5));
  live.idle(0.1);
  EXPECT_THAT(live.notices(), HasSubstr("a message of the encoders again"));
}

TEST_F(LiveSession, AFullDiskLosesTheRecordingAndNotTheCalibration) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 10.0));
  rlimit small = before;
  small.rlim_cur = 700000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  live.publish(part(0, 10.0, 40.0));
  const bool more = live.press();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_TRUE(more);
  EXPECT_THAT(live.notices(), HasSubstr("nothing more is recorded: "));
  EXPECT_THAT(live.notices(), HasSubstr("the calibration goes on"));
  EXPECT_EQ(live.session.recordings().at(0).data.figures.samples, imu_messages(part(0, 0.0, 40.0)));
  EXPECT_TRUE(live.session.inputs().digests.empty());
}

TEST_F(LiveSession, SaysThatAChannelNeverCame) {
  LiveRun live(bench_);
  live.press();
  std::vector<BusMessage> imu_only;
  for (const BusMessage& m : part(0, 0.0, 3.2)) {
    if (m.channel == "IMU") imu_only.push_back(m);
  }
  for (int i = 0; i < 12; ++i) {
    live.publish({imu_only.begin() + 100 * i, imu_only.begin() + 100 * (i + 1)});
    live.idle(0.1);
  }
  EXPECT_THAT(live.notices(), HasSubstr("lost channel: no message of the encoders for"));
}

// A stream that is not what the run says ends the program, once: what it left does not end the next one.
TEST_F(LiveSession, AWrongStreamIsRefusedAndLeavesNothingBehind) {
  std::vector<BusMessage> slow;
  int n = 0;
  for (const BusMessage& m : part(0, 0.0, 4.0)) {
    if (m.channel != "IMU" || ++n % 2 == 0) slow.push_back(m);
  }
  {
    LiveRun live(bench_);
    live.press();
    EXPECT_REFUSES(ExitCode::kInput, "the sheet's rate_hz says 400", live.publish(slow));
  }
  LiveRun live(bench_);
  EXPECT_EQ(live.state.copy().phase, Phase::kWaiting);
  live.press();
  live.publish(part(0, 0.0, 4.0));
  live.press();
  EXPECT_EQ(live.session.recordings().size(), 1U);
}

TEST_F(LiveSession, AJournalThatCannotBeGoneOnWithIsSetAside) {
  {
    LiveRun live(bench_);
    live.press();
    live.publish(part(0, 0.0, 0.4));  // too little to know the period from
    live.idle(0.1);
  }
  std::vector<BusMessage> later = part(0, 0.4, 20.0);
  for (BusMessage& m : later) put(m.data, kUtime, number_at(m.data, kUtime) + 3600000000);
  LiveRun live(bench_);
  EXPECT_THAT(live.notices(), HasSubstr("going on with mount_1"));
  live.publish(later);
  EXPECT_THAT(live.notices(), HasSubstr("the recording of mount_1 begins again"));
  live.press();
  EXPECT_NEAR(live.session.recordings().at(0).data.figures.duration, 19.5, 0.3);
}

TEST_F(LiveSession, RefusesMoreRecordingsThanACalibrationHolds) {
  io::RunFile many = bench_.run;
  for (int i = 3; i <= kMaxRecordings; ++i) {
    many.recordings.push_back(many.recordings[0]);
    many.recordings.back().log += std::to_string(i);
  }
  bus::Connection bus("memq://");
  SharedState state;
  EXPECT_REFUSES(ExitCode::kInput, "more than 32 recordings", Session(many, bench_.rig, bench_.mounts, bus, state, {}));
}

TEST_F(LiveSession, AMountThatIsEndedTooSoonIsRecordedAgain) {
  LiveRun live(bench_);
  live.press();
  live.publish(part(0, 0.0, 0.1));
  EXPECT_TRUE(live.press());
  EXPECT_THAT(live.notices(), HasSubstr("usable IMU samples; the recording of mount_1 begins again"));
  EXPECT_EQ(live.state.copy().phase, Phase::kRecording);
  EXPECT_TRUE(live.session.recordings().empty());
}

TEST_F(LiveSession, RefusesARunThatCannotBeRecorded) {
  io::RunFile hand = bench_.run;
  hand.recordings[1].mount.clear();
  bus::Connection bus("memq://");
  SharedState state;
  EXPECT_REFUSES(ExitCode::kInput, "each recording needs a mount and a log",
                 Session(hand, bench_.rig, bench_.mounts, bus, state, {}));
  io::RunFile one = bench_.run;
  one.channels.encoder.name = "IMU";
  EXPECT_REFUSES(ExitCode::kInput, "have the same channel", Session(one, bench_.rig, bench_.mounts, bus, state, {}));
}

}  // namespace
}  // namespace trunnion::app
