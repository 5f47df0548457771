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
#include <limits>
#include <string>
#include <vector>

#include "trunnion/calibration/channel.hpp"
#include "trunnion/calibration/encoder_course.hpp"
#include "trunnion/positions/observation.hpp"
#include "trunnion/positions/sample_sink.hpp"

namespace trunnion::calibration {

struct CompressOptions {
  double window = 0.1;  ///< length of a window [s]
  double period = 0.0;  ///< nominal sample period [s]; 0: the median of the first 256 steps
  SensorRange range;
  std::string name;  ///< of the recording, for messages
};

struct CompressedRecording {
  std::string name;
  std::vector<ObservationWindow> windows;
  EncoderCourse course;
  RecordingFigures figures;
};

class Compressor final : public SampleSink {
 public:
  explicit Compressor(CompressOptions options);

  /// Feeds one sample: mean angular rate [rad/s] and specific force [m/s^2] over the period that ends at @p utime [us].
  /// @throws Error (input) when the clock of the channel was reset
  void imu(std::int64_t utime, const InertialSample<double>& sample) override;

  /// Of the samples that are fed next [degC].
  void temperature(double celsius) override { celsius_ = celsius; }

  /// Feeds the readings of the two encoders [rad] at @p utime [us].
  /// @throws Error (input) when the clock of the channel was reset
  void encoder(std::int64_t utime, double azimuth, double pitch) override;

  /// Ends the recording. @throws Error (input) when nothing usable was fed, when more than one sample in a thousand was
  /// saturated, when there are more samples than their period has room for, or when the encoders and the unit do not
  /// overlap in time
  CompressedRecording finish();

  /// What is there before the end: windows from number @p from on, the course of the encoders so far, the figures.
  [[nodiscard]] CompressedRecording so_far(std::size_t from) const;
  [[nodiscard]] std::size_t windows() const { return result_.windows.size(); }
  [[nodiscard]] const RecordingFigures& figures() const { return result_.figures; }
  /// Stamps of the unit and of the encoders that were out of their order.
  [[nodiscard]] long long strays() const { return result_.figures.stray + encoder_figures_.stray; }
  /// From the first sample to the last [s].
  [[nodiscard]] double elapsed() const { return t_last_ - t_first_; }

 private:
  double seconds(std::int64_t utime);
  void place(double t, const InertialSample<double>& sample, double celsius);
  void close_window();
  bool suspicious();
  void mark_outliers();

  CompressOptions options_;
  CompressedRecording result_;
  ChannelClock imu_clock_;
  ChannelClock encoder_clock_;
  RecordingFigures encoder_figures_;
  bool has_origin_ = false;
  std::int64_t origin_ = 0;
  double t_first_ = 0.0;
  double t_last_ = 0.0;
  double t_window_end_ = 0.0;

  struct Early {
    double t;
    double celsius;
    InertialSample<double> sample;
  };
  std::vector<Early> early_;  // until the period is known

  // the open window, an array for each channel so that the checks run along it
  std::vector<double> t_;
  std::array<std::vector<double>, 6> channel_;
  std::vector<unsigned char> bad_;
  std::vector<double> scratch_;
  std::array<double, 6> usual_step_{};                         // running mean of the second differences
  std::array<double, 6> quantum_{};                            // smallest step seen
  double celsius_ = std::numeric_limits<double>::quiet_NaN();  // of the samples that come
  double celsius_sum_ = 0.0;                                   // in the open window
  int celsius_count_ = 0;
  std::array<double, 2> harmless_{};  // a deviation too small to matter, of each triad in the open window
};

}  // namespace trunnion::calibration
