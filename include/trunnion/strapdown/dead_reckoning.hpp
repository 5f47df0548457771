// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a vehicle went, by one unit on the hub of a wheel that does not steer: no encoder, no calibration.
///
/// z of the unit lies along the axle, x and y turn with the wheel; yaw is clockwise, as headings count. With phi the
/// wheel's angle, w = phi', complex x + i y, s = +1 where z points to the vehicle's left and -1 where to its right, R
/// the rolling radius:
///
///   G = exp(-i phi) (roll rate + i s yaw rate) + b + delta w                                     ... (1)
///   A = exp(-i phi) (s R w' - i s g) + p (i w' - w^2) + a_0                                      ... (2)
///
/// b: gyro bias, delta: tilt of the unit against the axle, p: its place from the axle, a_0: accelerometer bias.
/// phi follows the axle gyro, w = (w_z - b_z)(1 + k), and is locked to gravity by (2): a loop of second order, whose
/// integral is k, so that the axle's scale error leaves the distance. p and a_0 come from what (2) leaves, b and delta
/// from (1) (modulation/slow_states.hpp); at rest b and b_z are simply read. Then
///
///   roll rate + i s yaw rate = exp(i phi) (G - b - delta w),   speed = s R phi'                  ... (3)
///
/// and the vehicle goes where it points (non-holonomic constraint). Without the centripetal term of (2) the phase
/// ripples once a turn, and ripple times bias is the drift that a plain demodulation has. The loop locks to the unit's
/// own accelerometers, so a delay common to both sensors does not matter. The radius is not observable from the wheel
/// alone: 1 % of it is 1 % of the distance. Collin, IEEE Trans. Veh. Technol. 64 (2015), 2242;
/// docs/theory/modulation.md.

#pragma once

#include <cmath>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/modulation/slow_states.hpp"

namespace trunnion {

enum class AxleSide : signed char { kLeft = 1, kRight = -1 };  ///< where z points

template <class T>
struct Wheel {
  T radius;             ///< rolling [m]
  AxleSide axle;        ///< s
  T axle_range = T(0);  ///< of the gyro about the axle [rad/s]; 0: unknown
  T gyro_noise;         ///< 1 sigma of a sample [rad/s]
};

enum class WheelState : unsigned char {
  kWaiting,    ///< for a second of rest: the gyros' biases are read there
  kRest,       ///< the wheel stands
  kRolling,    ///
  kSaturated,  ///< faster than the axle gyro can follow: the phase is not to be believed
};

template <class T>
class WheelDeadReckoning {
 public:
  /// @param heading at the start, clockwise from north [rad]; @param period of a sample [s]
  WheelDeadReckoning(const Wheel<T>& wheel, const T& heading, const T& period)
      : wheel_(wheel),
        side_(wheel.axle == AxleSide::kLeft ? T(1) : T(-1)),
        period_(period),
        heading_(heading),
        in_plane_({wheel.gyro_noise, T(0.3), T(1e-6), T(0.5), T(0.01), T(0.035), T(1e-6)}) {}

  /// A sample. @param mean over the period that ends now
  /// @return kOutOfRange, and nothing taken, when a value is not finite
  Status add(const InertialSample<T>& mean) {
    using std::isfinite;
    if (!isfinite(mean.w.sum()) || !isfinite(mean.f.sum())) return Status::kOutOfRange;
    speed_ = T(0);
    if (state_ == WheelState::kWaiting) {
      settle(mean);
      return Status::kOk;
    }
    const T w = mean.w.z() - axle_bias_;
    still_ = abs_of(w) < T(kRestRate) ? still_ + period_ : T(0);
    if (still_ > T(kRestTime)) {
      rest(mean, w);
      return Status::kOk;
    }
    const bool saturated = wheel_.axle_range > T(0) && abs_of(mean.w.z()) >= T(0.995) * wheel_.axle_range;
    state_ = saturated ? WheelState::kSaturated : WheelState::kRolling;
    roll(mean, w);
    return Status::kOk;
  }

  [[nodiscard]] WheelState state() const { return state_; }
  [[nodiscard]] const T& heading() const { return heading_; }    ///< clockwise from north, not wrapped [rad]
  [[nodiscard]] const T& north() const { return north_; }        ///< from the start [m]
  [[nodiscard]] const T& east() const { return east_; }          ///< from the start [m]
  [[nodiscard]] const T& distance() const { return distance_; }  ///< rolled, backwards too [m]
  [[nodiscard]] const T& speed() const { return speed_; }        ///< forwards [m/s]
  /// Integral of the roll rate [rad]: where it runs away, the accelerometers lag the gyros.
  [[nodiscard]] const T& roll() const { return roll_; }
  [[nodiscard]] const T& axle_bias() const { return axle_bias_; }    ///< rad/s
  [[nodiscard]] const T& axle_scale() const { return axle_scale_; }  ///< k
  [[nodiscard]] const SlowStates<T>& in_plane() const { return in_plane_; }
  [[nodiscard]] Eigen::Matrix<T, 2, 1> place() const { return {place_.x, place_.y}; }  ///< p [m]

