// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <Eigen/Core>

#include "trunnion/calibration/parameters.hpp"
#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion::calibration {

/// What a turn adds up to at given unknowns.
struct TurnRotation {
  Quaternion<double> q = Quaternion<double>::Identity();  ///< case at its end to case at its start
  Eigen::Matrix<double, 3, Eigen::Dynamic> J;  ///< 3 x unknowns: right perturbation of q [rad] by the scaled unknowns
  double duration = 0.0;                       ///< s
};

/// Integrates eq. (2) of multi_position_solve.hpp, with coning over two steps (Savage 1998, eq. 43), and in the same
/// pass J, to first order in the cubic terms and second in a step's angle.
/// @param w_ie_b Earth rate in the case at the start [rad/s]; @param layout null: no derivative
TurnRotation integrate(const Turn& turn, const InertialUnit<double>& unit, const Vec3<double>& w_ie_b,
                       const Layout* layout, std::size_t recording);

}  // namespace trunnion::calibration
