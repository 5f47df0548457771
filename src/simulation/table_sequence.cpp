// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/table_sequence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/turntable/two_axis.hpp"

namespace trunnion::simulation {
namespace {

constexpr double kPeakRate = 1.875;                      // of a move over its mean rate
const double kPeakAcceleration = 10.0 / std::sqrt(3.0);  // of a move, over d / T^2
constexpr double kStands = 1e-12;                        // rad: no step
constexpr double kSlack = 1e-3;  // relative, of a limit that a plan may touch: it is looked at in steps

/// From @p from to @p to, the short way where the axis has no end.
double step_to(double from, double to, const AxisLimits& limits) {
  return limits.endless() ? std::remainder(to - from, 2.0 * kPi) : to - from;
}

AxisCommand stand(double angle) { return {angle, 0.0, 0.0, 0.0}; }
AxisCommand turn(double angle, double rate) { return {angle, rate, 0.0, 0.0}; }
AxisCommand swing(double angle, double amplitude, double frequency) { return {angle, 0.0, amplitude, frequency}; }

/// A turn of @p angle at @p rate, with a transition of @p transition at both ends.
double time_for(double angle, double rate, double transition) { return std::abs(angle) / rate + transition; }

}  // namespace

double duration_of(const TableSequence& sequence) {
  double duration = 0.0;
  for (const TableMove& move : sequence) duration += move.duration;
  return duration;
}

TableMotion motion_of(const TableSequence& sequence, const TableLimits& limits) {
  std::array<AxisCourse, 2> course;
  std::array<double, 2> angle{};
  double t = 0.0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const TableMove& move = sequence[i];
    for (std::size_t a = 0; a < 2; ++a) {
      const AxisCommand& axis = move.axis[a];
      if (i == 0 && move.duration == 0.0) {
        course[a] = AxisCourse(axis.angle);
        angle[a] = axis.angle;
        continue;
      }
      const double step = step_to(angle[a], axis.angle, limits[a]);
      if (std::abs(step) > kStands) course[a].move(t, move.transition, step);
      angle[a] += step;
      if (axis.rate != 0.0) {
        course[a].ramp(t, move.transition, axis.rate);
        course[a].ramp(t + move.duration - move.transition, move.transition, 0.0);
        angle[a] += axis.rate * (move.duration - move.transition);
      }
      if (axis.amplitude != 0.0)
        course[a].oscillate(t, t + move.duration, axis.amplitude, axis.frequency, move.transition);
    }
    t += move.duration;
  }
  return {course[kAzimuth], course[kPitch], t};
}

double transition_for(double step, double rate, const AxisLimits& limits) {
  const double d = std::abs(step);
  const double r = std::abs(rate);
  // both at once: their accelerations and rates add
  double transition = 0.0;
  if (d > 0.0) {
    const double room = limits.rate - r;
    transition = std::max(kPeakRate * d / std::max(room, 0.1 * limits.rate),
                          std::sqrt(2.0 * kPeakAcceleration * d / limits.acceleration));
  }
  return std::max({transition, 2.0 * kPeakRate * r / limits.acceleration, 0.5});
}

void check_limits(const TableSequence& sequence, const TableLimits& limits, const std::string& name) {
  static constexpr std::array<const char*, 2> kAxisName = {"azimuth", "pitch"};
  double t = 0.0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const TableMove& move = sequence[i];
    const bool stands = i == 0 && move.duration == 0.0;
    const bool fades = !move.is_rest();
    if (!stands && (!(move.duration > 0.0) || !(move.transition > 0.0) ||
                    (fades ? 2.0 : 1.0) * move.transition > move.duration * (1.0 + kSlack))) {
      throw Error(ExitCode::kInput,
                  name + ": move " + std::to_string(i + 1) + ": its duration has no room for its transitions");
    }
  }
  const TableMotion motion = motion_of(sequence, limits);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const TableMove& move = sequence[i];
    for (std::size_t a = 0; a < 2; ++a) {
      const AxisPeaks peaks = peaks_of(a == kAzimuth ? motion.azimuth : motion.pitch, t, move);
      const AxisLimits& limit = limits[a];
      const auto fail = [&](const char* what, double value, double bound, const char* unit) {
        char text[160];
        std::snprintf(text, sizeof text, ": move %zu: the %s would %s %.6g %s, its limit is %.6g", i + 1, kAxisName[a],
                      what, value / kRadPerDeg, unit, bound / kRadPerDeg);
        throw Error(ExitCode::kInput, name + text);
      };
      if (!limit.endless()) {
        const double slack = kSlack * (limit.highest - limit.lowest);
        if (peaks.lowest < limit.lowest - slack) fail("reach", peaks.lowest, limit.lowest, "deg");
        if (peaks.highest > limit.highest + slack) fail("reach", peaks.highest, limit.highest, "deg");
      }
      if (peaks.rate > limit.rate * (1.0 + kSlack)) fail("turn at", peaks.rate, limit.rate, "deg/s");
      if (peaks.acceleration > limit.acceleration * (1.0 + kSlack))
        fail("accelerate by", peaks.acceleration, limit.acceleration, "deg/s^2");
    }
    t += move.duration;
  }
}

