// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/run_file.hpp"

#include <gtest/gtest.h>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/earth.hpp"

namespace trunnion::io {
namespace {

const char* const kRun =
    "format: trunnion-run/1\n"
    "site: {latitude_deg: 43.88, height_m: 220}\n"
    "rig: table.urdf\n"
    "recordings:\n"
    "  - {mount: mount_1, log: one.lcm}\n";

class RunFileTest : public testing::Test {
 protected:
  RunFile read(const std::string& text) { return read_run_file(folder_.file("run.yaml", text)); }
  static std::string with(const std::string& more) { return std::string(kRun) + more; }
  TemporaryFolder folder_;
};

TEST_F(RunFileTest, ResolvesPathsAgainstItselfAndFillsInTheDefaults) {
  const RunFile run = read(kRun);
  EXPECT_EQ(run.rig, folder_ / "table.urdf");
  ASSERT_EQ(run.recordings.size(), 1U);
  EXPECT_EQ(run.recordings[0].log, folder_ / "one.lcm");
  EXPECT_EQ(run.site.gravity, normal_gravity(43.88 * kRadPerDeg, 220.0));
  EXPECT_EQ(run.site.gravity_sigma, 3e-4);
  EXPECT_TRUE(run.cubic && run.g_sensitivity && !run.quadratic && run.bias_per_recording && run.estimate_clock_offset);
}

TEST_F(RunFileTest, ReadsEveryKey) {
  const RunFile run = read(
      with("axes: [yaw, tilt]\nserial: A1\nclock: {imu_to_encoder_offset: 0.002}\nbias: shared\nmodel: [quadratic]\n"
           "refuse_above: {gyro_scale_ppm: 1000}\nlimits: {gyro_bias_deg_per_h: {value: 100, sigma: 2}}\nchannels: "
           "{imu: A, encoder: B}\n"
           "columns: {t: {column: 0, unit: s}, gyro_x: {column: rate x, unit: deg/s}}\n"));
  EXPECT_EQ(run.outer_axis, "yaw");
  EXPECT_EQ(run.inner_axis, "tilt");
  EXPECT_FALSE(run.estimate_clock_offset);
  EXPECT_EQ(run.clock_offset, 0.002);
  EXPECT_TRUE(run.quadratic && !run.cubic && !run.bias_per_recording);
  EXPECT_EQ(run.refuse_above[static_cast<std::size_t>(Entry::kGyroScale)], 1000.0);
  EXPECT_EQ(run.limits[static_cast<std::size_t>(Entry::kGyroBias)].sigma, 2.0);
  EXPECT_EQ(run.columns.at("gyro_x").name, "rate x");
}

TEST_F(RunFileTest, NamesAnUnknownKeyAndTheNearestKnownOne) {
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:6: recording: unknown key; did you mean 'recordings'?",
                 read(with("recording: 3\n")));
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:2: site.latitude: unknown key; did you mean 'latitude_deg'?",
                 read("format: trunnion-run/1\nsite: {latitude: 3}\nrecordings: [{log: a}]\n"));
  EXPECT_REFUSES(ExitCode::kInput, "refuse_above.gyro_scale: unknown key; did you mean 'gyro_scale_ppm'?",
                 read(with("refuse_above: {gyro_scale: 3}\n")));
  EXPECT_REFUSES(ExitCode::kInput, "model[0]: unknown term 'cubik'; did you mean 'cubic'?",
                 read(with("model: [cubik]\n")));
}

