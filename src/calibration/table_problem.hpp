// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The least-squares problem of a table run: what the batch solve and the running estimate stand on.

#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "recording_model.hpp"
#include "trunnion/calibration/parameters.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"

namespace trunnion::calibration {

/// Prior knowledge of one unknown: (x - mean) / sigma.
struct Prior {
  int index;
  double mean;
  double sigma;
};

/// @param mounts of the recordings, indices into Rig::mount. @param largest_rate rad/s, of the data
LayoutRequest layout_request(const TableSolveOptions& options, const Rig& rig, const std::vector<int>& mounts,
                             double largest_rate);

/// Of the windows, but for the hottest and the coldest two in a thousand: one wrong reading makes no range.
TemperatureRange range_of(const std::vector<TableRecording>& recordings);

/// Why these recordings cannot have terms of temperature; empty where they can.
std::string why_no_temperature(const std::vector<TableRecording>& recordings, const TemperatureRange& range);

Prior gravity_prior(const Layout& layout, const Site& site);

/// What is known before: the priors, and that a heading is on the circle. It may be anything there, and is nobody's
/// calibration: its flat prior is knowledge enough.
void add_prior_information(const Layout& layout, const std::vector<Prior>& priors, Eigen::MatrixXd& information);

class TableProblem {
 public:
  /// @param running for data that are not all there yet: every unknown has a prior as wide as an instrument can be
  /// wrong, and the heading one over the circle. The references must outlive the problem.
  /// @throws Error (input) for a recording whose units or nominal scales cannot be right
  TableProblem(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
               const TableSolveOptions& options, bool running = false);

  Solution solve();

  /// The estimate from @p start on, outliers weighed down; looks for the heading where @p seek_heading.
  CalibrationValues estimate(const CalibrationValues& start, bool seek_heading);

  [[nodiscard]] const Layout& layout() const { return layout_; }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }
  /// One a recording.
  [[nodiscard]] std::vector<std::unique_ptr<RecordingModel>>& models() { return models_; }

 private:
  /// How badly a recording fits.
  struct Fit {
    double chi_square = 0.0;
    std::string name;
  };

  [[nodiscard]] LayoutRequest request() const;
  static std::string span(const TableRecording& recording);
  void say(const char* stage) const;
  [[nodiscard]] bool weighted() const { return layout_.thermal_order > 0 && options_.even_temperatures; }
  void weigh_evenly();
  void set_noise(const UnitNoise& noise);
  void set_stride(std::size_t stride);
  [[nodiscard]] UnitNoise rest_noise() const;
  [[nodiscard]] UnitNoise residual_noise(UnitNoise noise) const;
  void find_start();
  int minimise(CalibrationValues& values, double* cost = nullptr, int most_iterations = 30);
  bool reweigh();
  [[nodiscard]] double scale(int i) const { return layout_.parameters[static_cast<std::size_t>(i)].scale; }
  void add_wide_priors();
  void hold_against_the_data(Observability& observability, const Fit& worst, double chi_square) const;
  Solution conclude(const UnitNoise& noise, int iterations);

  const std::vector<TableRecording>& recordings_;
  const Rig& rig_;
  const TableSolveOptions& options_;
  TemperatureRange temperature_;
  Layout layout_;
  CalibrationValues start_;  // and, after each minimise(), the current estimate
  std::vector<std::unique_ptr<RecordingModel>> models_;
  std::vector<Prior> priors_;
  bool converged_ = false;  // the last full solve
};

}  // namespace trunnion::calibration
