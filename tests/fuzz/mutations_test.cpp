// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Mutated logs, tables, YAML files and URDFs, 2500 of each kind: each is read to its end or refused, and never
/// anything else. Under the sanitize preset a memory error or undefined behaviour ends the test.

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "fuzz/mutate.hpp"
#include "matchers/log_request.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/calibration/compress.hpp"
#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/urdf.hpp"

namespace trunnion {
namespace {

constexpr int kMutations = 2500;  // of each kind

/// Feeds mutations of @p seed to @p read; every outcome but a clean read or an Error fails the test.
void run(const char* kind, const std::string& seed, const std::string& path, const std::function<void()>& read) {
  std::mt19937_64 rng(20261122);
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    io::write_whole(path, mutate(seed, rng));
    try {
      read();
    } catch (const Error& e) {
      ++refused;
      ASSERT_EQ(e.code(), ExitCode::kInput) << e.what();
      ASSERT_STRNE(e.what(), "");
    }
  }
  std::printf("[ FIGURE   ] %s: %d mutations, %d read, %d refused\n", kind, kMutations, kMutations - refused, refused);
  // the mutations must bite, and must not all be caught at the door
  EXPECT_GT(refused, kMutations / 100);
  EXPECT_LT(refused, kMutations);
}

TEST(Mutations, OfLogs) {
  const TemporaryFolder folder;
  const std::string path = folder / "fuzz.lcm";
  io::LcmLogWriter log(path);
  std::string message;
  for (int i = 0; i < 300; ++i) {
    io::encode_imu(1000000 + 2500 * i, i, {Vec3<double>(0.1, 0.01 * (i % 7), 0.3), Vec3<double>(1, 2, 9.8)}, message);
    log.write(i, "IMU", message);
    io::encode_encoder(1000000 + 2500 * i, i, 0.01 * i, 0.5, message);
    log.write(i, "ENCODER", message);
  }
  log.commit();
  run("logs", io::read_whole(path), path, [&] {
    calibration::CompressOptions options;
    options.name = path;
    calibration::Compressor compressor(options);
    io::read_lcm_recording(io::log_request(path, {}, true), compressor);
    static_cast<void>(compressor.finish());
  });
}

TEST(Mutations, OfTables) {
  const TemporaryFolder folder;
  const std::string path = folder / "fuzz.csv";
  const std::unique_ptr<io::LogWriter> writer = io::format_by_name("csv").write(path);
  for (int i = 0; i < 400; ++i) writer->imu(10000 * i, {Vec3<double>(0.1, 0.2, 0.3), Vec3<double>(1, 2, 9.8)});
  writer->commit();
  const std::string text = io::read_whole(path);
  run("tables", text, path, [&] {
    calibration::Compressor compressor({});
    io::format_by_name("csv").read(io::log_request(path, {}, false), compressor);
    static_cast<void>(compressor.finish());
  });
  run("tables by hand", text, path, [&] {
    calibration::RestsAndTurns parts(path);
    io::format_by_name("csv").read(io::log_request(path, {}, false), parts);
    static_cast<void>(parts.finish({}));
  });
}

TEST(Mutations, OfYaml) {
  const TemporaryFolder folder;
  static_cast<void>(folder.file("sheet.yaml", io::read_whole(std::string(TRUNNION_SHARE) + "/3dm-cv7.yaml")));
  const std::string path = folder / "run.yaml";
  const std::string seed =
      "format: trunnion-run/1\nsite: {latitude_deg: 43.88, height_m: 220, gravity_m_s2: 9.8, gravity_sigma_m_s2: "
      "1e-5}\nrig: table.urdf\nsheet: sheet.yaml\n"
      "clock: {imu_to_encoder_offset: estimate}\nbias: per_recording\nmodel: [cubic, g_sensitivity]\nrefuse_above: "
      "{gyro_scale_ppm: 500}\n"
      "limits: {gyro_bias_deg_per_h: {value: 100, sigma: 2}}\ncolumns: {t: {column: 0, unit: s}}\nrecordings:\n  - "
      "{mount: mount_1, log: a.lcm}\n"
      "  - {mount: mount_2, log: {imu: b.csv, encoder: c.csv}}\n";
  run("run files", seed, path, [&] { static_cast<void>(io::read_run_file(path)); });
  io::CalibrationFile file;
  file.mounts = {"mount_1", "mount_2"};
  file.record.has_rig = true;
  file.record.mounts = 2;
  file.record.recordings = 1;
  const std::string calibration = folder / "calibration.yaml";
  run("calibration files", io::to_yaml(file), calibration,
      [&] { static_cast<void>(io::read_calibration_file(calibration)); });
}

TEST(Mutations, OfUrdf) {
  const TemporaryFolder folder;
  const std::string path = folder / "rig.urdf";
  run("URDFs", io::read_whole(std::string(TRUNNION_SHARE) + "/two_axis_table.urdf"), path,
      [&] { static_cast<void>(io::read_rig(path, "azimuth", "pitch")); });
}

}  // namespace
}  // namespace trunnion
