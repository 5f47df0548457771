// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a navigator is, on the WGS-84 ellipsoid, poles and date line included, and how frame n moves over it.
///
/// Frame n is level with z down; its x axis starts out north and is then turned about z by nothing at all (wander
/// azimuth): north is a singularity of the border, not of the equations. With p = C_en^T z_e (the Earth's axis seen
/// from n: p_z = -sin L), one sqrt and no trigonometric function:
///
///   w_ie = Omega p,   w_en = (v_y, -v_x, 0) / (R_E + h) - kappa (v . p_h) (-p_y, p_x, 0),  p_h = (p_x, p_y)   ... (1)
///   kappa = (1/(R_N + h) - 1/(R_E + h)) / cos^2 L = a e^2 / ((1 - e^2 sin^2 L)^(3/2) (R_E + h)(R_N + h))
///
/// Every state is a compensated sum (Kahan, CACM 8 (1965), 40), so that float holds a position to a tenth of a
/// millimetre: never compile it with -ffast-math. Savage, J. Guidance 21 (1998), 208; Titterton & Weston, 2nd ed.,
/// ch. 3.

#pragma once

#include <cmath>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/triple.hpp"

namespace trunnion {

/// At the border: geodetic position, velocity in north-east-down, attitude q_nb with n = north-east-down.
template <class T>
struct NavigationState {
  T latitude = T(0);   ///< rad
  T longitude = T(0);  ///< rad, in (-pi, pi]
  T height = T(0);     ///< m above the ellipsoid
  Vec3<T> velocity = Vec3<T>::Zero();
  Quaternion<T> attitude = Quaternion<T>::Identity();
};

/// The same in the wander azimuth frame, without a trigonometric function: to go on from, or to send to a host.
template <class T>
struct WanderState {
  Quaternion<T> q_en = Quaternion<T>::Identity();  ///< of n in the Earth's frame
  Quaternion<T> q_nb = Quaternion<T>::Identity();
  Vec3<T> velocity = Vec3<T>::Zero();  ///< in n [m/s]
  T height = T(0);                     ///< m above the ellipsoid
};

namespace kernel {

/// @p wide as the nearest T, and what that leaves out.
template <class T, class U>
CompensatedSum<T> compensated(const U& wide) {
  const T sum = static_cast<T>(wide);
  return {sum, static_cast<T>(static_cast<U>(sum) - wide)};
}

template <class U, class T>
U widened(const T& sum, const T& error) {
  return static_cast<U>(sum) - static_cast<U>(error);
}

/// The states in n, and eq. (1).
template <class T>
struct WanderAzimuth {
  CompensatedSum<Quad<T>> q_nb;
  CompensatedSum<Quad<T>> q_en;
  CompensatedSum<Triple<T>> velocity;
  CompensatedSum<T> height;

  /// @param start in any scalar: what T cannot hold of a double position is kept beside it
  template <class U>
  explicit WanderAzimuth(const NavigationState<U>& start) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const U half_longitude = start.longitude / U(2);
    const U half_latitude = start.latitude / U(2);
    const U cl = cos(half_longitude);
    const U sl = sin(half_longitude);
    // half of -(latitude + 90 deg)
    const U root = sqrt(U(0.5));
    const U ct = root * (cos(half_latitude) - sin(half_latitude));
    const U st = -root * (cos(half_latitude) + sin(half_latitude));
    set(q_en, cl * ct, Vec3<U>(-sl * st, cl * st, sl * ct));
    const Quaternion<U> attitude = start.attitude.normalized();
    set(q_nb, attitude.w(), Vec3<U>(attitude.vec()));
    set(velocity, start.velocity);
    height = compensated<T>(start.height);
  }

  explicit WanderAzimuth(const WanderState<T>& start)
      : q_nb{normalized(quad<T>(start.q_nb)), {}},
        q_en{normalized(quad<T>(start.q_en)), {}},
        velocity{triple<T>(start.velocity), {}},
        height{start.height, T(0)} {}
  /// Without what the sums leave out.
  [[nodiscard]] WanderState<T> wander_state() const {
    return {quaternion(q_en.sum), quaternion(q_nb.sum), vector(velocity.sum), height.sum};
  }

