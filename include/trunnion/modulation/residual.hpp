// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a schedule of rotation modulation leaves of a unit's errors, in closed form.
///
/// A cycle of a schedule is made of arcs C(t) = A R(n, theta) B with R = n n^T + cos theta (I - n n^T) + sin theta [n
/// x], theta even in time, and of rests. With T its length, u what the body feels, b and M the unit's bias and matrix:
///
///   e     = (1/T) { integral C (b + M C^T u) dt + integral C M B^T n dtheta }                       ... (1)
///   c_k   = (1/T) integral C exp(-i k W t) dt,   W = 2 pi / T                                       ... (2)
///   N_j^2 = sum_(k != 0) |c_k,ji|^2 K / (2 |k| / T)                          1/f noise K/f          ... (3)
///   V_j   = K^2 (tau/T) integral G_ji^2 dt,  G = integral of C - c_0 from the start, rate random walk ... (4)
///
/// e: mean error in body axes (the second term of gyros only); N_j: density of the white noise that 1/f becomes; V_j:
/// variance of the integral over tau, a whole number of cycles, exact and with its edges. (3) and (4) hold for axes
/// whose c_0 is zero: mean_attitude() tells. Collin, Kirkko-Jaakkola & Takala, arXiv:1312.7839, for one axis;
/// docs/theory/modulation.md, section 5.

#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include "trunnion/core/linear.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/modulation/schedule.hpp"

namespace trunnion {

template <class T>
struct ScheduleTiming {
  T rate;   ///< of every move [rad/s], positive
  T dwell;  ///< of every rest [s]
};

namespace residual_detail {

/// An arc of a cycle, or a rest (rate 0).
template <class T>
struct Arc {
  Mat3<T> before;  // A
  Vec3<T> axis;    // n
  Mat3<T> after;   // B
  T angle;         // theta at its start
  T rate;          // signed
  T start;         // s from the beginning of the cycle
  T duration;
};

template <class T>
Mat3<T> turn(const Vec3<T>& axis, const T& angle) {
  using std::cos;
  using std::sin;
  const Mat3<T> along = axis * axis.transpose();
  return along + cos(angle) * (Mat3<T>::Identity() - along) + sin(angle) * skew<T>(axis);
}

/// Calls visit(arc) for every arc and rest of the cycle. @return its length [s]
template <class T, std::size_t N, class Visit>
T for_each_arc(const Schedule<N>& schedule, const ScheduleTiming<T>& timing, Visit visit) {
  T outer = T(0);
  T inner = T(0);
  T time = T(0);
  for (const ScheduleStep& step : schedule) {
    const bool is_outer = step.axis == ModulationAxis::kOuter;
    const T angle = T(0.5 * kPi) * T(step.quarter_turns);
    const T size = angle < T(0) ? -angle : angle;
    const Vec3<T> x = Vec3<T>::UnitX();
    const Vec3<T> z = Vec3<T>::UnitZ();
    Arc<T> arc;
    arc.before = is_outer ? Mat3<T>(Mat3<T>::Identity()) : turn<T>(z, outer);
    arc.after = is_outer ? turn<T>(x, inner) : Mat3<T>(Mat3<T>::Identity());
    arc.axis = is_outer ? z : x;
    arc.angle = is_outer ? outer : inner;
    arc.rate = angle < T(0) ? -timing.rate : timing.rate;
    arc.start = time;
    arc.duration = size / timing.rate;
    visit(arc);
    time += arc.duration;
    (is_outer ? outer : inner) += angle;
    if (!step.rests) continue;
    arc.angle += angle;
    arc.rate = T(0);
    arc.start = time;
    arc.duration = timing.dwell;
    visit(arc);
    time += arc.duration;
  }
  return time;
}

/// Integral of exp(i (a t + phase)) over [from, from + duration].
template <class T>
std::complex<T> wave(const T& a, const T& phase, const T& from, const T& duration) {
  using std::abs;
  using std::cos;
  using std::sin;
  const T middle = a * (from + duration / T(2)) + phase;
  const T half = a * duration / T(2);
  const T size = abs(half) < T(1e-4) ? duration * (T(1) - half * half / T(6)) : duration * sin(half) / half;
  return {size * cos(middle), size * sin(middle)};
}

/// Integral over an arc of C(t) exp(-i w t): eq. (2).
template <class T>
Eigen::Matrix<std::complex<T>, 3, 3> transform(const Arc<T>& arc, const T& w) {
  using C = std::complex<T>;
  const T phase = arc.angle - arc.rate * arc.start;
  const C one = wave<T>(-w, T(0), arc.start, arc.duration);
  const C plus = wave<T>(arc.rate - w, phase, arc.start, arc.duration);
  const C minus = wave<T>(-arc.rate - w, -phase, arc.start, arc.duration);
  const C cosine = T(0.5) * (plus + minus);
  const C sine = C(T(0), T(-0.5)) * (plus - minus);
  const Mat3<T> along = arc.axis * arc.axis.transpose();
  const Mat3<T> across = Mat3<T>::Identity() - along;
  Eigen::Matrix<C, 3, 3> R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = along(i, j) * one + across(i, j) * cosine + skew<T>(arc.axis)(i, j) * sine;
  }
  return arc.before.template cast<C>() * R * arc.after.template cast<C>();
}

}  // namespace residual_detail

