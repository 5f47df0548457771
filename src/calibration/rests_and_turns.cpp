// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/rests_and_turns.hpp"

#include <algorithm>
#include <cmath>

#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kBlock = 0.25;          // s
constexpr double kShortestRest = 1.0;    // s, before the ends are cut off
constexpr double kQuietQuantile = 0.15;  // of the blocks: the unit lies still for at least this share of the recording
constexpr double kScatterFactor = 3.0;
constexpr double kRestRate = 0.005;  // rad/s: what g-sensitivity may change between rests
constexpr double kTurnStep = 0.005;  // s
constexpr double kGap = 5.0;         // periods
constexpr double kUsualQuantile = 0.99;
constexpr double kOutlierFactor = 20.0;  // against that quantile

struct Block {
  std::size_t first, last;  // samples [first, last)
  Vec3<double> w;
  double scatter_w, scatter_f;
  bool still = false;
};

/// @param v not empty
double quantile(std::vector<double> v, double q) {
  const auto at = v.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

}  // namespace

void RestsAndTurns::imu(std::int64_t utime, const InertialSample<double>& sample) {
  const auto verdict = judge_and_count(clock_, utime, result_.name, "IMU", result_.figures);
  if (verdict == ChannelClock::Verdict::kNextAndFirstWasStray) {
    samples_.clear();
  } else if (verdict != ChannelClock::Verdict::kNext) {
    return;
  }
  if (samples_.empty()) origin_ = utime;
  samples_.push_back({1e-6 * static_cast<double>(ChannelClock::difference(utime, origin_)), sample});
}

void RestsAndTurns::encoder(std::int64_t, double, double) {}

/// Of each axis, how far every sample lies from the median of itself and its neighbours: a turn by hand, and noise,
/// make that small everywhere, a spike large at one place.
void RestsAndTurns::mend_outliers() {
  const std::size_t n = samples_.size();
  std::vector<double> lonely(n - 2);
  std::vector<bool> mended(n, false);
  for (int axis = 0; axis < 6; ++axis) {
    const auto at = [&](std::size_t i) -> double& {
      return axis < 3 ? samples_[i].value.w(axis) : samples_[i].value.f(axis - 3);
    };
    const auto between = [&](std::size_t i) {
      return std::max(std::min(at(i - 1), at(i + 1)), std::min(at(i), std::max(at(i - 1), at(i + 1))));
    };
    for (std::size_t i = 1; i + 1 < n; ++i) lonely[i - 1] = std::abs(at(i) - between(i));
    const double limit = kOutlierFactor * quantile(lonely, kUsualQuantile);
    if (!(limit > 0.0)) continue;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      if (std::abs(at(i) - between(i)) <= limit) continue;
      at(i) = 0.5 * (at(i - 1) + at(i + 1));
      mended[i] = true;
    }
  }
  result_.figures.outliers = std::count(mended.begin(), mended.end(), true);
}

