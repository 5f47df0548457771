// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "motion.hpp"

#include <algorithm>
#include <cmath>

#include "../terminal.hpp"
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

/// Intervals that follow each other as samples of an even period: their integrals are kept.
BodyMotionSeries even(const std::vector<Interval>& intervals, double period) {
  BodyMotionSeries series;
  series.period = period;
  InertialSample<double> sum;
  const double first = intervals.front().start;
  std::size_t done = 0;
  for (const Interval& interval : intervals) {
    double at = interval.start;
    for (;;) {
      const double next = first + static_cast<double>(done + 1) * period;
      const double until = std::min(next, interval.end);
      sum.w += (until - at) * interval.mean.w;
      sum.f += (until - at) * interval.mean.f;
      at = until;
      if (next > interval.end) break;
      series.mean.push_back({sum.w / period, sum.f / period});
      series.stamp.push_back(next);
      sum = InertialSample<double>{};
      ++done;
    }
  }
  return series;
}

/// The axial gyro and the axis must tell of the same turning.
void check_axis(double by_gyro, double by_axis, const char* what) {
  const double ratio = by_axis == 0.0 ? 0.0 : by_gyro / by_axis;
  if (ratio > 0.8 && ratio < 1.25) return;
  throw Error(ExitCode::kInput, "the gyro about z turned by " + figure(by_gyro / (2.0 * kPi), 4) + " turns, " + what +
                                    " by " + figure(by_axis / (2.0 * kPi), 4) + ": another axis, sign or unit?");
}

BodyMotionSeries by_index(const Recording& recording, double axial_range) {
  IndexDemodulator<double> demodulator(recording.period, axial_range, 0.0);
  std::vector<Interval> intervals;
  BodyMotionSeries counts;
  double by_gyro = 0.0;
  double by_pulses = 0.0;
  std::size_t next = 0;
  double last = 0.0;  // pulse
  double held = 0.0;  // rate about the axis
  const double origin = recording.stamp.front();
  for (std::size_t i = 1; i < recording.sample.size(); ++i) {
    const double start = recording.stamp[i - 1] - origin;
    const double end = recording.stamp[i] - origin;
    while (next < recording.pulse.size() && recording.pulse[next] - origin < start) ++next;
    if (next == recording.pulse.size() || recording.pulse[next] - origin >= end) {
      demodulator.add(recording.sample[i]);
      continue;
    }
    const double pulse = recording.pulse[next++] - origin;
    const Pulse kind = demodulator.add_with_pulse(recording.sample[i], (pulse - start) / (end - start));
    const TurnMean<double>& turn = demodulator.turn();
    if (kind == Pulse::kBounce) {
      ++counts.stray_pulses;
      continue;
    }
    if (kind == Pulse::kTurn) {
      counts.turns += turn.turns;
      counts.missed_pulses += turn.turns - 1;
      counts.saturated_turns += turn.saturated ? 1 : 0;
      by_gyro += turn.saturated ? turn.rate * turn.period : turn.unit.w.z() * turn.period;
      by_pulses += turn.rate * turn.period;
      InertialSample<double> body = turn.body;
      if (turn.saturated) body.w.z() = held;
      held = body.w.z();
      intervals.push_back({last, pulse, body});
    } else if (!intervals.empty()) {
      throw Error(ExitCode::kInput,
                  "the axis stood still, or its pulses failed, before " + figure(pulse, 6) + " s after the start");
    }
    last = pulse;
  }
  if (4 * counts.stray_pulses > counts.turns + 4)
    throw Error(ExitCode::kInput, std::to_string(counts.stray_pulses) +
                                      " of the index pulses do not come with a turn of the gyro about z, " +
                                      std::to_string(counts.turns) + " do: another axis, sign or unit?");
  if (intervals.empty()) throw Error(ExitCode::kInput, "no whole turn between the index pulses of the recording");
  check_axis(by_gyro, by_pulses, "the index pulses");
  BodyMotionSeries series = even(intervals, recording.period);
  for (double& stamp : series.stamp) stamp += origin;
  series.stray_pulses = counts.stray_pulses;
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
  double by_gyro = 0.0;
  double squares = 0.0;
  const auto time_of = [&recording](std::size_t i) { return recording.stamp[i] - recording.stamp[i - 1]; };
  for (std::size_t i = 1; i < recording.sample.size(); ++i) {
    const double step = recording.angle[i] - recording.angle[i - 1];
    by_gyro += recording.sample[i].w.z() * step;
    squares += step * step / time_of(i);
  }
  BodyMotionSeries series;
  series.period = recording.period;
  series.turns =
      static_cast<long long>(std::abs(recording.angle.back() - recording.angle.front()) / (2.0 * kPi) + 1e-6);
  check_axis(by_gyro, squares, "the encoder");
  if (series.turns < 1) throw Error(ExitCode::kInput, "the axis makes less than a whole turn: nothing is modulated");
  // first to learn the errors, then to use them from the first sample on
  for (const bool use : {false, true}) {
    for (std::size_t i = 1; i < recording.sample.size(); ++i) {
      const double h = time_of(i);
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
      if (!use) continue;
      const States::Plane body_w = gyro.correct(w, s, c, rate);
      const States::Plane body_f = accel.correct(f, s, c, rate * rate);
      series.mean.push_back(
          {Vec3<double>(body_w.x(), body_w.y(), unit.w.z() - rate), Vec3<double>(body_f.x(), body_f.y(), unit.f.z())});
      series.stamp.push_back(recording.stamp[i]);
    }
  }
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
