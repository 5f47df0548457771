// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/axis_motion.hpp"

#include <algorithm>
#include <cmath>

#include "trunnion/core/units.hpp"

namespace trunnion::simulation {
namespace {

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

double smooth_slope(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return 30.0 * u * u * (1.0 - u) * (1.0 - u);
}

/// Integral of smooth() from 0 to u, for u >= 0.
double smooth_integral(double u) {
  const double inside = std::min(u, 1.0);
  return inside * inside * inside * inside * (2.5 + inside * (inside - 3.0)) + (u - inside);
}

}  // namespace

void AxisCourse::ramp(double t, double duration, double rate) {
  Ramp next{t, duration, 0.0, rate, angle_};
  if (!ramps_.empty()) {
    const Ramp& last = ramps_.back();
    next.rate_before = last.rate_after;
    const double elapsed = t - last.t;
    next.angle = last.angle + last.rate_before * elapsed +
                 (last.rate_after - last.rate_before) * last.duration * smooth_integral(elapsed / last.duration);
  }
  ramps_.push_back(next);
}

void AxisCourse::move(double t, double duration, double step) { moves_.push_back({t, duration, step}); }

void AxisCourse::oscillate(double from, double to, double amplitude, double frequency, double fade) {
  oscillations_.push_back({from, to, amplitude, frequency, fade});
}

double AxisCourse::angle(double t) const {
  double angle = angle_;
  const auto after =
      std::upper_bound(ramps_.begin(), ramps_.end(), t, [](double time, const Ramp& ramp) { return time < ramp.t; });
  if (after != ramps_.begin()) {
    const Ramp& ramp = *(after - 1);
    const double elapsed = t - ramp.t;
    angle = ramp.angle + ramp.rate_before * elapsed +
            (ramp.rate_after - ramp.rate_before) * ramp.duration * smooth_integral(elapsed / ramp.duration);
  }
  for (const Move& move : moves_) {
    if (t > move.t) angle += move.step * smooth((t - move.t) / move.duration);
  }
  for (const Oscillation& o : oscillations_) {
    if (t <= o.from || t >= o.to) continue;
    const double envelope = smooth((t - o.from) / o.fade) * smooth((o.to - t) / o.fade);
    angle += envelope * o.amplitude * std::sin(2.0 * kPi * o.frequency * (t - o.from));
  }
  return angle;
}

double AxisCourse::rate(double t) const {
  double rate = 0.0;
  const auto after =
      std::upper_bound(ramps_.begin(), ramps_.end(), t, [](double time, const Ramp& ramp) { return time < ramp.t; });
  if (after != ramps_.begin()) {
    const Ramp& ramp = *(after - 1);
    rate = ramp.rate_before + (ramp.rate_after - ramp.rate_before) * smooth((t - ramp.t) / ramp.duration);
  }
  for (const Move& move : moves_) rate += move.step / move.duration * smooth_slope((t - move.t) / move.duration);
  for (const Oscillation& o : oscillations_) {
    if (t <= o.from || t >= o.to) continue;
    const double in = (t - o.from) / o.fade;
    const double out = (o.to - t) / o.fade;
    const double w = 2.0 * kPi * o.frequency;
    const double phase = w * (t - o.from);
    rate +=
        o.amplitude * (smooth(in) * smooth(out) * w * std::cos(phase) +
                       (smooth_slope(in) * smooth(out) - smooth(in) * smooth_slope(out)) / o.fade * std::sin(phase));
  }
  return rate;
}

}  // namespace trunnion::simulation