HandRecording RestsAndTurns::finish(const SensorRange& range) {
  RecordingFigures& figures = result_.figures;
  const std::size_t n = samples_.size();
  if (n < 100) throw Error(ExitCode::kInput, result_.name + ": only " + std::to_string(n) + " usable IMU samples");
  std::vector<double> step(n - 1);
  for (std::size_t i = 1; i < n; ++i) step[i - 1] = samples_[i].t - samples_[i - 1].t;
  figures.period = sample_period(step, result_.name);
  figures.duration = samples_.back().t;
  mend_outliers();
  figures.samples = static_cast<long long>(n) - figures.outliers;
  check_crowding(figures, result_.name);

  std::vector<Block> blocks;
  const auto length = static_cast<std::size_t>(std::max(4.0, std::round(kBlock / figures.period)));
  for (std::size_t first = 0; first + length <= n; first += length) {
    Block block{first, first + length, Vec3<double>::Zero(), 0.0, 0.0};
    Vec3<double> w = Vec3<double>::Zero();
    Vec3<double> f = Vec3<double>::Zero();
    Vec3<double> w2 = Vec3<double>::Zero();
    Vec3<double> f2 = Vec3<double>::Zero();
    const InertialSample<double>& origin = samples_[first].value;  // differences against it keep their digits
    for (std::size_t i = first; i < block.last; ++i) {
      const Vec3<double> dw = samples_[i].value.w - origin.w;
      const Vec3<double> df = samples_[i].value.f - origin.f;
      w += dw;
      f += df;
      w2 += dw.cwiseAbs2();
      f2 += df.cwiseAbs2();
    }
    const auto count = static_cast<double>(length);
    block.w = origin.w + w / count;
    block.scatter_w = std::sqrt(std::max(0.0, (w2 / count - (w / count).cwiseAbs2()).sum() / 3.0));
    block.scatter_f = std::sqrt(std::max(0.0, (f2 / count - (f / count).cwiseAbs2()).sum() / 3.0));
    blocks.push_back(block);
  }
  if (blocks.empty()) throw Error(ExitCode::kInput, result_.name + ": too short to hold a rest");
  std::vector<double> scatter_w;
  std::vector<double> scatter_f;
  for (const Block& b : blocks) {
    scatter_w.push_back(b.scatter_w);
    scatter_f.push_back(b.scatter_f);
  }
  const double quiet_w = quantile(scatter_w, kQuietQuantile);
  const double quiet_f = quantile(scatter_f, kQuietQuantile);
  std::vector<double> rest_rate[3];
  for (Block& b : blocks) {
    b.still = b.scatter_w <= kScatterFactor * quiet_w && b.scatter_f <= kScatterFactor * quiet_f;
    for (int i = 0; b.still && i < 3; ++i) rest_rate[i].push_back(b.w(i));
  }
  if (rest_rate[0].empty()) return std::move(result_);  // never still in both triads at once
  Vec3<double> usual;
  for (int i = 0; i < 3; ++i) usual(i) = quantile(rest_rate[i], 0.5);
  const double slack = kRestRate + 5.0 * quiet_w / std::sqrt(static_cast<double>(length));
  for (Block& b : blocks) {
    b.still = b.still && (b.w - usual).cwiseAbs().maxCoeff() < slack &&
              samples_[b.last - 1].t - samples_[b.first].t < 1.5 * kBlock + kGap * figures.period;
  }

  std::vector<std::size_t> rest_first;
  std::vector<std::size_t> rest_last;
  std::vector<double> rest_scatter_w;
  std::vector<double> rest_scatter_f;
  for (std::size_t b = 0; b < blocks.size();) {
    std::size_t e = b;
    while (e < blocks.size() && blocks[e].still &&
           (e == b || samples_[blocks[e].first].t - samples_[blocks[e].first - 1].t < kGap * figures.period))
      ++e;
    if (e > b + 2 && static_cast<double>(e - b) * kBlock >= kShortestRest) {
      Rest rest;
      const std::size_t first = blocks[b + 1].first;
      const std::size_t last = blocks[e - 2].last;
      rest.begin = samples_[first].t - figures.period;
      rest.end = samples_[last - 1].t;
      rest.samples = static_cast<int>(last - first);
      for (std::size_t i = first; i < last; ++i) {
        rest.mean.w += samples_[i].value.w / rest.samples;
        rest.mean.f += samples_[i].value.f / rest.samples;
      }
      for (std::size_t k = b + 1; k + 1 < e; ++k) {
        rest_scatter_w.push_back(blocks[k].scatter_w);
        rest_scatter_f.push_back(blocks[k].scatter_f);
      }
      result_.rests.push_back(rest);
      rest_first.push_back(first);
      rest_last.push_back(last);
    }
    b = std::max(e, b + 1);
  }
  if (!rest_scatter_w.empty()) {
    const double bessel = std::sqrt(static_cast<double>(length) / static_cast<double>(length - 1) * figures.period);
    result_.noise.gyro.density = quantile(rest_scatter_w, 0.5) * bessel;
    result_.noise.accel.density = quantile(rest_scatter_f, 0.5) * bessel;
  }

  for (std::size_t r = 0; r + 1 < result_.rests.size(); ++r) {
    Turn turn;
    turn.from = r;
    bool broken = false;
    TurnStep open;
    for (std::size_t i = rest_last[r]; i < rest_first[r + 1]; ++i) {
      const double dt = samples_[i].t - samples_[i - 1].t;
      broken = broken || dt > kGap * figures.period;
      open.dt += dt;
      open.mean.w += dt * samples_[i].value.w;
      open.mean.f += dt * samples_[i].value.f;
      if (open.dt + 0.5 * figures.period >= kTurnStep || i + 1 == rest_first[r + 1]) {
        open.mean.w /= open.dt;
        open.mean.f /= open.dt;
        turn.steps.push_back(open);
        open = TurnStep{};
      }
    }
    if (!broken && !turn.steps.empty()) result_.turns.push_back(std::move(turn));
  }
  // what lies before the first rest and after the last is not used: there it may be dropped on the floor
  for (std::size_t i = rest_first.empty() ? n : rest_first.front(); i < n && i < rest_last.back(); ++i) {
    if (range.saturated(samples_[i].value) && ++figures.saturated == 1) figures.first_saturated = samples_[i].t;
  }
  long long turning = 0;
  for (std::size_t r = 0; r + 1 < rest_first.size(); ++r)
    turning += static_cast<long long>(rest_first[r + 1] - rest_last[r]);
  check_saturation(figures, turning, result_.name);
  samples_ = {};
  return std::move(result_);
}

}  // namespace trunnion::calibration
