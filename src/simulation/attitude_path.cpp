// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/attitude_path.hpp"

#include <array>
#include <cmath>

#include "trunnion/core/units.hpp"

namespace trunnion::simulation {
namespace {

constexpr double kStep = 0.01;  // s

/// amplitude sin(2 pi t / period + phase) + offset, in deg/s.
struct Sine {
  double amplitude, period, phase, offset;
  [[nodiscard]] double at(double t) const {
    return kRadPerDeg * (amplitude * std::sin(2.0 * kPi * t / period + phase) + offset);
  }
};

/// A segment of flight: Euler angles that change evenly.
struct Leg {
  double duration, roll_rate, pitch_rate, yaw_rate;  // s, deg/s
};

}  // namespace

AttitudePath::AttitudePath(RatePath rate, const Quaternion<double>& start, double duration) : rate_(std::move(rate)) {
  knots_.push_back(start.normalized());
  for (double t = 0.0; t < duration - 0.5 * kStep; t += kStep) {
    t = kStep * static_cast<double>(knots_.size() - 1);
    knots_.push_back(step(knots_.back(), t, t + kStep));
  }
}

double AttitudePath::duration() const { return kStep * static_cast<double>(knots_.size() - 1); }

Quaternion<double> AttitudePath::step(const Quaternion<double>& q, double from, double to) const {
  const double h = to - from;
  const double node = std::sqrt(3.0) / 6.0;
  const Vec3<double> first = rate_(from + (0.5 - node) * h);
  const Vec3<double> second = rate_(from + (0.5 + node) * h);
  const Vec3<double> phi = 0.5 * h * (first + second) + std::sqrt(3.0) / 12.0 * h * h * first.cross(second);
  return (q * quaternion_exp(phi)).normalized();
}

Quaternion<double> AttitudePath::q_nb(double t) const {
  if (!(t > 0.0)) return knots_.front();
  if (t >= duration()) return knots_.back();
  const auto knot = static_cast<std::size_t>(t / kStep);
  return step(knots_[knot], kStep * static_cast<double>(knot), t);
}

AttitudePath example_1_stand_in(PlatformMotion motion, double duration) {
  static const std::array<std::array<Sine, 3>, 3> kRates = {{
      {{{0.5, 120, 0, 0}, {0.4, 100, kPi / 2, 0}, {0.6, 150, 0, 0.3}}},
      {{{3, 40, 0, 0}, {2, 50, kPi / 2, 0}, {4, 60, 0, 1}}},
      {{{15, 15, 0, 0}, {10, 12, kPi / 2, 0}, {20, 20, 0, 0}}},
  }};
  const auto& rates = kRates[static_cast<std::size_t>(motion)];
  return AttitudePath([&rates](double t) { return Vec3<double>(rates[0].at(t), rates[1].at(t), rates[2].at(t)); },
                      quaternion_of_euler(5.0 * kRadPerDeg, 3.0 * kRadPerDeg, 30.0 * kRadPerDeg), duration);
}

AttitudePath example_2_stand_in() {
  constexpr double kTurn = 90.0 / 5.86;  // deg/s
  static const std::array<Leg, 12> kLegs = {{{10, 0, 0, 0},
                                             {10, 0, 1, 0},
                                             {15, 0, 0, 0},
                                             {10, 0, -1, 0},
                                             {5, -3, 0, 0},
                                             {5.86, 0, 0, kTurn},
                                             {5, 3, 0, 0},
                                             {10, 0, 0, 0},
                                             {5, -3, 0, 0},
                                             {5.86, 0, 0, kTurn},
                                             {5, 3, 0, 0},
                                             {23.28, 0, 0, 0}}};
  const auto rate = [](double t) {
    double roll = 0.0;
    double pitch = 0.0;
    for (const Leg& leg : kLegs) {
      const double in = std::fmin(t, leg.duration);
      roll += leg.roll_rate * in * kRadPerDeg;
      pitch += leg.pitch_rate * in * kRadPerDeg;
      if (t <= leg.duration) {
        const Vec3<double> euler = kRadPerDeg * Vec3<double>(leg.roll_rate, leg.pitch_rate, leg.yaw_rate);
        return Vec3<double>(euler.x() - std::sin(pitch) * euler.z(),
                            std::cos(roll) * euler.y() + std::sin(roll) * std::cos(pitch) * euler.z(),
                            -std::sin(roll) * euler.y() + std::cos(roll) * std::cos(pitch) * euler.z());
      }
      t -= leg.duration;
    }
    return Vec3<double>(Vec3<double>::Zero());
  };
  return AttitudePath(rate, Quaternion<double>::Identity(), 110.0);
}

}  // namespace trunnion::simulation
