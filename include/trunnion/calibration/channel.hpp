// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What every reader of samples asks of a channel before it uses one: is the stamp the next one, is the reading within
/// the sensor's range, and do the samples fit into the time they span.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/positions/channel_clock.hpp"

namespace trunnion::calibration {

/// What was counted on the way.
struct RecordingFigures {
  long long samples = 0;     ///< used
  long long duplicates = 0;  ///< IMU and encoder stamps that repeat
  long long stray = 0;       ///< IMU and encoder stamps that step back or leap
  long long outliers = 0;
  long long saturated = 0;
  long long missing = 0;         ///< samples that the nominal period leaves a hole for
  double period = 0.0;           ///< s
  double duration = 0.0;         ///< s, first to last sample
  double first_saturated = 0.0;  ///< s after the start
};

struct SensorRange {
  double gyro = 0.0;   ///< rad/s; 0: unknown
  double accel = 0.0;  ///< m/s^2; 0: unknown

  [[nodiscard]] bool saturated(const InertialSample<double>& sample) const {
    return (gyro > 0.0 && sample.w.cwiseAbs().maxCoeff() >= gyro) ||
           (accel > 0.0 && sample.f.cwiseAbs().maxCoeff() >= accel);
  }
};

/// The verdict on @p utime [us], counted. @throws Error (input) naming the recording and the channel when the clock was
/// reset
ChannelClock::Verdict judge_and_count(ChannelClock& clock, std::int64_t utime, const std::string& recording,
                                      const char* channel, RecordingFigures& figures);

/// The sample period [s]: mean of the steps between stamps, which it sorts, that are near their median.
/// @param steps not empty
/// @throws Error (input) when their mean, without the longest hundredth, is another: stamps that come in bunches
double sample_period(std::vector<double>& steps, const std::string& recording);

/// @throws Error (input) when more than one in a thousand of the @p used samples was saturated
void check_saturation(const RecordingFigures& figures, long long used, const std::string& recording);

/// @throws Error (input) when there are more samples than periods, as when another publisher came in later, or when
/// more than a tenth of the stamps repeat
void check_crowding(const RecordingFigures& figures, const std::string& recording);

}  // namespace trunnion::calibration