 private:
  static constexpr double kRestRate = 0.1;      // rad/s: slower is at rest ...
  static constexpr double kRestForce = 2.0;     // m/s^2: gravity does not turn by more, and nobody shakes it
  static constexpr double kRestTime = 0.5;      // s, ... after so long
  static constexpr double kRestMemory = 5.0;    // s, of the biases read at rest
  static constexpr double kLearnRate = 1.0;     // rad/s: slower turning teaches nothing
  static constexpr double kLock = 1.0;          // 1/s
  static constexpr double kLockScale = 0.02;    // 1/(rad s), of k
  static constexpr double kLargestError = 0.5;  // rad: a bump is no phase
  static constexpr double kLowPass = 0.1;       // s, of w'
  static constexpr double kBump = 15.0;         // m/s^2: more is a bump
  static constexpr double kRoadNoise = 10.0;    // m/s^2, 1 sigma of what (2) leaves, correlated over a turn

  struct Complex {
    T x = T(0);
    T y = T(0);
    friend Complex operator+(const Complex& a, const Complex& b) { return {a.x + b.x, a.y + b.y}; }
    friend Complex operator-(const Complex& a, const Complex& b) { return {a.x - b.x, a.y - b.y}; }
    friend Complex operator*(const Complex& a, const Complex& b) {
      return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
    }
    friend Complex operator*(const T& k, const Complex& a) { return {k * a.x, k * a.y}; }
    [[nodiscard]] Complex conjugate() const { return {x, -y}; }
    [[nodiscard]] T squared() const { return x * x + y * y; }
  };

  static T abs_of(const T& v) { return v < T(0) ? -v : v; }
  static T clipped(const T& v, const T& limit) { return v > limit ? limit : v < -limit ? -limit : v; }
  static Complex unit(const T& angle) {
    using std::cos;
    using std::sin;
    return {T(cos(angle)), T(sin(angle))};
  }
  static T argument(const Complex& c) {
    using std::atan2;
    return atan2(c.y, c.x);
  }
  static Complex across(const Vec3<T>& v) { return {v.x(), v.y()}; }

  /// The first second of rest.
  void settle(const InertialSample<T>& mean) {
    // a wheel that rolls evenly has a steady rate too, but gravity goes round in it
    const bool moved = settled_ > T(0) && (abs_of(mean.w.z() - first_.w.z()) > T(kRestRate) ||
                                           (across(mean.f) - across(first_.f)).squared() > T(kRestForce * kRestForce));
    if (settled_ == T(0) || moved) {
      first_ = mean;
      settled_ = T(0);
      sum_ = InertialSample<T>{};
    }
    settled_ += period_;
    sum_.w += period_ * mean.w;
    sum_.f += period_ * mean.f;
    if (settled_ < T(1)) return;
    axle_bias_ = sum_.w.z() / settled_;
    in_plane_.read_bias({sum_.w.x() / settled_, sum_.w.y() / settled_}, wheel_.gyro_noise);
    phase_ = argument(Complex{T(0), -side_} * across(sum_.f).conjugate());
    state_ = WheelState::kRest;
    still_ = settled_;
  }

  void rest(const InertialSample<T>& mean, const T& w) {
    state_ = WheelState::kRest;
    const T share = period_ / T(kRestMemory);
    axle_bias_ += share * w;
    const auto& x = in_plane_.state();
    using Plane = typename SlowStates<T>::Plane;
    const Plane bias(x(SlowStates<T>::kBias), x(SlowStates<T>::kBias + 1));
    in_plane_.read_bias(bias + share * (mean.w.template head<2>() - bias), wheel_.gyro_noise);
    filtered_ = T(0);
    turned_tilt_ = Complex{};
    const Complex gravity = (across(mean.f) - bias_) * unit(phase_) * Complex{T(0), side_};
    lock(argument(gravity));
  }

  void lock(const T& error) {
    phase_ -= T(kLock) * period_ * clipped(error, T(kLargestError));
    phase_ = wrapped(phase_);
  }
  static T wrapped(const T& angle) {
    using std::floor;
    const T turn = T(2.0 * kPi);
    return angle - turn * floor(angle / turn + T(0.5));
  }

