// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/compress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

constexpr std::size_t kSamplesForPeriod = 256;
constexpr double kQuickFactor = 6.0;  // largest against mean second difference of a window without outliers
constexpr double kOutlierSigmas = 8.0;
constexpr double kHarmless =
    1e-5;  // of the triad's largest reading in the window: one such sample costs 0.3 ppm of the window
constexpr double kRunningWeight = 0.05;
constexpr double kPeriodTolerance = 0.02;  // of the sheet's period
constexpr double kSlowestPeriod = 0.1;     // s

double median_of_five(double a, double b, double c, double d, double e) {
  if (a > b) std::swap(a, b);
  if (c > d) std::swap(c, d);
  if (a > c) {
    std::swap(a, c);
    std::swap(b, d);
  }
  // a is the least of four: the median of five is the second least of b, c, d, e
  if (b > e) std::swap(b, e);
  return b < c ? std::min(c, e) : std::min(b, d);
}

}  // namespace

Compressor::Compressor(CompressOptions options) : options_(std::move(options)) {
  result_.name = options_.name;
  quantum_.fill(std::numeric_limits<double>::infinity());
  early_.reserve(kSamplesForPeriod);
}

double Compressor::seconds(std::int64_t utime) {
  if (!has_origin_) {
    has_origin_ = true;
    origin_ = utime;
  }
  return 1e-6 * static_cast<double>(ChannelClock::difference(utime, origin_));
}

void Compressor::imu(std::int64_t utime, const InertialSample<double>& sample) {
  const auto verdict = judge_and_count(imu_clock_, utime, options_.name, "IMU", result_.figures);
  if (verdict == ChannelClock::Verdict::kNextAndFirstWasStray) {
    early_.clear();
  } else if (verdict != ChannelClock::Verdict::kNext) {
    return;
  }
  const double t = seconds(utime);
  if (result_.figures.period > 0.0) {
    place(t, sample, celsius_);
    return;
  }
  early_.push_back({t, celsius_, sample});
  if (early_.size() < kSamplesForPeriod) return;
  scratch_.clear();
  for (std::size_t i = 1; i < early_.size(); ++i) scratch_.push_back(early_[i].t - early_[i - 1].t);
  const double found = sample_period(scratch_, options_.name);
  if (options_.period > 0.0 && std::abs(found / options_.period - 1.0) > kPeriodTolerance) {
    throw Error(ExitCode::kInput, options_.name + ": the samples come at " + std::to_string(1.0 / found) +
                                      " Hz, the sheet's rate_hz says " + std::to_string(1.0 / options_.period));
  }
  result_.figures.period = options_.period > 0.0 ? options_.period : found;
  for (const Early& e : early_) place(e.t, e.sample, e.celsius);
  early_ = {};
}

void Compressor::encoder(std::int64_t utime, double azimuth, double pitch) {
  const auto verdict = judge_and_count(encoder_clock_, utime, options_.name, "encoder", encoder_figures_);
  if (verdict == ChannelClock::Verdict::kNextAndFirstWasStray) {
    result_.course = EncoderCourse();
  } else if (verdict != ChannelClock::Verdict::kNext) {
    return;
  }
  result_.course.add(seconds(utime), azimuth, pitch);
}

void Compressor::place(double t, const InertialSample<double>& sample, double celsius) {
  const double period = result_.figures.period;
  if (result_.figures.samples == 0 && t_.empty()) {
    if (period > kSlowestPeriod) {
      throw Error(ExitCode::kInput, options_.name + ": the IMU channel has less than 10 samples a second");
    }
    t_first_ = t;
    t_last_ = t - period;
    t_window_end_ = t - period + options_.window;
  }
  const double step = t - t_last_;
  if (step > 1.5 * period) result_.figures.missing += static_cast<long long>(std::lround(step / period)) - 1;
  if (t - 0.5 * period > t_window_end_) {
    close_window();
    const double windows = std::floor((t - 0.5 * period - t_window_end_) / options_.window) + 1.0;
    t_window_end_ += windows * options_.window;
  }
  t_last_ = t;
  t_.push_back(t);
  if (std::isfinite(celsius)) {
    celsius_sum_ += celsius;
    ++celsius_count_;
  }
  for (int axis = 0; axis < 3; ++axis) {
    channel_[static_cast<std::size_t>(axis)].push_back(sample.w(axis));
    channel_[static_cast<std::size_t>(axis) + 3].push_back(sample.f(axis));
  }
  const bool saturated = options_.range.saturated(sample);
  bad_.push_back(saturated ? 1 : 0);
  if (saturated) {
    if (result_.figures.saturated == 0) result_.figures.first_saturated = t - t_first_;
    ++result_.figures.saturated;
  }
}