  /// U wider than T shows all digits. At a pole, longitude and heading are those of the meridian that n started on.
  template <class U>
  [[nodiscard]] NavigationState<U> state() const {
    using std::atan2;
    using std::sqrt;
    const Mat3<U> C_en = wide<U>(q_en).normalized().toRotationMatrix();
    const U px = C_en(2, 0);
    const U py = C_en(2, 1);
    NavigationState<U> state;
    state.latitude = atan2(-C_en(2, 2), sqrt(px * px + py * py));
    state.longitude = atan2(-C_en(1, 2), -C_en(0, 2));
    state.height = widened<U>(height.sum, height.error);
    const U wander = atan2(py, px);  // of north, from the x axis of n
    const Quaternion<U> q_north_n = quaternion_exp<U>(Vec3<U>(U(0), U(0), -wander));
    state.attitude = (q_north_n * wide<U>(q_nb)).normalized();
    state.velocity = q_north_n * wide<U>(velocity.sum, velocity.error);
    return state;
  }

  /// Takes errors out: true C_nb = Exp(phi) C_nb, dv navigated minus true [m/s], in north-east-down. Not at a pole.
  void correct(const Vec3<T>& phi, const Vec3<T>& dv) {
    using std::sqrt;
    const Triple<T> p = earth_axis(q_en.sum);
    const T across = sqrt(p.x * p.x + p.y * p.y);
    const T c = p.x / across;
    const T s = p.y / across;
    const auto in_n = [&c, &s](const Vec3<T>& v) { return turn_about_z(s, c, v); };
    const Quaternion<T> turn = quaternion_exp<T>(in_n(phi));
    const Quad<T> step = {turn.w() - T(1), triple<T>(turn.vec())};
    q_nb.add(product(step, q_nb.sum));
    velocity.add(T(-1) * triple<T>(in_n(dv)));
  }

  /// Exp(phi) - 1 of the small turn of a frame: less than 1e-3 rad an update.
  static TRUNNION_INLINE Quad<T> small_turn(const Triple<T>& phi) {
    const T eighth = T(0.125) * dot(phi, phi);
    return {-eighth, (T(0.5) - eighth * T(1.0 / 6.0)) * phi};
  }

  /// C_en^T z_e, eq. (1)
  static TRUNNION_INLINE Triple<T> earth_axis(const Quad<T>& q) {
    return {T(2) * (q.v.x * q.v.z - q.w * q.v.y), T(2) * (q.v.y * q.v.z + q.w * q.v.x),
            T(1) - T(2) * (q.v.x * q.v.x + q.v.y * q.v.y)};
  }

  /// w_en [rad/s], eq. (1)
  static TRUNNION_INLINE Triple<T> transport_rate(const Ellipsoid<T>& ellipsoid, const T& height, const Triple<T>& p,
                                                  const Triple<T>& v) {
    constexpr double kFactor = kEarthEccentricity2 / (1.0 - kEarthEccentricity2);
    const T inverse_east = T(1) / (ellipsoid.east_radius + height);
    const T inverse_north = T(1) / (ellipsoid.north_radius + height);
    const T kappa = T(kFactor) * ellipsoid.north_radius * inverse_east * inverse_north;
    const T along = kappa * (v.x * p.x + v.y * p.y);
    return {inverse_east * v.y + along * p.y, -(inverse_east * v.x + along * p.x), T(0)};
  }

 private:
  template <class U>
  static void set(CompensatedSum<Triple<T>>& to, const Vec3<U>& from) {
    const auto x = compensated<T>(from.x());
    const auto y = compensated<T>(from.y());
    const auto z = compensated<T>(from.z());
    to = {{x.sum, y.sum, z.sum}, {x.error, y.error, z.error}};
  }
  template <class U>
  static void set(CompensatedSum<Quad<T>>& to, const U& w, const Vec3<U>& v) {
    CompensatedSum<Triple<T>> vector;
    set(vector, v);
    const auto scalar = compensated<T>(w);
    to = {{scalar.sum, vector.sum}, {scalar.error, vector.error}};
  }
  template <class U>
  static Vec3<U> wide(const Triple<T>& sum, const Triple<T>& error) {
    return Vec3<U>(widened<U>(sum.x, error.x), widened<U>(sum.y, error.y), widened<U>(sum.z, error.z));
  }
  template <class U>
  static Quaternion<U> wide(const CompensatedSum<Quad<T>>& q) {
    const Vec3<U> v = wide<U>(q.sum.v, q.error.v);
    return Quaternion<U>(widened<U>(q.sum.w, q.error.w), v.x(), v.y(), v.z());
  }
};

}  // namespace kernel

/// @p state for a start without trigonometric functions: a host computes it, a firmware goes on from it.
template <class T, class U>
WanderState<T> wander_state(const NavigationState<U>& state) {
  return kernel::WanderAzimuth<T>(state).wander_state();
}

}  // namespace trunnion
