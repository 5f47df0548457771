// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The body's motion from a turning unit with an angle encoder: every sample at the unit's full rate, and the unit's
/// bias over a whole turn that slides along with them.
///
/// Frame p is fixed to the unit, its z is the axis. A sample is the mean over h, in which the axis turned by s = W h:
///
///   u = exp(i (phi - s/2 - W d)) m / sinc(s/2),    u_z = z - W                                        ... (1)
///   A = (1/T) integral of m,  B = (1/T) integral of u,  E = (1/T) integral of exp(i phi), over the 2 pi that end now
///   b = (A - E* B) / (1 - |E|^2)                                                                       ... (2)
///
/// m = x + i y, phi the encoder's angle at the stamp, d the delay of the unit's filter against the encoder. At an even
/// speed E is 0 and b the mean of m; at another the mean would hold a share of the body's motion. The window is a ring
/// of samples and running sums: what comes in is added, what leaves is taken away, the oldest sample in part: O(1) a
/// sample. The sums are compensated. docs/theory/modulation.md.

#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/modulation/index_demodulator.hpp"

namespace trunnion {

/// @p sample of p in the body's axes, eq. (1). @param angle of p against the body in the middle of the sample [rad];
/// @param step turned within it [rad]; @param period of the sample [s]
template <class T>
InertialSample<T> demodulate(const InertialSample<T>& sample, const T& angle, const T& step, const T& period) {
  using std::cos;
  using std::sin;
  const T k = sinc_correction(step);
  const T s = k * sin(angle);
  const T c = k * cos(angle);
  InertialSample<T> body{turn_about_z(s, c, sample.w), turn_about_z(s, c, sample.f)};
  body.w.z() -= step / period;
  return body;
}

/// @tparam Capacity samples in the slowest turn that (2) is to cover
template <class T, std::size_t Capacity>
class Demodulator {
 public:
  /// @param delay of the unit's output against the encoder [s]
  explicit Demodulator(const T& delay) : delay_(delay) {}

  /// @param mean over the sample, in p; @param angle of the encoder at its stamp [rad], wrapped or not: it may move by
  /// less than half a turn in a sample; @param period of the sample [s]
  /// @return kNotObservable for the first, of which only the angle is taken; kOutOfRange when a value is not finite or
  /// the period not positive: the next sample is then a first one
  Status add(const InertialSample<T>& mean, const T& angle, const T& period) {
    using std::floor;
    using std::isfinite;
    if (!(period > T(0)) || !isfinite(angle) || !isfinite(mean.w.sum()) || !isfinite(mean.f.sum())) {
      restart();
      return Status::kOutOfRange;
    }
    const T turn = T(2.0 * kPi);
    const T moved = angle - last_angle_;
    const T step = moved - turn * floor(moved / turn + T(0.5));
    last_angle_ = angle;
    if (!started_) {
      started_ = true;
      return Status::kNotObservable;
    }
    const T rate = step / period;
    const T middle = angle - step / T(2) - rate * delay_;
    body_ = demodulate(mean, middle, step, period);
    slide(mean, middle, step, period);
    return Status::kOk;
  }

  /// Samples were lost: the next is a first one.
  void restart() {
    started_ = false;
    clear();
  }

  /// The last sample in body axes, eq. (1). Its biases are still in it.
  [[nodiscard]] const InertialSample<T>& body() const { return body_; }

