// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/log_format.hpp"

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zstd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "io/format_bytes.hpp"
#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    stamps.push_back(utime);
    samples.push_back(s);
  }
  void temperature(double celsius) override { temperatures.push_back(celsius); }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    reading_stamps.push_back(utime);
    angles.push_back({azimuth, pitch});
  }
  std::vector<std::int64_t> stamps;
  std::vector<InertialSample<double>> samples;
  std::vector<double> temperatures;
  std::vector<std::int64_t> reading_stamps;
  std::vector<std::array<double, 2>> angles;
};

const InertialSample<double> kSample{Vec3<double>(0.25, -0.5, 0.125), Vec3<double>(1.5, -2.25, 9.75)};  // of few bits

class LogFormats : public testing::Test {
 protected:
  LogLosses read(const std::string& text, const LogRequest& wish = {}) {
    LogRequest request = wish;
    request.path = folder_.file("a.log", text);
    collect_ = std::make_unique<Collect>();
    return read_log(request, *collect_);
  }
  std::string format(const std::string& text) { return format_of(folder_.file("a.log", text)).name; }
  TemporaryFolder folder_;
  std::unique_ptr<Collect> collect_;
};

TEST_F(LogFormats, AreToldByTheirContent) {
  EXPECT_EQ(format("t_s,gyro_x_rad_s\n1,2\n"), "csv");
  EXPECT_EQ(format("\xef\xbb\xbft_s;x\n"), "csv");
  EXPECT_EQ(format(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w)})), "mip");
  EXPECT_EQ(format("noise before" + mip_packet({mip_accel(kSample.f)}) + mip_packet({mip_accel(kSample.f)})), "mip");
  EXPECT_EQ(format(ulog_head() + ulog_message('F', kCombinedFormat)), "ulog");
  EXPECT_EQ(format(mcap_head()), "mcap");
  EXPECT_EQ(format(std::string(5000, '\xed')), "lcm");
  EXPECT_EQ(format(std::string(5000, '\0')), "lcm");
  EXPECT_REFUSES(ExitCode::kInput, "is empty", format(""));
  EXPECT_REFUSES(ExitCode::kInput, "cannot read", format_of(folder_ / "none"));
  EXPECT_REFUSES(ExitCode::kInput, "not a regular file", format_of("/dev/null"));
}

TEST_F(LogFormats, SayWhatAFileIsThatIsNone) {
  for (const auto& [head, words] : {std::pair{std::string("\x1f\x8b\x08\0", 4), "gunzip"},
                                    std::pair{std::string("#ROSBAG V2.0\n"), "rosbags-convert"},
                                    std::pair{std::string("SQLite format 3\0", 16), "ros2 bag convert"},
                                    std::pair{std::string("PK\x03\x04"), "zip"}}) {
    const std::string& text = head;
    EXPECT_REFUSES(ExitCode::kInput, words, read(text + std::string(1000, '\x42')));
  }
}

