// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The body's motion from a turning unit, once a turn, with an index pulse and no angle sensor.
///
/// Frame p is fixed to the unit, its z is the axis; body axes are those of p at the pulse. Between two pulses the axial
/// gyro tells where in the turn a sample lies, and the pulses say what it adds, be it bias or the body's own turning:
/// with theta its integral since the last pulse, m = x + i y of a sample and a half the angle turned within it,
///
///   phi = theta - c t,   c = (theta(T) -+ 2 pi) / T,   W = +-2 pi / T,   u_z = mean z - W                 ... (1)
///   A = (1/T) sum h m = E* u + b,    B = (1/T) sum h exp(i phi) m a / sin a = u + E b                      ... (2)
///   E = (1/T) sum h exp(i phi) a / sin a,   u = (B - E A) / (1 - |E|^2),   b = (A - E* B) / (1 - |E|^2)    ... (3)
///
/// At an even speed E is 0 and (3) the plain means; when the speed changes within the turn they would mix u and b.
/// c is known only when the turn ends. The turn is demodulated with the last one, c', and then moved by k = c - c':
///
///   sum exp(i phi) m = S_0 - i k S_1 - k^2 S_2 / 2,   S_j = sum t^j exp(i (theta - c' t)) m              ... (4)
///
/// so nothing is stored, uneven speed is followed, and a turn is out with its pulse. docs/theory/modulation.md.

#pragma once

#include <cmath>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/modulation/revolution_average.hpp"

namespace trunnion {

/// 1/sinc of half the angle @p step turned within a sample: what its mean lost of a vector that turns.
template <class T>
T sinc_correction(const T& step) {
  const T a2 = step * step / T(4);
  return T(1) + a2 * (T(1) / T(6) + a2 * (T(7) / T(360) + a2 * T(31) / T(15120)));
}

/// A turn, or several of which pulses were missed.
template <class T>
struct TurnMean {
  T period = T(0);         ///< s, between the two pulses
  T rate = T(0);           ///< of the axis against the body [rad/s], eq. (2), signed
  int turns = 0;           ///< between the two pulses
  bool saturated = false;  ///< the axial gyro was at its range: body.w.z() is not to be believed
  bool unsteady =
      false;  ///< c changed by more than 0.3 rad a turn, the body's turning that is: (4) is too short for it
  InertialSample<T> body;  ///< means in body axes; across the axis the unit's bias is gone, along it it stays
  InertialSample<T> unit;  ///< across the axis b of eq. (3) [p], along it the mean
};

template <class T>
class IndexDemodulator {
 public:
  /// @param period of a sample [s]; @param axial_range at which the axial gyro saturates [rad/s], 0: unknown;
  /// @param index_angle of p's x from the body's x when the pulse comes [rad]
  IndexDemodulator(const T& period, const T& axial_range, const T& index_angle)
      : period_(period), index_angle_(index_angle), means_(2, T(2.0 * kPi) / period, axial_range) {}

  /// A sample without a pulse; one that is not finite breaks the open turn off. @param mean over the sample, in p
  void add(const InertialSample<T>& mean) {
    if (!finite(mean)) return restart();
    (void)means_.add(output(mean));
    accumulate(mean, T(1));
  }

  /// A sample with a pulse in it. @param before share of the sample that lies before the pulse, in [0, 1]
  /// @return kTurn: it stands in turn()
  Pulse add_with_pulse(const InertialSample<T>& mean, const T& before) {
    if (!finite(mean)) {
      restart();
      return Pulse::kBounce;
    }
    const Pulse pulse = means_.add_with_pulse(output(mean), before);
    if (pulse == Pulse::kBounce) {
      accumulate(mean, T(1));
      return pulse;
    }
    const T step = mean.w.z() * period_;
    const T end = angle_ + before * step;
    if (pulse == Pulse::kTurn) {
      const T start = angle_;
      accumulate(mean, before);
      close(start + before * step);
      angle_ = start;
    }
    w_ = f_ = e_ = Moments{};
    angle_ -= end;
    time_ = -before * period_;
    accumulate(mean, T(1) - before);
    return pulse;
  }

