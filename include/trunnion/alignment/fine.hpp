// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fine alignment: a navigator whose errors a Kalman filter takes out, because a point of the base is known to stand
/// still, or to move at a velocity that somebody else measures.
///
///   z = v - v_0 - C_nb (w_nb_b x l) = dv + phi x V + C_nb (l x b_g) + noise,   V = C_nb (w_nb_b x l)   ... (1)
///
/// v_0: of the point, none unless told; l: from it to the unit [b]; states and dynamics: strapdown/error_dynamics.hpp.
/// What is found goes into the navigator at once, the biases into its inputs. Innovations that stay beyond their sigmas
/// are a base that moves.
///
/// On a base that does not turn, the level gyro bias across north and the heading are one (sigma of b_E / (W cos L)),
/// and so are tilt and accelerometer bias: the covariance says so. On a platform that turns, feed the *unit's*
/// increments and the filter sees its biases go round against gravity and the Earth's rate: rotation-modulated
/// self-alignment is this same filter. The body's attitude is then q_nb of the unit times the platform's angle back.
/// Groves, 2nd ed., sec. 15.2; Titterton & Weston, 2nd ed., sec. 10.4; docs/theory/alignment.md.

#pragma once

#include "trunnion/alignment/coarse.hpp"
#include "trunnion/strapdown/error_dynamics.hpp"

namespace trunnion {

template <class T>
struct FineAlignmentNoise {
  T gyro;              ///< white [rad/s/sqrt(Hz)]
  T accel;             ///< white [m/s^2/sqrt(Hz)]
  T gyro_bias_walk;    ///< rad/s/sqrt(s)
  T accel_bias_walk;   ///< m/s^2/sqrt(s)
  T velocity;          ///< 1 sigma of how the point at rest shakes [m/s], from one update to the next
  T first_tilt;        ///< 1 sigma at the start [rad]
  T first_heading;     ///< rad
  T first_velocity;    ///< m/s
  T first_gyro_bias;   ///< rad/s
  T first_accel_bias;  ///< m/s^2
};

/// @tparam Algorithm as of Navigator
template <class Algorithm>
class FineAlignment {
 public:
  using T = typename Algorithm::Scalar;

  /// @param start position and first attitude; @param period of a sample [s]; @param samples between two updates, a
  /// multiple of the algorithm's; @param lever_arm l [m]
  FineAlignment(const NavigationState<T>& start, const T& period, int samples, const Vec3<T>& lever_arm,
                const FineAlignmentNoise<T>& noise)
      : navigator_(start, period), period_(period), samples_(samples), lever_arm_(lever_arm), noise_(noise) {
    Eigen::Matrix<T, 15, 1> first;
    first << noise.first_tilt, noise.first_tilt, noise.first_heading, noise.first_velocity, noise.first_velocity,
        noise.first_velocity, T(0), T(0), T(0), noise.first_gyro_bias, noise.first_gyro_bias, noise.first_gyro_bias,
        noise.first_accel_bias, noise.first_accel_bias, noise.first_accel_bias;
    P_ = first.cwiseAbs2().asDiagonal();
  }

  /// The point of the base moves: alignment in motion. @param velocity of it at the next samples [m/s, NED]
  void move(const Vec3<T>& velocity) { base_velocity_ = velocity; }

  /// Takes the next sample. @return kOutOfRange, and nothing changed, for one that is not finite or turns by more than
  /// a radian; kMovingBase from the first time on that the base moves:
  /// what was found since is not to be believed
  Status add(const Increment<T>& sample) {
    Increment<T> corrected = sample;
    corrected.angle -= period_ * gyro_bias_;
    corrected.velocity -= period_ * accel_bias_;
    const Status status = navigator_.add(corrected);
    if (status != Status::kOk) return status;
    sum_.angle += corrected.angle;
    sum_.velocity += corrected.velocity;
    // a mean belongs to the middle of its sample: on to its end
    end_rate_ = (T(1.5) * corrected.angle - T(0.5) * last_angle_) / period_;
    last_angle_ = corrected.angle;
    if (++count_ == samples_) {
      count_ = 0;
      update();
      sum_ = Increment<T>{};
    }
    return moved_ ? Status::kMovingBase : Status::kOk;
  }

  /// Attitude and its covariance. @return kMovingBase once the base has moved
  [[nodiscard]] Result<Alignment<T>> result() const {
    if (moved_) return Status::kMovingBase;
    Alignment<T> alignment;
    alignment.q_nb = navigator_.state().attitude;
    alignment.covariance = P_.template topLeftCorner<3, 3>();
    return alignment;
  }

