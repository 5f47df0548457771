// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitudes as a table, as LCM messages, and as figures in one record.

#pragma once

#include <array>
#include <map>
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
class AttitudeFigures {
 public:
  void add(const Solution& solution);
  [[nodiscard]] nlohmann::ordered_json json(const EngineOptions& options) const;
  /// Epochs, those that are fixed or held, and those that fit but for the stated length.
  [[nodiscard]] long long epochs() const { return epochs_; }
  [[nodiscard]] long long sure() const;
  [[nodiscard]] long long but_for_the_length() const { return free_; }
  /// Their mean length without it [m].
  [[nodiscard]] double free_length() const { return free_length_ / static_cast<double>(free_); }
  /// Why epochs were not fixed, in words; for when none was.
  [[nodiscard]] std::string why_not() const;

 private:
  std::map<AttitudeStatus, long long> counts_;
  std::map<Status, long long> reasons_;
  std::array<double, 2> length_{};
  std::array<double, 2> square_{};
  std::array<long long, 2> measured_{};
  double misfit_ = 0.0, degrees_ = 0.0, free_length_ = 0.0;
  long long epochs_ = 0, free_ = 0, silent_ = 0, refused_ = 0, excluded_ = 0;
  Vec3<double> sine_ = Vec3<double>::Zero();
  Vec3<double> cosine_ = Vec3<double>::Zero();
  Vec3<double> sigma_ = Vec3<double>::Zero();
  std::array<long long, 3> angles_{};
};

}  // namespace trunnion::app
