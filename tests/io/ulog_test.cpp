// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstring>
#include <limits>

#include "io/format_bytes.hpp"
#include "io/log_reading.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

using Ulogs = LogReading;

TEST_F(Ulogs, OfSensorCombined) {
  const LogLosses losses = read(
      ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined") +
      ulog_combined(7, 1000, kSample, 0) + ulog_combined(7, 2000, kSample, std::numeric_limits<std::int32_t>::max()) +
      ulog_combined(7, 3000, kSample, -100) + ulog_combined(8, 3500, kSample, 0) + ulog_message('L', "6a message"));
  EXPECT_THAT(collect_->stamps, ElementsAre(1000, 3000)) << "the second has no sample of the accelerometers";
  EXPECT_EQ(losses.note, "1 samples of the gyros without one of the accelerometers are passed over");
  EXPECT_EQ(collect_->samples[1].w, kSample.w);
  EXPECT_EQ(collect_->samples[1].f, kSample.f);
}

TEST_F(Ulogs, FollowANumberThatIsGivenToAnotherTopic) {
  const std::string begin = ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined") +
                            ulog_combined(7, 1, kSample, 0);
  const std::string removed = ulog_message('R', std::string("\x07\0", 2));
  const std::string other = ulog_subscribe(0, 7, "foo") + ulog_combined(7, 2, kSample, 0);
  for (const std::string& log :
       {begin + removed + ulog_combined(7, 2, kSample, 0), begin + removed + other, begin + other})
    EXPECT_EQ((read(log), collect_->stamps), std::vector<std::int64_t>{1});
  read(begin + other + ulog_subscribe(0, 9, "sensor_combined") + ulog_combined(9, 3, kSample, 0));
  EXPECT_THAT(collect_->stamps, ElementsAre(1, 3));
}

TEST_F(Ulogs, OfVehicleImu) {
  const std::string format =
      "vehicle_imu:uint64_t timestamp;uint64_t timestamp_sample;uint32_t accel_device_id;float[3] delta_angle;float[3] "
      "delta_velocity;uint16_t delta_angle_dt;uint16_t delta_velocity_dt;uint8_t[4] _padding0;";
  std::string data;
  append_little(data, std::uint64_t{9});
  append_little(data, std::uint64_t{5000});
  append_little(data, std::uint32_t{1});
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(0.005 * kSample.w(i)));
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(0.0025 * kSample.f(i)));
  append_little(data, std::uint16_t{5000});
  append_little(data, std::uint16_t{2500});
  const std::string log = ulog_head() + ulog_message('F', format) + ulog_subscribe(0, 1, "vehicle_imu") +
                          ulog_subscribe(1, 2, "vehicle_imu");
  read(log + ulog_data(1, data));
  EXPECT_THAT(collect_->stamps, ElementsAre(5000));
  EXPECT_LT((collect_->samples[0].w - kSample.w).norm(), 1e-7);
  EXPECT_LT((collect_->samples[0].f - kSample.f).norm(), 1e-6);
  LogRequest second;
  second.channels.imu.name = "vehicle_imu#1";
  read(log + ulog_data(2, data), second);
  EXPECT_EQ(collect_->samples.size(), 1U);
  EXPECT_REFUSES(ExitCode::kInput, "it has topics vehicle_imu, vehicle_imu#1", read(log + ulog_data(1, data), second));
  second.channels.imu.name = "vehicle_imu#x";
  EXPECT_REFUSES(ExitCode::kInput, "is no topic", read(log, second));
}

