// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Strapdown navigation on the WGS-84 ellipsoid, anywhere on it, poles and date line included.
///
/// In the wander azimuth frame n of wander_azimuth.hpp, with its w_ie and w_en:
///
///   q_nb <- Exp(-(w_ie + w_en) T) q_nb dq                                                        ... (1)
///   v    <- v + (I - 1/2 (w_ie + w_en) T x) C_nb dv + (g - (2 w_ie + w_en) x v) T                ... (3)
///   q_en <- q_en Exp(w_en T),   h <- h - v_z T                                                   ... (3)
///
/// with everything on the right at the middle of the update (v there to third order: its square is the centrifugal
/// force of a flight). dq, dv: strapdown/body_motion.hpp. Savage, J. Guidance 21
/// (1998), 19 and 208; Titterton & Weston, 2nd ed., ch. 3 and 11.

#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "trunnion/core/status.hpp"
#include "trunnion/strapdown/body_motion.hpp"
#include "trunnion/strapdown/wander_azimuth.hpp"

namespace trunnion {

/// @tparam Algorithm PreviousSample<T>, MultiSample<T, N> or ExactSamples<T, N>
template <class Algorithm>
class Navigator {
 public:
  using T = typename Algorithm::Scalar;
  static constexpr int kSamples = Algorithm::kSamples;

  /// @param start a NavigationState in any scalar: what T cannot hold of a double position is kept beside it; or a
  /// WanderState<T>
  /// @param period of one sample [s], positive
  template <class Start>
  Navigator(const Start& start, const T& period)
      : update_(T(kSamples) * period),
        earth_turn_(T(kEarthRate) * update_),
        x_(start),
        zero_(update_ > T(0) ? update_ - update_ : std::numeric_limits<T>::quiet_NaN()),
        long_(update_ > T(kLongUpdate)) {
    using std::fma;
    gravity_.sum = T(kEquatorGravity) * update_;
    gravity_.error = -fma(T(kEquatorGravity), update_, -gravity_.sum) -
                     T(kEquatorGravity - static_cast<double>(static_cast<T>(kEquatorGravity))) * update_;
    const Triple p = Frame::earth_axis(x_.q_en.sum);
    w_en_before_ = w_en_ = Frame::transport_rate(Ellipsoid<T>(p.z * p.z), x_.height.sum, p, x_.velocity.sum);
  }

