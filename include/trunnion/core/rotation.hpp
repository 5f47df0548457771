// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rotations. One convention everywhere:
///
///   C_nb takes b-components to n:  v_n = C_nb v_b           ... (1)
///   q_nb likewise, Hamilton, scalar first in arguments:  v_n = q_nb v_b q_nb^-1
///   C = Exp(phi) = I + sin|phi| K + (1 - cos|phi|) K^2,  K = skew(phi / |phi|)   ... (2)  Rodrigues
///   C_nb(t + dt) = C_nb(t) Exp(w_nb_b dt)  for a constant rate                      ... (3)
///   Exp(phi + d) = Exp(phi) Exp(Jr(phi) d),  Jr = I - (1 - cos|phi|)/|phi| K + (1 - sin|phi|/|phi|) K^2   ... (4)
///   C_nb = Rz(yaw) Ry(pitch) Rx(roll)                                               ... (5)
///
/// phi [rad] is the rotation vector. Sola, Deray, Atchuthan, arXiv:1812.01537, eq. (132)-(147).

#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "trunnion/core/linear.hpp"

namespace trunnion {

template <class T>
using Quaternion = Eigen::Quaternion<T>;

/// Quaternion of the rotation vector @p phi [rad], eq. (2). Exact through zero, and so are its derivatives.
template <class T>
Quaternion<T> quaternion_exp(const Vec3<T>& phi) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T theta2 = phi.squaredNorm();
  if (theta2 < T(1e-6)) {  // the next terms are theta^6 / 46080 and theta^6 / 645120: below 1e-22
    const T w = T(1) - theta2 * (T(1) / T(8) - theta2 / T(384));
    const T k = T(1) / T(2) - theta2 * (T(1) / T(48) - theta2 / T(3840));
    return Quaternion<T>(w, k * phi.x(), k * phi.y(), k * phi.z());
  }
  const T theta = sqrt(theta2);
  const T k = sin(theta / T(2)) / theta;
  return Quaternion<T>(cos(theta / T(2)), k * phi.x(), k * phi.y(), k * phi.z());
}

/// Rotation vector [rad] of the unit quaternion @p q, |phi| <= pi. The inverse of quaternion_exp().
template <class T>
Vec3<T> quaternion_log(const Quaternion<T>& q) {
  using std::atan2;
  using std::sqrt;
  const T sign = q.w() < T(0) ? T(-1) : T(1);
  const T w = sign * q.w();
  const Vec3<T> v = sign * q.vec();
  const T s2 = v.squaredNorm();
  if (s2 < T(1e-8)) {  // |phi| = 2 asin(s), asin(s)/s = 1 + s^2/6 + 3 s^4/40
    return v * (T(2) + s2 * (T(1) / T(3) + s2 * (T(3) / T(20))));
  }
  const T s = sqrt(s2);
  return v * (T(2) * atan2(s, w) / s);
}

/// Direction cosine matrix of the rotation vector @p phi [rad], eq. (2).
template <class T>
Mat3<T> rotation_exp(const Vec3<T>& phi) {
  return quaternion_exp(phi).toRotationMatrix();
}

/// Right Jacobian of Exp, eq. (4), to first order in d. Exact through zero.
template <class T>
Mat3<T> right_jacobian(const Vec3<T>& phi) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T theta2 = phi.squaredNorm();
  T a = T(0.5) - theta2 * (T(1) / T(24) - theta2 / T(720));
  T b = T(1) / T(6) - theta2 * (T(1) / T(120) - theta2 / T(5040));
  if (theta2 > T(0.01)) {  // below, the next terms are theta^6 / 40320: 2e-11 of 1/2
    const T theta = sqrt(theta2);
    const T half = sin(theta / T(2)) / theta;
    a = T(2) * half * half;
    b = (T(1) - sin(theta) / theta) / theta2;
  }
  const Mat3<T> K = skew(phi);
  return Mat3<T>::Identity() - a * K + b * K * K;
}

/// Roll, pitch, yaw [rad] of eq. (5). At a pitch of +-90 deg roll and yaw are one angle, which is given as yaw.
template <class T>
Vec3<T> euler_angles(const Quaternion<T>& q_nb) {
  using std::atan2;
  using std::sqrt;
  const Mat3<T> C = q_nb.toRotationMatrix();
  const T level = sqrt(C(0, 0) * C(0, 0) + C(1, 0) * C(1, 0));
  const T pitch = atan2(-C(2, 0), level);
  if (level < T(16) * std::numeric_limits<T>::epsilon()) return Vec3<T>(T(0), pitch, atan2(-C(0, 1), C(1, 1)));
  return Vec3<T>(atan2(C(2, 1), C(2, 2)), pitch, atan2(C(1, 0), C(0, 0)));
}

/// The quaternion of roll, pitch and yaw [rad], eq. (5).
template <class T>
Quaternion<T> quaternion_of_euler(const T& roll, const T& pitch, const T& yaw) {
  return Quaternion<T>(Eigen::AngleAxis<T>(yaw, Vec3<T>::UnitZ()) * Eigen::AngleAxis<T>(pitch, Vec3<T>::UnitY()) *
                       Eigen::AngleAxis<T>(roll, Vec3<T>::UnitX()));
}

/// Turns @p v about z by the angle whose sine and cosine are given: Rz(angle) v.
template <class T>
Vec3<T> turn_about_z(const T& sine, const T& cosine, const Vec3<T>& v) {
  return Vec3<T>(cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y(), v.z());
}

/// Turns @p v about y by the angle whose sine and cosine are given: Ry(angle) v.
template <class T>
Vec3<T> turn_about_y(const T& sine, const T& cosine, const Vec3<T>& v) {
  return Vec3<T>(cosine * v.x() + sine * v.z(), v.y(), cosine * v.z() - sine * v.x());
}

/// Turns @p v about x by the angle whose sine and cosine are given: Rx(angle) v.
template <class T>
Vec3<T> turn_about_x(const T& sine, const T& cosine, const Vec3<T>& v) {
  return Vec3<T>(v.x(), cosine * v.y() - sine * v.z(), sine * v.y() + cosine * v.z());
}

}  // namespace trunnion
