// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "motion.hpp"

#include <algorithm>
#include <cmath>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/modulation/demodulator.hpp"
#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/modulation/slow_states.hpp"

namespace trunnion::app {
namespace {

struct Interval {
  double start, end;  // s
  InertialSample<double> mean;
};

/// Intervals of any length as samples of an even period: their integrals are kept.
BodyMotionSeries even(const std::vector<Interval>& intervals, double period) {
  BodyMotionSeries series;
  series.period = period;
  InertialSample<double> sum;
  double from = intervals.front().start;
  for (const Interval& interval : intervals) {
    double at = std::max(from, interval.start);
    while (from + period <= interval.end + 1e-9) {
      const double share = from + period - at;
      series.mean.push_back({(sum.w + share * interval.mean.w) / period, (sum.f + share * interval.mean.f) / period});
      from += period;
      series.stamp.push_back(from);
      sum = InertialSample<double>{};
      at = from;
    }
    const double rest = interval.end - at;
    if (rest > 0.0) {
      sum.w += rest * interval.mean.w;
      sum.f += rest * interval.mean.f;
    }
  }
  return series;
}

BodyMotionSeries by_index(const Recording& recording, double axial_range) {
  IndexDemodulator<double> demodulator(recording.period, axial_range, 0.0);
  std::vector<Interval> intervals;
  BodyMotionSeries counts;
  std::size_t next = 0;
  for (std::size_t i = 0; i < recording.sample.size(); ++i) {
    const double end = recording.stamp[i];
    const double start = end - recording.period;
    while (next < recording.pulse.size() && recording.pulse[next] < start) ++next;
    if (next == recording.pulse.size() || recording.pulse[next] >= end) {
      demodulator.add(recording.sample[i]);
      continue;
    }
    const double pulse = recording.pulse[next++];
    if (demodulator.add_with_pulse(recording.sample[i], (pulse - start) / recording.period) != Pulse::kTurn) continue;
    const TurnMean<double>& turn = demodulator.turn();
    counts.turns += turn.turns;
    counts.missed_pulses += turn.turns - 1;
    counts.saturated_turns += turn.saturated ? 1 : 0;
    intervals.push_back({pulse - turn.period, pulse, turn.body});
  }
  if (intervals.empty()) throw Error(ExitCode::kInput, "no whole turn between the index pulses of the recording");
  BodyMotionSeries series = even(intervals, recording.period);
  series.turns = counts.turns;
  series.missed_pulses = counts.missed_pulses;
  series.saturated_turns = counts.saturated_turns;
  return series;
}

BodyMotionSeries by_encoder(const Recording& recording, double delay) {
  using States = SlowStates<double>;
  // how a vehicle moves, and what an uncalibrated unit may have: docs/theory/modulation.md, section 3
  States gyro({2e-3, 0.3, 1e-6, 0.5, 0.1, 0.035, 0.01});
  States accel({0.05, 3.0, 1e-5, 20.0, 1.0, 0.1, 0.01});
  BodyMotionSeries series;
  series.period = recording.period;
  const double h = recording.period;
  for (std::size_t i = 1; i < recording.sample.size(); ++i) {
    const double step = recording.angle[i] - recording.angle[i - 1];
    const double rate = step / h;
    const double angle = recording.angle[i] - 0.5 * step - rate * delay;
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    const double k = sinc_correction(step);
    const InertialSample<double>& unit = recording.sample[i];
    const States::Plane w = k * unit.w.head<2>();
    const States::Plane f = k * unit.f.head<2>();
    gyro.add(w, s, c, rate, h);
    accel.add(f, s, c, rate * rate, h);
    const States::Plane body_w = gyro.correct(w, s, c, rate);
    const States::Plane body_f = accel.correct(f, s, c, rate * rate);
    series.mean.push_back(
        {Vec3<double>(body_w.x(), body_w.y(), unit.w.z() - rate), Vec3<double>(body_f.x(), body_f.y(), unit.f.z())});
    series.stamp.push_back(recording.stamp[i]);
  }
  series.turns = std::llround(std::abs(recording.angle.back() - recording.angle.front()) / (2.0 * kPi));
  return series;
}

}  // namespace

BodyMotionSeries body_motion(const Recording& recording, Modulation modulation, double axial_range, double delay) {
  if (modulation == Modulation::kIndex) return by_index(recording, axial_range);
  if (modulation == Modulation::kEncoder) return by_encoder(recording, delay);
  BodyMotionSeries series;
  series.stamp = recording.stamp;
  series.mean = recording.sample;
  series.period = recording.period;
  return series;
}

}  // namespace trunnion::app
