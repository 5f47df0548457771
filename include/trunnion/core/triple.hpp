// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Three numbers, a matrix and a quaternion of them, that stay in registers.
///
/// The kernels that run once a sample, error_model/inertial_unit.hpp and strapdown/, compute with these; everything
/// else, and every interface, is Eigen. Eigen's expressions cost a kernel twice its instructions at -O2 and five times
/// at -Os: docs/decisions/2026-11-22-scalars-in-the-strapdown-kernel.md. The order of operations is fixed by the
/// source: with contraction off, the bits are the same on every machine.

#pragma once

#if defined(__FAST_MATH__) && !defined(TRUNNION_ALLOW_FAST_MATH)
#error "trunnion looks for NaN and compensates its sums: compile what includes it without -ffast-math"
#endif

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "trunnion/core/linear.hpp"

namespace trunnion::kernel {

template <class T>
struct Triple {
  T x, y, z;

  TRUNNION_INLINE friend Triple operator+(const Triple& a, const Triple& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  TRUNNION_INLINE friend Triple operator-(const Triple& a, const Triple& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  TRUNNION_INLINE friend Triple operator*(const T& k, const Triple& a) { return {k * a.x, k * a.y, k * a.z}; }
};

template <class T>
TRUNNION_INLINE T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
TRUNNION_INLINE Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
TRUNNION_INLINE Triple<T> triple(const Vec3<T>& v) {
  return {v.coeff(0), v.coeff(1), v.coeff(2)};
}

template <class T>
TRUNNION_INLINE Vec3<T> vector(const Triple<T>& a) {
  return Vec3<T>(a.x, a.y, a.z);
}

/// Whether no component is NaN or infinite, in one comparison.
template <class T>
TRUNNION_INLINE bool is_finite(const Triple<T>& a) {
  const T sum = a.x + a.y + a.z;
  return sum - sum == T(0);
}

/// Three rows.
template <class T>
struct Matrix {
  Triple<T> x, y, z;

  TRUNNION_INLINE friend Triple<T> operator*(const Matrix& A, const Triple<T>& b) {
    return {dot(A.x, b), dot(A.y, b), dot(A.z, b)};
  }
};

template <class T>
Matrix<T> matrix(const Mat3<T>& A) {
  return {triple<T>(A.row(0)), triple<T>(A.row(1)), triple<T>(A.row(2))};
}

/// Quaternion, or a step of one: Hamilton, scalar and vector part.
template <class T>
struct Quad {
  T w;
  Triple<T> v;

  TRUNNION_INLINE friend Quad operator+(const Quad& a, const Quad& b) { return {a.w + b.w, a.v + b.v}; }
  TRUNNION_INLINE friend Quad operator-(const Quad& a, const Quad& b) { return {a.w - b.w, a.v - b.v}; }
  TRUNNION_INLINE friend Quad operator*(const T& k, const Quad& a) { return {k * a.w, k * a.v}; }
};

template <class T>
TRUNNION_INLINE Quad<T> quad(const Eigen::Quaternion<T>& q) {
  return {q.w(), {q.x(), q.y(), q.z()}};
}

template <class T>
TRUNNION_INLINE Eigen::Quaternion<T> quaternion(const Quad<T>& q) {
  return Eigen::Quaternion<T>(q.w, q.v.x, q.v.y, q.v.z);
}

template <class T>
TRUNNION_INLINE T dot(const Quad<T>& a, const Quad<T>& b) {
  return a.w * b.w + dot(a.v, b.v);
}

template <class T>
TRUNNION_INLINE Quad<T> product(const Quad<T>& a, const Quad<T>& b) {
  return {a.w * b.w - a.v.x * b.v.x - a.v.y * b.v.y - a.v.z * b.v.z,
          {a.w * b.v.x + b.w * a.v.x + a.v.y * b.v.z - a.v.z * b.v.y,
           a.w * b.v.y + b.w * a.v.y + a.v.z * b.v.x - a.v.x * b.v.z,
           a.w * b.v.z + b.w * a.v.z + a.v.x * b.v.y - a.v.y * b.v.x}};
}

/// s + a x b: a chain that a processor with fused products takes in six.
template <class T>
TRUNNION_INLINE Triple<T> add_cross(const Triple<T>& s, const Triple<T>& a, const Triple<T>& b) {
  return {s.x + a.y * b.z - a.z * b.y, s.y + a.z * b.x - a.x * b.z, s.z + a.x * b.y - a.y * b.x};
}

/// s + k a.
template <class T>
TRUNNION_INLINE Triple<T> add_scaled(const Triple<T>& s, const T& k, const Triple<T>& a) {
  return {s.x + k * a.x, s.y + k * a.y, s.z + k * a.z};
}

/// Of length one. Not inlined: a start is made once.
template <class T>
TRUNNION_COLD Quad<T> normalized(const Quad<T>& q) {
  using std::sqrt;
  return (T(1) / sqrt(dot(q, q))) * q;
}

/// q a q^* of a unit quaternion q = (w, v).
template <class T>
TRUNNION_INLINE Triple<T> rotate(const T& w, const Triple<T>& v, const Triple<T>& a) {
  const Triple<T> c = cross(v, a);
  const Triple<T> turned = c + c;
  return add_cross(add_scaled(a, w, turned), v, turned);
}

/// Part by part: of a whole GCC makes a copy through the stack.
template <class T>
TRUNNION_INLINE void assign(T& to, const T& from) {
  to = from;
}
template <class T>
TRUNNION_INLINE void assign(Triple<T>& to, const Triple<T>& from) {
  to.x = from.x;
  to.y = from.y;
  to.z = from.z;
}
template <class T>
TRUNNION_INLINE void assign(Quad<T>& to, const Quad<T>& from) {
  to.w = from.w;
  assign(to.v, from.v);
}

/// A number (T, Triple, Quad) whose sums lose nothing to rounding: the true value is sum - error.
template <class V>
struct CompensatedSum {
  V sum{};
  V error{};

  TRUNNION_INLINE void add(const V& step) {
    const V corrected = step - error;
    const V next = sum + corrected;
    assign(error, (next - sum) - corrected);
    assign(sum, next);
  }
};

/// The same as sum.add(step), bit for bit, in a loop that is not inlined: for what is done seldom and should be small.
template <class T, class V>
TRUNNION_COLD void add_seldom(CompensatedSum<V>& to, const V& step) {
  static_assert(sizeof(V) % sizeof(T) == 0, "V is made of T");
  T* const sum = reinterpret_cast<T*>(&to.sum);
  T* const error = reinterpret_cast<T*>(&to.error);
  const T* const add = reinterpret_cast<const T*>(&step);
  for (std::size_t i = 0; i < sizeof(V) / sizeof(T); ++i) {
    const T corrected = add[i] - error[i];
    const T next = sum[i] + corrected;
    error[i] = (next - sum[i]) - corrected;
    sum[i] = next;
  }
}

}  // namespace trunnion::kernel
