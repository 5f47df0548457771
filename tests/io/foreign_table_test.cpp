// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/log_reading.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

using ForeignTables = LogReading;

TEST_F(ForeignTables, OfEveryKnownProgram) {
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

TEST_F(ForeignTables, GoneWrong) {
  const std::string header = "TimeStartup,GyroX,GyroY,GyroZ,AccelX,AccelY,AccelZ\n";
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: accel_y: is not finite", read(header + "12,1,2,3,4,,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: accel_y: should be a number, is 'x'", read(header + "12,1,2,3,4,x,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: t: should be a number",
                 read("Time,scaledGyroX,scaledGyroY,scaledGyroZ,scaledAccelX,scaledAccelY,scaledAccelZ\n"
                      "2018-01-02 10:11:12.5,1,2,3,4,5,6\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:3: t: no such column",
                 read("// Update Rate: 100.0Hz\n// x\nPacketCounter\tGyr_X\n1\t2\n"));
}

TEST_F(ForeignTables, InQuotes) {
  read(
      "\"t_s\",\"gyro_x_rad_s\",\"gyro_y_rad_s\",\"gyro_z_rad_s\",\"place, \"\"here\"\"\",\"accel_x_m_s2\","
      "\"accel_y_m_s2\",\"accel_z_m_s2\"\r\n"
      "\"1\",\"0.25\",-0.5,\"0.125\",\"a, \"\"b\"\", c\",1.5,\"-2.25\",\"9.75\"\r\n"
      "\"+2\",0.25,-0.5,0.125,,1.5,-2.25,\"9.75\" ,\r\n");
  EXPECT_THAT(collect_->stamps, ElementsAre(1000000, 2000000));
  for (const InertialSample<double>& sample : collect_->samples) {
    EXPECT_EQ(sample.w, kSample.w);
    EXPECT_EQ(sample.f, kSample.f);
  }
  LogRequest mine;
  mine.columns["t"] = {"Time, s", -1, "s"};
  const std::string header = "\"Time, s\";gyro_x_rad_s;gyro_y_rad_s;gyro_z_rad_s;accel_x_g;accel_y_g;accel_z_g\n";
  read(header + "1.5;1;2;3;4;5;6\n", mine);
  EXPECT_THAT(collect_->stamps, ElementsAre(1500000));
  EXPECT_REFUSES(ExitCode::kInput, "is '1,5': a decimal comma, where a point is read",
                 read(header + "1,5;1;2;3;4;5;6\n", mine));
  EXPECT_REFUSES(ExitCode::kInput, "gyro_y: should be a number, is 'x\"\"y'",
                 read(header + "1;1;\"x\"\"y\";3;4;5;6\n", mine));
  EXPECT_REFUSES(ExitCode::kInput, "has no row of numbers", read(header, mine));
}

TEST_F(ForeignTables, WithEmptyRowsAndRowsOfNoNumber) {
  const std::string header = "TimeStartup,GyroX,GyroY,GyroZ,AccelX,AccelY,AccelZ\n";
  const std::string row = "1000,1,2,3,4,5,6\n";
  read(header + row + "2000,,,,,,\n" + row);
  EXPECT_EQ(collect_->samples.size(), 2U) << "of another instrument";
  EXPECT_REFUSES(ExitCode::kInput, "a.log:3: gyro_x: is not finite",
                 read(header + row + "2000,nan,nan,nan,nan,nan,nan\n"));
}

TEST_F(ForeignTables, WithCommentsAboveTheHeader) {
  const std::string header = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
  const std::string row = "1,0.25,-0.5,0.125,1.5,-2.25,9.75\n";
  for (const std::string above : {"# by hand, on the bench\n", "% a\n\n% b, c\n", "#\n", "# 1\n# 2\n"}) {
    read(above + header + row);
    EXPECT_EQ(collect_->samples.size(), 1U) << above;
    read(above + "# " + header + "\n" + row);
    EXPECT_EQ(collect_->samples.size(), 1U) << above;
  }
  constexpr const char* kAxes[] = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};
  LogRequest by_index;
  by_index.columns["t"] = {"", 0, "s"};
  for (int k = 0; k < 6; ++k) by_index.columns[kAxes[k]] = {"", k + 1, k < 3 ? "rad/s" : "m/s^2"};
  read("% no names\n" + row, by_index);
  EXPECT_EQ(collect_->samples[0].f, kSample.f);
  EXPECT_REFUSES(ExitCode::kInput, "has no header", read("% no names\n" + row));
}

