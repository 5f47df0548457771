// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The course of the two encoders as least-squares cubic B-splines, built in one pass.
///
///   reading(t) = sum_k c_k B((t - t_0) / h - k),   c = argmin sum_i (reading_i - reading(t_i))^2       ... (1)
///
/// h is 4.7 encoder periods and at least 23.5 ms: no whole fraction of a window, so that the nodes of the windows meet
/// the knots at all phases and the O(h^3) ripple of the rate averages out. The spline smooths the quantisation and
/// gives rate and acceleration at any instant, so that a clock offset needs no second pass. Memory: h sets it, not the
/// samples. C. de Boor, A Practical Guide to Splines, ch. XIV; docs/theory/calibration.md, eq. 16.

#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "trunnion/turntable/encoder.hpp"

namespace trunnion::calibration {

/// Reading of one encoder and its first three time derivatives.
struct CourseValue {
  double angle = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

class EncoderCourse {
 public:
  /// Feeds the readings at @p t [s], wrapped or not [rad]. Times must increase.
  void add(double t, double azimuth, double pitch);

  /// Readings that departed from both neighbours and were left out.
  [[nodiscard]] long long outliers() const { return outliers_; }

  /// Solves eq. (1). Call once, after the last add(). @throws Error (input) when the stamps leave holes for more knots
  /// than the readings could ever fill
  void finish();

  /// Readings of both encoders at @p t [s], unwrapped; within [begin(), end()].
  [[nodiscard]] std::array<CourseValue, 2> at(double t) const;

  /// True where every knot interval from @p from to @p to [s] holds readings enough to be determined.
  [[nodiscard]] bool covers(double from, double to) const;

  [[nodiscard]] double begin() const { return t0_; }
  [[nodiscard]] double end() const { return t_last_; }
  [[nodiscard]] std::size_t readings() const { return readings_; }
  [[nodiscard]] std::size_t bytes() const {
    return coefficient_.capacity() * sizeof(coefficient_[0]) + gap_.capacity();
  }
  /// 1 sigma of one reading [rad], from its third differences: quantisation and noise together.
  [[nodiscard]] double reading_sigma() const;
  [[nodiscard]] double knot_spacing() const { return h_; }
  [[nodiscard]] double period() const { return period_; }

 private:
  void settle();
  void take(double t, double azimuth, double pitch);
  void start();
  void accumulate(double t, double azimuth, double pitch);

  struct Row {
    std::array<double, 4> band{};  // diagonal and three above it
    std::array<double, 2> right{};
    int readings = 0;
  };
  struct Reading {
    double t, azimuth, pitch;
  };
  std::array<Reading, 3> recent_{};  // the middle one is judged by its neighbours
  Reading taken_{};                  // the one before them
  std::size_t waiting_ = 0;          // of them
  double usual_departure_ = 0.0;     // rad, running mean
  long long outliers_ = 0;
  std::vector<Reading> first_;  // the readings that set the period, then freed
  std::vector<Row> rows_;       // freed by finish()
  std::vector<std::array<double, 2>> coefficient_;
  std::vector<unsigned char> gap_;  // per knot interval: 1 where no reading fell
  double t0_ = 0.0;
  double h_ = 0.0;
  double period_ = 0.0;
  double t_last_ = 0.0;
  std::size_t readings_ = 0;
  bool started_ = false;
  std::array<double, 2> unwrapped_{};
  std::array<std::array<double, 3>, 2> previous_{};  // three readings back, for the third difference
  std::array<double, 3> previous_t_{};
  double third_difference_sum_ = 0.0;
  std::size_t third_differences_ = 0;
};

}  // namespace trunnion::calibration