TEST_F(RunFileTest, NamesAWrongTypeRangeOrUnit) {
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:2: site.latitude_deg: should be a number, is 'north'",
                 read("format: trunnion-run/1\nsite: {latitude_deg: north}\nrecordings: [{log: a}]\n"));
  EXPECT_REFUSES(ExitCode::kInput, "site.latitude_deg: should lie in [-90, 90], is 143.88",
                 read("format: trunnion-run/1\nsite: {latitude_deg: 143.88}\nrecordings: [{log: a}]\n"));
  EXPECT_REFUSES(ExitCode::kInput,
                 "columns.gyro_x.unit: 'm/s' does not measure gyro_x: one of rad/s, deg/s, deg/h, counts",
                 read(with("columns: {gyro_x: {column: 1, unit: m/s}}\n")));
  EXPECT_REFUSES(ExitCode::kInput, "format: should be trunnion-run/1",
                 read("format: trunnion-run/2\nsite: {latitude_deg: 1}\nrecordings: []\n"));
  EXPECT_REFUSES(ExitCode::kInput, "recordings: is empty",
                 read("format: trunnion-run/1\nsite: {latitude_deg: 1}\nrecordings: []\n"));
  EXPECT_REFUSES(ExitCode::kInput, "recordings[0].mount: is missing",
                 read("format: trunnion-run/1\nsite: {latitude_deg: 1}\nrig: a\nrecordings: [{log: a}]\n"));
  EXPECT_REFUSES(ExitCode::kInput, "bias: stands twice", read(with("bias: shared\nbias: shared\n")));
  EXPECT_REFUSES(ExitCode::kInput, "columns.t: stands twice",
                 read(with("columns: {t: {column: 0, unit: s}, t: {column: 1, unit: s}}\n")));
  EXPECT_REFUSES(ExitCode::kInput, "recordings[0].log.encoder: the run has no rig",
                 read("format: trunnion-run/1\nsite: {latitude_deg: 1}\nrecordings: [{log: {imu: a, encoder: b}}]\n"));
  EXPECT_REFUSES(ExitCode::kInput, "not YAML, as trunnion-run/1 is", read("format: [\n"));
  EXPECT_REFUSES(ExitCode::kInput, "a recording is named in a run file", read(std::string(5 << 20, '\xed')));
  EXPECT_REFUSES(ExitCode::kInput, "nested too deep", read("format: " + std::string(5000, '[') + "\n"));
  const std::string run = "format: trunnion-run/1\nsite: {latitude_deg: 1}\nrecordings: [{log: a.lcm}]\n";
  EXPECT_NO_THROW(read("%YAML 1.2\n# one\n---\n" + run + "...\n# end\n"));
  EXPECT_NO_THROW(read("--- # one\n" + run + "serial: ---x\n"));
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:4: begins another document", read(run + "---\n" + run));
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:4: begins another document", read(run + "--- \r\n"));
  EXPECT_REFUSES(ExitCode::kInput, "run.yaml:6: begins another document", read(run + "...\n\nserial: 7\n"));
}

TEST_F(RunFileTest, ReadsTheSheetBesideIt) {
  static_cast<void>(folder_.file("sheet.yaml",
                                 "format: trunnion-sheet/1\nmodel: M\nrate_hz: 400\n"
                                 "gyroscope: {range_deg_per_s: 500, noise_deg_per_h_per_rt_hz: 5, "
                                 "bias_instability_deg_per_h: 1.5, bias_correlation_time_s: 200}\n"
                                 "accelerometer: {range_g: 8, noise_ug_per_rt_hz: 25}\n"));
  const RunFile run = read(with("sheet: sheet.yaml\n"));
  EXPECT_TRUE(run.sheet.has_noise);
  EXPECT_NEAR(run.sheet.noise.gyro.density, 5.0 * kRadPerSPerDegPerH, 1e-18);
  EXPECT_NEAR(run.sheet.accel_range, 8.0 * kStandardGravity, 1e-12);
  static_cast<void>(folder_.file(
      "sheet.yaml",
      "format: trunnion-sheet/1\nmodel: M\ngyroscope: {noise_deg_per_h_per_rt_hz: 5}\naccelerometer: {}\n"));
  EXPECT_REFUSES(ExitCode::kInput, "sheet.yaml:4: accelerometer: states no noise, while the other triad does",
                 read(with("sheet: sheet.yaml\n")));
  static_cast<void>(folder_.file(
      "sheet.yaml",
      "format: trunnion-sheet/1\nmodel: M\ngyroscope: {bias_instability_deg_per_h: 5}\naccelerometer: {}\n"));
  EXPECT_REFUSES(ExitCode::kInput, "gyroscope.bias_correlation_time_s: is missing", read(with("sheet: sheet.yaml\n")));
}

}  // namespace
}  // namespace trunnion::io
