// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A gimbal whose outer axis is level, with one mount: every direction of gravity can be had.

#pragma once

#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

inline Rig level_gimbal() {
  Rig rig;
  rig.geometry = TwoAxisGeometry::from_chain(Mat3<double>::Identity(), Vec3<double>::UnitX(), Mat3<double>::Identity(),
                                             Vec3<double>::Zero(), Vec3<double>::UnitZ())
                     .value();
  rig.mounts = 1;
  return rig;
}

}  // namespace trunnion::calibration
