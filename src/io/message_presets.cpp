// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <string_view>

#include "strict_yaml.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/message_map.hpp"

namespace trunnion::io {
namespace {

constexpr std::string_view kDefinitions = R"(
package trunnion_lcm;
struct imu_t { int64_t utime, sequence; double angular_rate[3], specific_force[3], temperature; }
struct imu_batch_t {
  int64_t utime, sequence; int32_t num_samples; int64_t sample_utime[num_samples];
  double gyro_x[num_samples], gyro_y[num_samples], gyro_z[num_samples];
  double accel_x[num_samples], accel_y[num_samples], accel_z[num_samples]; double temperature;
}
struct imu_counts_t { int64_t utime, sequence; int32_t gyro[3], accel[3], temperature; }
struct encoder_t { int64_t utime, sequence; int32_t num_axes; double angle[num_axes]; }
struct index_t { int64_t utime, sequence; int32_t turns; }
struct navigation_t { int64_t utime, sequence; double latitude, longitude, height, velocity[3], attitude[4]; }
struct gnss_raw_t {
  int64_t utime, sequence; int32_t antenna, week; double seconds; int32_t num_signals;
  int32_t satellite[num_signals], signal[num_signals];
  double code[num_signals], phase[num_signals], doppler[num_signals]; int8_t half_cycle[num_signals];
}
struct gnss_orbit_t {
  int64_t utime, sequence; int32_t satellite, healthy, toe_week; double toe_seconds; int32_t toc_week;
  double toc_seconds, toe_of_week, clock[3], elements[15];
}
struct attitude_t {
  int64_t utime, sequence; int8_t status, observable; int16_t satellites;
  double attitude[4], covariance[9], free_axis[3], rate[3];
}
package bot_core;
struct ins_t { int64_t utime, device_time; double gyro[3], mag[3], accel[3], quat[4], pressure, rel_alt; }
struct kvh_raw_imu_t { int64_t utime, packet_count; double delta_rotation[3], linear_acceleration[3]; }
struct kvh_raw_imu_batch_t { int64_t utime; int32_t num_packets; kvh_raw_imu_t raw_imu[num_packets]; }
struct joint_state_t {
  int64_t utime; int16_t num_joints; string joint_name[num_joints];
  float joint_position[num_joints], joint_velocity[num_joints], joint_effort[num_joints];
}
package microstrain;
struct ins_t { double gyro[3], mag[3], accel[3], quat[4], pressure, rel_alt, device_time; int64_t utime; }
package cheetah;
struct microstrain_lcmt { float quat[4], rpy[3], omega[3], acc[3]; int64_t good_packets, bad_packets; }
struct vectornav_lcmt { float q[4], w[3], a[3]; }
package mbot_lcm_msgs;
struct mbot_imu_t { int64_t utime; float gyro[3], accel[3], mag[3], angles_rpy[3], angles_quat[4], temp; }
package std_msgs;
struct Time { int32_t sec, nsec; }
struct Header { int32_t seq; std_msgs.Time stamp; string frame_id; }
package geometry_msgs;
struct Vector3 { double x, y, z; }
struct Quaternion { double x, y, z, w; }
package sensor_msgs;
struct Imu {
  std_msgs.Header header; geometry_msgs.Quaternion orientation; double orientation_covariance[9];
  geometry_msgs.Vector3 angular_velocity; double angular_velocity_covariance[9];
  geometry_msgs.Vector3 linear_acceleration; double linear_acceleration_covariance[9];
}
struct JointState {
  int32_t name_length, position_length, velocity_length, effort_length; std_msgs.Header header;
  string name[name_length]; double position[position_length], velocity[velocity_length], effort[effort_length];
}
package drake;
struct lcmt_iiwa_status {
  int64_t utime; int32_t num_joints;
  double joint_position_measured[num_joints], joint_velocity_estimated[num_joints];
  double joint_position_commanded[num_joints], joint_position_ipo[num_joints];
  double joint_torque_measured[num_joints], joint_torque_commanded[num_joints], joint_torque_external[num_joints];
}
)";

std::shared_ptr<const LcmTypes> make_types() {
  const auto types = std::make_shared<LcmTypes>();
  types->add_text(kDefinitions, "known types");
  return types;
}

std::vector<MessagePreset> make_presets() {
  const std::shared_ptr<const LcmTypes> types = known_types();
  std::vector<MessagePreset> presets;
  const auto add = [&](const char* type, const char* channel, bool is_imu) -> MessageMap& {
    presets.push_back({type, channel, is_imu, {}});
    MessageMap& map = presets.back().map;
    map.types = types;
    map.type = type;
    map.time = {{"utime"}, "us"};
    return map;
  };
  const auto imu = [&](const char* type, const char* channel, FieldChoice gyro, FieldChoice accel) -> MessageMap& {
    MessageMap& map = add(type, channel, true);
    map.gyro = std::move(gyro);
    map.accel = std::move(accel);
    return map;
  };
  const auto split = [](MessageMap& map) {
    map.clock = MessageMap::Clock::kSecondsAndNanoseconds;
    map.time = {{"header.stamp.sec", "header.stamp.nsec"}, "s"};
    map.sequence = "header.seq";
  };
  imu("bot_core.ins_t", "MICROSTRAIN_INS", {{"gyro"}, "rad/s"}, {{"accel"}, "m/s^2"});
  imu("microstrain.ins_t", "MICROSTRAIN_INS", {{"gyro"}, "rad/s"}, {{"accel"}, "m/s^2"});
  MessageMap& kvh = imu("bot_core.kvh_raw_imu_batch_t", "ATLAS_IMU_BATCH", {{"raw_imu.delta_rotation"}, "rad"},
                        {{"raw_imu.linear_acceleration"}, "m/s^2"});
  kvh.time.fields = {"raw_imu.utime"};
  kvh.sequence = "raw_imu.packet_count";
  imu("cheetah.microstrain_lcmt", "microstrain", {{"omega"}, "rad/s"}, {{"acc"}, "m/s^2"}).clock =
      MessageMap::Clock::kLog;
  imu("cheetah.vectornav_lcmt", "hw_vectornav", {{"w"}, "rad/s"}, {{"a"}, "m/s^2"}).clock = MessageMap::Clock::kLog;
  imu("mbot_lcm_msgs.mbot_imu_t", "MBOT_IMU", {{"gyro"}, "rad/s"}, {{"accel"}, "m/s^2"});
  split(imu("sensor_msgs.Imu", "", {{"angular_velocity.x", "angular_velocity.y", "angular_velocity.z"}, "rad/s"},
            {{"linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"}, "m/s^2"}));

  MessageMap& joints = add("bot_core.joint_state_t", "", false);
  joints.angle = {{"joint_position"}, "rad"};
  joints.joint_names = "joint_name";
  joints.joints = {"azimuth", "pitch"};
  MessageMap& ros_joints = add("sensor_msgs.JointState", "", false);
  ros_joints.angle = {{"position"}, "rad"};
  ros_joints.joint_names = "name";
  ros_joints.joints = {"azimuth", "pitch"};
  split(ros_joints);
  add("drake.lcmt_iiwa_status", "IIWA_STATUS", false).angle = {{"joint_position_measured"}, "rad"};
  return presets;
}

}  // namespace

std::shared_ptr<const LcmTypes> known_types() {
  static const std::shared_ptr<const LcmTypes> kTypes = make_types();
  return kTypes;
}

const std::vector<MessagePreset>& message_presets() {
  static const std::vector<MessagePreset> kPresets = make_presets();
  return kPresets;
}

const MessagePreset& message_preset(const std::string& name) {
  std::vector<std::string> names;
  for (const MessagePreset& preset : message_presets()) {
    if (preset.name == name) return preset;
    names.push_back(preset.name);
  }
  throw Error(ExitCode::kInput, "unknown preset '" + name + "'; did you mean '" + nearest(name, names) + "'?");
}

}  // namespace trunnion::io
