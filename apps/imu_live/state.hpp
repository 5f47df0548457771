// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a live calibration shows: one record, filled by the session and its estimator, read by the terminal and the
/// page.

#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace trunnion::app {

enum class Phase { kWaiting, kRecording, kSolving, kDone, kFailed };

const char* name_of(Phase phase);

struct LiveState {
  struct Step {
    std::string text;
    double seen = 0.0;  ///< s
    double asked = 0.0;
  };
  struct Entry {
    std::string name;
    std::string unit;
    double value = 0.0;  ///< in the unit
    double sigma = 0.0;
    double limit = 0.0;  ///< of sigma, in the unit
  };
  struct Notice {
    double t = 0.0;  ///< s since the start
    long long serial = 0;
    std::string text;
  };
  struct Point {
    double t = 0.0;             ///< s of the recording
    double azimuth_rate = 0.0;  ///< deg/s
    double pitch = 0.0;         ///< deg
    double gyro[3] = {0.0, 0.0, 0.0};
  };
  struct Channel {
    double rate_hz = 0.0;  ///< of what arrives
    double silent_s = 0.0;
    long long samples = 0;
    long long lost = 0;
    long long late = 0;
    long long damaged = 0;
  };

  Phase phase = Phase::kWaiting;
  std::string model;
  std::string mount;
  int recording = 0;  ///< from 1
  int recordings = 0;
  std::string guidance;
  bool unattended = false;
  bool enough = false;  ///< every sigma is within its limit, where limits are stated; else the plan is done
  std::vector<Step> steps;
  std::vector<Entry> entries;
  int within = 0;         ///< entries with a sigma within the limit
  double duration = 0.0;  ///< s of the recording
  Channel imu;
  Channel encoder;
  long long saturated = 0;
  long long strays = 0;  ///< stamps out of their order
  double chi_square = 0.0;
  std::deque<Notice> notices;
  std::deque<Point> plot;
  std::string verdict;
  std::vector<std::string> out_of_limits;
  std::string output;
};

/// The state and its lock.
class SharedState {
 public:
  template <class Change>
  void change(Change&& change) {
    const std::lock_guard<std::mutex> lock(mutex_);
    change(state_);
    ++version_;
  }
  [[nodiscard]] LiveState copy() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_;
  }
  [[nodiscard]] std::uint64_t version() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return version_;
  }
  /// For the page, schema trunnion/live/1.
  [[nodiscard]] std::string json() const;

 private:
  mutable std::mutex mutex_;
  LiveState state_;
  std::uint64_t version_ = 0;
};

}  // namespace trunnion::app
