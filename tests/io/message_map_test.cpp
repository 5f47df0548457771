// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages of other people's types through a run file's `channels` into samples.

#include "trunnion/io/message_map.hpp"
#include "trunnion/io/lcm_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/message_bytes.hpp"
#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::io {
namespace {

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    stamps.push_back(utime);
    samples.push_back(s);
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    stamps.push_back(utime);
    angles.push_back({azimuth, pitch});
  }
  std::vector<std::int64_t> stamps;
  std::vector<InertialSample<double>> samples;
  std::vector<std::array<double, 2>> angles;
};

class MessageMapTest : public testing::Test {
 protected:
  /// The channels of a run file with these lines.
  LogChannels channels(const std::string& lines, const std::string& sheet = "") {
    std::string run = "format: trunnion-run/1\nsite: {latitude_deg: 43.88}\nrecordings: [{log: a.lcm}]\n" + lines;
    if (!sheet.empty()) {
      static_cast<void>(folder_.file("sheet.yaml", "format: trunnion-sheet/1\nmodel: X\n" + sheet));
      run += "sheet: sheet.yaml\n";
    }
    return read_run_file(folder_.file("run.yaml", run)).channels;
  }
  /// The message through a decoder; @return what is wrong with it
  std::string decode(const LogChannels& channels, const std::string& message, bool imu = true) {
    sink_.stamps.clear();
    sink_.samples.clear();
    sink_.angles.clear();
    LcmDecoder decoder("log", sink_, channels);
    LcmEvent event;
    event.timestamp = 77;
    event.channel = "X";
    event.data = message;
    imu ? decoder.imu(event) : decoder.encoder(event);
    return decoder.first_fault();
  }
  static std::uint64_t fingerprint(const char* preset) {
    const MessageMap& map = message_preset(preset).map;
    return map.types->fingerprint(map.type);
  }
  TemporaryFolder folder_;
  Collect sink_;
};

TEST_F(MessageMapTest, APresetKnowsChannelFieldsAndUnits) {
  const LogChannels c = channels("channels: {imu: {preset: bot_core.ins_t}}\n");
  EXPECT_EQ(c.imu.name, "MICROSTRAIN_INS");
  MessageBytes m(fingerprint("bot_core.ins_t"));
  m.i64(1600000000123456).i64(42);
  for (int i = 0; i < 3 + 3 + 3 + 4 + 2; ++i) m.f64(0.125 * i);
  EXPECT_EQ(decode(c, m.bytes()), "");
  EXPECT_THAT(sink_.stamps, testing::ElementsAre(1600000000123456));
  EXPECT_EQ(sink_.samples.at(0).w, Vec3<double>(0, 0.125, 0.25));
  EXPECT_EQ(sink_.samples.at(0).f, Vec3<double>(0.75, 0.875, 1.0));
  EXPECT_THAT(decode(c, m.bytes().substr(1)), testing::HasSubstr("is no whole message of type bot_core.ins_t"));
}

TEST_F(MessageMapTest, IncrementsInBatchesThatOverlapAreTakenOnce) {
  const std::string sheet = "rate_hz: 1000\ngyroscope: {}\naccelerometer: {}\n";
  const LogChannels c = channels("channels: {imu: {preset: bot_core.kvh_raw_imu_batch_t}}\n", sheet);
  const auto batch = [&](int first, int n) {
    MessageBytes m(fingerprint("bot_core.kvh_raw_imu_batch_t"));
    m.i64(5).i32(n);
    for (int i = first; i < first + n; ++i) {
      m.i64(1000000 + 1000 * i).i64(i);
      for (int axis = 0; axis < 6; ++axis) m.f64(1e-3 * (i + axis));
    }
    return m.bytes();
  };
  LcmDecoder decoder("log", sink_, c);
  LcmEvent event;
  for (const int first : {10, 12, 15}) {
    const std::string message = batch(first, 4);
    event.data = message;
    decoder.imu(event);
  }
  // 10 .. 18 without a gap, each once
  ASSERT_EQ(sink_.samples.size(), 9U);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(sink_.stamps[static_cast<std::size_t>(i)], 1010000 + 1000 * i);
    EXPECT_NEAR(sink_.samples[static_cast<std::size_t>(i)].w.x(), 10.0 + i, 1e-12);  // rad in a millisecond
    EXPECT_NEAR(sink_.samples[static_cast<std::size_t>(i)].f.x(), 1e-3 * (13 + i), 1e-12);
  }
  EXPECT_EQ(decoder.imu_sequence().lost(), 0);
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:4: channels.imu: increments in rad need the rate_hz of a sheet",
                 channels("channels: {imu: {preset: bot_core.kvh_raw_imu_batch_t}}\n"));
}