AxisPeaks peaks_of(const AxisCourse& course, double t, const TableMove& move) {
  AxisPeaks peaks;
  peaks.lowest = peaks.highest = course.angle(t);
  if (move.duration == 0.0) return peaks;
  // an oscillation in forty steps, a transition in a hundred
  double step = move.transition / 100.0;
  for (const AxisCommand& axis : move.axis) {
    if (axis.frequency > 0.0) step = std::min(step, 1.0 / (40.0 * axis.frequency));
  }
  const double quiet = move.is_rest() ? move.transition : move.duration;
  const double h = 0.01 * step;
  for (double at = 0.0; at <= quiet; at += step) {
    const double angle = course.angle(t + at);
    peaks.lowest = std::min(peaks.lowest, angle);
    peaks.highest = std::max(peaks.highest, angle);
    peaks.rate = std::max(peaks.rate, std::abs(course.rate(t + at)));
    if (at > h && at < quiet - h)
      peaks.acceleration =
          std::max(peaks.acceleration, std::abs(course.rate(t + at + h) - course.rate(t + at - h)) / (2.0 * h));
  }
  return peaks;
}

TableSequence experiment(double lowest, double highest, int variant) {
  constexpr double kHold = 30.0;
  constexpr double kMove = 3.0;
  constexpr double kRamp = 2.0;
  const double middle = 0.5 * (lowest + highest);
  const double reach = 0.5 * (highest - lowest);
  TableSequence moves = {{0.0, kMove, {stand(0.0), stand(middle)}}};
  double azimuth = 0.0;
  // a tour of rests over the whole range
  for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0})
    moves.push_back({15.0, kMove, {stand(azimuth), stand(middle + share * reach)}});
  constexpr std::array<double, 5> kAmplitudeShare = {0.5, 0.5, 0.45, 0.4, 0.3};
  constexpr std::array<double, 5> kFrequency = {0.10, 0.16, 0.22, 0.28, 0.36};
  constexpr std::array<double, 10> kRestShare = {-1.0, 1.0, -0.6, 0.7, 0.3, -0.3, 0.9, -0.8, 0.5, -0.5};
  for (std::size_t step = 0; step < 10; ++step) {
    const auto rate_number = static_cast<int>(step / 2);
    const auto swing_number = static_cast<std::size_t>((rate_number + variant) % 5);
    // at rest: out to an angle of its own, and back to the middle
    moves.push_back({kHold - kMove, kMove, {stand(azimuth), stand(middle + kRestShare[step] * reach)}});
    moves.push_back({kMove, kMove, {stand(azimuth), stand(middle)}});
    const double rate = (step % 2 == 0 ? 10.0 : -10.0) * (rate_number + 1) * kRadPerDeg;
    moves.push_back(
        {kHold,
         kRamp,
         {turn(azimuth, rate), swing(middle, kAmplitudeShare[swing_number] * reach, kFrequency[swing_number])}});
    azimuth += rate * (kHold - kRamp);
  }
  moves.push_back({kHold, kMove, {stand(azimuth), stand(middle)}});
  return moves;
}

TableSequence design_run(const AxisLimits& pitch) {
  constexpr double kHold = 30.0;
  constexpr double kRamp = 2.0;
  const double middle = pitch.endless() ? 0.0 : 0.5 * (pitch.lowest + pitch.highest);
  // level, so that the azimuth's axis lies along one of the case
  const double level = std::clamp(0.0, pitch.lowest, pitch.highest);
  TableSequence moves = {{0.0, kRamp, {stand(0.0), stand(level)}}, {kHold, kRamp, {stand(0.0), stand(level)}}};
  std::array<double, 2> angle = {0.0, level};
  for (const std::size_t axis : {std::size_t{kAzimuth}, std::size_t{kPitch}}) {
    if (axis == kPitch) {
      angle[kPitch] = middle;
      moves.push_back({kHold, 3.0, {stand(angle[kAzimuth]), stand(middle)}});
    }
    for (int step = 0; step < 10; ++step) {
      const int rate_number = step / 2;
      const double rate = (step % 2 == 0 ? 5.0 : -5.0) * (rate_number + 1) * kRadPerDeg;
      TableMove move{kHold, kRamp, {stand(angle[kAzimuth]), stand(angle[kPitch])}};
      if (axis == kPitch && !pitch.endless()) {
        // the largest swing that the joint has room for, or one that takes ten seconds
        const double amplitude = std::min(0.45 * (pitch.highest - pitch.lowest), std::abs(rate) * 10.0 / (2.0 * kPi));
        move.axis[axis] = swing(middle, std::copysign(amplitude, rate), std::abs(rate) / amplitude / (2.0 * kPi));
      } else {
        move.axis[axis] = turn(angle[axis], rate);
        angle[axis] += rate * (kHold - kRamp);
      }
      moves.push_back(move);
    }
    moves.push_back({kHold, kRamp, {stand(angle[kAzimuth]), stand(angle[kPitch])}});
  }
  return moves;
}

