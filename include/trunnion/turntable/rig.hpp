// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A rig as drawn, and the bench it stands on: constants, before anything is estimated.

#pragma once

#include <array>

#include "trunnion/turntable/two_axis.hpp"

namespace trunnion {

inline constexpr int kMaxMounts = 8;

/// One mount of the unit on the pitch stage.
struct RigMount {
  Mat3<double> C_pb = Mat3<double>::Identity();
  Vec3<double> lever_p = Vec3<double>::Zero();  ///< origin of the case from the pitch joint [m]
};

struct Rig {
  TwoAxisGeometry geometry;
  std::array<RigMount, kMaxMounts> mount;
  int mounts = 0;
};

struct Site {
  double latitude = 0.0;        ///< geodetic [rad]
  double gravity = 9.80665;     ///< m/s^2
  double gravity_sigma = 3e-4;  ///< m/s^2
};

}  // namespace trunnion