TEST_F(LogFormats, WriteWhatTheyRead) {
  for (const LogFormat& format : log_formats()) {
    if (format.write == nullptr) continue;
    SCOPED_TRACE(format.name);
    const std::string path = folder_ / (std::string("written") + format.extension);
    const std::unique_ptr<LogWriter> writer = format.write(path);
    writer->temperature(21.5);
    for (int k = 0; k < 1000; ++k) {
      InertialSample<double> sample = kSample;
      sample.w.x() = 0.1 * k / 3.0;
      writer->imu(1700000000000000 + 2500 * k, sample);
      if (k % 10 == 0) writer->encoder(1700000000000001 + 2500 * k, 0.01 * k / 7.0, -1.25);
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    writer->commit();
    LogRequest request;
    request.path = path;
    request.need_encoder = writer->files().size() == 1;
    Collect collect;
    EXPECT_EQ(format_of(path).name, std::string(format.name));
    EXPECT_EQ(read_log(request, collect).bytes, 0);
    if (writer->files().size() > 1) {
      request.path = writer->files()[1];
      request.need_imu = false;
      request.need_encoder = true;
      read_log(request, collect);
    }
    ASSERT_EQ(collect.samples.size(), 1000U);
    ASSERT_EQ(collect.angles.size(), 100U);
    EXPECT_EQ(collect.stamps[999], 1700000000000000 + 2500 * 999);
    EXPECT_EQ(collect.samples[999].w.x(), 0.1 * 999 / 3.0);
    EXPECT_EQ(collect.samples[999].f, kSample.f);
    EXPECT_EQ(collect.reading_stamps[99], 1700000000000001 + 2500 * 990);
    EXPECT_EQ(collect.angles[99][0], 0.01 * 990 / 7.0);
    EXPECT_EQ(collect.temperatures.empty(), !writer->holds_temperature());
    if (!collect.temperatures.empty()) {
      EXPECT_EQ(collect.temperatures[0], 21.5);
    }
  }
}

TEST_F(LogFormats, LeaveNothingBehindWithoutCommit) {
  for (const LogFormat& format : log_formats()) {
    if (format.write == nullptr) continue;
    const std::unique_ptr<LogWriter> writer = format.write(folder_ / "x");
    writer->imu(1, kSample);
    writer->encoder(1, 0.0, 0.0);
  }
  EXPECT_EQ(folder_.files(), 0U);
}

TEST_F(LogFormats, McapHoldsStampsOfRosOnly) {
  const std::unique_ptr<LogWriter> writer = format_by_name("mcap").write(folder_ / "x.mcap");
  EXPECT_REFUSES(ExitCode::kInput, "ROS holds", writer->imu(-1, kSample));
  EXPECT_REFUSES(ExitCode::kInput, "ROS holds", writer->encoder(2147483648000000, 0.0, 0.0));
}

// --- MIP

TEST_F(LogFormats, MipInItsUnitsAndStamps) {
  EXPECT_EQ(read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1234567500)})).bytes, 0);
  ASSERT_EQ(collect_->samples.size(), 1U);
  EXPECT_EQ(collect_->stamps[0], 1234568) << "us, rounded";
  EXPECT_EQ(collect_->samples[0].w, kSample.w);
  EXPECT_LT((collect_->samples[0].f - kStandardGravity * kSample.f).norm(), 1e-12) << "g";
}

TEST_F(LogFormats, MipByGpsTime) {
  read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0xD3, 137649.863104, 1969, 3)}));
  EXPECT_EQ(collect_->stamps[0], (315964800LL + 1969LL * 604800) * 1000000 + 137649863104);
  read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0x12, 1.5, 1969, 5)}));
  EXPECT_EQ(collect_->stamps[0], (315964800LL + 1969LL * 604800) * 1000000 + 1500000);
  EXPECT_REFUSES(ExitCode::kInput, "without a stamp",
                 read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_gps_time(0xD3, 1.0, 1969, 1)})));
  EXPECT_REFUSES(ExitCode::kInput, "without a stamp", read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w)})));
}

TEST_F(LogFormats, MipOfIncrements) {
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

TEST_F(LogFormats, MipSaysWhatItPassesOver) {
  const LogLosses lost = read(mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1)}) +
                              mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w)}) +
                              mip_packet({mip_accel(kSample.f), mip_reference_time(2)}));
  EXPECT_EQ(collect_->samples.size(), 1U);
  EXPECT_EQ(lost.note,
            "1 packets of sensor data without a stamp, 1 packets of sensor data with either rates or specific forces, "
            "not both");
}

// A unit's own clock and GPS count from different days: what has not the first packet's is counted.
TEST_F(LogFormats, MipKeepsToOneClock) {
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

TEST_F(LogFormats, MipThatIsHalfLostIsRefused) {
  std::string text;
  for (int k = 0; k < 2000; ++k)
    text += mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1000000LL * k)});
  std::string spoilt = text;
  for (std::size_t i = text.size() / 4; i < text.size() / 2; ++i) spoilt[i] = static_cast<char>(i * i);
  EXPECT_REFUSES(ExitCode::kInput, "is no packet; ", read(spoilt));
}