TableSequence soak(const AxisLimits& pitch, double duration, int variant) {
  constexpr double kRest = 12.0;
  constexpr double kTurn = 18.0;
  constexpr double kMove = 3.0;
  constexpr double kRamp = 2.0;
  const double middle = pitch.endless() ? 0.0 : 0.5 * (pitch.lowest + pitch.highest);
  const double reach = pitch.endless() ? 0.5 * kPi : 0.5 * (pitch.highest - pitch.lowest);
  constexpr std::array<double, 4> kRestShare = {-1.0, 0.0, 1.0, 0.5};
  constexpr std::array<double, 4> kRate = {40.0, -40.0, -20.0, 20.0};
  constexpr std::array<double, 3> kFrequency = {0.11, 0.16, 0.21};
  TableSequence moves = {{0.0, kMove, {stand(0.0), stand(middle)}}};
  double azimuth = 0.0;
  double t = 0.0;
  for (std::size_t step = 0; t + kRest + kMove + kTurn <= duration; ++step) {
    moves.push_back({kRest, kMove, {stand(azimuth), stand(middle + kRestShare[step % 4] * reach)}});
    moves.push_back({kMove, kMove, {stand(azimuth), stand(middle)}});
    const double rate = kRate[step % 4] * kRadPerDeg;
    const double frequency = kFrequency[(step + static_cast<std::size_t>(variant)) % 3];
    moves.push_back({kTurn, kRamp, {turn(azimuth, rate), swing(middle, 0.4 * reach, frequency)}});
    azimuth += rate * (kTurn - kRamp);
    t += kRest + kMove + kTurn;
  }
  if (duration - t > kMove) moves.push_back({duration - t, kMove, {stand(azimuth), stand(middle)}});
  return moves;
}

TableSequence rest_only(double lowest, double highest) {
  const double middle = 0.5 * (lowest + highest);
  return {{0.0, 1.0, {stand(0.0), stand(middle)}}, {60.0, 1.0, {stand(0.0), stand(middle)}}};
}

namespace {

/// Rests between right-angled turns, outer axis (0) and inner axis (1).
TableSequence right_angles(const std::vector<std::pair<int, int>>& turns, double dwell, double rate) {
  std::array<double, 2> angle{};
  TableSequence moves = {{0.0, 1.0, {stand(0.0), stand(0.0)}}, {dwell, 1.0, {stand(0.0), stand(0.0)}}};
  const double transition = kPeakRate * 0.5 * kPi / rate;
  for (const auto& [axis, direction] : turns) {
    angle[static_cast<std::size_t>(axis)] += direction * 0.5 * kPi;
    moves.push_back({dwell + transition, transition, {stand(angle[0]), stand(angle[1])}});
  }
  return moves;
}

}  // namespace

TableSequence sixteen_positions(double dwell, double rate) {
  return right_angles({{0, 1},
                       {0, 1},
                       {0, 1},
                       {1, 1},
                       {1, 1},
                       {1, 1},
                       {0, 1},
                       {1, 1},
                       {0, 1},
                       {0, 1},
                       {1, -1},
                       {0, -1},
                       {1, -1},
                       {0, -1},
                       {1, -1}},
                      dwell, rate);
}

TableSequence nineteen_positions(double dwell, double rate) {
  return right_angles({{0, 1},
                       {0, 1},
                       {0, 1},
                       {0, -1},
                       {0, -1},
                       {0, -1},
                       {1, 1},
                       {0, 1},
                       {0, 1},
                       {0, 1},
                       {0, -1},
                       {0, -1},
                       {0, -1},
                       {0, 1},
                       {1, 1},
                       {1, 1},
                       {1, 1},
                       {0, 1}},
                      dwell, rate);
}

TableSequence whole_turns(double dwell, double rate) {
  constexpr double kRamp = 4.0;
  const double time = time_for(2.0 * kPi, rate, kRamp);
  const double transition = kPeakRate * 0.5 * kPi / rate;
  TableSequence moves = {{0.0, 1.0, {stand(0.0), stand(0.0)}}};
  for (int position = 0; position < 12; ++position) {
    const double outer = 0.5 * kPi * (position % 4);
    const int quarter = position / 4;
    const double inner = 0.5 * kPi * quarter;
    moves.push_back({position == 0 ? dwell : dwell + transition, transition, {stand(outer), stand(inner)}});
    const double direction = position % 4 < 2 ? 1.0 : -1.0;
    TableMove whole{time, kRamp, {stand(outer), stand(inner)}};
    whole.axis[static_cast<std::size_t>(position % 2)].rate = direction * rate;
    moves.push_back(whole);
  }
  moves.push_back({dwell, kRamp, {stand(1.5 * kPi), stand(kPi)}});
  return moves;
}

}  // namespace trunnion::simulation
