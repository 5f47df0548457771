// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/message_map.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/positions/channel_clock.hpp"

namespace trunnion::io {
namespace {

constexpr double kLatest = 9.2e12;  // s: beyond it a stamp does not fit into 64 bits of microseconds

std::vector<std::string> paths_of(const MessageMap& map) {
  std::vector<std::string> paths = map.clock == MessageMap::Clock::kLog ? std::vector<std::string>() : map.time.fields;
  for (const FieldChoice* choice : {&map.gyro, &map.accel, &map.angle})
    paths.insert(paths.end(), choice->fields.begin(), choice->fields.end());
  if (!map.joint_names.empty()) paths.push_back(map.joint_names);
  if (!map.sequence.empty()) paths.push_back(map.sequence);
  return paths;
}

}  // namespace

MappedMessages::Scale MappedMessages::scale_of(const char* quantity, const FieldChoice& choice,
                                               const SensorSheet& sheet, const char* delta) {
  if (choice.unit == "counts") {
    const NominalScale<double>& counts =
        std::string_view(quantity) == "gyro_x" ? sheet.counts.gyro : sheet.counts.accel;
    return {1.0 / counts.scale, counts.zero};
  }
  if (choice.unit == delta) {
    if (!(sheet.rate_hz > 0.0))
      throw Error(ExitCode::kInput, std::string("increments in ") + delta + " need the rate_hz of a sheet");
    return {sheet.rate_hz, 0.0};
  }
  const double si = unit_in_si(quantity, choice.unit);
  std::string expected;
  if (si == 0.0 && !unit_fits(quantity, choice.unit, expected))
    throw Error(ExitCode::kInput, "unit '" + choice.unit + "': should be one of " + expected + ", " + delta);
  return {si, 0.0};
}

MappedMessages::MappedMessages(std::shared_ptr<const MessageMap> map, const SensorSheet& sheet)
    : map_(std::move(map)), reader_(*map_->types, map_->type, paths_of(*map_)) {
  gyro_ = map_->clock == MessageMap::Clock::kLog ? 0 : map_->time.fields.size();
  accel_ = gyro_ + map_->gyro.fields.size();
  angle_ = accel_ + map_->accel.fields.size();
  names_ = angle_ + map_->angle.fields.size();
  sequence_ = names_ + (map_->joint_names.empty() ? 0 : 1);
  const std::vector<std::string> paths = paths_of(*map_);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool text = reader_.kind(i) == LcmFieldReader::Kind::kText;
    if (text != (!map_->joint_names.empty() && i == names_))
      throw Error(ExitCode::kInput, "field '" + paths[i] + "' of " + map_->type + (text ? " is text" : " is no text"));
  }
  for (std::size_t i = 0; map_->clock == MessageMap::Clock::kSecondsAndNanoseconds && i < 2; ++i) {
    if (reader_.kind(i) != LcmFieldReader::Kind::kInteger)
      throw Error(ExitCode::kInput, "field '" + paths[i] + "' of " + map_->type +
                                        " is no integer: {field:, unit: s} reads seconds with a fraction");
  }
  if (sequence_ < paths.size() && reader_.kind(sequence_) != LcmFieldReader::Kind::kInteger)
    throw Error(ExitCode::kInput, "field '" + map_->sequence + "' of " + map_->type + " is no integer");
  if (map_->clock == MessageMap::Clock::kField) {
    time_si_ = unit_in_si("t", map_->time.unit);
    if (time_si_ == 0.0)
      throw Error(ExitCode::kInput, "unit '" + map_->time.unit + "': should be one of s, ms, us, ns");
  }
  if (!map_->gyro.fields.empty()) gyro_scale_ = scale_of("gyro_x", map_->gyro, sheet, "rad");
  if (!map_->accel.fields.empty()) accel_scale_ = scale_of("accel_x", map_->accel, sheet, "m/s");
  for (std::size_t i = 0; i < 2 && !map_->angle.fields.empty(); ++i) {
    if (map_->angle.unit == "ticks") {
      if (map_->ticks_per_turn[i] == 0.0) throw Error(ExitCode::kInput, "unit 'ticks' needs per_turn");
      angle_si_[i] = 2.0 * kPi / map_->ticks_per_turn[i];
    } else {
      angle_si_[i] = unit_in_si("azimuth", map_->angle.unit);
      if (angle_si_[i] == 0.0)
        throw Error(ExitCode::kInput, "unit '" + map_->angle.unit + "': should be one of rad, deg, ticks");
    }
  }
  if (sheet.rate_hz > 0.0) period_ = 1.0 / sheet.rate_hz;
}

std::size_t MappedMessages::count(std::size_t path) const {
  switch (reader_.kind(path)) {
    case LcmFieldReader::Kind::kInteger:
      return reader_.integers(path).size();
    case LcmFieldReader::Kind::kReal:
      return reader_.reals(path).size();
    case LcmFieldReader::Kind::kText:
      break;
  }
  return reader_.texts(path).size();
}

double MappedMessages::number(std::size_t path, std::size_t k) const {
  return reader_.kind(path) == LcmFieldReader::Kind::kReal ? reader_.reals(path)[k]
                                                           : static_cast<double>(reader_.integers(path)[k]);
}

