// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/csv.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/log_format.hpp"

namespace trunnion::io {
namespace {

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    stamps.push_back(utime);
    samples.push_back(s);
  }
  void encoder(std::int64_t utime, double a, double p) override {
    stamps.push_back(utime);
    angles.push_back({a, p});
  }
  std::vector<std::int64_t> stamps;
  std::vector<InertialSample<double>> samples;
  std::vector<std::array<double, 2>> angles;
};

const char* const kHeader = "t_s,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,accel_x_g,accel_y_g,accel_z_g\n";

class Csv : public testing::Test {
 protected:
  Collect& read(const std::string& text, const ColumnMap& map = {}, const SensorSheet& sheet = {}) {
    LogRequest request;
    request.path = folder_.file("a.csv", text);
    request.columns = map;
    request.channels.sheet = sheet;
    Sha256 digest;
    request.digest = &digest;
    format_by_name("csv").read(request, collect_);
    digest_ = digest.finish();
    return collect_;
  }
  TemporaryFolder folder_;
  Collect collect_;
  std::string digest_;
};

TEST_F(Csv, FindsColumnsByHeaderAndConvertsUnits) {
  read(std::string(kHeader) + "0.01,180,0,-90,0,0,1\n0.02,1e1,+2,3,4,5,6\r\n");
  ASSERT_EQ(collect_.samples.size(), 2U);
  EXPECT_EQ(collect_.stamps[0], 10000);
  EXPECT_NEAR(collect_.samples[0].w.x(), kPi, 1e-15);
  EXPECT_EQ(collect_.samples[0].f.z(), kStandardGravity);
  EXPECT_NEAR(collect_.samples[1].w.y(), 2.0 * kRadPerDeg, 1e-15);
  EXPECT_EQ(digest_.size(), 64U);
}

TEST_F(Csv, ColumnsMayStandInAnyOrderAmongOthers) {
  read(
      "note;accel_z_m_s2;t_ms;gyro_x_rad_s;gyro_y_rad_s;gyro_z_rad_s;accel_x_m_s2;accel_y_m_s2\nhello;9.8;5;1;2;3;4;"
      "5\n");
  ASSERT_EQ(collect_.samples.size(), 1U);
  EXPECT_EQ(collect_.stamps[0], 5000);
  EXPECT_EQ(collect_.samples[0].f, Vec3<double>(4, 5, 9.8));
}

TEST_F(Csv, AMapServesAFileWithoutHeader) {
  ColumnMap map;
  map["t"] = {"", 0, "us"};
  int index = 1;
  for (const char* q : {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"})
    map[q] = {"", index++, "counts"};
  SensorSheet sheet;
  sheet.counts.gyro = {100.0, 32768.0};
  sheet.counts.accel = {10.0, 0.0};
  read("5000 32868 32768 32668 10 20 98\n", map, sheet);
  EXPECT_EQ(collect_.stamps[0], 5000);
  EXPECT_EQ(collect_.samples[0].w, Vec3<double>(1, 0, -1));
  EXPECT_EQ(collect_.samples[0].f, Vec3<double>(1, 2, 9.8));
}

TEST_F(Csv, RefusesAndSaysWhere) {
  EXPECT_REFUSES(ExitCode::kInput, "a.csv: is empty", read("\n  \n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.csv:3: row too short: 4 columns, 7 needed",
                 read(std::string(kHeader) + "0,0,0,0,0,0,1\n0.01,1,2,3\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.csv:2: gyro_y: should be a number, is 'x7'",
                 read(std::string(kHeader) + "0,0,x7,0,0,0,1\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.csv:2: accel_z: is not finite", read(std::string(kHeader) + "0,0,0,0,0,0,nan\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.csv:1: gyro_x: the header has no unit: name it one of gyro_x_rad_s, gyro_x_deg_s",
                 read("t_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n0,0,0,0,0,0,1\n"));
  ColumnMap map;
  map["t"] = {"Tiem", -1, "s"};
  EXPECT_REFUSES(ExitCode::kInput, "a.csv:1: t: no column 'Tiem'; nearest is 'Time'", read("Time,a\n0,0\n", map));
}

TEST_F(Csv, TwoFilesMustAgreeInTheirStamps) {
  const std::string gyro = folder_.file("g.txt", "0.00 1 2 3\n0.01 4 5 6\n");
  std::string other;
  read_split_csv(gyro, folder_.file("a.txt", "0.00 1 2 3\n0.01 4 5 6\n"), {}, {}, collect_, digest_, other);
  ASSERT_EQ(collect_.samples.size(), 2U);
  EXPECT_EQ(collect_.samples[1].w, Vec3<double>(4, 5, 6));
  EXPECT_REFUSES(
      ExitCode::kInput, "b.txt:2: t: is not the stamp of the same row",
      read_split_csv(gyro, folder_.file("b.txt", "0.00 1 2 3\n0.02 4 5 6\n"), {}, {}, collect_, digest_, other));
  EXPECT_REFUSES(ExitCode::kInput, "has more rows than",
                 read_split_csv(gyro, folder_.file("c.txt", "0.00 1 2 3\n"), {}, {}, collect_, digest_, other));
}

TEST_F(Csv, AHeaderOfTwoFilesIsHeeded) {
  const std::string gyro = folder_.file("g.csv", "t_s,gyro_y_rad_s,gyro_z_rad_s,gyro_x_deg_s\n0.00,2,3,180\n");
  const std::string accel = folder_.file("a.csv", "t_s,accel_z_m_s2,accel_y_m_s2,accel_x_m_s2\n0.00,3,2,1\n");
  std::string other;
  read_split_csv(gyro, accel, {}, {}, collect_, digest_, other);
  EXPECT_NEAR(collect_.samples.at(0).w.x(), kPi, 1e-12);
  EXPECT_EQ(collect_.samples[0].w.tail<2>(), Eigen::Vector2d(2, 3));
  EXPECT_EQ(collect_.samples[0].f, Vec3<double>(1, 2, 3));
  EXPECT_REFUSES(ExitCode::kInput, "b.txt:1: has no header, while the other file has one",
                 read_split_csv(gyro, folder_.file("b.txt", "0.00 1 2 3\n"), {}, {}, collect_, digest_, other));
}

TEST_F(Csv, ReadsEncoders) {
  LogRequest request;
  request.path = folder_.file("e.csv", "t_s,azimuth_deg,pitch_rad\n1,180,0.5\n");
  request.need_imu = false;
  request.need_encoder = true;
  read_log(request, collect_);
  ASSERT_EQ(collect_.angles.size(), 1U);
  EXPECT_NEAR(collect_.angles[0][0], kPi, 1e-15);
  EXPECT_EQ(collect_.angles[0][1], 0.5);
}

TEST_F(Csv, ReadsBackWhatItWrites) {
  const InertialSample<double> sample{Vec3<double>(0.1, 1.0 / 3.0, -1e-17), Vec3<double>(9.81, 2e5, 0.0)};
  LogRequest request;
  request.path = folder_ / "written.csv";
  const std::unique_ptr<LogWriter> writer = format_by_name("csv").write(request.path);
  writer->imu(12500000, sample);
  writer->imu(12510000, sample);
  writer->commit();
  read_log(request, collect_);
  ASSERT_EQ(collect_.samples.size(), 2U);
  EXPECT_EQ(collect_.samples[0].w, sample.w);
  EXPECT_EQ(collect_.samples[0].f, sample.f);
}

}  // namespace
}  // namespace trunnion::io