  [[nodiscard]] const Navigator<Algorithm>& navigator() const { return navigator_; }
  [[nodiscard]] const Vec3<T>& gyro_bias() const { return gyro_bias_; }    ///< rad/s
  [[nodiscard]] const Vec3<T>& accel_bias() const { return accel_bias_; }  ///< m/s^2
  [[nodiscard]] const ErrorMatrix<T>& covariance() const { return P_; }
  /// Velocity against what a base at rest explains, in sigmas: mean square that forgets over 32 updates (as one of 63:
  /// 189 degrees of freedom), 1 if all is well.
  [[nodiscard]] const T& strangeness() const { return strangeness_; }
  /// The last of these velocities [m/s], north-east-down.
  [[nodiscard]] const Vec3<T>& innovation() const { return innovation_; }

 private:
  static constexpr double kStrange = 2.3;  // by chance: 13 sigmas of the mean that strangeness() is

  void update() {
    using std::cos;
    using std::sin;
    const T dt = T(samples_) * period_;
    const NavigationState<T> state = navigator_.state();
    const Mat3<T> C_nb = state.attitude.toRotationMatrix();
    // the dynamics are those of the middle of the interval
    NavigationState<T> middle = state;
    middle.attitude = state.attitude * quaternion_exp<T>(T(-0.5) * sum_.angle);
    const ErrorMatrix<T> F = error_dynamics<T>(middle, middle.attitude * (sum_.velocity / dt));
    Eigen::Matrix<T, 15, 1> density;
    density << Vec3<T>::Constant(noise_.gyro * noise_.gyro), Vec3<T>::Constant(noise_.accel * noise_.accel),
        Vec3<T>::Zero(), Vec3<T>::Constant(noise_.gyro_bias_walk * noise_.gyro_bias_walk),
        Vec3<T>::Constant(noise_.accel_bias_walk * noise_.accel_bias_walk);
    P_ = propagate_covariance<T>(P_, F, density, dt);

    const Vec3<T> w_ie(T(kEarthRate) * cos(state.latitude), T(0), T(-kEarthRate) * sin(state.latitude));
    const Vec3<T> w_nb = end_rate_ - C_nb.transpose() * w_ie;
    const Vec3<T> swing = C_nb * w_nb.cross(lever_arm_);
    Eigen::Matrix<T, 3, 15> H = Eigen::Matrix<T, 3, 15>::Zero();
    H.template block<3, 3>(0, kPhi) = -skew<T>(swing);
    H.template block<3, 3>(0, kVelocityError).setIdentity();
    H.template block<3, 3>(0, kGyroBias) = C_nb * skew<T>(lever_arm_);
    innovation_ = state.velocity - base_velocity_ - swing;
    const Eigen::Matrix<T, 15, 3> cross_covariance = P_ * H.transpose();
    Mat3<T> S = H * cross_covariance;
    S.diagonal().array() += noise_.velocity * noise_.velocity;
    const Mat3<T> S_inverse = S.inverse();
    strangeness_ += (innovation_.dot(S_inverse * innovation_) / T(3) - strangeness_) / T(32);
    moved_ = moved_ || strangeness_ > T(kStrange);
    const Eigen::Matrix<T, 15, 3> K = cross_covariance * S_inverse;
    const Eigen::Matrix<T, 15, 1> found = K * innovation_;
    const ErrorMatrix<T> left = ErrorMatrix<T>::Identity() - K * H;  // Joseph's form
    P_ = left * P_ * left.transpose() + noise_.velocity * noise_.velocity * K * K.transpose();
    navigator_.correct(found.template segment<3>(kPhi), found.template segment<3>(kVelocityError));
    gyro_bias_ += found.template segment<3>(kGyroBias);
    accel_bias_ += found.template segment<3>(kAccelBias);
  }

  Navigator<Algorithm> navigator_;
  T period_;
  int samples_;
  Vec3<T> lever_arm_;
  FineAlignmentNoise<T> noise_;
  ErrorMatrix<T> P_;
  Vec3<T> gyro_bias_ = Vec3<T>::Zero();
  Vec3<T> accel_bias_ = Vec3<T>::Zero();
  Increment<T> sum_;
  Vec3<T> last_angle_ = Vec3<T>::Zero();
  Vec3<T> end_rate_ = Vec3<T>::Zero();
  Vec3<T> base_velocity_ = Vec3<T>::Zero();
  Vec3<T> innovation_ = Vec3<T>::Zero();
  T strangeness_ = T(1);
  int count_ = 0;
  bool moved_ = false;
};

}  // namespace trunnion
