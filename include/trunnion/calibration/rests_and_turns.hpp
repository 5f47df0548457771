// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A recording by hand, taken apart: where the unit lay still, and how it turned in between.
///
/// A block of 0.25 s is still when its scatter is near the recording's quietest and its mean rate near the rests' own.
/// A rest is a second or more of still blocks, without its first and last. What lies between two rests, unbroken in
/// time, is a turn. Tedaldi, Pretto & Menegatti, ICRA 2014, use a static detector of this kind;
/// docs/theory/calibration.md, eq. 23.

#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "trunnion/calibration/channel.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/positions/sample_sink.hpp"

namespace trunnion::calibration {

struct Rest {
  double begin = 0.0;  ///< s
  double end = 0.0;
  int samples = 0;
  InertialSample<double> mean;
};

/// Samples between two rests, thinned to steps of 5 ms or one sample.
struct TurnStep {
  double dt = 0.0;  ///< s
  InertialSample<double> mean;
};

struct Turn {
  std::size_t from = 0;  ///< rest before; the rest after is from + 1
  std::vector<TurnStep> steps;
};

struct HandRecording {
  std::string name;
  std::vector<Rest> rests;
  std::vector<Turn> turns;
  UnitNoise noise;  ///< white noise from the rests; no wander
  RecordingFigures figures;
};

/// Takes a recording apart in two steps: feed it, then finish().
class RestsAndTurns final : public SampleSink {
 public:
  explicit RestsAndTurns(std::string name) { result_.name = std::move(name); }

  /// As Compressor::imu().
  void imu(std::int64_t utime, const InertialSample<double>& sample) override;

  /// There are none by hand: ignored.
  void encoder(std::int64_t utime, double azimuth, double pitch) override;

  /// A sample that stands alone against both its neighbours is an outlier: counted, and put between them.
  /// @throws Error (input) when too few samples were fed or the unit saturated between the first rest and the last
  HandRecording finish(const SensorRange& range);

 private:
  struct Sample {
    double t;
    InertialSample<double> value;
  };
  void mend_outliers();

  HandRecording result_;
  ChannelClock clock_;
  std::int64_t origin_ = 0;
  std::vector<Sample> samples_;
};

}  // namespace trunnion::calibration