TEST_F(Ulogs, PrefersSensorCombined) {
  const std::string imu =
      "vehicle_imu:uint64_t timestamp_sample;float[3] delta_angle;float[3] delta_velocity;uint16_t delta_angle_dt;"
      "uint16_t delta_velocity_dt;";
  const std::string head = ulog_head() + ulog_message('F', imu) + ulog_message('F', kCombinedFormat) +
                           ulog_subscribe(0, 1, "vehicle_imu") + ulog_subscribe(0, 7, "sensor_combined");
  const LogLosses lost = read(head + ulog_data(1, std::string(36, '\1')) + ulog_combined(7, 1000, kSample, 0) +
                              ulog_message('O', std::string("\x32\0", 2)) + ulog_combined(7, 2000, kSample, 0));
  EXPECT_THAT(collect_->stamps, ElementsAre(1000, 2000));
  EXPECT_EQ(lost.note, "1 dropouts of the logger, 50 ms in all");
  EXPECT_REFUSES(ExitCode::kInput, "beyond any clock",
                 read(head + ulog_combined(7, std::uint64_t{1} << 63U, kSample, 0)));
}

TEST_F(Ulogs, NamesTheVehiclesOwnCalibration) {
  const auto parameter = [](const std::string& key, auto value) {
    std::string content(1, static_cast<char>(key.size()));
    content += key;
    append_little(content, value);
    return ulog_message('P', content);
  };
  const std::string log = ulog_head() + parameter("float CAL_ACC0_XOFF", -0.25F) +
                          parameter("float CAL_ACC0_YOFF", 0.0F) + parameter("float CAL_ACC0_XSCALE", 1.0F) +
                          parameter("float CAL_GYRO0_ZOFF", 0.5F) +
                          parameter("int32_t SENS_BOARD_ROT", std::int32_t{4}) + ulog_message('F', kCombinedFormat) +
                          ulog_subscribe(0, 7, "sensor_combined") + ulog_combined(7, 1000, kSample, 0);
  EXPECT_EQ(
      read(log).note,
      "the vehicle's own SENS_BOARD_ROT = 4, CAL_ACC0_XOFF = -0.25, CAL_GYRO0_ZOFF = 0.5 are in its units' readings");
}

TEST_F(Ulogs, NestedAndPaddedFormats) {
  // the padding at the end is not logged; a nested type is counted whole
  const std::string nested = "point:float x;float y;float z;";
  const std::string format =
      "sensor_combined:uint64_t timestamp;point[2] marks;uint8_t flag;uint8_t[3] _padding0;float[3] gyro_rad;float[3] "
      "accelerometer_m_s2;uint8_t[4] _padding1;";
  std::string data;
  append_little(data, std::uint64_t{77});
  data += std::string(24 + 4, '\1');
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(kSample.w(i)));
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(kSample.f(i)));
  read(ulog_head() + ulog_message('F', format) + ulog_message('F', nested) + ulog_subscribe(0, 1, "sensor_combined") +
       ulog_data(1, data));
  EXPECT_EQ(collect_->samples.at(0).f, kSample.f);
}

TEST_F(Ulogs, ThatIsDamaged) {
  const std::string head = ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined");
  std::string log = head;
  for (int k = 0; k < 100; ++k) log += ulog_combined(7, static_cast<std::uint64_t>(k), kSample, 0);
  log += std::string("\xff\xff\x01garbage", 10);
  log += ulog_message('S', std::string("\x2f\x73\x13\x20\x25\x0c\xbb\x12", 8));
  for (int k = 100; k < 200; ++k) log += ulog_combined(7, static_cast<std::uint64_t>(k), kSample, 0);
  LogLosses lost = read(log);
  EXPECT_EQ(collect_->samples.size(), 200U);
  EXPECT_EQ(lost.records, 1);
  EXPECT_EQ(lost.bytes, 10);
  lost = read(log.substr(0, log.size() - 5));
  EXPECT_EQ(collect_->samples.size(), 199U);
  EXPECT_EQ(lost.records, 2);
  EXPECT_REFUSES(ExitCode::kInput, "shorter than its format", read(head + ulog_data(7, "short")));
  EXPECT_REFUSES(ExitCode::kInput, "no samples of an IMU", read(head));
  EXPECT_REFUSES(ExitCode::kInput, "newer kind",
                 read(ulog_head() + ulog_message('B', std::string(8, '\0') + "\x02" + std::string(31, '\0'))));
  EXPECT_REFUSES(ExitCode::kInput, "gyro_rad",
                 read(ulog_head() + ulog_message('F', "sensor_combined:uint64_t timestamp;") +
                      ulog_subscribe(0, 7, "sensor_combined")));
  std::string endless;  // types that are made of each other
  for (const char* name : {"sensor_combined", "a", "b"})
    endless += ulog_message('F', std::string(name) + ":a x;b y;a[9999] z;uint64_t timestamp;");
  EXPECT_REFUSES(ExitCode::kInput, "timestamp", read(ulog_head() + endless + ulog_subscribe(0, 7, "sensor_combined")));
}

