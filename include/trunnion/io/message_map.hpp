// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the messages of somebody else's type become samples: which fields, in which units.

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/io/lcm_type.hpp"
#include "trunnion/io/sensor_sheet.hpp"

namespace trunnion::io {

/// Fields of a message that make one quantity.
struct FieldChoice {
  std::vector<std::string> fields;  ///< one path with all components, or one each
  std::string unit;
};

/// One type of message. A message may hold one sample or, in arrays, several.
struct MessageMap {
  enum class Clock { kField, kSecondsAndNanoseconds, kLog };

  std::shared_ptr<const LcmTypes> types;
  std::string type;
  Clock clock = Clock::kField;
  FieldChoice time;   ///< us, ns, ms, s: one stamp a sample, or that of the last; or seconds and nanoseconds
  FieldChoice gyro;   ///< rad/s, deg/s, deg/h, counts, or rad: angles turned in a sample's period
  FieldChoice accel;  ///< m/s^2, g, mg, counts, or m/s: velocities gained in a sample's period
  FieldChoice angle;  ///< rad, deg, ticks: outer and inner
  std::array<double, 2> ticks_per_turn{};     ///< negative: they count the other way
  std::string joint_names;                    ///< field with the names of the angles, or empty
  std::array<std::string, 2> joints;          ///< which of them
  std::array<std::size_t, 2> elements{0, 1};  ///< else: of one field with more than two angles
  std::string sequence;                       ///< or empty
};

/// A channel by name; without a map its messages are of package trunnion_lcm.
struct ChannelChoice {
  std::string name;
  std::shared_ptr<const MessageMap> map;
};

/// A map that is ready to use, for a type that is met often.
struct MessagePreset {
  std::string name;     ///< of the type
  std::string channel;  ///< where it usually is
  bool is_imu = true;   ///< else of the encoders
  MessageMap map;
};

const std::vector<MessagePreset>& message_presets();

/// The definitions of package trunnion_lcm and of the presets.
std::shared_ptr<const LcmTypes> known_types();

/// @throws Error (input) for a name that no preset has, with the nearest
const MessagePreset& message_preset(const std::string& name);

/// Decodes messages by a map.
class MappedMessages {
 public:
  struct Sample {
    std::int64_t utime = 0;
    std::int64_t sequence = 0;
    InertialSample<double> value;
  };

  /// @param sheet what a count is, and the period of a sample
  /// @throws Error (input) for a field that the type does not have, a unit that does not measure it, or a scale or
  /// rate that the sheet does not state
  MappedMessages(std::shared_ptr<const MessageMap> map, const SensorSheet& sheet);

  /// @return empty, or what is wrong with the message
  std::string imu(const LcmEvent& event, std::vector<Sample>& samples);
  std::string encoder(const LcmEvent& event, std::int64_t& utime, std::int64_t& sequence, std::array<double, 2>& angle);

  [[nodiscard]] bool has_sequence() const { return !map_->sequence.empty(); }

 private:
  /// (number - zero) * si
  struct Scale {
    double si = 1.0;
    double zero = 0.0;
  };
  static Scale scale_of(const char* quantity, const FieldChoice& choice, const SensorSheet& sheet, const char* delta);
  [[nodiscard]] std::size_t count(std::size_t path) const;
  [[nodiscard]] double number(std::size_t path, std::size_t k) const;
  [[nodiscard]] std::string time_of(const LcmEvent& event, std::size_t k, std::int64_t& utime) const;
  [[nodiscard]] Vec3<double> triple(std::size_t first, std::size_t paths, std::size_t k, const Scale& scale) const;

  std::shared_ptr<const MessageMap> map_;
  LcmFieldReader reader_;
  std::size_t gyro_ = 0;  // first path of each; the time's is 0
  std::size_t accel_ = 0;
  std::size_t angle_ = 0;
  std::size_t names_ = 0;
  std::size_t sequence_ = 0;
  double time_si_ = 1e-6;
  Scale gyro_scale_;
  Scale accel_scale_;
  std::array<double, 2> angle_si_{1.0, 1.0};
  double period_ = 0.0;
};

}  // namespace trunnion::io