TEST_F(MessageMapTest, SplitTimeIsExact) {
  const LogChannels c = channels("channels: {imu: {channel: 'imu#sensor_msgs.Imu', preset: sensor_msgs.Imu}}\n");
  MessageBytes m(fingerprint("sensor_msgs.Imu"));
  m.i32(3).i32(1700000000).i32(123456789).text("imu_link");
  for (int i = 0; i < 4 + 9; ++i) m.f64(-1);
  m.f64(0.1).f64(0.2).f64(0.3);
  for (int i = 0; i < 9; ++i) m.f64(-1);
  m.f64(1).f64(2).f64(3);
  for (int i = 0; i < 9; ++i) m.f64(-1);
  EXPECT_EQ(decode(c, m.bytes()), "");
  EXPECT_THAT(sink_.stamps, testing::ElementsAre(1700000000123456));
  EXPECT_EQ(sink_.samples.at(0).w, Vec3<double>(0.1, 0.2, 0.3));
  EXPECT_EQ(sink_.samples.at(0).f, Vec3<double>(1, 2, 3));
}

TEST_F(MessageMapTest, WithoutATimeTheLogsIsTaken) {
  const LogChannels c = channels("channels: {imu: {preset: cheetah.vectornav_lcmt}}\n");
  MessageBytes m(fingerprint("cheetah.vectornav_lcmt"));
  for (int i = 0; i < 10; ++i) m.f32(0.5F * static_cast<float>(i));
  EXPECT_EQ(decode(c, m.bytes()), "");
  EXPECT_THAT(sink_.stamps, testing::ElementsAre(77));
  EXPECT_EQ(sink_.samples.at(0).w, Vec3<double>(2, 2.5, 3));
}

TEST_F(MessageMapTest, JointsAreFoundByName) {
  const LogChannels c = channels(
      "channels: {encoder: {channel: JOINTS, preset: bot_core.joint_state_t, angle: {joints: [base, arm]}}}\n");
  const auto message = [&](std::initializer_list<const char*> names) {
    MessageBytes m(fingerprint("bot_core.joint_state_t"));
    m.i64(9).i16(static_cast<int>(names.size()));
    for (const char* name : names) m.text(name);
    for (std::size_t i = 0; i < 3 * names.size(); ++i) m.f32(0.25F * static_cast<float>(i));
    return m.bytes();
  };
  EXPECT_EQ(decode(c, message({"leg", "arm", "base"}), false), "");
  EXPECT_THAT(sink_.angles.at(0), testing::ElementsAre(0.5, 0.25));
  EXPECT_THAT(decode(c, message({"leg", "base"}), false), testing::HasSubstr("has no joint 'arm'"));
}

class OwnTypes : public MessageMapTest {
 protected:
  OwnTypes() {
    static_cast<void>(
        folder_.file("own.lcm",
                     "package own;\nstruct imu_t { double t; int16_t n; float gx[n], gy[n], gz[n]; int32_t a[3]; }\n"
                     "struct axes_t { int64_t stamp_ns; int32_t ticks[3]; int32_t count; }\n"));
  }
  static constexpr const char* kTypes = "lcm_types: [own.lcm]\n";
};

TEST_F(OwnTypes, FieldsUnitsAndTicksAreTheRunFiles) {
  const LogChannels c = channels(std::string(kTypes) +
                                     "channels:\n  imu: {channel: A, type: own.imu_t, time: {field: t, unit: s}, gyro: "
                                     "{fields: [gx, gy, gz], unit: deg/s}, "
                                     "accel: {field: a, unit: counts}}\n"
                                     "  encoder: {channel: B, type: own.axes_t, time: {field: stamp_ns, unit: ns}, "
                                     "sequence: count, angle: {fields: "
                                     "['ticks[0]', 'ticks[2]'], unit: ticks, per_turn: [4096, -1024]}}\n",
                                 "gyroscope: {}\naccelerometer: {scale_counts_per_m_s2: 200, zero_counts: 32768}\n");
  LcmTypes types;
  types.add(folder_ / "own.lcm");
  MessageBytes imu(types.fingerprint("own.imu_t"));
  imu.f64(1000.25).i16(1).f32(90.0F).f32(180.0F).f32(-90.0F).i32(32768).i32(32968).i32(32568);
  EXPECT_EQ(decode(c, imu.bytes()), "");
  EXPECT_THAT(sink_.stamps, testing::ElementsAre(1000250000));
  EXPECT_TRUE(sink_.samples.at(0).w.isApprox(Vec3<double>(kPi / 2, kPi, -kPi / 2), 1e-15));
  EXPECT_TRUE(sink_.samples.at(0).f.isApprox(Vec3<double>(0, 1, -1), 1e-15));
  MessageBytes axes(types.fingerprint("own.axes_t"));
  axes.i64(1700000000123456789).i32(1024).i32(5).i32(256).i32(3);
  EXPECT_EQ(decode(c, axes.bytes(), false), "");
  EXPECT_THAT(sink_.stamps, testing::ElementsAre(1700000000123456));
  EXPECT_NEAR(sink_.angles.at(0)[0], kPi / 2, 1e-15);
  EXPECT_NEAR(sink_.angles.at(0)[1], -kPi / 2, 1e-15);
}