  /// Over the last whole turn: b of eq. (2) across the axis [p], the mean along it. @return kNotObservable before a
  /// turn is full, after the direction changed, or when a turn takes more than Capacity samples
  [[nodiscard]] Result<InertialSample<T>> whole_turn() const {
    const T turn = T(2.0 * kPi);
    const T size = angle_.sum < T(0) ? -angle_.sum : angle_.sum;
    if (count_ == 0 || !(size >= turn)) return Status::kNotObservable;
    const Entry& oldest = ring_[first_];
    const T step = oldest.step < T(0) ? -oldest.step : oldest.step;
    // the share of the oldest sample that lies more than a turn back
    const T out = step > T(0) ? (size - turn) / step * oldest.period : T(0);
    const T time = time_.sum - out;
    const Vec3<T> e = (phasor_.sum - out * oldest.phasor) / time;
    const T rest = T(1) - e.squaredNorm();
    if (!(rest > T(0.1))) return Status::kNotObservable;
    const auto bias = [&](const Vec3<T>& plain, const Vec3<T>& turned) {
      Vec3<T> b = (plain - turn_about_z(T(-e.y()), e.x(), turned)) / rest;
      b.z() = plain.z();
      return b;
    };
    return InertialSample<T>{
        bias((sum_w_.sum - out * oldest.mean.w) / time, (turned_w_.sum - out * oldest.turned.w) / time),
        bias((sum_f_.sum - out * oldest.mean.f) / time, (turned_f_.sum - out * oldest.turned.f) / time)};
  }

 private:
  struct Entry {
    InertialSample<T> mean;
    InertialSample<T> turned;          // eq. (1)
    Vec3<T> phasor = Vec3<T>::Zero();  // exp(i phi) / sinc, as turned has it
    T step = T(0);
    T period = T(0);
  };
  /// Sums that come and go for hours: Kahan.
  template <class V>
  struct Sum {
    V sum;
    V error;
    void add(const V& term) {
      const V corrected = term - error;
      const V next = sum + corrected;
      error = (next - sum) - corrected;
      sum = next;
    }
  };

  void slide(const InertialSample<T>& mean, const T& middle, const T& step, const T& period) {
    using std::cos;
    using std::sin;
    if ((step > T(0) && angle_.sum < T(0)) || (step < T(0) && angle_.sum > T(0))) clear();
    if (count_ == Capacity) drop();
    Entry& entry = ring_[(first_ + count_) % Capacity];
    const T k = sinc_correction(step);
    entry = {mean, body_, Vec3<T>(k * cos(middle), k * sin(middle), T(0)), step, period};
    ++count_;
    change(entry, T(1));
    const T turn = T(2.0 * kPi);
    while (count_ > 1) {
      const T left = angle_.sum - ring_[first_].step;
      if ((left < T(0) ? -left : left) < turn) break;
      drop();
    }
  }
  void drop() {
    change(ring_[first_], T(-1));
    first_ = (first_ + 1) % Capacity;
    --count_;
  }
  void change(const Entry& entry, const T& sign) {
    const T time = sign * entry.period;
    sum_w_.add((time * entry.mean.w).eval());
    sum_f_.add((time * entry.mean.f).eval());
    turned_w_.add((time * entry.turned.w).eval());
    turned_f_.add((time * entry.turned.f).eval());
    phasor_.add((time * entry.phasor).eval());
    angle_.add(sign * entry.step);
    time_.add(time);
  }
  void clear() {
    count_ = 0;
    sum_w_ = sum_f_ = turned_w_ = turned_f_ = phasor_ = {Vec3<T>::Zero(), Vec3<T>::Zero()};
    angle_ = time_ = {T(0), T(0)};
  }

  T delay_;
  T last_angle_ = T(0);
  bool started_ = false;
  InertialSample<T> body_;
  std::array<Entry, Capacity> ring_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  Sum<Vec3<T>> sum_w_{Vec3<T>::Zero(), Vec3<T>::Zero()};
  Sum<Vec3<T>> sum_f_{Vec3<T>::Zero(), Vec3<T>::Zero()};
  Sum<Vec3<T>> turned_w_{Vec3<T>::Zero(), Vec3<T>::Zero()};
  Sum<Vec3<T>> turned_f_{Vec3<T>::Zero(), Vec3<T>::Zero()};
  Sum<Vec3<T>> phasor_{Vec3<T>::Zero(), Vec3<T>::Zero()};
  Sum<T> angle_{T(0), T(0)};
  Sum<T> time_{T(0), T(0)};
};

}  // namespace trunnion
