// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A first attitude from vectors seen in n and known in b, without a start.
///
///   C = [b_1 | (b_2 - b_1 cos a) / sin a | b_1 x b_2 / (L sin a)] / L                                    ... (1)
///     = [x_1 x_2 x_1 x x_2] [b_1 b_2 b_1 x b_2]^-1   for slaves anywhere                                 ... (2)
///   C_nb = argmin sum_k w_k |x_k - C b_k|^2 = U diag(1, 1, det U det V) V^T,   sum_k w_k x_k b_k^T = U S V^T  ... (3)
///
/// (1), of the paper, is orthonormal only without noise; (3) with C for the sum is the rotation nearest to it. (3)
/// knows one weight a vector: it starts most_likely_attitude(), which knows the covariance. Jwo, CMC 66 (2021), 2105,
/// eq. (6); Wahba, SIAM Rev. 7 (1965), 409; Markley, J. Astronaut. Sci. 36 (1988), 245.

#pragma once

#include <Eigen/LU>
#include <Eigen/SVD>

#include "trunnion/attitude/vector_observation.hpp"

namespace trunnion {

/// The rotation nearest to @p C, eq. (3). @return kNotObservable where C leaves an axis open
template <class T>
Result<Mat3<T>> nearest_rotation(const Mat3<T>& C) {
  if (!C.allFinite()) return Status::kOutOfRange;
  const Eigen::JacobiSVD<Mat3<T>> parts(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const T det = parts.matrixU().determinant() * parts.matrixV().determinant() > T(0) ? T(1) : T(-1);
  // the loss function's curvature about the axis that is known worst
  if (!(parts.singularValues()(1) + det * parts.singularValues()(2) >
        T(64) * std::numeric_limits<T>::epsilon() * parts.singularValues()(0)))
    return Status::kNotObservable;
  return Mat3<T>(parts.matrixU() * Vec3<T>(T(1), T(1), det).asDiagonal() * parts.matrixV().transpose());
}

/// Eq. (2): not orthonormal. @return kNotObservable for vectors in one line
template <class T>
Result<Mat3<T>> attitude_by_equation_six(const Vec3<T>& x_1, const Vec3<T>& x_2, const Eigen::Matrix<T, 3, 2>& b) {
  Mat3<T> seen;
  seen << x_1, x_2, x_1.cross(x_2);
  Mat3<T> body;
  body << b, Vec3<T>(b.col(0)).cross(Vec3<T>(b.col(1)));
  const T det = body.determinant();
  if (!(det > T(1e-6) * b.col(0).squaredNorm() * b.col(1).squaredNorm())) return Status::kNotObservable;
  return Mat3<T>(seen * body.inverse());
}

/// Eq. (3), each vector with the weight of its mean variance; for one vector, or several in one line, the attitude that
/// shows it and leaves the body's z as near to down as can be.
///
/// @return kOutOfRange for what is not finite; kNotObservable where too little was seen
template <class T, int M>
Result<Quaternion<T>> wahba(const VectorObservation<T, M>& seen, const RigidVectors<T, M>& vectors) {
  using std::abs;
  if (!vectors.valid() || !seen.value.allFinite() || !seen.information.allFinite()) return Status::kOutOfRange;
  Mat3<T> sum = Mat3<T>::Zero();
  for (int k = 0; k < M; ++k) {
    const T weight = seen.information.template block<3, 3>(3 * k, 3 * k).trace();
    sum += weight * seen.value.template segment<3>(3 * k) * vectors.b().col(k).transpose();
  }
  if (vectors.rank() < 3) {  // sum = x b^T
    const Eigen::JacobiSVD<Mat3<T>> parts(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (!(parts.singularValues()(0) > T(0))) return Status::kNotObservable;
    const Vec3<T> x = parts.matrixU().col(0);
    const Vec3<T> b = parts.matrixV().col(0);
    // a second vector: down, or where that is the first itself, north
    const Vec3<T> second_b = abs(b.z()) < T(0.9) ? Vec3<T>::UnitZ() : Vec3<T>::UnitX();
    const Vec3<T> second_x = abs(x.z()) < T(0.9999) && abs(b.z()) < T(0.9) ? Vec3<T>::UnitZ() : Vec3<T>::UnitX();
    sum = x * b.transpose() + x.cross(second_x).normalized() * b.cross(second_b).normalized().transpose();
  }
  const Result<Mat3<T>> C = nearest_rotation(sum);
  if (!C.ok()) return C.status();
  return Quaternion<T>(C.value());
}

/// The attitude of greatest likelihood without a start: wahba(), then most_likely_attitude().
template <class T, int M>
Result<AttitudeEstimate<T>> attitude_from_vectors(const VectorObservation<T, M>& seen,
                                                  const RigidVectors<T, M>& vectors) {
  const Result<Quaternion<T>> start = wahba(seen, vectors);
  if (!start.ok()) return start.status();
  return most_likely_attitude(start.value(), seen, vectors);
}

}  // namespace trunnion