/// One quick look along each channel: second differences d_k = x_k - (x_(k-1) + x_(k+1)) / 2 of a clean window are all
/// of one size. Also keeps their running mean and the smallest step.
bool Compressor::suspicious() {
  const std::size_t n = t_.size();
  bool any = false;
  harmless_ = {0.0, 0.0};
  for (std::size_t c = 0; c < 6; ++c) {
    for (const double x : channel_[c]) harmless_[c / 3] = std::max(harmless_[c / 3], kHarmless * std::abs(x));
  }
  for (std::size_t c = 0; c < 6; ++c) {
    const double* x = channel_[c].data();
    double largest = 0.0;
    double sum = 0.0;
    double quantum = quantum_[c];
    for (std::size_t k = 1; k + 1 < n; ++k) {
      const double d = std::abs(x[k] - 0.5 * (x[k - 1] + x[k + 1]));
      largest = std::max(largest, d);
      sum += d;
      const double move = std::abs(x[k] - x[k - 1]);
      quantum = move > 0.0 ? std::min(quantum, move) : quantum;
    }
    // the two ends have one neighbour only: their first differences, held against what the neighbours do
    largest = std::max({largest, 0.5 * std::abs(x[1] - x[0] - (x[2] - x[1])),
                        0.5 * std::abs(x[n - 1] - x[n - 2] - (x[n - 2] - x[n - 3]))});
    const double mean = sum / static_cast<double>(n - 2);
    quantum_[c] = quantum;
    const double usual = usual_step_[c] > 0.0 ? std::min(mean, 2.0 * usual_step_[c]) : mean;
    if (largest > kQuickFactor * usual + 3.0 * quantum + harmless_[c / 3]) {
      any = true;
    } else {
      usual_step_[c] = usual_step_[c] > 0.0 ? usual_step_[c] + kRunningWeight * (mean - usual_step_[c]) : mean;
    }
  }
  return any;
}

/// The careful look: each sample against the median of itself and its two neighbours on either side.
void Compressor::mark_outliers() {
  const std::size_t n = t_.size();
  std::vector<double>& deviation = scratch_;
  deviation.resize(3 * n);
  const auto quantile = [&](std::size_t from, std::size_t rank) {
    const auto at = deviation.begin() + static_cast<std::ptrdiff_t>(from + rank);
    std::nth_element(deviation.begin() + static_cast<std::ptrdiff_t>(from), at,
                     deviation.begin() + static_cast<std::ptrdiff_t>(from + n));
    return *at;
  };
  for (std::size_t c = 0; c < 6; ++c) {
    const std::vector<double>& x = channel_[c];
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = std::min(std::max<std::size_t>(k, 2), n - 3);
      deviation[k] = std::abs(x[k] - median_of_five(x[i - 2], x[i - 1], x[i], x[i + 1], x[i + 2]));
      deviation[n + k] = deviation[k];
      const std::size_t j = std::min(std::max<std::size_t>(k, 1), n - 2);
      deviation[2 * n + k] = std::abs(x[j] - 0.5 * (x[j - 1] + x[j + 1]));
    }
    // of noise the first is the larger; of a smooth course without noise only the second is not zero
    const double scale = std::max({quantile(n, (4 * n) / 5), quantile(2 * n, n / 2), 0.5 * usual_step_[c]});
    for (std::size_t k = 0; k < n; ++k) {
      if (bad_[k] == 0 && deviation[k] > kOutlierSigmas * scale + 3.0 * quantum_[c] + harmless_[c / 3]) {
        bad_[k] = 1;
        ++result_.figures.outliers;
      }
    }
  }
}

void Compressor::close_window() {
  const std::size_t n = t_.size();
  if (n >= 5 && suspicious()) mark_outliers();
  const double period = result_.figures.period;
  ObservationWindow window;
  window.half_width = 0.5 * options_.window;
  window.t = t_window_end_ - window.half_width;
  std::array<double, kWindowNodes> moment{};
  std::array<double, 6> sum{};
  for (std::size_t k = 0; k < n; ++k) {
    if (bad_[k] != 0) continue;
    ++window.samples;
    const double b = (t_[k] - window.t) / window.half_width;
    const double a = b - period / window.half_width;
    double bp = b;
    double ap = a;
    for (int j = 0; j < kWindowNodes; ++j) {
      moment[static_cast<std::size_t>(j)] += (bp - ap) / (j + 1);
      bp *= b;
      ap *= a;
    }
    for (std::size_t c = 0; c < 6; ++c) sum[c] += channel_[c][k];
  }
  if (window.samples > 0) {
    const double count = window.samples;
    for (double& m : moment) m *= window.half_width / (period * count);
    window.weight = quadrature_weights(moment);
    window.mean.w = Vec3<double>(sum[0], sum[1], sum[2]) / count;
    window.mean.f = Vec3<double>(sum[3], sum[4], sum[5]) / count;
    if (celsius_count_ > 0) window.temperature = celsius_sum_ / celsius_count_;
    result_.figures.samples += window.samples;
    result_.windows.push_back(window);
  }
  celsius_sum_ = 0.0;
  celsius_count_ = 0;
  t_.clear();
  bad_.clear();
  for (auto& channel : channel_) channel.clear();
}

CompressedRecording Compressor::finish() {
  RecordingFigures& figures = result_.figures;
  if (figures.period <= 0.0) {
    throw Error(ExitCode::kInput, options_.name + ": only " + std::to_string(early_.size()) + " usable IMU samples");
  }
  if (!t_.empty()) close_window();
  figures.duration = t_last_ - t_first_;
  check_saturation(figures, figures.samples + figures.saturated + figures.outliers, options_.name);
  check_crowding(figures, options_.name);
  figures.duplicates += encoder_figures_.duplicates;  // of no harm: an encoder may be read more often than it moves
  figures.stray += encoder_figures_.stray;
  result_.course.finish();
  return std::move(result_);
}

CompressedRecording Compressor::so_far(std::size_t from) const {
  CompressedRecording part;
  part.name = result_.name;
  part.windows.assign(result_.windows.begin() + static_cast<std::ptrdiff_t>(std::min(from, result_.windows.size())),
                      result_.windows.end());
  part.course = result_.course;
  part.course.finish();
  part.figures = result_.figures;
  return part;
}

}  // namespace trunnion::calibration
