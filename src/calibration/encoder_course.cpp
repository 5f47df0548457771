// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/encoder_course.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

constexpr std::size_t kReadingsForPeriod = 64;
constexpr double kShortestKnotSpacing = 0.0235;  // s
constexpr double kPeriodsPerKnot = 4.7;
constexpr double kOutlierFactor = 20.0;
constexpr double kRunningWeight = 0.01;
constexpr double kLargestAcceleration = 20.0;  // rad/s^2, of a table
constexpr std::size_t kRowsPerReading = 50;    // bounds the memory that leaping stamps can ask for
constexpr std::size_t kRowsAtLeast = 100000;
// Weight of the third differences against one reading: bridges the holes with a parabola, biases nothing measurable.
constexpr double kSmoothing = 1e-7;
constexpr std::array<double, 4> kThirdDifference = {-1.0, 3.0, -3.0, 1.0};

std::array<double, 4> basis(double s) {
  const double r = 1.0 - s;
  return {r * r * r / 6.0, (4.0 + s * s * (3.0 * s - 6.0)) / 6.0, (4.0 + r * r * (3.0 * r - 6.0)) / 6.0,
          s * s * s / 6.0};
}

double nearest_turn(double angle, double reference) {
  return angle - 2.0 * kPi * std::round((angle - reference) / (2.0 * kPi));
}

}  // namespace

void EncoderCourse::add(double t, double azimuth, double pitch) {
  if (waiting_ > 0) {
    // std::round costs more than the rest of this function: only at a wrap
    const Reading& last = recent_[waiting_ - 1];
    if (std::abs(azimuth - last.azimuth) > kPi) azimuth = nearest_turn(azimuth, last.azimuth);
    if (std::abs(pitch - last.pitch) > kPi) pitch = nearest_turn(pitch, last.pitch);
  }
  recent_[waiting_++] = {t, azimuth, pitch};
  if (waiting_ == recent_.size()) settle();
}

/// Passes on the oldest of three readings, and drops the middle one when it departs from what the others say by more
/// than the table can accelerate in between.
void EncoderCourse::settle() {
  const Reading& a = recent_[0];
  const Reading& b = recent_[1];
  const Reading& c = recent_[2];
  const double span = c.t - a.t;
  const auto departure_from = [&](const Reading& p, const Reading& q) {
    const double u = (b.t - p.t) / (q.t - p.t);
    return std::max(std::abs(b.azimuth - p.azimuth - u * (q.azimuth - p.azimuth)),
                    std::abs(b.pitch - p.pitch - u * (q.pitch - p.pitch)));
  };
  // between its neighbours, and in line with the two before: a wild neighbour spoils one of them only
  double departure = departure_from(a, c);
  if (readings_ > 0) departure = std::min(departure, departure_from(taken_, a));
  if (departure > kOutlierFactor * usual_departure_ + kLargestAcceleration * span * span) {
    ++outliers_;
    recent_[1] = recent_[2];
    // it was unwrapped against the one that goes
    if (std::abs(recent_[1].azimuth - a.azimuth) > kPi)
      recent_[1].azimuth = nearest_turn(recent_[1].azimuth, a.azimuth);
    if (std::abs(recent_[1].pitch - a.pitch) > kPi) recent_[1].pitch = nearest_turn(recent_[1].pitch, a.pitch);
    waiting_ = 2;
    return;
  }
  usual_departure_ += kRunningWeight * (departure - usual_departure_);
  take(a.t, a.azimuth, a.pitch);
  recent_[0] = recent_[1];
  recent_[1] = recent_[2];
  waiting_ = 2;
}

void EncoderCourse::take(double t, double azimuth, double pitch) {
  taken_ = {t, azimuth, pitch};
  unwrapped_ = {azimuth, pitch};
  if (readings_ >= 3 && period_ > 0.0 && std::abs(t - previous_t_[0] - 3.0 * period_) < 0.5 * period_) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto& p = previous_[axis];
      const double d = unwrapped_[axis] - 3.0 * p[2] + 3.0 * p[1] - p[0];
      third_difference_sum_ += d * d;
    }
    third_differences_ += 2;
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
    previous_[axis] = {previous_[axis][1], previous_[axis][2], unwrapped_[axis]};
  previous_t_ = {previous_t_[1], previous_t_[2], t};
  ++readings_;
  t_last_ = t;
  if (started_) {
    accumulate(t, azimuth, pitch);
  } else {
    first_.push_back({t, azimuth, pitch});
    if (first_.size() == kReadingsForPeriod) start();
  }
}

void EncoderCourse::start() {
  started_ = true;
  std::vector<double> steps;
  for (std::size_t i = 1; i < first_.size(); ++i) steps.push_back(first_[i].t - first_[i - 1].t);
  if (!steps.empty()) {
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    period_ = steps[steps.size() / 2];
  }
  h_ = std::max(kShortestKnotSpacing, kPeriodsPerKnot * period_);
  t0_ = first_.empty() ? 0.0 : first_.front().t;
  for (const Reading& r : first_) accumulate(r.t, r.azimuth, r.pitch);
  first_ = {};
}

