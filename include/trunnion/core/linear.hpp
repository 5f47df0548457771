// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Vectors and matrices of fixed size over any scalar: float, double, long double, an integer for storage, or an
/// automatic-differentiation number.

#pragma once

#include "trunnion/core/inline.hpp"

// Eigen's element access too: docs/how-to/link-it-into-your-firmware.md has the counts.
#if defined(__GNUC__) && defined(__OPTIMIZE_SIZE__) && !defined(EIGEN_STRONG_INLINE)
#define EIGEN_STRONG_INLINE TRUNNION_INLINE
#endif

#include <Eigen/Core>
#include <Eigen/LU>

namespace trunnion {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;

template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;

/// The matrix of the cross product: skew(a) * b == a x b.
template <class T>
Mat3<T> skew(const Vec3<T>& a) {
  Mat3<T> S;
  S << T(0), -a.z(), a.y(), a.z(), T(0), -a.x(), -a.y(), a.x(), T(0);
  return S;
}

/// A B and A P A^T by plain loops: of six rows and more, Eigen's products of fixed size are code by the kilobyte, and
/// minutes of compiling.
template <class T, int R, int K, int C>
Eigen::Matrix<T, R, C> product(const Eigen::Matrix<T, R, K>& A, const Eigen::Matrix<T, K, C>& B) {
  Eigen::Matrix<T, R, C> product_of;
  for (int c = 0; c < C; ++c) {
    for (int r = 0; r < R; ++r) {
      T sum = T(0);
      for (int k = 0; k < K; ++k) sum += A.coeff(r, k) * B.coeff(k, c);
      product_of.coeffRef(r, c) = sum;
    }
  }
  return product_of;
}

/// A P A^T of a symmetric P; exactly symmetric.
template <class T, int R, int K>
Eigen::Matrix<T, R, R> congruence(const Eigen::Matrix<T, R, K>& A, const Eigen::Matrix<T, K, K>& P) {
  const Eigen::Matrix<T, R, K> left = product(A, P);
  Eigen::Matrix<T, R, R> result;
  for (int c = 0; c < R; ++c) {
    for (int r = 0; r <= c; ++r) {
      T sum = T(0);
      for (int k = 0; k < K; ++k) sum += left.coeff(r, k) * A.coeff(c, k);
      result.coeffRef(r, c) = result.coeffRef(c, r) = sum;
    }
  }
  return result;
}

}  // namespace trunnion
