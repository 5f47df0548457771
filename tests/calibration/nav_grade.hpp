// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A navigation-grade unit on a level gimbal, and how far a calibration of it is from the truth.

#pragma once

#include <algorithm>
#include <cstdio>

#include "calibration/experiment.hpp"
#include "calibration/gimbal.hpp"
#include "trunnion/calibration/kalman_36.hpp"

namespace trunnion::calibration {

inline constexpr double kArcSecond = kRadPerDeg / 3600.0;

/// Largest errors of scales and cross-couplings in the frame of the accelerometers, and of the biases.
struct Errors {
  double gyro_scale = 0.0, gyro_cross = 0.0, accel_scale = 0.0, accel_cross = 0.0;  // -, rad
  double gyro_bias = 0.0, accel_bias = 0.0;
};

inline Errors errors_of(const InertialUnit<double>& found, const InertialUnit<double>& truth) {
  const InertialUnit<double> t = in_accelerometer_frame(truth);
  const InertialUnit<double> f = in_accelerometer_frame(found);
  Errors e;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double& gyro = i == j ? e.gyro_scale : e.gyro_cross;
      double& accel = i == j ? e.accel_scale : e.accel_cross;
      gyro = std::max(gyro, std::abs(f.gyro.M(i, j) - t.gyro.M(i, j)));
      accel = std::max(accel, std::abs(f.accel.M(i, j) - t.accel.M(i, j)));
    }
  }
  e.gyro_bias = (f.gyro.bias - t.gyro.bias).cwiseAbs().maxCoeff();
  e.accel_bias = (f.accel.bias - t.accel.bias).cwiseAbs().maxCoeff();
  return e;
}

inline void print(const char* what, const Errors& e, const Kalman36Result& result) {
  std::printf(
      "[ FIGURE   ] 36 states, %s: gyro %.3f ppm, %.3f arcsec, %.5f deg/h; accelerometer %.3f ppm, %.3f arcsec, %.3f "
      "ug; "
      "%d rounds, %d rests\n",
      what, 1e6 * e.gyro_scale, e.gyro_cross / kArcSecond, e.gyro_bias / kRadPerSPerDegPerH, 1e6 * e.accel_scale,
      e.accel_cross / kArcSecond, e.accel_bias / kMetresPerS2PerMicroG, result.rounds, result.rests);
}

inline simulation::TableRunSettings nav_grade() {
  simulation::TableRunSettings s;
  s.noise.gyro = {0.002 * kRadPerDeg / 60.0, 0.0, 1.0};
  s.noise.accel = {5.0 * kMetresPerS2PerMicroG, 0.0, 1.0};
  s.gyro_bias = 0.05 * kRadPerSPerDegPerH;
  s.gyro_turn_on_bias = 0.0;
  s.gyro_scale = 100e-6;
  s.gyro_cross_coupling = 60.0 * kArcSecond;
  s.gyro_cubic = 0.0;
  s.gyro_g_sensitivity = 0.0;
  s.accel_bias = 100.0 * kMetresPerS2PerMicroG;
  s.accel_turn_on_bias = 0.0;
  s.accel_scale = 100e-6;
  s.accel_cross_coupling = 60.0 * kArcSecond;
  s.lever_arm = 0.04;
  s.rate = 100.0;
  s.exact_gravity = true;
  return s;
}

struct Recorded {
  CalibrationValues truth;
  Kalman36 filter{"run"};
  TableRecording recording;
};

inline void record(const simulation::TableRunSettings& settings, const simulation::TableSequence& sequence,
                   Recorded& run) {
  const Rig rig = level_gimbal();
  run.truth = simulation::draw_truth(settings, rig, bench(), 1);
  CompressOptions options;
  options.name = "run";
  Compressor compressor(options);
  simulation::run_table(settings, run.truth, rig, bench(), simulation::motion_of(sequence), 0, 0,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
                           run.filter.imu(t, s);
                           compressor.imu(t, s);
                         },
                         [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
  run.recording.data = compressor.finish();
}

inline Kalman36Result filtered(const Recorded& run) {
  Kalman36Options options;
  options.noise = nav_grade().noise;
  return run.filter.finish(bench(), options);
}

}  // namespace trunnion::calibration
