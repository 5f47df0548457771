// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A two-axis table or gimbal: an azimuth stage o that turns in the base t, a pitch stage p that turns in o, and the
/// unit's case b in a mount on p. The table is imperfect; the imperfections are parameters.
///
///   C_ut = Exp([tilt_x, tilt_y, 0]) Rz(heading)                    u: east-north-up               ... (1)
///   C_tp = C_to Rz(azimuth) Rx(i0 + i) Ry(pitch) C_qp                                              ... (2)
///   C_pb = C_pb(nominal) Exp(mount_error)                                                          ... (3)
///   w_ip_p = C_qp^T [ a' Ry(-p) Rx(-i) z + p' y + Ry(-p) Rx(-i) Rz(-a) C_ot C_tu w_ie_u ]          ... (4)
///   f_p = C_pu g up + w_ip' x l + w_ip x (w_ip x l) + acceleration of the pitch joint              ... (5)
///
/// o: azimuth stage with z along the azimuth axis and the nominal pitch axis in its y-z plane; q: pitch stage with y
/// along the pitch axis. For a rig whose axes are z and y, C_to = C_qp = I and i0 = 0. i: non-orthogonality of the
/// axes, which turns the pitch axis about (pitch axis x azimuth axis). l: lever arm of the sensing point from the pitch
/// joint [m], in p. a, p: azimuth and pitch *angles*, not encoder readings. docs/theory/calibration.md, eq. 6-12.

#pragma once

#include <array>

#include "trunnion/core/earth.hpp"
#include "trunnion/core/linear.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/turntable/encoder.hpp"

namespace trunnion {

enum Axis : int { kAzimuth = 0, kPitch = 1 };

/// What the drawing of the rig says, eq. (2): constants.
struct TwoAxisGeometry {
  Mat3<double> C_to = Mat3<double>::Identity();
  Mat3<double> C_qp = Mat3<double>::Identity();
  double nonorthogonality = 0.0;                      ///< i0 [rad]
  Vec3<double> pitch_joint_o = Vec3<double>::Zero();  ///< from any point of the azimuth axis to the pitch joint [m]

  /// From a kinematic chain: the azimuth joint's origin rotation in t and its axis, the pitch joint's origin rotation
  /// and position in the azimuth link and its axis. Axes are unit vectors.
  /// @return kNotObservable where the axes are within 0.1 rad of parallel: such a rig has no two axes
  [[nodiscard]] static Result<TwoAxisGeometry> from_chain(const Mat3<double>& C_ta, const Vec3<double>& azimuth_axis_a,
                                                          const Mat3<double>& C_ap, const Vec3<double>& pitch_joint_a,
                                                          const Vec3<double>& pitch_axis_p) {
    const Vec3<double> pitch_axis_a = C_ap * pitch_axis_p;
    const Vec3<double> x = pitch_axis_a.cross(azimuth_axis_a);
    if (!(x.norm() > 0.1)) return Status::kNotObservable;
    Mat3<double> C_ao;
    C_ao.col(0) = x.normalized();
    C_ao.col(1) = azimuth_axis_a.cross(C_ao.col(0));
    C_ao.col(2) = azimuth_axis_a;
    TwoAxisGeometry rig;
    rig.C_to = C_ta * C_ao;
    const Vec3<double> pitch_axis_o = C_ao.transpose() * pitch_axis_a;
    rig.nonorthogonality = std::atan2(pitch_axis_o.z(), pitch_axis_o.y());
    rig.C_qp = rotation_exp<double>(Vec3<double>(-rig.nonorthogonality, 0, 0)) * C_ao.transpose() * C_ap;
    rig.pitch_joint_o = C_ao.transpose() * pitch_joint_a;
    return rig;
  }
};

/// What the drawing does not say: zero is the perfect rig, level and with its x axis to the east.
template <class T>
struct TwoAxisErrors {
  T tilt_x = T(0);            ///< rad, about east
  T tilt_y = T(0);            ///< rad, about north
  T heading = T(0);           ///< rad, of the root link's x axis, from east towards north
  T nonorthogonality = T(0);  ///< i [rad]
  std::array<EncoderEccentricity<T>, 2> eccentricity;
};

/// The rig at a site: turns joint motion into what a perfect unit in the pitch stage feels.
template <class T>
class TwoAxisTable {
 public:
  /// @param latitude geodetic [rad]; @param gravity [m/s^2], positive down
  TwoAxisTable(const TwoAxisGeometry& rig, const TwoAxisErrors<T>& errors, double latitude, const T& gravity)
      : errors_(errors),
        C_qp_(rig.C_qp),
        p_is_q_(rig.C_qp.isIdentity(0.0)),
        has_joint_offset_(rig.pitch_joint_o.head<2>().squaredNorm() > 0.0) {
    using std::cos;
    using std::sin;
    const Mat3<T> C_ut = base_attitude();
    const Mat3<T> C_ot = rig.C_to.transpose().template cast<T>();
    w_ie_o_ = C_ot * (C_ut.transpose() * earth_rate_enu(latitude).template cast<T>());
    reaction_o_ = C_ot * C_ut.transpose().col(2) * gravity;
    const T i = T(rig.nonorthogonality) + errors.nonorthogonality;
    sin_i_ = sin(i);
    cos_i_ = cos(i);
    pitch_joint_o_ = rig.pitch_joint_o.template cast<T>();
    C_uo_ = C_ut * rig.C_to.template cast<T>();
  }