void EncoderCourse::accumulate(double t, double azimuth, double pitch) {
  const double u = (t - t0_) / h_;
  const auto k = static_cast<std::size_t>(u);
  if (k > kRowsPerReading * readings_ + kRowsAtLeast) {
    throw Error(ExitCode::kInput, "the encoder's stamps leave holes for " + std::to_string(k) + " knots in " +
                                      std::to_string(readings_) + " readings");
  }
  if (rows_.size() < k + 4) rows_.resize(k + 4);
  const std::array<double, 4> b = basis(u - static_cast<double>(k));
  Row* row = &rows_[k];
  row->readings += 1;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) row[i].band[j - i] += b[i] * b[j];
    row[i].right[0] += b[i] * azimuth;
    row[i].right[1] += b[i] * pitch;
  }
}

void EncoderCourse::finish() {
  for (std::size_t i = 0; i < waiting_; ++i) take(recent_[i].t, recent_[i].azimuth, recent_[i].pitch);
  waiting_ = 0;
  if (!started_) start();
  const std::size_t n = rows_.size();
  gap_.assign(n, 0);
  for (std::size_t k = 0; k + 3 < n; ++k) gap_[k] = rows_[k].readings == 0 ? 1 : 0;
  for (std::size_t k = 0; k + 3 < n; ++k) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i; j < 4; ++j) {
        rows_[k + i].band[j - i] += kSmoothing * kThirdDifference[i] * kThirdDifference[j];
      }
    }
  }
  // banded L D L^T, in place: band[0] becomes D, band[1..3] the rows of L^T
  for (std::size_t k = 0; k < n; ++k) {
    Row& pivot = rows_[k];
    const double d = pivot.band[0] > 0.0 ? pivot.band[0] : 1.0;
    for (std::size_t i = 1; i < 4 && k + i < n; ++i) {
      const double factor = pivot.band[i] / d;
      for (std::size_t j = i; j < 4; ++j) rows_[k + i].band[j - i] -= factor * pivot.band[j];
      for (std::size_t axis = 0; axis < 2; ++axis) rows_[k + i].right[axis] -= factor * pivot.right[axis];
    }
  }
  coefficient_.assign(n, {0.0, 0.0});
  for (std::size_t k = n; k-- > 0;) {
    const Row& pivot = rows_[k];
    const double d = pivot.band[0] > 0.0 ? pivot.band[0] : 1.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double value = pivot.right[axis];
      for (std::size_t i = 1; i < 4 && k + i < n; ++i) value -= pivot.band[i] * coefficient_[k + i][axis];
      coefficient_[k][axis] = value / d;
    }
  }
  rows_ = {};
}

std::array<CourseValue, 2> EncoderCourse::at(double t) const {
  std::array<CourseValue, 2> value;
  if (coefficient_.size() < 4) return value;
  const double u = std::clamp((t - t0_) / h_, 0.0, static_cast<double>(coefficient_.size() - 3) - 1e-9);
  const auto k = static_cast<std::size_t>(u);
  const double s = u - static_cast<double>(k);
  const double r = 1.0 - s;
  const std::array<double, 4> b = basis(s);
  const std::array<double, 4> b1 = {-0.5 * r * r, s * (1.5 * s - 2.0), -r * (1.5 * r - 2.0), 0.5 * s * s};
  const std::array<double, 4> b2 = {r, 3.0 * s - 2.0, 3.0 * r - 2.0, s};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // differences against the first coefficient: an unwrapped azimuth may have grown large
    const double c0 = coefficient_[k][axis];
    const double d1 = coefficient_[k + 1][axis] - c0;
    const double d2 = coefficient_[k + 2][axis] - c0;
    const double d3 = coefficient_[k + 3][axis] - c0;
    value[axis].angle = c0 + b[1] * d1 + b[2] * d2 + b[3] * d3;
    value[axis].rate = (b1[1] * d1 + b1[2] * d2 + b1[3] * d3) / h_;
    value[axis].acceleration = (b2[1] * d1 + b2[2] * d2 + b2[3] * d3) / (h_ * h_);
    value[axis].jerk = (3.0 * d1 - 3.0 * d2 + d3) / (h_ * h_ * h_);
  }
  return value;
}

bool EncoderCourse::covers(double from, double to) const {
  if (coefficient_.size() < 4 || from < t0_ || to > t_last_) return false;
  const auto first = static_cast<std::size_t>((from - t0_) / h_);
  const auto last = std::min(static_cast<std::size_t>((to - t0_) / h_), gap_.size() - 1);
  for (std::size_t k = first; k <= last; ++k) {
    if (gap_[k] != 0) return false;
  }
  return true;
}

double EncoderCourse::reading_sigma() const {
  if (third_differences_ == 0) return 0.0;
  return std::sqrt(third_difference_sum_ / (20.0 * static_cast<double>(third_differences_)));
}

}  // namespace trunnion::calibration