  /// The last complete turn.
  [[nodiscard]] const TurnMean<T>& turn() const { return turn_; }
  [[nodiscard]] int turns_without_pulse() const { return means_.turns_without_pulse(); }
  /// Forgets the open turn: the axis was not followed for a while.
  void restart() {
    means_.restart();
    angle_ = time_ = excess_ = T(0);
  }

 private:
  static bool finite(const InertialSample<T>& mean) {
    using std::isfinite;
    return isfinite(mean.w.sum()) && isfinite(mean.f.sum());
  }

  static UnitOutput<T> output(const InertialSample<T>& mean) {
    return {mean.w.x(), mean.w.y(), mean.w.z(), mean.f.x(), mean.f.y(), mean.f.z()};
  }

  /// S_0, S_1, S_2 of eq. (4).
  struct Moments {
    std::array<Vec3<T>, 3> sum{Vec3<T>::Zero(), Vec3<T>::Zero(), Vec3<T>::Zero()};
    void add(const Vec3<T>& turned, const T& t) {
      sum[0] += turned;
      sum[1] += t * turned;
      sum[2] += t * t * turned;
    }
    [[nodiscard]] Vec3<T> moved(const T& k) const {
      const T half = k * k / T(2);
      return Vec3<T>(sum[0].x() + k * sum[1].y() - half * sum[2].x(), sum[0].y() - k * sum[1].x() - half * sum[2].y(),
                     T(0));
    }
  };

  void accumulate(const InertialSample<T>& mean, const T& share) {
    using std::cos;
    using std::sin;
    const T step = mean.w.z() * period_;
    const T t = time_ + period_ / T(2);
    const T phase = angle_ + step / T(2) - excess_ * t;
    const T k = share * sinc_correction(step);
    const T s = k * sin(phase);
    const T c = k * cos(phase);
    w_.add(turn_about_z(s, c, mean.w), t);
    f_.add(turn_about_z(s, c, mean.f), t);
    e_.add(Vec3<T>(c, s, T(0)), t);
    angle_ += step;
    time_ += period_;
  }

  void close(const T& angle) {
    const Revolution<T>& revolution = means_.turn();
    const T samples = revolution.samples;
    turn_.period = samples * period_;
    turn_.turns = revolution.turns < 1 ? 1 : revolution.turns;
    turn_.saturated = revolution.saturated;
    const T whole = (angle < T(0) ? T(-2.0 * kPi) : T(2.0 * kPi)) * T(turn_.turns);
    turn_.rate = whole / turn_.period;
    const T excess = (angle - whole) / turn_.period;
    const T k = excess - excess_;
    const T change = k * turn_.period;
    turn_.unsteady = (change < T(0) ? -change : change) > T(0.3);
    const Vec3<T> e = e_.moved(k) / samples;
    separate(e, Vec3<T>(revolution.mean(0), revolution.mean(1), revolution.mean(2)), w_.moved(k) / samples,
             turn_.body.w, turn_.unit.w);
    separate(e, Vec3<T>(revolution.mean(3), revolution.mean(4), revolution.mean(5)), f_.moved(k) / samples,
             turn_.body.f, turn_.unit.f);
    turn_.body.w.z() -= turn_.rate;
    excess_ = excess;
  }

  /// Eq. (3), then from the axes at the pulse to those of the body.
  void separate(const Vec3<T>& e, const Vec3<T>& plain, const Vec3<T>& turned, Vec3<T>& body, Vec3<T>& unit) const {
    using std::cos;
    using std::sin;
    const T rest = T(1) - e.squaredNorm();
    const Vec3<T> u = (turned - turn_about_z(e.y(), e.x(), plain)) / rest;
    const Vec3<T> b = (plain - turn_about_z(T(-e.y()), e.x(), turned)) / rest;
    body = turn_about_z(T(sin(index_angle_)), T(cos(index_angle_)), u);
    unit = b;
    body.z() = unit.z() = plain.z();
  }

  T period_;
  T index_angle_;
  RevolutionAverage<T> means_;
  T angle_ = T(0);   // theta at the end of the last sample
  T time_ = T(0);    // since the pulse
  T excess_ = T(0);  // c
  Moments w_;
  Moments f_;
  Moments e_;
  TurnMean<T> turn_;
};

}  // namespace trunnion
