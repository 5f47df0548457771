// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Strapdown navigation on the WGS-84 ellipsoid, anywhere on it, poles and date line included.
///
/// Frame n is level with z down; its x axis starts out north and is then turned about z by nothing at all (wander
/// azimuth): north is a singularity of the border, not of the equations. With p = C_en^T z_e (the Earth's axis seen
/// from n: p_z = -sin L), one sqrt and no trigonometric function an update:
///
///   w_en = (v_y, -v_x, 0) / (R_E + h) - kappa (v . p_h) (-p_y, p_x, 0),  p_h = (p_x, p_y)        ... (1)
///   kappa = (1/(R_N + h) - 1/(R_E + h)) / cos^2 L = a e^2 / ((1 - e^2 sin^2 L)^(3/2) (R_E + h)(R_N + h))
///   q_nb <- Exp(-(w_ie + w_en) T) q_nb dq                                                        ... (2)
///   v    <- v + (I - 1/2 (w_ie + w_en) T x) C_nb dv + (g - (2 w_ie + w_en) x v) T                ... (3)
///   q_en <- q_en Exp(w_en T),   h <- h - v_z T                                                   ... (4)
///
/// with everything on the right at the middle of the update (v there to third order: its square is the centrifugal
/// force of a flight). dq, dv: strapdown/body_motion.hpp. Savage, J. Guidance 21
/// (1998), 19 and 208; Titterton & Weston, 2nd ed., ch. 3 and 11. Every state is a compensated sum (Kahan, CACM 8
/// (1965), 40), so that float holds a position to a tenth of a millimetre: never compile it with -ffast-math.

#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/strapdown/body_motion.hpp"

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

namespace strapdown_detail {

/// Numbers (T, Triple, Quad) whose sums lose nothing to rounding: the true value is sum - error.
template <class V>
struct CompensatedSum {
  V sum{};
  V error{};

  inline void add(const V& step) {
    const V corrected = step - error;
    const V next = sum + corrected;
    error = (next - sum) - corrected;
    sum = next;
  }
};

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

}  // namespace strapdown_detail

/// @tparam Algorithm PreviousSample<T>, MultiSample<T, N> or ExactSamples<T, N>
template <class Algorithm>
class Navigator {
 public:
  using T = typename Algorithm::Scalar;
  static constexpr int kSamples = Algorithm::kSamples;

  /// @param start in any scalar: what T cannot hold of a double position is kept beside it
  /// @param period of one sample [s], positive
  template <class U>
  Navigator(const NavigationState<U>& start, const T& period)
      : update_(T(kSamples) * period), earth_turn_(T(kEarthRate) * update_), long_(update_ > T(kLongUpdate)) {
    using std::cos;
    using std::fma;
    using std::sin;
    using std::sqrt;
    gravity_.sum = T(kEquatorGravity) * update_;
    gravity_.error = -fma(T(kEquatorGravity), update_, -gravity_.sum) -
                     T(kEquatorGravity - static_cast<double>(static_cast<T>(kEquatorGravity))) * update_;
    const U half_longitude = start.longitude / U(2);
    const U half_latitude = start.latitude / U(2);
    const U cl = cos(half_longitude);
    const U sl = sin(half_longitude);
    // half of -(latitude + 90 deg)
    const U root = sqrt(U(0.5));
    const U ct = root * (cos(half_latitude) - sin(half_latitude));
    const U st = -root * (cos(half_latitude) + sin(half_latitude));
    set(q_en_, cl * ct, Vec3<U>(-sl * st, cl * st, sl * ct));
    const Quaternion<U> q_nb = start.attitude.normalized();
    set(q_nb_, q_nb.w(), Vec3<U>(q_nb.vec()));
    set(velocity_, start.velocity);
    height_ = strapdown_detail::compensated<T>(start.height);
    const Triple p = earth_axis(q_en_.sum);
    w_en_before_ = w_en_ = transport_rate(Ellipsoid<T>(p.z * p.z), height_.sum, p, velocity_.sum);
  }

  /// Takes the next sample; with the last of an update the state moves on, and updated() is true.
  /// @return kOutOfRange, and nothing changed, for a sample that is not finite or turns by more than a radian
  Status add(const Increment<T>& sample) {
    const T sum = sample.angle.sum() + sample.velocity.sum();
    if (!(sum - sum == T(0)) || !(sample.angle.squaredNorm() <= T(1))) return Status::kOutOfRange;
    if constexpr (kSamples == 1) {
      advance(algorithm_({sample}));
      updated_ = true;
    } else {
      sample_[count_++] = sample;
      updated_ = count_ == sample_.size();
      if (updated_) {
        count_ = 0;
        advance(algorithm_(sample_));
      }
    }
    return Status::kOk;
  }