TEST_F(OwnTypes, AMessageWhosePartsDoNotAgreeIsLeftOut) {
  const std::string imu =
      "channels: {imu: {channel: A, type: own.imu_t, time: {field: t, unit: s}, gyro: {fields: [gx, gy, gz], unit: "
      "rad/s}, accel: "
      "{field: a, unit: g}}}\n";
  const LogChannels c = channels(kTypes + imu);
  LcmTypes types;
  types.add(folder_ / "own.lcm");
  MessageBytes two(types.fingerprint("own.imu_t"));
  two.f64(1).i16(2);
  for (int i = 0; i < 6; ++i) two.f32(0.0F);
  two.i32(0).i32(0).i32(1);
  EXPECT_THAT(decode(c, two.bytes()), testing::HasSubstr("has not three components of each sample"));
  for (const double t : {std::nan(""), 1e300, -1e300}) {
    MessageBytes m(types.fingerprint("own.imu_t"));
    m.f64(t).i16(1).f32(0).f32(0).f32(0).i32(0).i32(0).i32(1);
    EXPECT_THAT(decode(c, m.bytes()), testing::HasSubstr("the stamp is no time"));
  }
}

TEST_F(OwnTypes, TheRunFileIsHeldAgainstTheType) {
  const auto with = [&](const std::string& imu) {
    return channels(std::string(kTypes) + "channels: {imu: {" + imu + "}}\n");
  };
  const std::string good = "channel: A, type: own.imu_t, time: {field: t, unit: s}, ";
  EXPECT_REFUSES(ExitCode::kInput,
                 "run.yaml:5: channels.imu: message type 'own.imu_t' has no field 'gyro'; it has: t, n, gx",
                 with(good + "gyro: {field: gyro, unit: rad/s}, accel: {field: a, unit: g}"));
  EXPECT_REFUSES(ExitCode::kInput, "unit 'rpm': should be one of rad/s, deg/s, deg/h, counts, rad",
                 with(good + "gyro: {fields: [gx, gy, gz], unit: rpm}, accel: {field: a, unit: g}"));
  EXPECT_REFUSES(ExitCode::kInput, "channels.imu.gyro.fields: should be 3 paths",
                 with(good + "gyro: {fields: [gx, gy], unit: rad/s}, accel: {field: a, unit: g}"));
  EXPECT_REFUSES(ExitCode::kInput, "unknown preset 'bot_core.inst'; did you mean 'bot_core.ins_t'?",
                 with("preset: bot_core.inst"));
  EXPECT_REFUSES(ExitCode::kInput, "unknown preset 'bot_core.joint_state_t'", with("preset: bot_core.joint_state_t"));
  EXPECT_REFUSES(ExitCode::kInput, "has no channel", with("preset: sensor_msgs.Imu"));
  EXPECT_REFUSES(ExitCode::kInput, "channels.imu.time",
                 with("channel: A, type: own.imu_t, gyro: {field: a, unit: rad/s}, accel: {field: a, unit: g}"));
  EXPECT_REFUSES(
      ExitCode::kInput, "'own.imu' is not defined; did you mean 'own.imu_t'?",
      with("channel: A, type: own.imu, time: log, gyro: {field: a, unit: rad/s}, accel: {field: a, unit: g}"));
  EXPECT_REFUSES(ExitCode::kInput, "unit 'min': should be one of s, ms, us, ns",
                 with("channel: A, type: own.imu_t, time: {field: t, unit: min}, gyro: {field: a, unit: rad/s}, accel: "
                      "{field: a, unit: g}"));
}

}  // namespace
}  // namespace trunnion::io
