// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Epochs of an array's receivers to attitudes: the tracker of the library, or the paper's filter, or none.

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "trunnion/interferometer/antenna_signals.hpp"
#include "trunnion/interferometer/attitude_tracker.hpp"

namespace trunnion::app {

/// What every antenna's receiver saw at one time; of a receiver that is silent, nothing.
struct ArrayEpoch {
  std::int64_t utime = 0;  ///< us, of the master's message
  GpsTime time;
  std::vector<AntennaEpoch<kMostSignals>> antenna;  ///< the master first
  std::vector<bool> heard;
};

struct Solution {
  std::int64_t utime = 0;
  GpsTime time;
  AttitudeStatus status = AttitudeStatus::kNone;
  Status reason = Status::kOk;  ///< why the epoch itself is not fixed
  bool silent = false;          ///< a receiver was not heard
  AttitudeEstimate<double> attitude;
  Vec3<double> rate = Vec3<double>::Zero();  ///< rad/s, where has_rate
  bool has_rate = false;
  int satellites = 0;
  int excluded = 0;
  double misfit = 0.0;
  int degrees = 0;
  double gap = 0.0;
  Eigen::Matrix<double, 3, 2> baseline =
      Eigen::Matrix<double, 3, 2>::Zero();  ///< n [m], where status of the epoch is fixed or held
  std::array<bool, 2> has_baseline{};
  bool started = false;  ///< the filter starts here
  bool refused = false;
  /// m, of slaves whose phases fit but for the length that was stated; 0: no such case.
  std::array<double, 2> other_length{};
};

enum class AttitudeFilter { kNone, kPaper, kMultiplicative };

struct EngineOptions {
  std::vector<Vec3<double>> slaves;  ///< from the master, in the body [m]; one or two
  double figure_sigma = 0.005;       ///< of their lengths and angle [m]
  SignalNoise noise;
  AttitudeFilter filter = AttitudeFilter::kMultiplicative;
  TrackerOptions<double> tracker;
  bool driven = false;        ///< by gyros, of gyro()
  bool keep_records = false;  ///< for smooth()
};

class Engine {
 public:
  /// @throws Error (usage) for a figure that the filter cannot use
  static std::unique_ptr<Engine> make(const EngineOptions& options);
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  virtual Solution add(const ArrayEpoch& epoch) = 0;
  /// The unit's mean rate over the @p t [s] before @p utime [us]. It waits until the epoch that it belongs to comes:
  /// raw phases are later than gyros.
  virtual void gyro(std::int64_t utime, double t, const Vec3<double>& w_ib_b) = 0;
  /// The solutions of add(), smoothed in place. @throws Error (numerics)
  virtual void smooth(std::vector<Solution>& solutions) = 0;
  /// Times the filter started again against its own prediction.
  [[nodiscard]] virtual int restarts() const = 0;
};

}  // namespace trunnion::app