  /// Takes errors out that a filter has found, as strapdown/error_dynamics.hpp has them: true C_nb = Exp(phi) C_nb, dv
  /// navigated minus true [m/s], in north-east-down; small. Not at a pole.
  void correct(const Vec3<T>& phi, const Vec3<T>& dv) {
    using std::sqrt;
    const Triple p = earth_axis(q_en_.sum);
    const T across = sqrt(p.x * p.x + p.y * p.y);
    const T c = p.x / across;
    const T s = p.y / across;
    const auto in_n = [&c, &s](const Vec3<T>& v) { return turn_about_z(s, c, v); };
    const Quaternion<T> turn = quaternion_exp<T>(in_n(phi));
    const Quad step = {turn.w() - T(1), strapdown_detail::triple<T>(turn.vec())};
    q_nb_.add(product(step, q_nb_.sum));
    velocity_.add(T(-1) * strapdown_detail::triple<T>(in_n(dv)));
  }

  /// Whether the last add() completed an update: every kSamples samples.
  [[nodiscard]] bool updated() const { return updated_; }

  /// The state after the last update; U wider than T shows all digits. At a pole, longitude and heading are those of
  /// the meridian that frame n started on.
  template <class U = T>
  [[nodiscard]] NavigationState<U> state() const {
    using std::atan2;
    using std::sqrt;
    const Mat3<U> C_en = wide<U>(q_en_).normalized().toRotationMatrix();
    const U px = C_en(2, 0);
    const U py = C_en(2, 1);
    NavigationState<U> state;
    state.latitude = atan2(-C_en(2, 2), sqrt(px * px + py * py));
    state.longitude = atan2(-C_en(1, 2), -C_en(0, 2));
    state.height = strapdown_detail::widened<U>(height_.sum, height_.error);
    const U wander = atan2(py, px);  // of north, from the x axis of n
    const Quaternion<U> q_north_n = quaternion_exp<U>(Vec3<U>(U(0), U(0), -wander));
    state.attitude = (q_north_n * wide<U>(q_nb_)).normalized();
    state.velocity = q_north_n * wide<U>(velocity_.sum, velocity_.error);
    return state;
  }

 private:
  using Triple = strapdown_detail::Triple<T>;
  using Quad = strapdown_detail::Quad<T>;
  template <class V>
  using Sum = strapdown_detail::CompensatedSum<V>;

  template <class U>
  static void set(Sum<Triple>& to, const Vec3<U>& from) {
    const auto x = strapdown_detail::compensated<T>(from.x());
    const auto y = strapdown_detail::compensated<T>(from.y());
    const auto z = strapdown_detail::compensated<T>(from.z());
    to = {{x.sum, y.sum, z.sum}, {x.error, y.error, z.error}};
  }
  template <class U>
  static void set(Sum<Quad>& to, const U& w, const Vec3<U>& v) {
    Sum<Triple> vector;
    set(vector, v);
    const auto scalar = strapdown_detail::compensated<T>(w);
    to = {{scalar.sum, vector.sum}, {scalar.error, vector.error}};
  }
  template <class U>
  static Vec3<U> wide(const Triple& sum, const Triple& error) {
    using strapdown_detail::widened;
    return Vec3<U>(widened<U>(sum.x, error.x), widened<U>(sum.y, error.y), widened<U>(sum.z, error.z));
  }
  template <class U>
  static Quaternion<U> wide(const Sum<Quad>& q) {
    const Vec3<U> v = wide<U>(q.sum.v, q.error.v);
    return Quaternion<U>(strapdown_detail::widened<U>(q.sum.w, q.error.w), v.x(), v.y(), v.z());
  }

  /// Exp(phi) - 1 of the small turn of a frame: less than 1e-3 rad an update.
  static inline Quad small_turn(const Triple& phi) {
    const T eighth = T(0.125) * dot(phi, phi);
    return {-eighth, (T(0.5) - eighth * T(1.0 / 6.0)) * phi};
  }

  /// C_en^T z_e, eq. (1)
  static inline Triple earth_axis(const Quad& q) {
    return {T(2) * (q.v.x * q.v.z - q.w * q.v.y), T(2) * (q.v.y * q.v.z + q.w * q.v.x),
            T(1) - T(2) * (q.v.x * q.v.x + q.v.y * q.v.y)};
  }

