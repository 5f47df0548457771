// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "state.hpp"

#include <nlohmann/json.hpp>

namespace trunnion::app {

const char* name_of(Phase phase) {
  switch (phase) {
    case Phase::kWaiting:
      return "waiting";
    case Phase::kRecording:
      return "recording";
    case Phase::kSolving:
      return "solving";
    case Phase::kDone:
      return "done";
    case Phase::kFailed:
      break;
  }
  return "failed";
}

std::string SharedState::json() const {
  using Json = nlohmann::ordered_json;
  const LiveState s = copy();
  const auto channel = [](const LiveState::Channel& c) {
    return Json{{"rate_hz", c.rate_hz}, {"silent_s", c.silent_s}, {"samples", c.samples},
                {"lost", c.lost},       {"late", c.late},         {"damaged", c.damaged}};
  };
  Json json = {{"schema", "trunnion/live/1"},
               {"phase", name_of(s.phase)},
               {"model", s.model},
               {"mount", s.mount},
               {"recording", s.recording},
               {"recordings", s.recordings},
               {"guidance", s.guidance},
               {"enough", s.enough},
               {"duration_s", s.duration},
               {"imu", channel(s.imu)},
               {"encoder", channel(s.encoder)},
               {"saturated", s.saturated},
               {"strays", s.strays},
               {"chi_square", s.chi_square},
               {"within", s.within},
               {"verdict", s.verdict},
               {"out_of_limits", s.out_of_limits},
               {"output", s.output}};
  json["steps"] = Json::array();
  for (const auto& step : s.steps)
    json["steps"].push_back({{"text", step.text}, {"seen_s", step.seen}, {"asked_s", step.asked}});
  json["entries"] = Json::array();
  for (const auto& e : s.entries)
    json["entries"].push_back(
        {{"name", e.name}, {"unit", e.unit}, {"value", e.value}, {"sigma", e.sigma}, {"limit", e.limit}});
  json["notices"] = Json::array();
  for (const auto& n : s.notices) json["notices"].push_back({{"t_s", n.t}, {"text", n.text}});
  Json t = Json::array();
  Json azimuth = Json::array();
  Json pitch = Json::array();
  Json gyro = Json::array({Json::array(), Json::array(), Json::array()});
  for (const auto& p : s.plot) {
    t.push_back(p.t);
    azimuth.push_back(p.azimuth_rate);
    pitch.push_back(p.pitch);
    for (std::size_t i = 0; i < 3; ++i) gyro[i].push_back(p.gyro[i]);
  }
  json["plot"] = {{"t_s", t}, {"azimuth_deg_s", azimuth}, {"pitch_deg", pitch}, {"gyro_deg_s", gyro}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace trunnion::app
