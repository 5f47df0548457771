// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "channel_yaml.hpp"

#include <algorithm>
#include <cstddef>

#include "trunnion/core/error.hpp"

namespace trunnion::io {
namespace {

std::vector<std::string> list_of(const StrictYaml& node) {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < node.length(); ++i) list.push_back(node.at(i).text());
  return list;
}

/// {field: path, unit: u} or {fields: [...], unit: u}.
FieldChoice choice_of(const StrictYaml& node, std::size_t components) {
  FieldChoice choice;
  choice.unit = node.at("unit").text();
  if (node.has("field") == node.has("fields")) node.fail("should have either field or fields");
  if (node.has("field")) {
    choice.fields = {node.at("field").text()};
  } else {
    choice.fields = list_of(node.at("fields"));
    if (choice.fields.size() != components)
      node.at("fields").fail("should be " + std::to_string(components) + " paths, one a component");
  }
  return choice;
}

void read_time(const StrictYaml& node, MessageMap& map) {
  if (!node.is_map()) {
    if (node.text() != "log") node.fail("should be log, {field:, unit:} or {seconds:, nanoseconds:}");
    map.clock = MessageMap::Clock::kLog;
    return;
  }
  node.only({"field", "unit", "seconds", "nanoseconds"});
  if (node.has("seconds")) {
    map.clock = MessageMap::Clock::kSecondsAndNanoseconds;
    map.time.fields = {node.at("seconds").text(), node.at("nanoseconds").text()};
    map.time.unit = "s";
    return;
  }
  map.clock = MessageMap::Clock::kField;
  map.time = choice_of(node, 1);
}

void read_angle(const StrictYaml& node, MessageMap& map) {
  node.only({"field", "fields", "unit", "per_turn", "names", "joints", "elements"});
  if (map.angle.fields.empty() || node.has("unit")) map.angle = choice_of(node, 2);
  if (node.has("per_turn")) {
    const StrictYaml ticks = node.at("per_turn");
    for (std::size_t i = 0; i < 2; ++i) {
      const StrictYaml one = ticks.is_sequence() ? ticks.at(i) : ticks;
      map.ticks_per_turn[i] = one.number();
      if (map.ticks_per_turn[i] == 0.0) one.fail("should not be zero");
    }
  }
  if (node.has("names")) map.joint_names = node.at("names").text();
  if (node.has("joints") || node.has("names")) {
    if (node.at("joints").length() != 2) node.at("joints").fail("should be two names, outer and inner");
    map.joints = {node.at("joints").at(0).text(), node.at("joints").at(1).text()};
  }
  if (node.has("elements")) {
    for (std::size_t i = 0; i < 2; ++i) {
      const long long element = node.at("elements").at(i).integer();
      if (element < 0 || element > 10000) node.at("elements").fail("should be two places from 0, outer and inner");
      map.elements[i] = static_cast<std::size_t>(element);
    }
  }
}

}  // namespace

ChannelChoice read_channel(const StrictYaml& node, bool is_imu, const std::shared_ptr<const LcmTypes>& types,
                           const SensorSheet& sheet) {
  if (!node.is_map()) return {node.text(), nullptr};
  node.only(is_imu ? std::vector<std::string>{"channel", "preset", "type", "time", "gyro", "accel", "sequence"}
                   : std::vector<std::string>{"channel", "preset", "type", "time", "angle", "sequence"});
  ChannelChoice choice;
  MessageMap map;
  if (node.has("preset")) {
    if (node.has("type")) node.at("type").fail("is the preset's: state one of them");
    std::vector<std::string> names;
    for (const MessagePreset& preset : message_presets()) {
      if (preset.is_imu == is_imu) names.push_back(preset.name);
    }
    const std::string name = node.at("preset").text();
    if (std::find(names.begin(), names.end(), name) == names.end())
      node.at("preset").fail("unknown preset '" + name + "'; did you mean '" + nearest(name, names) + "'?");
    const MessagePreset& preset = message_preset(name);
    choice.name = preset.channel;
    map = preset.map;
  } else {
    map.types = types;
    map.type = node.at("type").text();
  }
  if (node.has("channel")) choice.name = node.at("channel").text();
  if (choice.name.empty()) node.fail("has no channel, and the preset does not know it");
  if (node.has("time") || !node.has("preset")) read_time(node.at("time"), map);
  if (is_imu) {
    for (const auto& [key, into] : {std::pair{"gyro", &map.gyro}, std::pair{"accel", &map.accel}}) {
      if (node.has("preset") && !node.has(key)) continue;
      node.at(key).only({"field", "fields", "unit"});
      *into = choice_of(node.at(key), 3);
    }
  } else if (!node.has("preset") || node.has("angle")) {
    read_angle(node.at("angle"), map);
  }
  if (node.has("sequence")) map.sequence = node.at("sequence").text();
  choice.map = std::make_shared<const MessageMap>(std::move(map));
  try {
    static_cast<void>(MappedMessages(choice.map, sheet));
  } catch (const Error& e) {
    node.fail(e.what());
  }
  return choice;
}

}  // namespace trunnion::io
