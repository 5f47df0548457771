// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/channel.hpp"

#include <algorithm>
#include <numeric>

#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kSaturatedFraction = 1e-3;
constexpr double kBunched = 1.5;
constexpr double kRepeated = 0.1;  // of the samples
constexpr double kCrowded = 1.05;  // samples for each period of the span

}  // namespace

ChannelClock::Verdict judge_and_count(ChannelClock& clock, std::int64_t utime, const std::string& recording,
                                      const char* channel, RecordingFigures& figures) {
  const ChannelClock::Verdict verdict = clock.judge(utime);
  if (verdict == ChannelClock::Verdict::kDuplicate) ++figures.duplicates;
  // of two stamps that do not follow each other, the second was counted before the first proved to be the stray
  if (verdict == ChannelClock::Verdict::kStray) ++figures.stray;
  if (verdict != ChannelClock::Verdict::kReset) return verdict;
  throw Error(ExitCode::kInput,
              recording + ": the clock of the " + channel + " channel was reset: its stamps went to utime " +
                  std::to_string(utime) +
                  " and stayed there; split the recording at that point, or see what unit its time is in");
}

double sample_period(std::vector<double>& steps, const std::string& recording) {
  std::sort(steps.begin(), steps.end());
  const double median = steps[steps.size() / 2];
  const std::size_t usual = steps.size() - std::min(steps.size() - 1, 2 + steps.size() / 100);
  const double mean = std::accumulate(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(usual), 0.0) /
                      static_cast<double>(usual);
  if (mean > kBunched * median || median > kBunched * mean) {
    throw Error(ExitCode::kInput, recording + ": the stamps come in bunches: " + std::to_string(1e3 * median) +
                                      " ms apart in the median, " + std::to_string(1e3 * mean) +
                                      " ms on average; do two units publish on one channel, or are these times of "
                                      "arrival instead of times of measurement?");
  }
  // stamps in whole milliseconds step 2, 3, 2, 3: the mean of what is within half of the median knows better
  const auto from = std::lower_bound(steps.begin(), steps.end(), 0.5 * median);
  const auto to = std::upper_bound(from, steps.end(), kBunched * median);
  return std::accumulate(from, to, 0.0) / static_cast<double>(to - from);
}

void check_saturation(const RecordingFigures& figures, long long used, const std::string& recording) {
  if (static_cast<double>(figures.saturated) > kSaturatedFraction * static_cast<double>(used)) {
    throw Error(ExitCode::kInput, recording + ": saturated: " + std::to_string(figures.saturated) + " of " +
                                      std::to_string(used) + " samples at or past the sheet's range, first at " +
                                      std::to_string(figures.first_saturated) +
                                      " s; turn slower, or correct the range or the nominal scale in the sheet");
  }
}

void check_crowding(const RecordingFigures& figures, const std::string& recording) {
  const long long offered = figures.samples + figures.saturated + figures.outliers;
  const auto count = static_cast<double>(offered);
  if (static_cast<double>(figures.duplicates) > kRepeated * count) {
    throw Error(ExitCode::kInput, recording + ": " + std::to_string(figures.duplicates) + " stamps repeat, " +
                                      std::to_string(offered) +
                                      " samples do not: the stamps are coarser than the samples");
  }
  if (count * figures.period > kCrowded * (figures.duration + 2.0 * figures.period)) {
    throw Error(ExitCode::kInput, recording + ": " + std::to_string(offered) + " samples of " +
                                      std::to_string(1e3 * figures.period) + " ms do not fit into " +
                                      std::to_string(figures.duration) + " s: do two units publish on one channel?");
  }
}

}  // namespace trunnion::calibration
