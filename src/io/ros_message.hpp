// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages of ROS as bytes: sensor_msgs Imu and JointState, as ROS 2 (CDR) and ROS 1 serialise them.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion::io {

enum class RosEncoding { kCdr, kRos1 };

struct RosImu {
  std::int64_t utime = 0;
  InertialSample<double> sample;
};

struct RosAngles {
  std::int64_t utime = 0;
  std::array<double, 2> angle{};
};

/// @param wrong takes what is wrong with a message that is not returned
std::optional<RosImu> decode_ros_imu(std::string_view message, RosEncoding encoding, std::string& wrong);
/// The positions of two joints, by name.
std::optional<RosAngles> decode_ros_joints(std::string_view message, RosEncoding encoding,
                                           const std::array<std::string, 2>& joints, std::string& wrong);

/// CDR, little-endian; covariances unknown, no orientation. Stamps from 0 to 2^31 s.
void encode_ros_imu(std::int64_t utime, const InertialSample<double>& sample, std::string& out);
void encode_ros_joints(std::int64_t utime, const std::array<std::string, 2>& joints, const std::array<double, 2>& angle,
                       std::string& out);

/// Definitions of the two, with all that they are made of, as a ROS 2 recording carries them.
extern const char* const kRosImuDefinition;
extern const char* const kRosJointStateDefinition;

}  // namespace trunnion::io
