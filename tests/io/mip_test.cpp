// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "io/format_bytes.hpp"
#include "io/log_reading.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

using MipStreams = LogReading;

TEST_F(MipStreams, InItsUnitsAndStamps) {
  EXPECT_EQ(read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1234567500)})).bytes, 0);
  ASSERT_EQ(collect_->samples.size(), 1U);
  EXPECT_EQ(collect_->stamps[0], 1234568) << "us, rounded";
  EXPECT_EQ(collect_->samples[0].w, kSample.w);
  EXPECT_LT((collect_->samples[0].f - kStandardGravity * kSample.f).norm(), 1e-12) << "g";
}

TEST_F(MipStreams, ByGpsTime) {
  read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0xD3, 137649.863104, 1969, 3)}));
  EXPECT_EQ(collect_->stamps[0], (315964800LL + 1969LL * 604800) * 1000000 + 137649863104);
  read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0x12, 1.5, 1969, 5)}));
  EXPECT_EQ(collect_->stamps[0], (315964800LL + 1969LL * 604800) * 1000000 + 1500000);
  EXPECT_REFUSES(ExitCode::kInput, "without a stamp",
                 read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0xD3, 1.0, 1969, 1)})));
  EXPECT_REFUSES(ExitCode::kInput, "without a stamp", read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w)})));
}

TEST_F(MipStreams, OfIncrements) {
  const auto at = [](std::int64_t milliseconds) {
    return mip_packet({mip_deltas(0.01 * kSample.w, 0.01 * kSample.f), mip_reference_time(1000000 * milliseconds)});
  };
  // of its own period only where the step is like the one before: not across a gap
  const LogLosses lost = read(at(0) + at(10) + at(20) + at(120) + at(130) + at(140) +
                              mip_packet({mip_deltas(0.02 * kSample.w, 0.02 * kSample.f), mip_reference_time(240000000),
                                          mip_period(20000000)}));
  EXPECT_THAT(collect_->stamps, ElementsAre(20000, 140000, 240000));
  EXPECT_THAT(lost.note, testing::HasSubstr("4 packets of sensor data with increments after a gap"));
  for (const auto& s : collect_->samples) {
    EXPECT_LT((s.w - kSample.w).norm(), 1e-7);
    EXPECT_LT((s.f - kStandardGravity * kSample.f).norm(), 1e-5);
  }
}

TEST_F(MipStreams, SaysWhatItPassesOver) {
  const LogLosses lost = read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1)}) +
                              mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w)}) +
                              mip_packet({mip_accel(kSample.f), mip_reference_time(2)}));
  EXPECT_EQ(collect_->samples.size(), 1U);
  EXPECT_EQ(lost.note,
            "1 packets of sensor data without a stamp, 1 packets of sensor data with either rates or specific forces, "
            "not both");
}

// A unit's own clock and GPS count from different days: what has not the first packet's is counted.
TEST_F(MipStreams, KeepsToOneClock) {
  std::string text;
  for (int k = 0; k < 10; ++k) {
    std::vector<std::string> fields = {mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0xD3, 1.0 * k, 2000, 3)};
    if (k % 2 == 1) fields.push_back(mip_reference_time(1000000LL * k));
    text += mip_packet(fields);
  }
  EXPECT_EQ(read(text).note, "");
  ASSERT_EQ(collect_->stamps.size(), 10U);
  for (std::size_t k = 1; k < 10; ++k) EXPECT_EQ(collect_->stamps[k] - collect_->stamps[k - 1], 1000000);
  const std::string own = mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1)});
  EXPECT_EQ(read(own + text).note, "5 packets of sensor data without a stamp");
  LogRequest named;
  named.channels.imu.name = "IMU";
  EXPECT_REFUSES(ExitCode::kInput, "has no channel 'IMU'", read(text, named));
}

TEST_F(MipStreams, ThatIsHalfLostIsRefused) {
  std::string text;
  for (int k = 0; k < 2000; ++k)
    text += mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1000000LL * k)});
  std::string spoilt = text;
  for (std::size_t i = text.size() / 4; i < text.size() / 2; ++i) spoilt[i] = static_cast<char>(i * i);
  EXPECT_REFUSES(ExitCode::kInput, "is no packet; ", read(spoilt));
}

TEST_F(MipStreams, WithDamageGoesOn) {
  std::string text;
  for (int k = 0; k < 2000; ++k)
    text += mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1000000LL * k)});
  const std::size_t one = text.size() / 2000;
  std::string spoilt = text;
  spoilt[100 * one + 7] = static_cast<char>(spoilt[100 * one + 7] ^ 1);  // its checksum tells
  spoilt.insert(500 * one, "ue junk \x75\x65 more");
  spoilt.resize(spoilt.size() - 3);
  const LogLosses lost = read(spoilt);
  EXPECT_EQ(collect_->samples.size(), 1998U);
  EXPECT_EQ(lost.records, 3);
  EXPECT_GT(lost.bytes, static_cast<long long>(one));
}

TEST_F(MipStreams, FieldsOfWrongLength) {
  EXPECT_REFUSES(ExitCode::kInput, "wrong length", read(mip_packet({std::string("\x0d\x04hello world", 13)})));
  EXPECT_REFUSES(ExitCode::kInput, "wrong length", read(mip_packet({std::string("\x01\x04", 2)})));
  EXPECT_REFUSES(ExitCode::kInput, "is twice",
                 read(mip_packet({mip_accel(kSample.f), mip_accel(kSample.f), mip_gyro(kSample.w)})));
  EXPECT_REFUSES(ExitCode::kInput, "not both", read(mip_packet({mip_accel(kSample.f), mip_reference_time(1)})));
  EXPECT_REFUSES(
      ExitCode::kInput, "is not finite",
      read(mip_packet({mip_accel(Vec3<double>(0.0, std::nan(""), 0.0)), mip_gyro(kSample.w), mip_reference_time(1)})));
}

}  // namespace
}  // namespace trunnion::io