/// Stamp number @p k [us], exact where the fields are integers.
std::string MappedMessages::time_of(const LcmEvent& event, std::size_t k, std::int64_t& utime) const {
  if (map_->clock == MessageMap::Clock::kLog) {
    utime = event.timestamp;
    return {};
  }
  if (reader_.kind(0) == LcmFieldReader::Kind::kInteger) {
    const std::int64_t t = reader_.integers(0)[k];
    if (map_->clock == MessageMap::Clock::kSecondsAndNanoseconds) {
      const double below = number(1, k);
      if (std::abs(static_cast<double>(t)) > kLatest || !(below >= 0.0 && below < 1e9)) return "the stamp is no time";
      utime = 1000000 * t + static_cast<std::int64_t>(below / 1000.0);
      return {};
    }
    if (map_->time.unit == "us") {
      utime = t;
      return {};
    }
    if (map_->time.unit == "ns") {
      utime = t / 1000;
      return {};
    }
  }
  const double t = number(0, k) * time_si_;
  if (!(std::abs(t) < kLatest)) return "the stamp is no time";
  utime = static_cast<std::int64_t>(std::llround(1e6 * t));
  return {};
}

Vec3<double> MappedMessages::triple(std::size_t first, std::size_t paths, std::size_t k, const Scale& scale) const {
  Vec3<double> v;
  for (std::size_t i = 0; i < 3; ++i) {
    const double raw = paths == 1 ? number(first, 3 * k + i) : number(first + i, k);
    v(static_cast<int>(i)) = (raw - scale.zero) * scale.si;
  }
  return v;
}

std::string MappedMessages::imu(const LcmEvent& event, std::vector<Sample>& samples) {
  samples.clear();
  if (!reader_.read(event.data)) return "is no whole message of type " + map_->type;
  const auto agree = [&](const FieldChoice& choice, std::size_t first, std::size_t& n) {
    const std::size_t paths = choice.fields.size();
    n = paths == 1 ? count(first) / 3 : count(first);
    if (paths == 1) return count(first) % 3 == 0;
    return count(first + 1) == n && count(first + 2) == n;
  };
  std::size_t n = 0;
  std::size_t of_accel = 0;
  if (!agree(map_->gyro, gyro_, n) || !agree(map_->accel, accel_, of_accel) || n != of_accel)
    return "has not three components of each sample";
  std::size_t stamps = n == 0 ? 0 : 1;
  if (map_->clock != MessageMap::Clock::kLog) {
    stamps = count(0);
    if (map_->clock == MessageMap::Clock::kSecondsAndNanoseconds && count(1) != stamps)
      return "has not a stamp for each sample";
  }
  if (n > 0 && stamps != n && stamps != 1) return "has not a stamp for each sample";
  if (n > 1 && stamps == 1 && period_ == 0.0)
    return "has one stamp for several samples: their rate_hz must be in the sheet";
  const std::size_t numbers = has_sequence() ? count(sequence_) : 0;
  samples.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    Sample& sample = samples[k];
    std::string wrong = time_of(event, stamps == n ? k : 0, sample.utime);
    if (!wrong.empty()) return wrong;
    if (stamps != n)
      sample.utime =
          ChannelClock::difference(sample.utime, std::llround(1e6 * period_ * static_cast<double>(n - 1 - k)));
    if (numbers == n) {
      sample.sequence = reader_.integers(sequence_)[k];
    } else if (numbers > 0) {
      sample.sequence = static_cast<std::int64_t>(static_cast<std::uint64_t>(reader_.integers(sequence_)[0]) + k);
    }
    sample.value.w = triple(gyro_, map_->gyro.fields.size(), k, gyro_scale_);
    sample.value.f = triple(accel_, map_->accel.fields.size(), k, accel_scale_);
  }
  return {};
}

std::string MappedMessages::encoder(const LcmEvent& event, std::int64_t& utime, std::int64_t& sequence,
                                    std::array<double, 2>& angle) {
  if (!reader_.read(event.data)) return "is no whole message of type " + map_->type;
  if (map_->clock != MessageMap::Clock::kLog && count(0) == 0) return "has no stamp";
  if (map_->clock == MessageMap::Clock::kSecondsAndNanoseconds && count(1) == 0) return "has no stamp";
  std::string wrong = time_of(event, 0, utime);
  if (!wrong.empty()) return wrong;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t paths = map_->angle.fields.size();
    std::size_t element = paths == 1 ? map_->elements[i] : 0;
    if (!map_->joint_names.empty()) {
      const auto& names = reader_.texts(names_);
      element = static_cast<std::size_t>(std::find(names.begin(), names.end(), map_->joints[i]) - names.begin());
      if (element == names.size()) return "has no joint '" + map_->joints[i] + "'";
    }
    const std::size_t path = angle_ + (paths == 1 ? 0 : i);
    if (element >= count(path)) return "has " + std::to_string(count(path)) + " angles";
    angle[i] = number(path, element) * angle_si_[i];
  }
  sequence = has_sequence() && count(sequence_) > 0 ? reader_.integers(sequence_)[0] : 0;
  return {};
}

}  // namespace trunnion::io
