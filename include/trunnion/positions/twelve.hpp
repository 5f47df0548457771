// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The twelve positions: three mounts of an orthogonal fixture x two table axes x two directions.
///
/// The mounts are the three cyclic permutations of the axes, so that each case axis meets each table axis. Which case
/// axis a turn excites follows from the mount, it is never written down: excited_axis().
/// docs/theory/calibration.md, section 2.

#pragma once

#include <array>

#include "trunnion/core/linear.hpp"
#include "trunnion/turntable/two_axis.hpp"

namespace trunnion {

inline constexpr int kMounts = 3;

/// One position: what is turned, and which way.
struct Position {
  int mount;      ///< 0, 1, 2
  Axis axis;      ///< of the table
  int direction;  ///< +1 or -1
};

inline constexpr std::array<Position, 12> kTwelvePositions = {{
    {0, kAzimuth, +1},
    {0, kAzimuth, -1},
    {0, kPitch, +1},
    {0, kPitch, -1},
    {1, kAzimuth, +1},
    {1, kAzimuth, -1},
    {1, kPitch, +1},
    {1, kPitch, -1},
    {2, kAzimuth, +1},
    {2, kAzimuth, -1},
    {2, kPitch, +1},
    {2, kPitch, -1},
}};

/// C_pb of the cyclic mount @p mount (0, 1, 2): case x, y, z lie along p-axes (0, 1, 2), (2, 0, 1), (1, 2, 0).
inline Mat3<double> cyclic_mount(int mount) {
  Mat3<double> C_pb = Mat3<double>::Zero();
  for (int column = 0; column < 3; ++column) C_pb((column + 2 * mount) % 3, column) = 1.0;
  return C_pb;
}

/// Case axis (0, 1, 2) that a turn about the table axis excites at pitch zero, and the sign: +-(axis + 1).
inline int excited_axis(const Mat3<double>& C_pb, const Position& position) {
  const Vec3<double> axis_p = position.axis == kAzimuth ? Vec3<double>::UnitZ() : Vec3<double>::UnitY();
  const Vec3<double> axis_b = C_pb.transpose() * axis_p;
  int index = 0;
  axis_b.cwiseAbs().maxCoeff(&index);
  return (axis_b(index) * position.direction > 0 ? 1 : -1) * (index + 1);
}

}  // namespace trunnion
