// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Vectors that are fixed in the body and seen in n: what was seen, how surely, and what attitudes it allows.
///
///   x_k = C_nb (b_k + d_k) + v_k,   k = 1 ... M,   v ~ (0, N^-1)                                         ... (1)
///   C_nb = C_hat Exp(phi):   x_k - C_hat b_k = -C_hat [b_k x] phi + ...                                  ... (2)
///   d ~ (0, s^2 P),   P = I - J J^+,   J = -[b_k x]: what no rotation of the b_k reaches                 ... (3)
///   N' = (N^-1 + s^2 P')^-1 = N - N P' (I / s^2 + P' N P')^-1 P' N,   P' = (I x C) P (I x C)^T             ... (4)
///
/// N is the information, the inverse of the covariance: where the x_k are not all to be had, it is singular and (4)
/// still holds. d is what the figure of the vectors may be other than stated: a length, the angle between two. Its
/// part that turns the whole figure is no error but the definition of b. For one vector P is along it: a length
/// that is an observation of sigma s, and s = 0 a length that is certain.

#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"

namespace trunnion {

/// The x_k, one after the other, and N.
template <class T, int M>
struct VectorObservation {
  Eigen::Matrix<T, 3 * M, 1> value = Eigen::Matrix<T, 3 * M, 1>::Zero();                ///< n [m]
  Eigen::Matrix<T, 3 * M, 3 * M> information = Eigen::Matrix<T, 3 * M, 3 * M>::Zero();  ///< 1/m^2
  int rank = 3 * M;                                                                     ///< of the information
};

/// The b_k and s.
template <class T, int M>
class RigidVectors {
 public:
  using Stack = Eigen::Matrix<T, 3 * M, 1>;
  using Square = Eigen::Matrix<T, 3 * M, 3 * M>;

  /// @param b the vectors, as columns [m], finite and none of them zero; @param sigma s [m], zero or more
  explicit RigidVectors(const Eigen::Matrix<T, 3, M>& b, const T& sigma = T(0)) : b_(b), sigma_(sigma) {
    const Eigen::Matrix<T, 3 * M, 3> J = turned_by(Mat3<T>::Identity());
    const Eigen::SelfAdjointEigenSolver<Mat3<T>> parts(J.transpose() * J);
    Mat3<T> inverse = Mat3<T>::Zero();
    for (int i = 0; i < 3; ++i) {
      const T value = parts.eigenvalues()(i);
      if (!(value > T(1e-4) * parts.eigenvalues()(2))) continue;
      inverse += parts.eigenvectors().col(i) * parts.eigenvectors().col(i).transpose() / value;
      ++rank_;
    }
    P_ = Square::Identity() - congruence(J, inverse);
  }

  [[nodiscard]] bool valid() const {
    return b_.allFinite() && b_.colwise().squaredNorm().minCoeff() > T(0) && sigma_ >= T(0) &&
           sigma_ <= std::numeric_limits<T>::max();
  }
  [[nodiscard]] const Eigen::Matrix<T, 3, M>& b() const { return b_; }
  [[nodiscard]] const T& sigma() const { return sigma_; }
  /// How many rotations the vectors show: 3, and 2 where they lie in one line.
  [[nodiscard]] int rank() const { return rank_; }

  /// C b_k, one after the other.
  [[nodiscard]] Stack seen_from(const Mat3<T>& C_nb) const {
    Stack x;
    for (int k = 0; k < M; ++k) x.template segment<3>(3 * k) = C_nb * b_.col(k);
    return x;
  }
  /// Derivative of C b_k with respect to phi, eq. (2).
  [[nodiscard]] Eigen::Matrix<T, 3 * M, 3> turned_by(const Mat3<T>& C_nb) const {
    Eigen::Matrix<T, 3 * M, 3> H;
    for (int k = 0; k < M; ++k) H.template middleRows<3>(3 * k) = -C_nb * skew<T>(b_.col(k));
    return H;
  }
  /// Eq. (4), turned back to n: the information about C b_k that is left when the d_k are not known.
  [[nodiscard]] Square loosened(const Square& N, const Mat3<T>& C_nb) const {
    if (!(sigma_ > T(0))) return N;
    Square turn = Square::Zero();
    for (int k = 0; k < M; ++k) turn.template block<3, 3>(3 * k, 3 * k) = C_nb;
    const Square P = congruence(turn, P_);
    const Square across = product(N, P);
    const Square inner = Square::Identity() / (sigma_ * sigma_) + product(P, across);
    return N - product(across, Square(inner.partialPivLu().solve(across.transpose())));
  }