TEST_F(LogFormats, MipWithDamageGoesOn) {
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

TEST_F(LogFormats, MipFieldsOfWrongLength) {
  EXPECT_REFUSES(ExitCode::kInput, "wrong length", read(mip_packet({std::string("\x0d\x04hello world", 13)})));
  EXPECT_REFUSES(ExitCode::kInput, "wrong length", read(mip_packet({std::string("\x01\x04", 2)})));
  EXPECT_REFUSES(ExitCode::kInput, "is twice",
                 read(mip_packet({mip_accel(kSample.f), mip_accel(kSample.f), mip_gyro(kSample.w)})));
  EXPECT_REFUSES(ExitCode::kInput, "not both", read(mip_packet({mip_accel(kSample.f), mip_reference_time(1)})));
  EXPECT_REFUSES(
      ExitCode::kInput, "is not finite",
      read(mip_packet({mip_accel(Vec3<double>(0.0, std::nan(""), 0.0)), mip_gyro(kSample.w), mip_reference_time(1)})));
}

// --- ULog

TEST_F(LogFormats, UlogOfSensorCombined) {
  read(ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined") +
       ulog_combined(7, 1000, kSample, 0) + ulog_combined(7, 2000, kSample, std::numeric_limits<std::int32_t>::max()) +
       ulog_combined(7, 3000, kSample, -100) + ulog_combined(8, 3500, kSample, 0) + ulog_message('L', "6a message"));
  EXPECT_THAT(collect_->stamps, ElementsAre(1000, 3000)) << "the second has no sample of the accelerometers";
  EXPECT_EQ(collect_->samples[1].w, kSample.w);
  EXPECT_EQ(collect_->samples[1].f, kSample.f);
}

TEST_F(LogFormats, UlogOfVehicleImu) {
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

TEST_F(LogFormats, UlogPrefersSensorCombined) {
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

TEST_F(LogFormats, UlogNamesTheVehiclesOwnCalibration) {
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

TEST_F(LogFormats, UlogNestedAndPaddedFormats) {
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

TEST_F(LogFormats, UlogThatIsDamaged) {
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
TEST_F(LogFormats, UlogFindsItsMessagesAgain) {
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

TEST_F(LogFormats, UlogEndsWhereSomethingWasAppended) {
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

TEST_F(LogFormats, UlogDoesNotMixItsTopics) {
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

// --- MCAP

TEST_F(LogFormats, McapOfRos1AndRos2) {
  const std::string imu = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr") +
                          mcap_message(1, cdr_imu(12, 345678900, kSample));
  read(mcap_head() + imu + mcap_end());
  EXPECT_THAT(collect_->stamps, ElementsAre(12345679));
  EXPECT_EQ(collect_->samples[0].w, kSample.w);
  EXPECT_EQ(collect_->samples[0].f, kSample.f);
  read(mcap_head() + mcap_schema(1, "sensor_msgs/Imu") + mcap_channel(3, 1, "/imu", "ros1") +
       mcap_message(3, ros1_imu(12, 345678000, kSample)) + mcap_end());
  EXPECT_THAT(collect_->stamps, ElementsAre(12345678));
  EXPECT_EQ(collect_->samples[0].f, kSample.f);
}

std::string compressed(const std::string& how, const std::string& records) {
  std::string out(ZSTD_compressBound(records.size()) + LZ4F_compressFrameBound(records.size(), nullptr), '\0');
  out.resize(how == "zstd" ? ZSTD_compress(out.data(), out.size(), records.data(), records.size(), 3)
                           : LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr));
  return out;
}

TEST_F(LogFormats, McapInCompressedChunks) {
  const std::string channel = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  std::string records = channel;
  for (std::uint32_t k = 1; k <= 500; ++k) records += mcap_message(1, cdr_imu(k, 0, kSample));
  const std::uint32_t crc = crc_of(records);
  for (const char* how : {"zstd", "lz4"}) {
    SCOPED_TRACE(how);
    const std::string packed = compressed(how, records);
    EXPECT_LT(packed.size(), records.size() / 4);
    EXPECT_EQ(read(mcap_head() + mcap_chunk(how, packed, records.size(), crc) + mcap_end()).bytes, 0);
    EXPECT_EQ(collect_->samples.size(), 500U);
    for (const auto& [wrong, what] :
         {std::pair{mcap_chunk(how, packed, records.size(), crc ^ 1U), "checksum"},
          std::pair{mcap_chunk(how, packed, records.size() + 1, crc), "decompressed"},
          std::pair{mcap_chunk(how, packed, records.size() - 1, crc), "decompressed"},
          std::pair{mcap_chunk(how, packed, std::uint64_t{1} << 27U, 0), "another size"},
          std::pair{mcap_chunk(how, packed, std::uint64_t{1} << 29U, 0), "larger than 256 MiB"},
          std::pair{mcap_chunk(how, std::string(2000, 'n'), records.size(), 0), "decompressed"}}) {
      const auto& text = wrong;
      EXPECT_REFUSES(ExitCode::kInput, what, read(mcap_head() + text + mcap_end()));
    }
    // what is damaged is passed over where there is a hundred times as much else
    const std::string whole = mcap_chunk(how, packed, records.size(), crc);
    const std::string wrong = mcap_chunk(how, packed, records.size(), crc ^ 1U);
    std::string hundred;
    for (int k = 0; k < 110; ++k) hundred += whole;
    const LogLosses lost = read(mcap_head() + hundred + wrong + mcap_end());
    EXPECT_EQ(lost.records, 1);
    EXPECT_THAT(lost.note, testing::HasSubstr("chunk: does not have its checksum"));
    EXPECT_EQ(collect_->samples.size(), 110U * 500U);
    EXPECT_REFUSES(ExitCode::kInput, "bytes cannot be read", read(mcap_head() + whole + wrong + mcap_end()));
  }
  EXPECT_REFUSES(ExitCode::kInput, "zstd and lz4 are read",
                 read(mcap_head() + mcap_chunk("brotli", records, records.size(), crc) + mcap_end()));
}

TEST_F(LogFormats, McapThatWasCut) {
  std::string log = mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  for (std::uint32_t k = 0; k < 50; ++k) log += mcap_message(1, cdr_imu(k, 0, kSample));
  const LogLosses lost = read(log.substr(0, log.size() - 7));
  EXPECT_EQ(collect_->samples.size(), 49U);
  EXPECT_EQ(lost.records, 1);
  EXPECT_EQ(read(log).records, 1) << "a recording that was not ended";
}

TEST_F(LogFormats, McapWithSeveralTopics) {
  const std::string types = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_schema(2, "sensor_msgs/msg/JointState") +
                            mcap_schema(3, "sensor_msgs/msg/Image");
  const std::string log =
      mcap_head() + types + mcap_channel(1, 1, "/imu/a", "cdr") + mcap_channel(2, 2, "/joint_states", "cdr") +
      mcap_channel(3, 3, "/camera", "cdr") + mcap_message(1, cdr_imu(1, 0, kSample)) +
      mcap_message(2, cdr_joints(2, {"wheel", "pitch", "azimuth"}, {9.0, 0.5, 0.25})) + mcap_message(3, "an image");
  LogRequest both;
  both.need_encoder = true;
  read(log + mcap_end(), both);
  EXPECT_THAT(collect_->angles, ElementsAre(std::array<double, 2>{0.25, 0.5}));
  both.joints = {"pan", "tilt"};
  EXPECT_REFUSES(ExitCode::kInput, "no position of a joint 'pan'", read(log + mcap_end(), both));
  EXPECT_EQ(read(log + mcap_end()).note, "") << "joints that are there and were not asked for";
  LogRequest pan;
  pan.joints = {"pan", "tilt"};
  EXPECT_EQ(read(log + mcap_end(), pan).note,
            "1 joint states without a position of 'pan' and 'tilt' (axes of the run file)");
  const std::string again =
      mcap_channel(9, 2, "/other", "cdr") + mcap_message(9, cdr_joints(3, {"pitch", "azimuth"}, {0.1, 0.2}));
  EXPECT_REFUSES(ExitCode::kInput, "more than one: /joint_states and /other", read(log + again + mcap_end()));
  read(log + mcap_channel(8, 1, "/imu/idle", "cdr") + mcap_end());
  EXPECT_EQ(collect_->samples.size(), 1U) << "a topic without a message is no other";
  read(log + mcap_channel(7, 3, "", "cdr") + mcap_end());
  EXPECT_EQ(collect_->samples.size(), 1U) << "nor is a topic without a name";

  const std::string two = log + mcap_channel(4, 1, "/imu/b", "cdr") + mcap_message(4, cdr_imu(3, 0, kSample));
  EXPECT_REFUSES(ExitCode::kInput, "more than one: /imu/a and /imu/b", read(two + mcap_end()));
  LogRequest b;
  b.channels.imu.name = "/imu/b";
  read(two + mcap_end(), b);
  EXPECT_THAT(collect_->stamps, ElementsAre(3000000));
  b.channels.imu.name = "/camera";
  EXPECT_REFUSES(ExitCode::kInput, "is of type sensor_msgs/msg/Image in cdr, not sensor_msgs/msg/Imu", read(log, b));
  b.channels.imu.name = "/none";
  EXPECT_REFUSES(ExitCode::kInput,
                 "it has topics /imu/a (sensor_msgs/msg/Imu), /joint_states (sensor_msgs/msg/JointState), /camera",
                 read(log + mcap_end(), b));
}

TEST_F(LogFormats, McapWhoseChunksOverlapIsToBeSorted) {
  const std::string channel = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  const auto chunk = [&](std::uint32_t from, std::uint32_t step) {
    std::string records = channel;
    for (std::uint32_t k = 0; k < 50; ++k) {
      const std::uint32_t at = from + step * k;
      records += mcap_message(1, cdr_imu(at, 0, kSample), 1000000000ULL * at);
    }
    return mcap_chunk("", records, records.size(), 0);
  };
  EXPECT_REFUSES(ExitCode::kInput, "/imu: goes back within the time of the chunk before: sort",
                 read(mcap_head() + chunk(100, 2) + chunk(101, 2) + mcap_end()));
  read(mcap_head() + chunk(100, 1) + chunk(150, 1) + chunk(1, 1) + mcap_end());  // a clock that was reset
  EXPECT_EQ(collect_->samples.size(), 150U);
}

// Texts are let in before anything is known of them: a chunk of 17 KB can hold a name of 256 MiB.
TEST_F(LogFormats, McapNamesAreOfALengthThatNamesHave) {
  EXPECT_REFUSES(ExitCode::kInput, "schema: has no name",
                 read(mcap_head() + mcap_schema(1, std::string(2000, 'n')) + mcap_end()));
}

TEST_F(LogFormats, McapMessagesThatAreNone) {
  const std::string head = mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  const std::string whole = cdr_imu(1, 0, kSample);
  EXPECT_REFUSES(ExitCode::kInput, "shorter than its type",
                 read(head + mcap_message(1, whole.substr(0, whole.size() - 1)) + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "shorter than its type", read(head + mcap_message(1, "") + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "no linear acceleration",
                 read(head + mcap_message(1, cdr_imu(1, 0, kSample, 0.0, -1.0)) + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "no angular velocity",
                 read(head + mcap_message(1, cdr_imu(1, 0, kSample, -1.0, 0.0)) + mcap_end()));
  InertialSample<double> none = kSample;
  none.f.y() = std::nan("");
  EXPECT_REFUSES(ExitCode::kInput, "specific_force[1]: is not finite",
                 read(head + mcap_message(1, cdr_imu(1, 0, none)) + mcap_end()));
  std::string other_order = whole;
  other_order[1] = 0;  // big-endian: the same bytes are other numbers, or no message
  EXPECT_REFUSES(ExitCode::kInput, "", read(head + mcap_message(1, other_order) + mcap_end()));
}

// --- tables of other programs

TEST_F(LogFormats, TablesOfOtherPrograms) {
  const std::string row = "0.25,-0.5,0.125,1.5,-2.25,9.75\n";
  const auto only = [&](const std::string& text, std::int64_t stamp, double rate, double force) {
    SCOPED_TRACE(text);
    read(text);
    ASSERT_EQ(collect_->samples.size(), 1U);
    EXPECT_EQ(collect_->stamps[0], stamp);
    EXPECT_LT((collect_->samples[0].w - rate * kSample.w).norm(), 1e-12);
    EXPECT_LT((collect_->samples[0].f - force * kSample.f).norm(), 1e-12);
  };
  only(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m "
      "s^-2],a_RS_S_z [m s^-2]\n1403636579758555136," +
          row,
      1403636579758555, 1.0, 1.0);
  only(
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angular_velocity.x,field.angular_velocity"
      ".y,field.angular_velocity.z,field.linear_acceleration.x,field.linear_acceleration.y,field.linear_acceleration.z"
      "\n1500000000000000000,7,1400000000123456789,imu," +
          row,
      1400000000123457, 1.0, 1.0);
  only("TimeStartup,GyroX,GyroY,GyroZ,AccelX,AccelY,AccelZ,Temperature\n 12000," + row, 12, 1.0, 1.0);
  only("timeStartup,angularRateX,angularRateY,angularRateZ,accelX,accelY,accelZ\n12000," + row, 12, 1.0, 1.0);
  only("TimeStartup,UncompGyroX,UncompGyroY,UncompGyroZ,UncompAccX,UncompAccY,UncompAccZ\n12000," + row, 12, 1.0, 1.0);
  only(
      "// Start Time: Unknown\n// Update Rate: 100.0Hz\nPacketCounter\tSampleTimeFine\tGyr_X\tGyr_Y\tGyr_Z\tAcc_X\t"
      "Acc_Y\tAcc_Z\n7\t12\t0.25\t-0.5\t0.125\t1.5\t-2.25\t9.75\n",
      1200, 1.0, 1.0);
  only(
      "sep=,\nDeviceTag:,1\nFirmwareVersion:,3.0.0\nStartTime: ,2025\n\nPacketCounter,SampleTimeFine,Gyr_X,Gyr_Y,"
      "Gyr_Z,Acc_X,Acc_Y,Acc_Z\n1,345," +
          row,
      345, kRadPerDeg, 1.0);
  only(
      "DATA_START\nTime,inertial-6253.7:scaledGyroX,inertial-6253.7:scaledGyroY,inertial-6253.7:scaledGyroZ,"
      "inertial-6253.7:scaledAccelX,inertial-6253.7:scaledAccelY,inertial-6253.7:scaledAccelZ\n5000," +
          row,
      5, 1.0, kStandardGravity);
  only(
      "FILE_INFO\nDecimalSeparator=period\n\nDEVICE_INFO\nFirmwareVersion,1.1.19\n\nDATA_START\nGPS TFlags,GPS "
      "Week,GPS "
      "TOW,X Gyro [x8005],Y Gyro [x8005],Z Gyro [x8005],X Accel [x8004],Y Accel [x8004],Z Accel [x8004],Lat\n"
      "5,1,0.5,,,,,,,48.1\n5,1,1.5,0.25,-0.5,0.125,1.5,-2.25,9.75,\n",
      (315964800LL + 604801) * 1000000 + 500000, 1.0, kStandardGravity);
}

TEST_F(LogFormats, TablesOfOtherProgramsGoneWrong) {
  const std::string header = "TimeStartup,GyroX,GyroY,GyroZ,AccelX,AccelY,AccelZ\n";
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: accel_y: is not finite", read(header + "12,1,2,3,4,,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: accel_y: should be a number, is 'x'", read(header + "12,1,2,3,4,x,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: t: should be a number",
                 read("Time,scaledGyroX,scaledGyroY,scaledGyroZ,scaledAccelX,scaledAccelY,scaledAccelZ\n"
                      "2018-01-02 10:11:12.5,1,2,3,4,5,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:3: t: no such column",
                 read("// Update Rate: 100.0Hz\n// x\nPacketCounter\tGyr_X\n1\t2\n"));
}

TEST_F(LogFormats, TablesOfTwoInstruments) {
  const std::string row = "5000,1,1,1,0.25,-0.5,0.125,1.5,-2.25,9.75\n";
  const std::string of_b = "B:scaledGyroX,B:scaledGyroY,B:scaledGyroZ,B:scaledAccelX,B:scaledAccelY,B:scaledAccelZ";
  read("Time,A:scaledAccelX,A:scaledAccelY,A:scaledAccelZ," + of_b + "\n" + row);
  ASSERT_EQ(collect_->samples.size(), 1U);
  EXPECT_LT((collect_->samples[0].f - kStandardGravity * kSample.f).norm(), 1e-12) << "not A's beside B's";
  std::string of_a = of_b;
  for (char& c : of_a) c = c == 'B' ? 'A' : c;
  EXPECT_REFUSES(ExitCode::kInput, "B:scaledGyroX: is there of 'A:' too",
                 read("Time," + of_a + "," + of_b + "\n5000,1,2,3,4,5,6,1,2,3,4,5,6\n"));
}

TEST_F(LogFormats, TablesThatCannotBeUnderstood) {
  const std::string ours = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
  EXPECT_REFUSES(ExitCode::kInput, "gyro_x: is there twice, as 'gyro_x_rad_s' and 'gyro_x_deg_s'",
                 read(ours + ",gyro_x_deg_s\n1,2,3,4,5,6,7,8\n"));
  EXPECT_REFUSES(ExitCode::kInput, "or map one of its own under columns: in a run file: time, gx",
                 read("time,gx\n1,2\n"));
  EXPECT_REFUSES(ExitCode::kInput, "the file has no header; map its columns by index", read("1,2,3\n"));
  read(ours + "\n1,2,3,4,5,6,7\n   \n\t\r\n# a remark\n2,2,3,4,5,6,7\n  ");
  EXPECT_EQ(collect_->samples.size(), 2U);
}

TEST_F(LogFormats, TablesBeforeGpsTimeIsKnown) {
  const std::string header =
      "GPS Week,GPS TOW,X Gyro [x8005],Y Gyro [x8005],Z Gyro [x8005],X Accel [x8004],Y Accel [x8004],Z Accel "
      "[x8004]\n";
  EXPECT_EQ(read(header + "0,10,1,2,3,4,5,6\n2000,20,1,2,3,4,5,6\n").note,
            "1 rows of GPS week 0, before the time was known, are left out");
  EXPECT_EQ(collect_->samples.size(), 1U);
}

TEST_F(LogFormats, CountersThatWrap) {
  LogRequest request;
  request.channels.sheet.rate_hz = 100.0;
  request.columns["t"] = {"PacketCounter", -1, "samples"};
  const std::string header =
      "// Update Rate: 100.0Hz\nPacketCounter\tSampleTimeFine\tGyr_X\tGyr_Y\tGyr_Z\tAcc_X\tAcc_Y\tAcc_Z\n";
  read(header + "65534\t\t1\t2\t3\t4\t5\t6\n65535\t\t1\t2\t3\t4\t5\t6\n0\t\t1\t2\t3\t4\t5\t6\n1\t\t1\t2\t3\t4\t5\t6\n",
       request);
  EXPECT_THAT(collect_->stamps, ElementsAre(655340000, 655350000, 655360000, 655370000));
  request.channels.sheet.rate_hz = 0.0;
  EXPECT_REFUSES(ExitCode::kInput, "no sheet says their rate_hz", read(header + "1\t\t1\t2\t3\t4\t5\t6\n", request));
  read(
      "sep=,\nDeviceTag:,1\n\nPacketCounter,SampleTimeFine,Gyr_X,Gyr_Y,Gyr_Z,Acc_X,Acc_Y,Acc_Z\n"
      "1,4294960000,1,2,3,4,5,6\n2,1000,1,2,3,4,5,6\n");
  EXPECT_THAT(collect_->stamps, ElementsAre(4294960000, 4294968296));
}

TEST_F(LogFormats, TablesInUtf16) {
  EXPECT_REFUSES(ExitCode::kInput, "UTF-16: save it as UTF-8", read(std::string("\xff\xfet\0_\0s\0\n\0", 10)));
}

TEST_F(LogFormats, TablesOfAThermometerThatBeginsLate) {
  const std::unique_ptr<LogWriter> writer = format_by_name("csv").write(folder_ / "late.csv");
  writer->imu(1000000, kSample);
  writer->temperature(21.0);
  writer->imu(2000000, kSample);
  writer->commit();
  Collect collect;
  LogRequest request;
  request.path = folder_ / "late.csv";
  read_log(request, collect);
  EXPECT_THAT(collect.temperatures, ElementsAre(21.0));
  EXPECT_EQ(collect.samples.size(), 2U);
}

TEST_F(LogFormats, UnitAndEncodersInOneTable) {
  LogRequest both;
  both.need_encoder = true;
  const std::string text =
      "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,azimuth_rad,pitch_deg\n"
      "1,0.25,-0.5,0.125,1.5,-2.25,9.75,0.5,180\n";
  read(text, both);
  EXPECT_EQ(collect_->samples.size(), 1U);
  EXPECT_THAT(collect_->angles, ElementsAre(std::array<double, 2>{0.5, kPi}));
  read(text);
  EXPECT_TRUE(collect_->angles.empty());
}

TEST_F(LogFormats, DigestsAreOfTheWholeFile) {
  const std::string head = mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr") +
                           mcap_message(1, cdr_imu(1, 0, kSample)) + mcap_end();
  for (const std::string& text :
       {head + "what comes after",
        mip_packet({mip_accel(kSample.f), mip_gyro(kSample.w), mip_reference_time(1)}) + "end",
        ulog_head() + ulog_message('F', kCombinedFormat) + ulog_subscribe(0, 7, "sensor_combined") +
            ulog_combined(7, 1, kSample, 0) + "x"}) {
    Sha256 digest;
    LogRequest request;
    request.digest = &digest;
    read(text, request);
    EXPECT_EQ(digest.finish(), sha256(text));
  }
}

// --- real recordings

struct Seen {
  long long samples = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
  std::int64_t longest = 0;
  std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
  Vec3<double> force = Vec3<double>::Zero();
  double largest_rate = 0.0;
};

class Look final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    if (seen.samples++ == 0) {
      seen.first = utime;
    } else {
      seen.longest = std::max(seen.longest, utime - seen.last);
      seen.shortest = std::min(seen.shortest, utime - seen.last);
    }
    seen.last = utime;
    seen.force += s.f;
    seen.largest_rate = std::max(seen.largest_rate, s.w.cwiseAbs().maxCoeff());
  }
  void encoder(std::int64_t, double, double) override {}
  Seen seen;
};

class RealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(TRUNNION_DATA)) GTEST_SKIP() << "no recordings at " << TRUNNION_DATA;
  }
  Seen look(const char* file, LogRequest request = {}) {
    request.path = std::string(TRUNNION_DATA) + "/" + file;
    Look look_;
    losses_ = read_log(request, look_);
    look_.seen.force /= static_cast<double>(look_.seen.samples);
    std::printf("[ FIGURE   ] %s: %s, %lld samples, %.3f s, mean force %.4f m/s^2\n", file,
                format_of(request.path).name, look_.seen.samples,
                1e-6 * static_cast<double>(look_.seen.last - look_.seen.first), look_.seen.force.norm());
    return look_.seen;
  }
  LogLosses losses_;
};

TEST_F(RealRecordings, MicroStrainMip) {
  const Seen seen = look("formats/mip/mip_data.bin");
  EXPECT_EQ(seen.samples, 4473);
  EXPECT_EQ(losses_.records + losses_.bytes, 0);
  EXPECT_EQ(seen.shortest, 8000);
  EXPECT_EQ(seen.longest, 8000);
  EXPECT_EQ(seen.last - seen.first, 35776000);
  EXPECT_LT((seen.force / kStandardGravity - Vec3<double>(-0.0506, -0.0582, -0.9446)).cwiseAbs().maxCoeff(), 5e-5);
}

TEST_F(RealRecordings, Px4Ulog) {
  const Seen seen = look("formats/px4_ulog/sample.ulg");
  EXPECT_EQ(seen.samples, 17070);
  EXPECT_EQ(losses_.records + losses_.bytes, 0);
  EXPECT_NEAR(1e-6 * static_cast<double>(seen.last - seen.first), 68.9, 0.05);
  EXPECT_NEAR(seen.force.norm(), 9.8, 0.3) << "in flight";
}

TEST_F(RealRecordings, MicroStrainCsv) {
  const Seen seen = look("formats/microstrain_csv/microstrain.csv");
  EXPECT_EQ(seen.samples, 144);
  EXPECT_EQ(seen.first, (315964800LL + 1969LL * 604800) * 1000000 + 137649863104);
  EXPECT_NEAR(1e-6 * static_cast<double>(seen.longest), 0.01, 1e-5);
  EXPECT_NEAR(seen.force.norm(), 9.84, 0.05);
}

TEST_F(RealRecordings, NilsPodCsvByColumns) {
  LogRequest request;
  request.channels.sheet.rate_hz = 102.4;
  request.columns["t"] = {"n_samples", -1, "samples"};
  for (const char* axis : {"x", "y", "z"}) {
    request.columns[std::string("gyro_") + axis] = {std::string("gyr_") + axis, -1, "deg/s"};
    request.columns[std::string("accel_") + axis] = {std::string("acc_") + axis, -1, "m/s^2"};
  }
  const Seen seen = look("imucal_ferraris/example_ferraris_session.csv", request);
  EXPECT_EQ(seen.samples, 10376);
  EXPECT_NEAR(1e-6 * static_cast<double>(seen.last - seen.first), 10375 / 102.4, 1e-5);
  EXPECT_GT(seen.largest_rate, 1.0) << "turned by hand, rad/s";
  EXPECT_LT(seen.largest_rate, 20.0);
}

TEST_F(RealRecordings, CarDriveWithoutHeader) {
  LogRequest request;
  const std::array<const char*, 7> quantities = {"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z", "t"};
  for (std::size_t i = 0; i < quantities.size(); ++i)
    request.columns[quantities[i]] = {"", static_cast<int>(i), i < 3 ? "g" : i < 6 ? "deg/s" : "ms"};
  const Seen seen = look("gnss_imu_drive/drive_0708/imu_1934.csv", request);
  EXPECT_NEAR(1e-6 * static_cast<double>(seen.last - seen.first), 549.0, 1.0);
  EXPECT_NEAR(static_cast<double>(seen.samples) / (1e-6 * static_cast<double>(seen.last - seen.first)), 100.0, 1.0);
  EXPECT_NEAR(seen.force.norm(), 9.8, 0.3);
}

}  // namespace
}  // namespace trunnion::io
