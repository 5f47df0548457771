// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Strapdown navigation for a microcontroller: body motion and attitude at the rate of the samples, the Earth at a
/// slow one.
///
/// Fast, every two samples of which the second ends it (T: the time of both): coning and sculling of MultiSample<2>,
/// with n held still in inertial space since the last slow step,
///
///   phi = theta_1 + theta_2 + 2/3 theta_1 x theta_2,   q_nb <- q_nb dq(phi)                             ... (1)
///   u <- u + C_nb dv,   s <- s + T (u - C_nb dv / 2)                                                    ... (2)
///
/// so that u is the integral of the specific force and s that of u. Slow, after a time D of at most a second or so:
///
///   v_mean = v + s/D + g D/2 + half of (4)'s first product + a third of its second                      ... (3)
///   v <- v + u + g D + v_mean x (2 w_ie + w_en) D + (u - s/D) x (w_ie + w_en) D                         ... (4)
///   q_nb <- Exp(-(w_ie + w_en) D) q_nb,  q_en <- q_en Exp(w_en D),  h <- h - D (v_mean)_z               ... (5)
///
/// with w_ie and w_en in the middle of D, g at its start. What (4) leaves out is of second order in D; no trigonometric
/// function but at the border, and no branch that depends on a sample but the refusals. Savage, J. Guidance 21 (1998),
/// 19 and 208 (two-speed integration); docs/theory/strapdown.md, section 3. Navigator is the finer one.

#pragma once

#include <limits>

#include "trunnion/core/status.hpp"
#include "trunnion/strapdown/body_motion.hpp"
#include "trunnion/strapdown/wander_azimuth.hpp"

namespace trunnion {

template <class T>
class TwoSpeedNavigator {
 public:
  /// @param start a NavigationState in any scalar: what T cannot hold of a double position is kept beside it; or a
  /// WanderState<T>
  /// @param period of one sample [s], positive
  /// @param updates between slow steps, of two samples each: 0.1 s or so, at most a second
  template <class Start>
  TwoSpeedNavigator(const Start& start, const T& period, int updates)
      : update_(T(2) * period),
        updates_(static_cast<std::int16_t>(updates < 1       ? 1
                                           : updates > 10000 ? 10000
                                                             : updates)),
        push_(update_ > T(0) ? T(kPush) + (update_ - update_) : std::numeric_limits<T>::quiet_NaN()),
        x_(start) {
    if (T(updates_) * update_ > T(1))
      updates_ = update_ < T(1) ? static_cast<std::int16_t>(T(1) / update_) : std::int16_t{1};
  }

  /// Takes the next sample; every second one completes an update, and updated() is true.
  /// @return as of the other one
  Status add(const Increment<T>& sample) {
    next() = sample;
    return take();
  }

  /// Where the next sample is to be written, so that it need not be copied: then call take().
  [[nodiscard]] Increment<T>& next() { return updated_ ? first_ : second_; }
  /// Takes what was written to next(). @return as of the other ones
  Status take() {
    updated_ = !updated_;
    return updated_ ? add(first_, second_) : Status::kOk;
  }

  /// Takes both samples of an update.
  /// @return kOutOfRange, and neither has gone in, for a sample that is not finite, two that turn by more than half a
  /// radian or push by more than 100 m/s, and every one when the period is not positive; kOutOfRange, ten times a
  /// second, when the velocity has passed 100 km/s or is not a number: the state is none
  TRUNNION_INLINE Status add(const Increment<T>& first, const Increment<T>& second) {
    using namespace kernel;
    const Triple theta = triple(second.angle);
    const Triple v = triple(second.velocity);
    const Triple theta_first = triple(first.angle);
    const Triple v_first = triple(first.velocity);
    const Triple theta_k = T(2.0 / 3.0) * theta_first;
    const Triple v_k = T(2.0 / 3.0) * v_first;
    const Triple phi = add_cross(theta_first + theta, theta_k, theta);
    const T phi2 = dot(phi, phi);
    const Triple sum = v_first + v;
    const Triple dv = add_cross(add_cross(sum, theta_k, v), v_k, theta);
    // one comparison for all: NaN and infinity fail it, and so do 100 m/s
    if (!(phi2 + push_ * dot(dv, dv) <= T(0.25))) return Status::kOutOfRange;
    const auto factor = RotationFactors<T>::short_series(phi2);
    const Triple turned = cross(phi, sum);
    const Triple push = add_scaled(add_scaled(dv, factor.first, turned), factor.second, cross(phi, turned));

    const Triple force = rotate(x_.q_nb.sum.w, x_.q_nb.sum.v, push);
    assign(u_, u_ + force);
    assign(sum_u_, sum_u_ + u_);
    x_.q_nb.add(product(x_.q_nb.sum, Quad{factor.w, factor.v * phi}));
    return ++count_ < updates_ ? Status::kOk : slow_step();
  }

  /// Whether the last add() of one sample completed an update.
  [[nodiscard]] bool updated() const { return updated_; }

