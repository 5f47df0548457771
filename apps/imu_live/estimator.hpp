// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What follows the recording beside it: the running estimate, the plan, the mount. A thread of its own, so that the
/// bus never waits for it.

#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "state.hpp"
#include "trunnion/calibration/mount_watch.hpp"
#include "trunnion/calibration/sequential_solve.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/urdf.hpp"

namespace trunnion::app {

class Estimator {
 public:
  /// The references must outlive it.
  Estimator(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& mounts, SharedState& state);
  Estimator(const Estimator&) = delete;
  Estimator& operator=(const Estimator&) = delete;
  ~Estimator();

  /// Recording number @p recording, from 1, begins in this mount of the rig.
  void begin(int recording, int mount);
  /// What has come of the recording since the last call. Not dropped, and done in order.
  void add(calibration::CompressedRecording part);
  /// The recording that was begun last is void.
  void abandon();
  /// Whether add() would wait its turn.
  [[nodiscard]] bool busy() const;

 private:
  struct Job {
    enum class Kind { kBegin, kAdd, kAbandon } kind = Kind::kAdd;
    int recording = 0;
    int mount = 0;
    calibration::CompressedRecording part;
  };

  void push(Job job);
  void work();
  void take(Job& job);
  void follow(const calibration::CompressedRecording& part);
  void show_estimate();
  void show_plan();
  void notice(const std::string& text);

  const io::RunFile& run_;
  const io::RigFile& rig_;
  std::vector<std::string> mounts_;
  SharedState& state_;
  calibration::SequentialSolve solve_;

  int recording_ = 0;
  int mount_ = 0;
  bool failed_ = false;
  TablePlan plan_;
  std::optional<calibration::MountWatch> watch_;
  std::vector<ObservationWindow> ahead_;  // of the encoders
  bool said_mount_ = false;
  bool said_moved_ = false;
  int linearisations_ = 0;
  int misfits_ = 0;
  std::string said_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool working_ = false;
  bool end_ = false;
  std::thread thread_;  // last: it uses the rest
};

/// The entries of an estimate, or of the calibration, each against its limit.
std::vector<LiveState::Entry> entries_of(const io::RunFile& run, const std::vector<calibration::Parameter>& parameters,
                                         const Eigen::VectorXd& x, const Eigen::VectorXd& sigma);

/// How many of them have a sigma within its limit.
int count_within(const std::vector<LiveState::Entry>& entries);

/// Adds a notice with the time since the start of the program.
void add_notice(SharedState& state, const std::string& text);

}  // namespace trunnion::app
