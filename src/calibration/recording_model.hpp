// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One recording against the model: residuals of its windows, whitened, and their normal equations.
///
/// A row (one sensor of one window) depends on 25 unknowns only: nine of its own sensor, thirteen of the rig and three
/// of the mount; with terms of temperature on ten more of its sensor. Rig derivatives come from the rung-1 table in
/// automatic-differentiation numbers; the rest is linear.

#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "trunnion/calibration/parameters.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "whitening.hpp"

namespace trunnion::calibration {

class RecordingModel {
 public:
  /// What a pass carries along with the residual, which is counted: nothing, or derivatives without those of
  /// temperature or with them.
  enum class Rows : int { kNone = 1, kPlain = 26, kThermal = 36 };

  /// @param index of the recording in the layout. @param clock_offset where the encoders are looked for first [s] The
  /// references must outlive the model.
  RecordingModel(const TableRecording& recording, std::size_t index, const Rig& rig, const Site& site,
                 const Layout& layout, double clock_offset);

  /// Takes in the windows that came, and for which the encoders are there.
  void refresh();

  /// Windows that have samples and encoders on all sides.
  [[nodiscard]] std::size_t windows() const { return usable_.size(); }
  [[nodiscard]] const ObservationWindow& window(std::size_t k) const { return recording_.data.windows[usable_[k]]; }

  void set_noise(const UnitNoise& noise) { noise_ = noise; }
  /// Looks at every n-th window only.
  void set_stride(std::size_t stride) { stride_ = stride; }
  /// Robust inflation of the measurement variance: per window, rows 0-2 gyro, 3-5 accelerometer; 1 is full weight.
  [[nodiscard]] std::vector<std::array<float, 6>>& inflation() { return inflation_; }
  [[nodiscard]] const std::vector<std::array<float, 6>>& inflation() const { return inflation_; }

  /// A weight for each window, rows and cost times it; empty: one.
  void set_weights(std::vector<float> weights) { weights_ = std::move(weights); }
  /// Of all windows: their number where there are no weights.
  [[nodiscard]] double total_weight() const {
    return weights_.empty() ? static_cast<double>(windows()) : std::accumulate(weights_.begin(), weights_.end(), 0.0);
  }

  /// Sum of the squared innovations, weighted. With @p normal also adds J^T J, J^T r and r^T r over (unknowns,
  /// residual). @param power of the weights: 2 for the covariance of a weighted sum
  double evaluate(const CalibrationValues& values, Eigen::MatrixXd* normal, int power = 1) const;

  using Visit = std::function<void(std::size_t window, int row, double residual, double innovation)>;
  /// Calls @p visit for every row.
  void residuals(const CalibrationValues& values, const Visit& visit) const;

  [[nodiscard]] std::size_t index() const { return index_; }

  /// Median specific force of the slow windows [m/s^2]; gravity where there are none.
  [[nodiscard]] double force_at_rest() const;

  /// Median of the gyros' rate, less its mean at rest, against the encoders' over the turning windows; 1 where there
  /// is neither.
  [[nodiscard]] double rate_ratio() const;

  /// Adds |step| between neighbouring windows at rest, scaled to a noise density.
  void rest_noise(std::vector<double>& gyro, std::vector<double>& accel) const;

 private:
  struct Model;
  struct WindowInput;
  template <Rows kRows>
  struct Pass;

 public:
  /// Normal equations at one estimate, to which windows are added as they come. Without terms of temperature.
  class Linearisation {
   public:
    /// The model must outlive it.
    Linearisation(const RecordingModel& model, const CalibrationValues& values);
    Linearisation(Linearisation&& other) noexcept;
    ~Linearisation();
    /// Takes the windows since the last call.
    void extend(const Visit& visit);
    /// Adds J^T J, J^T r and r^T r as evaluate() does.
    void add_to(Eigen::MatrixXd& normal);

   private:
    const RecordingModel* model_;
    std::unique_ptr<Pass<Rows::kPlain>> pass_;
  };

 private:
  [[nodiscard]] double variance(std::size_t k, int row, bool moving) const;
  template <class T>
  [[nodiscard]] AxisMotion<T> motion(const CourseValue& reading) const;
  template <Rows kRows, class VisitRow>
  double run(const CalibrationValues& values, Eigen::MatrixXd* normal, int power, VisitRow&& visit) const;
  template <Rows kRows, class VisitRow>
  void advance(Pass<kRows>& pass, VisitRow&& visit) const;
  [[nodiscard]] std::size_t mount() const { return static_cast<std::size_t>(recording_.mount); }
  template <bool kWithRows>
  bool window_input(const Model& model, const ObservationWindow& window, double offset, bool has_places,
                    WindowInput& in) const;
  void add_derivatives(const Model& model, const std::array<CourseValue, 2>& reading, double weight,
                       WindowInput& in) const;
  template <Rows kRows>
  void scatter(Pass<kRows>& pass, Eigen::MatrixXd& into) const;
  template <class RowNormal>
  void scatter_row(int row, const RowNormal& normal, Eigen::MatrixXd& into) const;

  const TableRecording& recording_;
  std::size_t index_;
  double first_offset_;  // of the clocks, where the encoders are looked for
  std::size_t examined_ = 0;
  const Rig& rig_;
  const Site& site_;
  const Layout& layout_;
  std::vector<std::size_t> usable_;
  std::vector<std::array<float, 6>> inflation_;
  std::vector<float> weights_;
  UnitNoise noise_;
  double encoder_variance_ = 0.0;  // of a window's mean rate
  double angle_variance_ = 0.0;    // of a window's mean angle, as one of many in a rest
  std::size_t stride_ = 1;
};

}  // namespace trunnion::calibration
