// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A path written as functions of time, and exactly what a perfect unit on it delivers.
///
/// Shares no equation with the integrator: position, velocity and acceleration go through Earth-fixed coordinates by
/// automatic differentiation, the attitude through Euler angles,
///
///   f_b = C_be (r'' + 2 Omega x r' - g_e),   w_ib_b = C_bn (w_ie + w_en) + E(roll, pitch) (roll', pitch', yaw')   ...
///   (1)
///
/// and increments are integrals of (1) by six-point Gauss-Legendre, in long double. Groves, 2nd ed., eq. (2.112),
/// (2.57)-(2.58), (5.28).

#pragma once

#include <array>
#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/strapdown/increment.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion::simulation {

/// A function of time with its first two derivatives.
template <class T>
struct TimeJet {
  T value = T(0);
  T rate = T(0);
  T acceleration = T(0);

  TimeJet() = default;
  TimeJet(T v) : value(v) {}  // NOLINT(google-explicit-constructor): a constant
  TimeJet(T v, T r, T a) : value(v), rate(r), acceleration(a) {}

  /// f(*this), of which f, f', f'' are given at value.
  [[nodiscard]] TimeJet chain(T f, T df, T ddf) const { return {f, df * rate, ddf * rate * rate + df * acceleration}; }
  friend TimeJet operator+(const TimeJet& a, const TimeJet& b) {
    return {a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration};
  }
  friend TimeJet operator-(const TimeJet& a, const TimeJet& b) {
    return {a.value - b.value, a.rate - b.rate, a.acceleration - b.acceleration};
  }
  friend TimeJet operator*(const TimeJet& a, const TimeJet& b) {
    return {a.value * b.value, a.rate * b.value + a.value * b.rate,
            a.acceleration * b.value + T(2) * a.rate * b.rate + a.value * b.acceleration};
  }
  friend TimeJet sin(const TimeJet& a) { return a.chain(std::sin(a.value), std::cos(a.value), -std::sin(a.value)); }
  friend TimeJet cos(const TimeJet& a) { return a.chain(std::cos(a.value), -std::sin(a.value), -std::cos(a.value)); }
  friend TimeJet inverse_sqrt(const TimeJet& a) {
    const T y = T(1) / std::sqrt(a.value);
    return a.chain(y, -y * y * y / T(2), T(3) * y * y * y * y * y / T(4));
  }
};

/// Integrals over [from, to] of @p sample, a callable InertialSample<T>(T t): Gauss-Legendre with six points.
template <class T, class Sampler>
Increment<T> integrate(const Sampler& sample, T from, T to) {
  constexpr std::array<T, 3> kNode = {T(0.238619186083196908630501721680711935L),
                                      T(0.661209386466264513661399595019905347L),
                                      T(0.932469514203152027812301554493994609L)};
  constexpr std::array<T, 3> kWeight = {T(0.467913934572691047389870343989550995L),
                                        T(0.360761573048138607569833513837716112L),
                                        T(0.171324492379170345040296142172732894L)};
  const T middle = (from + to) / T(2);
  const T half = (to - from) / T(2);
  Increment<T> increment;
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    for (const T side : {T(-1), T(1)}) {
      const InertialSample<T> s = sample(middle + side * kNode[i] * half);
      increment.angle += kWeight[i] * half * s.w;
      increment.velocity += kWeight[i] * half * s.f;
    }
  }
  return increment;
}

/// Where a path is at one time: geodetic position and roll, pitch, yaw of C_nb, n = north-east-down. Radians, metres.
template <class S>
struct Pose {
  S latitude, longitude, height, roll, pitch, yaw;
};

/// @tparam Path callable: `Pose<S> operator()(const S& t)` for S of TimeJet, long double
template <class Path>
class PathTruth {
 public:
  using T = long double;
  using S = TimeJet<T>;

  explicit PathTruth(Path path) : path_(std::move(path)) {}

