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

}  // namespace trunnion
