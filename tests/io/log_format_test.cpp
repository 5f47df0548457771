// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/log_format.hpp"

#include <filesystem>
#include <limits>

#include "io/format_bytes.hpp"
#include "io/log_reading.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

using LogFormats = LogReading;

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
  EXPECT_REFUSES(ExitCode::kInput, "is a folder: name the recording in it", format_of("/"));
}

TEST_F(LogFormats, SayWhatAFileIsThatIsNone) {
  for (const auto& [head, words] :
       {std::pair{std::string("\x1f\x8b\x08\0", 4), "gunzip"},
        std::pair{std::string("#ROSBAG V2.0\n"), "rosbags-convert"},
        std::pair{std::string("SQLite format 3\0", 16), "ros2 bag convert"},
        std::pair{std::string("PK\x03\x04"), "zip"}, std::pair{std::string("PAR1\x15\x04"), "Parquet"},
        std::pair{std::string("<?xml version"), "XML"}, std::pair{std::string("{\"t\": 1"), "JSON"}}) {
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