  [[nodiscard]] NavigationState<T> state(T t) const {
    const Pose<S> pose = path_(S(t, T(1), T(0)));
    NavigationState<T> state;
    state.latitude = pose.latitude.value;
    state.longitude = pose.longitude.value;
    state.height = pose.height.value;
    const Mat3<T> C_en = earth_from_north(pose);
    state.velocity = C_en.transpose() * earth_fixed(pose)[1];
    state.attitude = Quaternion<T>(north_from_body(pose));
    return state;
  }

  /// w_ib_b [rad/s] and f_b [m/s^2] at @p t, eq. (1).
  [[nodiscard]] InertialSample<T> sample(T t) const {
    const Pose<S> pose = path_(S(t, T(1), T(0)));
    const Mat3<T> C_en = earth_from_north(pose);
    const Mat3<T> C_nb = north_from_body(pose);
    const auto r = earth_fixed(pose);
    const Vec3<T> omega(T(0), T(0), T(kEarthRate));
    const Vec3<T> gravity(T(0), T(0), normal_gravity<T>(pose.latitude.value, pose.height.value));
    InertialSample<T> sample;
    sample.f = C_nb.transpose() * (C_en.transpose() * (r[2] + T(2) * omega.cross(r[1])) - gravity);
    const T sl = std::sin(pose.latitude.value);
    const T cl = std::cos(pose.latitude.value);
    const Vec3<T> w_en(pose.longitude.rate * cl, -pose.latitude.rate, -pose.longitude.rate * sl);
    const T sr = std::sin(pose.roll.value);
    const T cr = std::cos(pose.roll.value);
    const T sp = std::sin(pose.pitch.value);
    const T cp = std::cos(pose.pitch.value);
    const Vec3<T> w_nb(pose.roll.rate - sp * pose.yaw.rate, cr * pose.pitch.rate + sr * cp * pose.yaw.rate,
                       -sr * pose.pitch.rate + cr * cp * pose.yaw.rate);
    sample.w = C_nb.transpose() * (C_en.transpose() * omega + w_en) + w_nb;
    return sample;
  }

  /// Integrals over [from, to].
  [[nodiscard]] Increment<T> increment(T from, T to) const {
    return integrate([this](T t) { return sample(t); }, from, to);
  }

 private:
  static Mat3<T> earth_from_north(const Pose<S>& pose) {
    const T sl = std::sin(pose.latitude.value);
    const T cl = std::cos(pose.latitude.value);
    const T so = std::sin(pose.longitude.value);
    const T co = std::cos(pose.longitude.value);
    Mat3<T> C;
    C << -sl * co, -so, -cl * co, -sl * so, co, -cl * so, cl, T(0), -sl;
    return C;
  }

  static Mat3<T> north_from_body(const Pose<S>& pose) {
    return (Eigen::AngleAxis<T>(pose.yaw.value, Vec3<T>::UnitZ()) *
            Eigen::AngleAxis<T>(pose.pitch.value, Vec3<T>::UnitY()) *
            Eigen::AngleAxis<T>(pose.roll.value, Vec3<T>::UnitX()))
        .toRotationMatrix();
  }

  /// Position, velocity and acceleration in Earth-fixed coordinates.
  static std::array<Vec3<T>, 3> earth_fixed(const Pose<S>& pose) {
    const S sl = sin(pose.latitude);
    const S cl = cos(pose.latitude);
    const S radius = S(T(kEarthRadius)) * inverse_sqrt(S(T(1)) - S(T(kEarthEccentricity2)) * sl * sl);
    const S across = (radius + pose.height) * cl;
    const S x = across * cos(pose.longitude);
    const S y = across * sin(pose.longitude);
    const S z = (S(T(1) - T(kEarthEccentricity2)) * radius + pose.height) * sl;
    return {Vec3<T>(x.value, y.value, z.value), Vec3<T>(x.rate, y.rate, z.rate),
            Vec3<T>(x.acceleration, y.acceleration, z.acceleration)};
  }

  Path path_;
};

}  // namespace trunnion::simulation