  /// q_nb now, n as it stood at the last slow step: less than 2e-5 rad of the Earth's turning behind.
  [[nodiscard]] Quaternion<T> attitude() const { return kernel::quaternion(x_.q_nb.sum); }
  /// Velocity now in n [m/s], but for the slow step's small terms.
  [[nodiscard]] Vec3<T> velocity() const {
    kernel::Triple<T> v = x_.velocity.sum + u_;
    v.z = v.z + T(kEquatorGravity) * (T(count_) * update_);
    return kernel::vector(v);
  }

  /// The state after the last slow step but for the attitude, which is now's; without a trigonometric function.
  [[nodiscard]] WanderState<T> wander_state() const { return x_.wander_state(); }

  /// The state after the last update, as if a slow step ended now; U wider than T shows all digits.
  template <class U = T>
  [[nodiscard]] NavigationState<U> state() const {
    TwoSpeedNavigator now = *this;
    if (now.count_ > 0) (void)now.slow_step();
    return now.x_.template state<U>();
  }

  /// Takes errors out that a filter has found, as Navigator::correct().
  void correct(const Vec3<T>& phi, const Vec3<T>& dv) {
    if (count_ > 0) (void)slow_step();
    x_.correct(phi, dv);
  }

 private:
  using Triple = kernel::Triple<T>;
  using Quad = kernel::Quad<T>;
  using Frame = kernel::WanderAzimuth<T>;

  /// Eq. (3)-(5). @return kOutOfRange when the velocity is none
  TRUNNION_COLD Status slow_step() {
    using namespace kernel;
    const T D = T(count_) * update_;
    const T half = T(0.5) * D;
    const Triple v = x_.velocity.sum;
    const Triple p_start = Frame::earth_axis(x_.q_en.sum);
    const Ellipsoid<T> ellipsoid(p_start.z * p_start.z);
    const Triple mean_u = (T(1) / T(count_)) * add_scaled(sum_u_, T(-0.5), u_);  // s / D
    const Triple late = u_ - mean_u;
    const T fall = T(kEquatorGravity) * D;
    Triple start = v + mean_u;
    start.z = start.z + T(0.5) * fall;
    const T height = x_.height.sum - half * start.z;
    const T excess = D * ellipsoid.gravity_excess(height);
    start.z = start.z + T(0.5) * excess;
    // the mean velocity and the rate of n depend on each other, weakly: twice is as good as for ever
    Triple mean = start;
    Triple turned, w_ie_D;
    for (int pass = 0; pass < 2; ++pass) {
      w_ie_D = (T(kEarthRate) * D) * add_cross(p_start, half * p_start, w_en_);
      const Triple zeta_before = w_ie_D + D * w_en_;
      const Triple coriolis = cross(mean, w_ie_D + zeta_before);
      const Triple moved_on = cross(late, zeta_before);  // n turns under u
      turned = coriolis + moved_on;
      mean = add_scaled(add_scaled(start, T(0.5), coriolis), T(1.0 / 3.0), moved_on);
      w_en_ = Frame::transport_rate(ellipsoid, height, p_start, mean);
    }
    const Triple zeta = w_ie_D + D * w_en_;

    Triple dv = u_;
    dv.z = (dv.z + fall) + excess;
    dv = dv + turned;
    add_seldom<T>(x_.velocity, dv);
    // what T leaves out of gravity: it would never average
    x_.velocity.error.z =
        x_.velocity.error.z - T(kEquatorGravity - static_cast<double>(static_cast<T>(kEquatorGravity))) * D;
    x_.height.add(-D * mean.z);
    turn(x_.q_en, D * w_en_, false);
    turn(x_.q_nb, T(-1) * zeta, true);
    u_ = sum_u_ = Triple{T(0), T(0), T(0)};
    count_ = 0;
    return dot(x_.velocity.sum, x_.velocity.sum) <= T(1e10) ? Status::kOk : Status::kOutOfRange;
  }

  /// Exp(phi) q or q Exp(phi) of a small phi, and the length of q brought back to one.
  TRUNNION_COLD static void turn(kernel::CompensatedSum<Quad>& q, const Triple& phi, bool from_left) {
    Quad step = Frame::small_turn(phi);
    step.w = step.w + (T(0.5) - T(0.5) * dot(q.sum, q.sum));
    // a product's factors change places where its cross product changes sign
    const Quad turned = product(q.sum, step);
    const Triple twice = T(from_left ? 2 : 0) * cross(step.v, q.sum.v);
    kernel::add_seldom<T>(q, Quad{turned.w, turned.v + twice});
  }

  static constexpr double kPush = 0.25 / (100.0 * 100.0);

  T update_;  // s
  std::int16_t updates_;
  std::int16_t count_ = 0;
  bool updated_ = true;
  T push_;          // takes 100 m/s for half a radian; NaN when the period is none: it then refuses every update
  Triple u_{};      // since the last slow step, eq. (2)
  Triple sum_u_{};  // of u after each update: s is update_ times this, less half of the last u
  Triple w_en_{};   // in the middle of the last slow step
  Frame x_;
  Increment<T> first_;
  Increment<T> second_;
};

}  // namespace trunnion