  /// Takes the next sample; with the last of an update the state moves on, and updated() is true.
  /// @return kOutOfRange, and nothing changed, for a sample that is not finite or turns by more than a radian, and for
  /// every one when the period is not positive
  Status add(const Increment<T>& sample) {
    const T sum = sample.angle.sum() + sample.velocity.sum();
    if (!(sum - sum == zero_) || !(sample.angle.squaredNorm() <= T(1))) return Status::kOutOfRange;
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
  void correct(const Vec3<T>& phi, const Vec3<T>& dv) { x_.correct(phi, dv); }

  /// Whether the last add() completed an update: every kSamples samples.
  [[nodiscard]] bool updated() const { return updated_; }

  /// The state after the last update; U wider than T shows all digits. At a pole, longitude and heading are those of
  /// the meridian that frame n started on.
  template <class U = T>
  [[nodiscard]] NavigationState<U> state() const {
    return x_.template state<U>();
  }

 private:
  using Triple = kernel::Triple<T>;
  using Quad = kernel::Quad<T>;
  using Frame = kernel::WanderAzimuth<T>;

  static constexpr bool kNarrow = std::numeric_limits<T>::digits < 30;  // float: 1e-7 of gravity is 60 m in an hour

  static constexpr double kLongUpdate = 0.03;  // s: shorter, the second order is below 4e-12 m/s^2

  void advance(const BodyMotion<T>& motion) {
    const T dt = update_;
    const Quad q_nb = x_.q_nb.sum;
    const Quad q_en = x_.q_en.sum;
    const Triple v = x_.velocity.sum;

    // specific force in n, from where the update started
    const Triple force = rotate(q_nb.w, q_nb.v, kernel::triple(motion.velocity));

    // what the rounding of q_nb and of gravity leaves out: at rest it would never average
    Triple left_out{};
    if constexpr (kNarrow) {
      const Quad& e = x_.q_nb.error;
      left_out = cross(T(2) * (q_nb.w * e.v - e.w * q_nb.v + cross(q_nb.v, e.v)), force);
    }

    // the Earth's axis from n, then everything at the middle of the update
    const T half = T(0.5) * dt;
    Triple p = Frame::earth_axis(q_en);
    // the transport rate in the middle, extrapolated from the last two
    const T ahead_x = w_en_.x + (w_en_.x - w_en_before_.x);
    const T ahead_y = w_en_.y + (w_en_.y - w_en_before_.y);
    p = {p.x - half * ahead_y * p.z, p.y + half * ahead_x * p.z, p.z + half * (p.x * ahead_y - p.y * ahead_x)};
    const Triple w_ie_dt = earth_turn_ * p;
    const Triple zeta_ahead = {w_ie_dt.x + dt * ahead_x, w_ie_dt.y + dt * ahead_y, w_ie_dt.z};
    const Ellipsoid<T> ellipsoid(p.z * p.z);
    const T height = x_.height.sum - half * v.z;
    Triple push = force + cross(force, T(0.5) * zeta_ahead);
    push.z = (push.z + gravity_.sum) + dt * ellipsoid.gravity_excess(height);
    const Triple about_dv = push + cross(v, w_ie_dt + zeta_ahead);
    const Triple middle = v + (T(0.375) * about_dv + T(0.125) * (started_ ? dv_before_ : about_dv));
    w_en_before_ = w_en_;
    w_en_ = Frame::transport_rate(ellipsoid, height, p, middle);
    const Triple zeta = w_ie_dt + dt * w_en_;

    const Triple dv = push + cross(middle, w_ie_dt + zeta);
    dv_before_ = dv;
    started_ = true;
    x_.height.add(-dt * (v.z + T(0.5) * dv.z));
    if constexpr (kNarrow)
      x_.velocity.error = x_.velocity.error + Triple{left_out.x, left_out.y, left_out.z + gravity_.error};
    x_.velocity.add(dv);
    x_.q_en.add(product(q_en, Frame::small_turn(dt * w_en_)));  // a millionth of a turn: its length is kept by the sum

    // of long updates the second order too, for a force that is even in n; float would not see it. Here and anew: above
    // it costs registers
    if constexpr (!kNarrow) {
      if (long_) {
        const Triple again = rotate(q_nb.w, q_nb.v, kernel::triple(motion.velocity));
        x_.velocity.add(T(1.0 / 12.0) * cross(cross(again, zeta), zeta));
      }
    }
    const Quad step = product(q_nb, {motion.rotation_w, kernel::triple(motion.rotation_v)});
    const T stretch = T(0.5) - T(0.5) * dot(q_nb, q_nb);  // brings the length back to one
    Quad frame = Frame::small_turn(T(-1) * zeta);
    frame.w += stretch;
    x_.q_nb.add(step + product(frame, q_nb + step));
  }

  Algorithm algorithm_;
  std::array<Increment<T>, static_cast<std::size_t>(kSamples)> sample_;
  std::size_t count_ = 0;
  bool updated_ = false;
  T update_;                           // s
  T earth_turn_;                       // rad an update
  kernel::CompensatedSum<T> gravity_;  // gamma_e, m/s an update
  Frame x_;
  Triple w_en_{};  // of the last update
  Triple w_en_before_{};
  Triple dv_before_{};
  T zero_;  // NaN when the period is none: it then refuses every sample
  bool started_ = false;
  bool long_;
};

}  // namespace trunnion