/// Length of a cycle [s].
template <class T, std::size_t N>
T cycle_time(const Schedule<N>& schedule, const ScheduleTiming<T>& timing) {
  return residual_detail::for_each_arc(schedule, timing, [](const residual_detail::Arc<T>&) {});
}

/// c_0, eq. (2): the share of each unit axis [column] that stays on each body axis [row].
template <class T, std::size_t N>
Mat3<T> mean_attitude(const Schedule<N>& schedule, const ScheduleTiming<T>& timing) {
  Mat3<T> sum = Mat3<T>::Zero();
  const T time = residual_detail::for_each_arc(schedule, timing, [&sum](const residual_detail::Arc<T>& arc) {
    sum += residual_detail::transform<T>(arc, T(0)).real();
  });
  return sum / time;
}

/// Mean error over a cycle, eq. (1), in body axes. @param matrix M, the errors of scale and alignment; @param input
/// what the body feels, constant; @param gyro whether the triad feels the moves
template <class T, std::size_t N>
Vec3<T> mean_error(const Schedule<N>& schedule, const ScheduleTiming<T>& timing, const Vec3<T>& bias,
                   const Mat3<T>& matrix, const Vec3<T>& input, bool gyro) {
  using residual_detail::Arc;
  using std::cos;
  using std::sin;
  Vec3<T> sum = Vec3<T>::Zero();
  const T time = residual_detail::for_each_arc(schedule, timing, [&](const Arc<T>& arc) {
    const Mat3<T> once = residual_detail::transform<T>(arc, T(0)).real();
    sum += once * bias;
    if (gyro) sum += arc.rate * (once * matrix * arc.after.transpose() * arc.axis);
    // C M C^T = A (sum of R_p Y R_q^T times the products of 1, cos, sin) A^T
    const Mat3<T> Y = arc.after * matrix * arc.after.transpose();
    const Mat3<T> along = arc.axis * arc.axis.transpose();
    const std::array<Mat3<T>, 3> part = {along, Mat3<T>::Identity() - along, skew<T>(arc.axis)};
    const T phase = arc.angle - arc.rate * arc.start;
    const auto single = residual_detail::wave<T>(arc.rate, phase, arc.start, arc.duration);
    const auto twice = residual_detail::wave<T>(T(2) * arc.rate, T(2) * phase, arc.start, arc.duration);
    const T half = T(0.5);
    const T cc = half * (arc.duration + twice.real());
    const T ss = half * (arc.duration - twice.real());
    const T cs = half * twice.imag();
    const std::array<std::array<T, 3>, 3> product = {
        {{arc.duration, single.real(), single.imag()}, {single.real(), cc, cs}, {single.imag(), cs, ss}}};
    Mat3<T> turned = Mat3<T>::Zero();
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = 0; q < 3; ++q) turned += product[p][q] * part[p] * Y * part[q].transpose();
    }
    sum += arc.before * turned * arc.before.transpose() * input;
  });
  return sum / time;
}

template <class T>
struct NoiseResidual {
  Vec3<T> flicker = Vec3<T>::Zero();      ///< N_j for K = 1 [1/sqrt(Hz) of sqrt(K)], eq. (3)
  Vec3<T> random_walk = Vec3<T>::Zero();  ///< sqrt(V_j / tau) for K = 1 [s], eq. (4)
};

/// Eq. (3), (4). @param harmonics of the sums: the rest falls with the third power of their number
template <class T, std::size_t N>
NoiseResidual<T> noise_residual(const Schedule<N>& schedule, const ScheduleTiming<T>& timing, int harmonics) {
  using residual_detail::Arc;
  using std::sqrt;
  using C = std::complex<T>;
  const T time = cycle_time(schedule, timing);
  const T w = T(2.0 * kPi) / time;
  NoiseResidual<T> left;
  Mat3<T> start = Mat3<T>::Zero();  // G's mean: what makes G(0) zero
  for (int k = 1; k <= harmonics; ++k) {
    Eigen::Matrix<C, 3, 3> c = Eigen::Matrix<C, 3, 3>::Zero();
    residual_detail::for_each_arc(schedule, timing,
                                  [&](const Arc<T>& arc) { c += residual_detail::transform<T>(arc, T(k) * w); });
    c /= C(time);
    const Vec3<T> power = T(2) * c.cwiseAbs2().rowwise().sum();  // both signs of k
    left.flicker += power * time / (T(2) * T(k));
    left.random_walk += power / (T(k) * w * T(k) * w);
    start += T(2) * c.imag() / (T(k) * w);
  }
  left.random_walk += start.cwiseAbs2().rowwise().sum();
  left.flicker = left.flicker.cwiseSqrt().eval();
  left.random_walk = left.random_walk.cwiseSqrt().eval();
  return left;
}

}  // namespace trunnion