  /// w_en [rad/s], eq. (1)
  static inline Triple transport_rate(const Ellipsoid<T>& ellipsoid, const T& height, const Triple& p,
                                      const Triple& v) {
    constexpr double kFactor = kEarthEccentricity2 / (1.0 - kEarthEccentricity2);
    const T inverse_east = T(1) / (ellipsoid.east_radius + height);
    const T inverse_north = T(1) / (ellipsoid.north_radius + height);
    const T kappa = T(kFactor) * ellipsoid.north_radius * inverse_east * inverse_north;
    const T along = kappa * (v.x * p.x + v.y * p.y);
    return {inverse_east * v.y + along * p.y, -(inverse_east * v.x + along * p.x), T(0)};
  }

  static constexpr bool kNarrow = std::numeric_limits<T>::digits < 30;  // float: 1e-7 of gravity is 60 m in an hour

  static constexpr double kLongUpdate = 0.03;  // s: shorter, the second order is below 4e-12 m/s^2

  void advance(const BodyMotion<T>& motion) {
    const T dt = update_;
    const Quad q_nb = q_nb_.sum;
    const Quad q_en = q_en_.sum;
    const Triple v = velocity_.sum;

    // specific force in n, from where the update started
    const Triple force = rotate(q_nb.w, q_nb.v, strapdown_detail::triple(motion.velocity));

    // what the rounding of q_nb and of gravity leaves out: at rest it would never average
    Triple left_out{};
    if constexpr (kNarrow) {
      const Quad& e = q_nb_.error;
      left_out = cross(T(2) * (q_nb.w * e.v - e.w * q_nb.v + cross(q_nb.v, e.v)), force);
    }

    // the Earth's axis from n, then everything at the middle of the update
    const T half = T(0.5) * dt;
    Triple p = earth_axis(q_en);
    // the transport rate in the middle, extrapolated from the last two
    const T ahead_x = w_en_.x + (w_en_.x - w_en_before_.x);
    const T ahead_y = w_en_.y + (w_en_.y - w_en_before_.y);
    p = {p.x - half * ahead_y * p.z, p.y + half * ahead_x * p.z, p.z + half * (p.x * ahead_y - p.y * ahead_x)};
    const Triple w_ie_dt = earth_turn_ * p;
    const Triple zeta_ahead = {w_ie_dt.x + dt * ahead_x, w_ie_dt.y + dt * ahead_y, w_ie_dt.z};
    const Ellipsoid<T> ellipsoid(p.z * p.z);
    const T height = height_.sum - half * v.z;
    Triple push = force + cross(force, T(0.5) * zeta_ahead);
    push.z = (push.z + gravity_.sum) + dt * ellipsoid.gravity_excess(height);
    const Triple about_dv = push + cross(v, w_ie_dt + zeta_ahead);
    const Triple middle = v + (T(0.375) * about_dv + T(0.125) * (started_ ? dv_before_ : about_dv));
    w_en_before_ = w_en_;
    w_en_ = transport_rate(ellipsoid, height, p, middle);
    const Triple zeta = w_ie_dt + dt * w_en_;

    const Triple dv = push + cross(middle, w_ie_dt + zeta);
    dv_before_ = dv;
    started_ = true;
    height_.add(-dt * (v.z + T(0.5) * dv.z));
    if constexpr (kNarrow)
      velocity_.error = velocity_.error + Triple{left_out.x, left_out.y, left_out.z + gravity_.error};
    velocity_.add(dv);
    q_en_.add(product(q_en, small_turn(dt * w_en_)));  // a millionth of a turn: its length is kept by the sum

    // of long updates the second order too, for a force that is even in n; float would not see it. Here and anew: above
    // it costs registers
    if constexpr (!kNarrow) {
      if (long_) {
        const Triple again = rotate(q_nb.w, q_nb.v, strapdown_detail::triple(motion.velocity));
        velocity_.add(T(1.0 / 12.0) * cross(cross(again, zeta), zeta));
      }
    }
    const Quad step = product(q_nb, {motion.rotation_w, strapdown_detail::triple(motion.rotation_v)});
    const T stretch = T(0.5) - T(0.5) * dot(q_nb, q_nb);  // brings the length back to one
    Quad frame = small_turn(T(-1) * zeta);
    frame.w += stretch;
    q_nb_.add(step + product(frame, q_nb + step));
  }

  Algorithm algorithm_;
  std::array<Increment<T>, static_cast<std::size_t>(kSamples)> sample_;
  std::size_t count_ = 0;
  bool updated_ = false;
  T update_;        // s
  T earth_turn_;    // rad an update
  Sum<T> gravity_;  // gamma_e, m/s an update
  Sum<Quad> q_nb_;
  Sum<Quad> q_en_;
  Sum<Triple> velocity_;
  Sum<T> height_;
  Triple w_en_{};  // of the last update
  Triple w_en_before_{};
  Triple dv_before_{};
  bool started_ = false;
  bool long_;
};

}  // namespace trunnion
