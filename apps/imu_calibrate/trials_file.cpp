// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trials_file.hpp"

#include <algorithm>
#include <array>

#include "trunnion/comparison/trial.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

using Json = nlohmann::ordered_json;

bool is_figure(const Json& value) { return value.is_number() && value.get<double>() >= 0.0; }

bool is_method(const std::string& name, const Json& one) {
  const auto& known = comparison::kMethodNames;
  if (std::find(known.begin(), known.end(), name) == known.end() || !one.is_object()) return false;
  for (const auto& [key, value] : one.items()) {
    if (key == "failure" ? !value.is_string() : !is_figure(value)) return false;
  }
  return true;
}

bool is_navigation(const Json& one) {
  for (const char* const arm : {"raw", "calibrated", "floor"}) {
    if (!one.is_object() || !one.contains(arm) || !one.at(arm).is_object()) return false;
    for (const char* const name : {"position_m", "velocity_m_s", "attitude_deg"}) {
      if (!one.at(arm).contains(name) || !is_figure(one.at(arm).at(name))) return false;
    }
  }
  return true;
}

bool is_trial(const Json& trial) {
  if (!trial.is_object() || !trial.contains("seed") || !trial.at("seed").is_number_unsigned() ||
      !trial.contains("methods") || !trial.at("methods").is_object())
    return false;
  for (const auto& [name, one] : trial.at("methods").items()) {
    if (!is_method(name, one)) return false;
  }
  if (!trial.contains("navigations")) return true;
  const Json& navigations = trial.at("navigations");
  return navigations.is_array() && !navigations.empty() &&
         std::all_of(navigations.begin(), navigations.end(), [](const Json& one) { return is_navigation(one); });
}

}  // namespace

Json read_trials(const std::string& path) {
  Json tree = Json::parse(io::read_whole(path), nullptr, false);
  if (tree.is_discarded() || !tree.is_object() || !tree.contains("format") || tree.at("format") != kTrialsFormat ||
      !tree.contains("trials") || !tree.at("trials").is_array() || !tree.contains("settings"))
    throw Error(ExitCode::kInput, path + ": is no result file of trials");
  std::size_t number = 0;
  for (const Json& trial : tree.at("trials")) {
    ++number;
    if (!is_trial(trial))
      throw Error(ExitCode::kInput, path + ": trial " + std::to_string(number) +
                                        ": its seed, methods or navigations are not what trials writes");
  }
  return tree;
}

}  // namespace trunnion::app