  void roll(const InertialSample<T>& mean, const T& w) {
    const T before = filtered_;
    filtered_ += period_ / T(kLowPass) * (w - filtered_);
    const T acceleration = (filtered_ - before) / period_;
    T turned = w * period_ * (T(1) + axle_scale_);
    phase_ += turned;
    // eq. (2): what the accelerometers should see, and the phase that they do
    const Complex h{-filtered_ * filtered_, acceleration};
    const Complex vehicle{side_ * wheel_.radius * acceleration, -side_ * T(kStandardGravity)};
    const Complex force = across(mean.f) - bias_ - place_ * h;
    const T error = clipped(argument(force * unit(phase_) * vehicle.conjugate()), T(kLargestError));
    lock(error);
    turned -= T(kLock) * period_ * error;
    const bool learn = abs_of(w) > T(kLearnRate) && state_ == WheelState::kRolling;
    if (learn) axle_scale_ -= T(kLockScale) * period_ * (w < T(0) ? -error : error);

    const Complex e = unit(phase_);
    const T k = sinc_correction(T(w * period_));
    const typename SlowStates<T>::Plane gyro(k * mean.w.x(), k * mean.w.y());
    const auto body = in_plane_.correct(gyro, e.y, e.x, w);
    T yaw = side_ * body.y() * period_;
    turned_tilt_ = turned_tilt_ + period_ * w * e;
    if (learn) {
      yaw -= side_ * learn_errors(gyro, e, w);
      learn_place(force - e.conjugate() * vehicle, h);
    }
    roll_ += body.x() * period_;
    const T way = side_ * wheel_.radius * turned;
    const Complex direction = unit(heading_ + yaw / T(2));
    heading_ += yaw;
    north_ += way * direction.x;
    east_ += way * direction.y;
    distance_ += abs_of(way);
    speed_ = way / period_;
  }

  /// b and delta. What delta was wrong by until now went into the heading as the integral of w exp(i phi) since the
  /// last rest: half a turn's worth, taken back as delta becomes known.
  /// @return what to take back, imaginary part [rad]
  T learn_errors(const typename SlowStates<T>::Plane& gyro, const Complex& e, const T& w) {
    using S = SlowStates<T>;
    const typename S::StateVector before = in_plane_.state();
    in_plane_.add(gyro, e.y, e.x, w, period_);
    const typename S::StateVector change = in_plane_.state() - before;
    const Complex delta{change(S::kDelta), change(S::kDelta + 1)};
    const Complex back = delta * turned_tilt_;

    roll_ -= back.x;
    return back.y;
  }

  /// Recursive least squares of p and a_0.
  void learn_place(const Complex& left, const Complex& h) {
    using std::sqrt;
    const T size = sqrt(left.squared());
    const Complex r = size > T(kBump) ? T(kBump) / size * left : left;
    const Complex to_place = place_variance_ * h.conjugate() + covariance_;
    const Complex to_bias = covariance_.conjugate() * h.conjugate() + Complex{bias_variance_, T(0)};
    const T innovation = (h * to_place + to_bias).x + T(kRoadNoise * kRoadNoise);
    const T gain = T(1) / innovation;
    place_ = place_ + gain * (to_place * r);
    bias_ = bias_ + gain * (to_bias * r);
    place_variance_ -= gain * to_place.squared();
    covariance_ = covariance_ - gain * (to_place * to_bias.conjugate());
    bias_variance_ -= gain * to_bias.squared();
  }

  Wheel<T> wheel_;
  T side_;
  T period_;
  WheelState state_ = WheelState::kWaiting;
  InertialSample<T> first_;
  InertialSample<T> sum_;
  T settled_ = T(0);
  T still_ = T(0);
  T phase_ = T(0);
  T axle_bias_ = T(0);
  T axle_scale_ = T(0);
  T filtered_ = T(0);
  Complex place_;                      // p
  Complex bias_;                       // a_0
  T place_variance_ = T(0.02 * 0.02);  // m^2
  T bias_variance_ = T(0.1 * 0.1);     // (m/s^2)^2
  Complex covariance_;
  T heading_;
  T roll_ = T(0);
  T north_ = T(0);
  T east_ = T(0);
  T distance_ = T(0);
  T speed_ = T(0);
  SlowStates<T> in_plane_;
  Complex turned_tilt_;  // integral of w exp(i phi) since the last rest
};

}  // namespace trunnion
