// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Three numbers, and a quaternion, that stay in registers.
///
/// The strapdown kernel alone computes with these; everything else, and every interface, is Eigen. Eigen's expressions
/// cost the kernel twice its instructions at -O2: docs/decisions/2026-11-22-scalars-in-the-strapdown-kernel.md.

#pragma once

#include "trunnion/core/linear.hpp"

namespace trunnion::strapdown_detail {

template <class T>
struct Triple {
  T x, y, z;

  friend inline Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend inline Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend inline Triple operator*(const T& k, const Triple& a) { return {k * a.x, k * a.y, k * a.z}; }
};

template <class T>
inline T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
inline Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
inline Triple<T> triple(const Vec3<T>& v) {
  return {v.x(), v.y(), v.z()};
}

template <class T>
inline Vec3<T> vector(const Triple<T>& a) {
  return Vec3<T>(a.x, a.y, a.z);
}

/// Quaternion, or a step of one: Hamilton, scalar and vector part.
template <class T>
struct Quad {
  T w;
  Triple<T> v;

  friend inline Quad operator+(const Quad& a, const Quad& b) { return {a.w + b.w, a.v + b.v}; }
  friend inline Quad operator-(const Quad& a, const Quad& b) { return {a.w - b.w, a.v - b.v}; }
  friend inline Quad operator*(const T& k, const Quad& a) { return {k * a.w, k * a.v}; }
};

template <class T>
inline T dot(const Quad<T>& a, const Quad<T>& b) {
  return a.w * b.w + dot(a.v, b.v);
}

template <class T>
inline Quad<T> product(const Quad<T>& a, const Quad<T>& b) {
  return {a.w * b.w - a.v.x * b.v.x - a.v.y * b.v.y - a.v.z * b.v.z,
          {a.w * b.v.x + b.w * a.v.x + (a.v.y * b.v.z - a.v.z * b.v.y),
           a.w * b.v.y + b.w * a.v.y + (a.v.z * b.v.x - a.v.x * b.v.z),
           a.w * b.v.z + b.w * a.v.z + (a.v.x * b.v.y - a.v.y * b.v.x)}};
}

/// q a q^* of a unit quaternion q = (w, v).
template <class T>
inline Triple<T> rotate(const T& w, const Triple<T>& v, const Triple<T>& a) {
  const Triple<T> c = cross(v, a);
  const Triple<T> turned = c + c;
  return a + (w * turned + cross(v, turned));
}

}  // namespace trunnion::strapdown_detail