TEST_F(ForeignTables, WhoseRowsDoNotFitTheirHeader) {
  const std::string header = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
  const std::string row = "1,0.25,-0.5,0.125,1.5,-2.25,9.75";
  EXPECT_REFUSES(ExitCode::kInput, "a.log:3: has 8 cells under a header of 7",
                 read(header + row + "\n" + row + ",8\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: has 14 cells under a header of 7",
                 read(header + "0,000,0,100,0,200,0,300,0,100,0,200,9,800\n"));
  std::string blanks = header + "\"1\" " + row;  // names of rows, as R writes them
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  EXPECT_REFUSES(ExitCode::kInput, "a.log:2: has 8 cells under a header of 7", read(blanks));
  read(header + row + ",,\r\n,,,,,,\n" + row + ", \n");
  EXPECT_EQ(collect_->samples.size(), 2U) << "empty cells and empty rows of a spreadsheet";
  LogRequest twice;
  twice.columns["gyro_y"] = {"gyro_x_rad_s", -1, "rad/s"};
  EXPECT_REFUSES(ExitCode::kInput, "gyro_y: is of the same column as gyro_x", read(header + row, twice));
  EXPECT_REFUSES(ExitCode::kInput, "a.log:1: has a carriage return within", read("a\rb\rc\n"));
}

TEST_F(ForeignTables, KnowATemperatureOrKnowItNoMore) {
  read(
      "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,temperature_deg_c\n"
      "1,1,2,3,4,5,6,nan\n2,1,2,3,4,5,6,25\n3,1,2,3,4,5,6,\n4,1,2,3,4,5,6\n5,1,2,3,4,5,6,nan\n6,1,2,3,4,5,6,-\n");
  EXPECT_THAT(collect_->temperatures, ElementsAre(25.0, testing::IsNan()));
}

TEST_F(ForeignTables, WhoseLinesOrColumnsAreAmbiguous) {
  const std::string header = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_g,accel_y_g,accel_z_g,note";
  const std::string row = "1,1,2,3,4,5,6,x";
  read(header + "\r\n" + row + "\r\r\n" + row + "\r\n");
  EXPECT_EQ(collect_->samples.size(), 2U);
  for (const std::string& ends : {row + "\r" + row + "\n", "1,1,2,3,4,5,6\r1,1,2,3,4,5,6\n" + row})
    EXPECT_REFUSES(ExitCode::kInput, "a.log:2: has a carriage return within", read(header + "\n" + ends));
  EXPECT_REFUSES(ExitCode::kInput, "gyro_y: is there twice, as 'GyroY'",
                 read("TimeStartup,GyroX,GyroY,GyroY,GyroZ,AccelX,AccelY,AccelZ\n1,1,2,3,4,5,6,7\n"));
  std::string wide = "TimeStartup";
  for (int i = 0; i < 5000; ++i) wide += "," + std::to_string(i) + ":GyroX";
  EXPECT_REFUSES(ExitCode::kInput, "has more than 4096 columns", read(wide + "\n"));
}

TEST_F(ForeignTables, OfTwoInstruments) {
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

TEST_F(ForeignTables, ThatCannotBeUnderstood) {
  const std::string ours = "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
  EXPECT_REFUSES(ExitCode::kInput, "gyro_x: is there twice, as 'gyro_x_rad_s' and 'gyro_x_deg_s'",
                 read(ours + ",gyro_x_deg_s\n1,2,3,4,5,6,7,8\n"));
  EXPECT_REFUSES(ExitCode::kInput, "or map one of its own under columns: in a run file: time, gx",
                 read("time,gx\n1,2\n"));
  EXPECT_REFUSES(ExitCode::kInput, "the file has no header; map its columns by index", read("1,2,3\n"));
  read(ours + "\n1,2,3,4,5,6,7\n   \n\t\r\n# a remark\n2,2,3,4,5,6,7\n  ");
  EXPECT_EQ(collect_->samples.size(), 2U);
}

TEST_F(ForeignTables, BeforeGpsTimeIsKnown) {
  const std::string header =
      "GPS Week,GPS TOW,X Gyro [x8005],Y Gyro [x8005],Z Gyro [x8005],X Accel [x8004],Y Accel [x8004],Z Accel "
      "[x8004]\n";
  EXPECT_EQ(read(header + "0,10,1,2,3,4,5,6\n2000,20,1,2,3,4,5,6\n").note,
            "1 rows of GPS week 0, before the time was known, are left out");
  EXPECT_EQ(collect_->samples.size(), 1U);
}

TEST_F(ForeignTables, CountersThatWrap) {
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

TEST_F(ForeignTables, InUtf16) {
  EXPECT_REFUSES(ExitCode::kInput, "UTF-16: save it as UTF-8", read(std::string("\xff\xfet\0_\0s\0\n\0", 10)));
}

TEST_F(ForeignTables, OfAThermometerThatBeginsLate) {
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

TEST_F(ForeignTables, UnitAndEncodersInOneTable) {
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

}  // namespace
}  // namespace trunnion::io
