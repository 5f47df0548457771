// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A live session at a simulated table, all in one process: the bus is LCM's memory queue.

#pragma once

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "imu_calibrate/result.hpp"
#include "imu_live/session.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/simulation/table_run.hpp"

namespace trunnion::app {

struct BusMessage {
  std::string channel;
  std::string data;
};

/// The rig and the unit of apps/share, and a run file for them.
class LiveBench {
 public:
  /// @param more lines of the run file
  explicit LiveBench(std::uint64_t seed, const std::string& more = "") {
    settings.seed = seed;
    const std::string share = TRUNNION_SHARE;
    static_cast<void>(folder.file("rig.urdf", io::read_whole(share + "/two_axis_table.urdf")));
    static_cast<void>(folder.file("sheet.yaml", io::read_whole(share + "/3dm-cv7.yaml")));
    run_path = folder.file(
        "run.yaml",
        "format: trunnion-run/1\nsite: {latitude_deg: 43.88, height_m: 220, gravity_sigma_m_s2: "
        "1e-5}\nrig: rig.urdf\nsheet: sheet.yaml\nrecordings:\n  - {mount: mount_1, log: 1.lcm}\n  - {mount: "
        "mount_2, log: 2.lcm}\n  - {mount: mount_3, log: 3.lcm}\n" +
            more);
    run = io::read_run_file(run_path);
    mounts = mounts_of(run);
    rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, mounts);
    settings.noise = run.sheet.noise;
    truth = simulation::draw_truth(settings, rig.rig, run.site, 3);
  }

  /// What the table publishes of one mount, up to @p seconds; sequences begin at @p sequence.
  [[nodiscard]] std::vector<BusMessage> messages(int mount, double seconds = 1e9) const {
    std::vector<BusMessage> all;
    std::string message;
    simulation::TableMotion motion =
        simulation::motion_of(simulation::experiment(rig.limits[kPitch].lowest, rig.limits[kPitch].highest, mount));
    motion.duration = std::min(motion.duration, seconds);
    simulation::run_table(settings, truth, rig.rig, run.site, motion, mount, mount,
                          {[&](std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample) {
                             io::encode_imu(utime, sequence, sample, message);
                             all.push_back({"IMU", message});
                           },
                           [&](std::int64_t utime, std::int64_t sequence, double azimuth, double pitch) {
                             io::encode_encoder(utime, sequence, azimuth, pitch, message);
                             all.push_back({"ENCODER", message});
                           }});
    return all;
  }

  TemporaryFolder folder;
  std::string run_path;
  io::RunFile run;
  std::vector<std::string> mounts;
  io::RigFile rig;
  simulation::TableRunSettings settings;
  CalibrationValues truth;
};

/// A session on its own bus.
class LiveRun {
 public:
  explicit LiveRun(const LiveBench& bench)
      : bus("memq://"), session(bench.run, bench.rig, bench.mounts, bus, state, {}) {}

  void publish(const std::vector<BusMessage>& messages) {
    for (const BusMessage& m : messages) {
      bus.publish(m.channel, m.data);
      session.step();
    }
  }
  /// A key of the operator, and the time to see it. @return false when every recording is there
  bool press() {
    session.next();
    return idle(0.1);
  }
  bool idle(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    bool more = true;
    while (more && std::chrono::steady_clock::now() < end) more = session.step();
    return more;
  }
  /// The notices so far, a line each.
  [[nodiscard]] std::string notices() const {
    std::string text;
    for (const auto& notice : state.copy().notices) text += notice.text + "\n";
    return text;
  }

  SharedState state;
  bus::Connection bus;
  Session session;
};

}  // namespace trunnion::app
