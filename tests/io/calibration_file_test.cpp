// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/calibration_file.hpp"

#include <gtest/gtest.h>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"

namespace trunnion::io {
namespace {

CalibrationFile example() {
  CalibrationFile file;
  file.model = "3DM-CV7";
  file.serial = "6286.12345";
  file.mounts = {"mount_1", "mount_2"};
  CalibrationRecord& r = file.record;
  r.has_rig = true;
  r.mounts = 2;
  r.recordings = 2;
  r.recording_mount[1] = 1;
  r.value.unit.gyro.bias = Vec3<double>(0.1, 1.0 / 3.0, -1e-9);
  r.value.unit.gyro.M << 1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3, 9e-3;
  r.value.unit.accel.M(1, 2) = 0.01;
  r.value.rig.heading = -1.5;
  r.value.rig.eccentricity[1] = {1e-5, -2e-5};
  r.value.mount_error[1] = Vec3<double>(1e-4, 2e-4, 3e-4);
  r.value.lever_arm[0] = Vec3<double>(0.04, 0, 0);
  r.value.clock_offset = -0.003;
  r.value.recording_bias[1].w = Vec3<double>(0.5, 0.6, 0.7);
  r.sigma.unit.gyro.bias = Vec3<double>(1e-6, 2e-6, 3e-6);
  r.sigma.rig.heading = 0.01;
  file.gauge = {"pitch_encoder_zero"};
  file.tool = "imu_calibrate 0.1.0";
  file.run = "run.yaml";
  file.inputs = {{"position_1.lcm", std::string(64, 'a')}};
  return file;
}

TEST(CalibrationFile, ReadsBackWhatItWritesToTheLastBit) {
  const TemporaryFolder folder;
  const CalibrationFile a = example();
  const CalibrationFile b = read_calibration_file(folder.file("c.yaml", to_yaml(a)));
  EXPECT_EQ(b.model, a.model);
  EXPECT_EQ(b.serial, a.serial);
  EXPECT_EQ(b.mounts, a.mounts);
  EXPECT_EQ(b.record.value.unit.gyro.bias, a.record.value.unit.gyro.bias);
  // I + M is written, so M comes back to an epsilon of one
  EXPECT_LT((b.record.value.unit.gyro.M - a.record.value.unit.gyro.M).cwiseAbs().maxCoeff(), 2.3e-16);
  EXPECT_EQ(b.record.value.rig.heading, -1.5);
  EXPECT_EQ(b.record.value.mount_error[1], a.record.value.mount_error[1]);
  EXPECT_EQ(b.record.value.lever_arm[0], a.record.value.lever_arm[0]);
  EXPECT_EQ(b.record.value.clock_offset, -0.003);
  EXPECT_EQ(b.record.value.recording_bias[1].w, a.record.value.recording_bias[1].w);
  EXPECT_EQ(b.record.recording_mount[1], 1);
  EXPECT_EQ(b.record.sigma.unit.gyro.bias, a.record.sigma.unit.gyro.bias);
  EXPECT_EQ(b.record.sigma.unit.gyro.M, Mat3<double>::Zero());
}

TEST(CalibrationFile, ReadsBackTheFurtherTerms) {
  const TemporaryFolder folder;
  CalibrationFile a = example();
  InertialUnit<double>& unit = a.record.value.unit;
  unit.gyro.asymmetry = Vec3<double>(1e-4, -2e-4, 3e-4);
  unit.accel.asymmetry = Vec3<double>(0.0, 1e-5, 0.0);
  unit.accel_place.col(1) = Vec3<double>(0.01, 0.02, -0.03);
  unit.thermal.reference = 20.0;
  unit.thermal.lowest = -19.5;
  unit.thermal.highest = 1.0 / 3.0;
  unit.thermal.bias[0].w.x() = 1e-5;
  unit.thermal.scale[2].f = Vec3<double>(1e-9, 2e-9, 3e-9);
  a.record.sigma.unit.accel_place.col(1) = Vec3<double>(1e-5, 2e-5, 3e-5);
  a.record.sigma.unit.thermal.scale[2].f.z() = 1e-11;
  const CalibrationFile b = read_calibration_file(folder.file("c.yaml", to_yaml(a)));
  const InertialUnit<double>& back = b.record.value.unit;
  EXPECT_EQ(back.gyro.asymmetry, unit.gyro.asymmetry);
  EXPECT_EQ(back.accel.asymmetry, unit.accel.asymmetry);
  EXPECT_EQ(back.accel_place, unit.accel_place);
  EXPECT_EQ(back.thermal.reference, 20.0);
  EXPECT_EQ(back.thermal.lowest, -19.5);
  EXPECT_EQ(back.thermal.highest, 1.0 / 3.0);
  EXPECT_EQ(back.thermal.order(), 3);
  EXPECT_EQ(back.thermal.bias[0].w, unit.thermal.bias[0].w);
  EXPECT_EQ(back.thermal.scale[2].f, unit.thermal.scale[2].f);
  EXPECT_EQ(b.record.sigma.unit.accel_place, a.record.sigma.unit.accel_place);
  EXPECT_EQ(b.record.sigma.unit.thermal.scale[2].f, a.record.sigma.unit.thermal.scale[2].f);
}

TEST(CalibrationFile, WritesNullForWhatWasNotEstimated) {
  const std::string text = to_yaml(example());
  EXPECT_THAT(text, testing::HasSubstr("matrix: [[null,null,null]"));
  EXPECT_THAT(text, testing::HasSubstr("serial: \"6286.12345\""));
}

TEST(CalibrationFile, RefusesWhatItCannotUse) {
  const TemporaryFolder folder;
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = to_yaml(example());
    text.replace(text.find(from), from.size(), to);
    return folder.file("c.yaml", text);
  };
  EXPECT_REFUSES(ExitCode::kInput, "gyroscope.bias: unknown key; did you mean 'bias_rad_s'?",
                 read_calibration_file(changed("bias_rad_s", "bias")));
  EXPECT_REFUSES(ExitCode::kInput, "format: should be trunnion-calibration/1",
                 read_calibration_file(changed("calibration/1", "calibration/9")));
  EXPECT_REFUSES(ExitCode::kInput, "verdict: should be within_limits or out_of_limits",
                 read_calibration_file(changed("verdict: \"within_limits\"", "verdict: bananas")));
  EXPECT_REFUSES(ExitCode::kInput, "gyroscope.bias_rad_s[0]: should be a number",
                 read_calibration_file(changed("bias_rad_s: [", "bias_rad_s: [null, 0, 0] #")));
  EXPECT_REFUSES(ExitCode::kInput, "sigma.gyroscope.bias_rad_s[1]: is a sigma, and negative", {
    std::string text = to_yaml(example());
    const std::size_t at = text.find("bias_rad_s: [", text.find("sigma:"));
    read_calibration_file(folder.file("c.yaml", text.replace(at, 13, "bias_rad_s: [0, -1e-9, 0] # ")));
  });
  EXPECT_REFUSES(ExitCode::kInput, "is no mount of the rig",
                 read_calibration_file(changed("\"mount\":\"mount_2\"", "\"mount\":\"mount_7\"")));
}

}  // namespace
}  // namespace trunnion::io
