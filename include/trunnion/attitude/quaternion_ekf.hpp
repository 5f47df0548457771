// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The seven-state quaternion filter of the paper: what multiplicative_ekf.hpp is held against.
///
///   x = (q_1 ... q_4, p, q, r),   q' = 1/2 Omega(w) q = 1/2 Xi(q) w,   w' = -beta w + noise               ... (1)
///   q <- cos(|w| t / 2) q + sin(|w| t / 2) / |w| Omega q                                                 ... (2)
///   Q_qq = 1/4 Xi Xi^T q_w t^3/3,   Q_qw = 1/2 Xi q_w t^2/2,   Q_ww = q_w t I                            ... (3)
///   z = the computed quaternion,   H = [I_4 0],   R = r I_4                                              ... (4)
///
/// The computed quaternion is that of attitude_by_equation_six(). Its sign is that nearer to the prediction, and the
/// state is made a unit quaternion again after each step: without either it fails. R of full rank is wrong, four
/// numbers carry three errors, and P comes out optimistic. Jwo, CMC 66 (2021), 2105, sec. 3.

#pragma once

#include <Eigen/Cholesky>
#include <limits>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"

namespace trunnion {

template <class T>
class QuaternionEkf {
 public:
  using Vector = Eigen::Matrix<T, 7, 1>;
  using Square = Eigen::Matrix<T, 7, 7>;

  /// @param beta 0 for a random walk, 1/tau for Gauss-Markov [1/s]; @param walk sqrt(q_w) [rad/s/sqrt(s)]
  /// @param r variance of each element of the computed quaternion; @param rate_sigma at the start [rad/s]
  QuaternionEkf(const Quaternion<T>& start, const T& beta, const T& walk, const T& r, const T& rate_sigma)
      : beta_(beta), density_(walk * walk), r_(r) {
    const Quaternion<T> q = start.normalized();
    x_ << q.w(), q.x(), q.y(), q.z(), T(0), T(0), T(0);
    P_.diagonal() << r, r, r, r, rate_sigma * rate_sigma, rate_sigma * rate_sigma, rate_sigma * rate_sigma;
  }

  [[nodiscard]] Quaternion<T> q_nb() const { return Quaternion<T>(x_(0), x_(1), x_(2), x_(3)); }
  [[nodiscard]] Vec3<T> rate() const { return x_.template tail<3>(); }
  [[nodiscard]] const Square& covariance() const { return P_; }

  /// Eq. (2), (3). @return kOutOfRange, and nothing changed, for a time that is not finite or negative
  Status predict(const T& t) {
    using std::exp;
    if (!(t >= T(0) && t <= std::numeric_limits<T>::max())) return Status::kOutOfRange;
    const Eigen::Matrix<T, 4, 3> Xi = xi();
    const Vec3<T> w = rate();
    const T kept = exp(-beta_ * t);
    const Quaternion<T> turn = quaternion_exp<T>(w * t);
    Square Phi = Square::Identity();
    Phi.template topLeftCorner<4, 4>() << turn.w(), -turn.x(), -turn.y(), -turn.z(),  //
        turn.x(), turn.w(), turn.z(), -turn.y(),                                      //
        turn.y(), -turn.z(), turn.w(), turn.x(),                                      //
        turn.z(), turn.y(), -turn.x(), turn.w();
    Phi.template topRightCorner<4, 3>() = T(0.5) * t * Xi;
    Phi.template bottomRightCorner<3, 3>() *= kept;
    P_ = (Phi * P_ * Phi.transpose()).eval();
    P_.template topLeftCorner<4, 4>() += T(0.25) * density_ * t * t * t / T(3) * Xi * Xi.transpose();
    const Eigen::Matrix<T, 4, 3> cross = T(0.25) * density_ * t * t * Xi;
    P_.template topRightCorner<4, 3>() += cross;
    P_.template bottomLeftCorner<3, 4>() += cross.transpose();
    P_.template bottomRightCorner<3, 3>().diagonal().array() += density_ * t;
    x_.template head<4>() = (Phi.template topLeftCorner<4, 4>() * x_.template head<4>()).eval().normalized();
    x_.template tail<3>() *= kept;
    return Status::kOk;
  }

  /// Eq. (4), Joseph's form. @param computed of either sign. @return kOutOfRange for what is not finite
  Status update(const Quaternion<T>& computed) {
    Eigen::Matrix<T, 4, 1> z(computed.w(), computed.x(), computed.y(), computed.z());
    if (!z.allFinite()) return Status::kOutOfRange;
    if (z.dot(x_.template head<4>()) < T(0)) z = -z;
    const Eigen::Matrix<T, 4, 4> S = P_.template topLeftCorner<4, 4>() + r_ * Eigen::Matrix<T, 4, 4>::Identity();
    const Eigen::Matrix<T, 7, 4> K = S.ldlt().solve(P_.template topRows<4>()).transpose();
    Square rest = Square::Identity();
    rest.template leftCols<4>() -= K;
    x_ += (K * (z - x_.template head<4>())).eval();
    P_ = (rest * P_ * rest.transpose() + r_ * K * K.transpose()).eval();
    x_.template head<4>().normalize();
    return Status::kOk;
  }

 private:
  [[nodiscard]] Eigen::Matrix<T, 4, 3> xi() const {
    Eigen::Matrix<T, 4, 3> Xi;
    Xi << -x_(1), -x_(2), -x_(3),  //
        x_(0), -x_(3), x_(2),      //
        x_(3), x_(0), -x_(1),      //
        -x_(2), x_(1), x_(0);
    return Xi;
  }

  T beta_;
  T density_;
  T r_;
  Vector x_;
  Square P_ = Square::Zero();
};

}  // namespace trunnion
