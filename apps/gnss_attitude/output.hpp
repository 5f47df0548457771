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

/// 1 sigma of roll, pitch and yaw [rad]; not a number for an angle that is mostly the one about the free axis. What
/// that one, by convention the body's z as low as can be, moves of the others is in their sigma, with kLevel.
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
  [[nodiscard]] long long but_for_the_length(std::size_t slave) const { return free_[slave]; }
  /// Their mean length without it [m].
  [[nodiscard]] double free_length(std::size_t slave) const {
    return free_length_[slave] / static_cast<double>(free_[slave]);
  }
  /// Epochs in which a slave's baseline was measured, and its mean length [m].
  [[nodiscard]] long long measured(std::size_t slave) const { return measured_[slave]; }
  [[nodiscard]] double length(std::size_t slave) const {
    return length_[slave] / static_cast<double>(measured_[slave]);
  }
  /// Why epochs were not fixed, in words; for when none was.
  [[nodiscard]] std::string why_not() const;

 private:
  std::map<AttitudeStatus, long long> counts_;
  std::map<Status, long long> reasons_;
  std::array<double, 2> length_{};
  std::array<double, 2> square_{};
  std::array<long long, 2> measured_{};
  std::array<double, 2> free_length_{};
  std::array<long long, 2> free_{};
  double misfit_ = 0.0, degrees_ = 0.0;
  long long epochs_ = 0, silent_ = 0, refused_ = 0, excluded_ = 0;
  Vec3<double> sine_ = Vec3<double>::Zero();
  Vec3<double> cosine_ = Vec3<double>::Zero();
  Vec3<double> sigma_ = Vec3<double>::Zero();
  std::array<long long, 3> angles_{};
};

}  // namespace trunnion::app