 private:
  Eigen::Matrix<T, 3, M> b_;
  T sigma_;
  Square P_;
  int rank_ = 0;
};

/// An attitude and what is known of it.
template <class T>
struct AttitudeEstimate {
  Quaternion<T> q_nb = Quaternion<T>::Identity();
  Mat3<T> information = Mat3<T>::Zero();  ///< of phi, eq. (2) [1/rad^2]; singular where an axis is not observable
  Mat3<T> covariance = Mat3<T>::Zero();   ///< of phi [rad^2], over the observable axes
  int observable = 0;                     ///< axes, of 3
  Vec3<T> free_axis = Vec3<T>::Zero();    ///< in b, where observable is 2: about it, q_nb is arbitrary
  T cost = T(0);                          ///< of the vectors, chi-square with their rank less `observable`
};

namespace kernel {

/// Covariance, observable axes and the free one from the information of vectors that show @p rank axes.
template <class T>
void describe(int rank, AttitudeEstimate<T>& estimate) {
  const Eigen::SelfAdjointEigenSolver<Mat3<T>> parts(estimate.information);
  const T least = T(1e-6) * parts.eigenvalues()(2);
  estimate.observable = 0;
  estimate.covariance.setZero();
  estimate.free_axis.setZero();
  for (int i = 0; i < 3; ++i) {
    const Vec3<T> axis = parts.eigenvectors().col(i);
    if (i >= 3 - rank && parts.eigenvalues()(i) > least && parts.eigenvalues()(i) > T(0)) {
      ++estimate.observable;
      estimate.covariance += axis * axis.transpose() / parts.eigenvalues()(i);
    } else {
      estimate.free_axis = axis;
    }
  }
  if (estimate.observable != 2) estimate.free_axis.setZero();
}

}  // namespace kernel

/// The attitude of greatest likelihood: Gauss-Newton on SO(3) over (2), with the whole covariance. About an axis that
/// the vectors do not show it stays as @p start has it.
///
/// @return kNotObservable when fewer than two axes show; kOutOfRange for what is not finite; kInconsistent when it does
/// not settle: the start was too far off, or the x_k have not the figure of the b_k
template <class T, int M>
Result<AttitudeEstimate<T>> most_likely_attitude(const Quaternion<T>& start, const VectorObservation<T, M>& seen,
                                                 const RigidVectors<T, M>& vectors) {
  constexpr int kMostSteps = 20;
  if (!vectors.valid() || !seen.value.allFinite() || !seen.information.allFinite() || !start.coeffs().allFinite())
    return Status::kOutOfRange;
  AttitudeEstimate<T> estimate;
  estimate.q_nb = start.normalized();
  const T small = T(16) * std::numeric_limits<T>::epsilon();
  for (int step = 0; step < kMostSteps; ++step) {
    const Mat3<T> C = estimate.q_nb.toRotationMatrix();
    const Eigen::Matrix<T, 3 * M, 1> r = seen.value - vectors.seen_from(C);
    const Eigen::Matrix<T, 3 * M, 3 * M> N = vectors.loosened(seen.information, C);
    const Eigen::Matrix<T, 3 * M, 3> H = vectors.turned_by(C);
    const Eigen::Matrix<T, 3 * M, 1> Nr = N * r;
    estimate.information = congruence<T>(Eigen::Matrix<T, 3, 3 * M>(H.transpose()), N);
    estimate.cost = r.dot(Nr);
    kernel::describe(vectors.rank(), estimate);
    if (estimate.observable < 2) return Status::kNotObservable;
    const Vec3<T> phi = estimate.covariance * (H.transpose() * Nr);
    const T length = phi.norm();
    estimate.q_nb = (estimate.q_nb * quaternion_exp(phi)).normalized();
    // settled to a thousandth of a sigma, or to the last digits
    if (length < small || phi.dot(estimate.information * phi) < T(1e-6)) return estimate;
  }
  return Status::kInconsistent;
}

}  // namespace trunnion