  /// Angular rate w_ip_p [rad/s] and specific force f_p [m/s^2] at @p lever_p [m] from the pitch joint, eq. (4), (5),
  /// for the motion that the two encoders *read*.
  [[nodiscard]] InertialSample<T> input(const AxisMotion<T>& azimuth_reading, const AxisMotion<T>& pitch_reading,
                                        const Vec3<T>& lever_p) const {
    using std::cos;
    using std::sin;
    const AxisMotion<T> a = errors_.eccentricity[kAzimuth].correct(azimuth_reading);
    const AxisMotion<T> p = errors_.eccentricity[kPitch].correct(pitch_reading);
    const T sa = sin(a.angle);
    const T ca = cos(a.angle);
    const T sp = sin(p.angle);
    const T cp = cos(p.angle);
    const auto o_to_q = [&](const Vec3<T>& v) { return turn_about_y<T>(-sp, cp, turn_about_x<T>(-sin_i_, cos_i_, v)); };
    const Vec3<T> axis_q(-sp * cos_i_, sin_i_, cp * cos_i_);                     // azimuth axis in q
    const Vec3<T> axis_rate_q(-p.rate * axis_q.z(), T(0), p.rate * axis_q.x());  // its time derivative
    const Vec3<T> w_ie_turned_o = turn_about_z<T>(-sa, ca, w_ie_o_);
    const Vec3<T> w_ie_q = o_to_q(w_ie_turned_o);

    Vec3<T> w_tq_q = a.rate * axis_q;
    w_tq_q.y() += p.rate;
    const Vec3<T> w_iq_q = w_tq_q + w_ie_q;
    Vec3<T> w_dot_q = a.acceleration * axis_q + a.rate * axis_rate_q - w_tq_q.cross(w_ie_q);
    w_dot_q.y() += p.acceleration;

    const Vec3<T> lever_q = p_is_q_ ? lever_p : Vec3<T>(C_qp_.template cast<T>() * lever_p);
    Vec3<T> f_q =
        o_to_q(turn_about_z<T>(-sa, ca, reaction_o_)) + w_dot_q.cross(lever_q) + w_iq_q.cross(w_iq_q.cross(lever_q));
    if (has_joint_offset_) {
      Vec3<T> w_io_o = w_ie_turned_o;
      w_io_o.z() += a.rate;
      const Vec3<T> w_io_dot_o(a.rate * w_ie_turned_o.y(), -a.rate * w_ie_turned_o.x(), a.acceleration);
      f_q += o_to_q(w_io_dot_o.cross(pitch_joint_o_) + w_io_o.cross(w_io_o.cross(pitch_joint_o_)));
    }
    if (p_is_q_) return {w_iq_q, f_q};
    const Mat3<T> C_pq = C_qp_.transpose().template cast<T>();
    return {C_pq * w_iq_q, C_pq * f_q};
  }

  /// C_up of the pitch stage at the joint *angles* [rad], eq. (1), (2).
  [[nodiscard]] Mat3<T> attitude(const T& azimuth, const T& pitch) const {
    const Mat3<T> Rz = rotation_exp<T>(Vec3<T>(T(0), T(0), azimuth));
    const Mat3<T> Ry = rotation_exp<T>(Vec3<T>(T(0), pitch, T(0)));
    Mat3<T> Rx = Mat3<T>::Identity();
    Rx(1, 1) = Rx(2, 2) = cos_i_;
    Rx(2, 1) = sin_i_;
    Rx(1, 2) = -sin_i_;
    return C_uo_ * Rz * Rx * Ry * C_qp_.template cast<T>();
  }

  /// Position of a point of the pitch stage against the azimuth axis, in u [m], at the joint angles [rad].
  [[nodiscard]] Vec3<T> position(const T& azimuth, const T& pitch, const Vec3<T>& lever_p) const {
    const Mat3<T> Rz = rotation_exp<T>(Vec3<T>(T(0), T(0), azimuth));
    return C_uo_ * (Rz * pitch_joint_o_) + attitude(azimuth, pitch) * lever_p;
  }

 private:
  /// C_ut, eq. (1).
  [[nodiscard]] Mat3<T> base_attitude() const {
    return rotation_exp<T>(Vec3<T>(errors_.tilt_x, errors_.tilt_y, T(0))) *
           rotation_exp<T>(Vec3<T>(T(0), T(0), errors_.heading));
  }

  TwoAxisErrors<T> errors_;
  Mat3<double> C_qp_;
  bool p_is_q_;  // the usual rig: spares two products a call
  bool has_joint_offset_;
  Vec3<T> w_ie_o_;
  Vec3<T> reaction_o_;  ///< what an accelerometer at rest feels, at azimuth zero
  Vec3<T> pitch_joint_o_;
  Mat3<T> C_uo_;
  T sin_i_;
  T cos_i_;
};

}  // namespace trunnion
