// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitudes as a table, as LCM messages, and as figures in one record.

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "receivers.hpp"

namespace trunnion::app {

/// "fixed", "held", ...
const char* status_name(AttitudeStatus status);

/// 1 sigma of roll, pitch and yaw [rad]; not a number for an angle that the free axis moves.
Vec3<double> euler_sigma(const AttitudeEstimate<double>& attitude);

/// CSV: header and rows. Angles that are not observable, and what an epoch has not, are empty.
void write_attitude_csv(const std::string& path, const std::vector<Solution>& solutions);
/// One line of the table, without a newline.
std::string attitude_row(const Solution& solution);
/// An LCM log of attitude_t on @p channel.
void write_attitude_log(const std::string& path, const std::string& channel, const std::vector<Solution>& solutions);
io::AttitudeMessage message_of(const Solution& solution, std::int64_t sequence);

/// Counts of each status, what the baselines measure against what was stated, and how steady the angles are.
nlohmann::ordered_json attitude_summary(const std::vector<Solution>& solutions, const EngineOptions& options);

}  // namespace trunnion::app