// What is lost ends where messages follow each other again, with the logger's marks or without.
TEST_F(Ulogs, FindsItsMessagesAgain) {
  std::string log = ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined");
  std::size_t middle = 0;
  for (int k = 0; k < 2000; ++k) {
    if (k == 100) log += '\0';
    if (k == 1000) middle = log.size();
    log += ulog_combined(7, static_cast<std::uint64_t>(k), kSample, 0);
  }
  const LogLosses lost = read(log);
  EXPECT_EQ(collect_->samples.size(), 2000U);
  EXPECT_EQ(lost.records, 1);
  EXPECT_EQ(lost.bytes, 1);
  log.insert(middle, std::string(10000, '\xff'));
  EXPECT_REFUSES(ExitCode::kInput, "message: is none; ", read(log));
}

TEST_F(Ulogs, EndsWhereSomethingWasAppended) {
  std::string log = ulog_head();
  const std::string head = ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 0xffff, "sensor_combined");
  std::string data;
  for (int k = 0; k < 20; ++k) data += ulog_combined(0xffff, static_cast<std::uint64_t>(k), kSample, 0);
  data.resize(data.size() - 12);  // a crash within the last one
  std::string flags(8, '\0');
  flags += '\1' + std::string(7, '\0');
  const std::size_t begins = log.size() + 3 + 40 + head.size() + data.size();
  append_little(flags, static_cast<std::uint64_t>(begins));
  flags += std::string(16, '\0');
  log += ulog_message('B', flags) + head + data;
  ASSERT_EQ(log.size(), begins);
  for (int k = 0; k < 50; ++k) log += ulog_message('L', "6........what the crash was");
  for (int k = 0; k < 200; ++k) log += ulog_message('L', std::string(60, 'x'));
  EXPECT_EQ(read(log).records, 1);
  EXPECT_EQ(collect_->samples.size(), 19U);
  for (const auto& sample : collect_->samples) EXPECT_EQ(sample.f, kSample.f);
}

TEST_F(Ulogs, DoesNotMixItsTopics) {
  std::string format = "vehicle_imu:uint64_t timestamp_sample;float[3] delta_angle;float[3] delta_velocity;";
  format += "uint16_t delta_angle_dt;uint16_t delta_velocity_dt;";
  std::string slow;
  append_little(slow, std::uint64_t{1});
  for (int i = 0; i < 6; ++i) append_little(slow, 0.5F);
  append_little(slow, std::uint16_t{5000});
  append_little(slow, std::uint16_t{5000});
  const std::string log = ulog_head() + ulog_message('F', kCombinedFormat) + ulog_message('F', format) +
                          ulog_subscribe(0, 1, "vehicle_imu") + ulog_data(1, slow) +
                          ulog_subscribe(0, 2, "sensor_combined") + ulog_combined(2, 5, kSample, 0);
  EXPECT_REFUSES(ExitCode::kInput, "begins sensor_combined where vehicle_imu has samples already", read(log));
  LogRequest request;
  request.channels.imu.name = "vehicle_imu";
  read(log, request);
  EXPECT_THAT(collect_->stamps, ElementsAre(1));
  request.channels.imu.name = "sensor_combined";
  read(log, request);
  EXPECT_THAT(collect_->stamps, ElementsAre(5));
}

}  // namespace
}  // namespace trunnion::io
