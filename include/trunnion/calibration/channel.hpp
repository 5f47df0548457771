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

namespace trunnion::calibration {

/// Judges the stamps of one channel.
///
/// A stamp that does not increase, or that leaps by more than a second, is a stray until the next stamp continues from
/// it: one damaged stamp costs one message. Stamps that stay behind, or more than ten minutes ahead, are another clock.
class ChannelClock {
 public:
  enum class Verdict {
    kNext,
    kNextAndFirstWasStray,  ///< use it, and forget the only one that was accepted before
    kDuplicate,
    kStray,
    kReset
  };

  static constexpr int kResetAfter = 20;                      ///< messages that stay away
  static constexpr std::int64_t kLeap = 1000000;              ///< us
  static constexpr std::int64_t kLongestSilence = 600000000;  ///< us; also bounds what a hostile stamp can ask for

  /// a - b [us]; unsigned inside, so that hostile stamps wrap and do not overflow.
  static std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }

  Verdict judge(std::int64_t utime) {
    if (accepted_ == 0) return accept(utime);
    const std::int64_t step = difference(utime, last_);
    if (step > 0 && step <= kLeap) return accept(utime);
    if (step == 0) return Verdict::kDuplicate;
    const std::int64_t from_candidate = difference(utime, candidate_);
    const bool continues = astray_ > 0 && from_candidate > 0 && from_candidate <= kLeap;
    if (continues && accepted_ == 1) {
      accept(utime);
      return Verdict::kNextAndFirstWasStray;
    }
    if (continues && step > 0 && step <= kLongestSilence) return accept(utime);
    candidate_ = utime;
    return ++astray_ >= kResetAfter ? Verdict::kReset : Verdict::kStray;
  }

 private:
  Verdict accept(std::int64_t utime) {
    last_ = utime;
    astray_ = 0;
    ++accepted_;
    return Verdict::kNext;
  }

  std::int64_t last_ = 0;
  std::int64_t candidate_ = 0;
  long long accepted_ = 0;
  int astray_ = 0;
};

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
