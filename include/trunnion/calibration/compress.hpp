// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One streaming pass from samples to observation windows: memory grows with the windows (0.1 s each), not with the
/// samples.
///
/// A sample with a stray stamp is dropped and counted; a clock that was reset is refused. A sample that stands alone
/// against its neighbours (eight robust sigmas) is an outlier, one at or past the sensor's range is saturated: both are
/// left out, and the window's weights know it (positions/observation.hpp).

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trunnion/calibration/encoder_course.hpp"
#include "trunnion/positions/observation.hpp"

namespace trunnion::calibration {

/// Judges the stamps of one channel.
///
/// A stamp that does not increase, or that leaps by more than a second, is a stray until the next stamp continues from
/// it: one damaged stamp costs one message. Stamps that stay behind, or more than ten minutes ahead, are another clock.
class ChannelClock {
 public:
  enum class Verdict { kNext, kDuplicate, kStray, kReset };

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
    // after the first stamp alone, it is the first that was damaged
    if (continues && (accepted_ == 1 || (step > 0 && step <= kLongestSilence))) return accept(utime);
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

struct CompressOptions {
  double window = 0.1;       ///< length of a window [s]
  double period = 0.0;       ///< nominal sample period [s]; 0: the median of the first 256 steps
  double gyro_range = 0.0;   ///< rad/s; 0: unknown
  double accel_range = 0.0;  ///< m/s^2; 0: unknown
  std::string name;          ///< of the recording, for messages
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

struct CompressedRecording {
  std::string name;
  std::vector<ObservationWindow> windows;
  EncoderCourse course;
  RecordingFigures figures;
};

class Compressor {
 public:
  explicit Compressor(CompressOptions options);

  /// Feeds one sample: mean angular rate [rad/s] and specific force [m/s^2] over the period that ends at @p utime [us].
  /// @throws Error (input) when the clock of the channel was reset
  void imu(std::int64_t utime, const InertialSample<double>& sample);

  /// Feeds the readings of the two encoders [rad] at @p utime [us].
  /// @throws Error (input) when the clock of the channel was reset
  void encoder(std::int64_t utime, double azimuth, double pitch);

  /// Ends the recording. @throws Error (input) when nothing usable was fed, when more than one sample in a thousand was
  /// saturated, or when the encoders and the unit do not overlap in time
  CompressedRecording finish();

 private:
  bool accept(ChannelClock& clock, std::int64_t utime, const char* channel);
  double seconds(std::int64_t utime);
  void place(double t, const InertialSample<double>& sample);
  void close_window();
  bool suspicious();
  void mark_outliers();

  CompressOptions options_;
  CompressedRecording result_;
  ChannelClock imu_clock_;
  ChannelClock encoder_clock_;
  bool has_origin_ = false;
  std::int64_t origin_ = 0;
  double t_first_ = 0.0;
  double t_last_ = 0.0;
  double t_window_end_ = 0.0;

  struct Early {
    double t;
    InertialSample<double> sample;
  };
  std::vector<Early> early_;  // until the period is known

  // the open window, an array for each channel so that the checks run along it
  std::vector<double> t_;
  std::array<std::vector<double>, 6> channel_;
  std::vector<unsigned char> bad_;
  std::vector<double> scratch_;
  std::array<double, 6> usual_step_{};  // running mean of the second differences
  std::array<double, 6> quantum_{};     // smallest step seen
  std::array<double, 2> harmless_{};    // a deviation too small to matter, of each triad in the open window
};

}  // namespace trunnion::calibration
