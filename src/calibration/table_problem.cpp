// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "table_problem.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "trunnion/calibration/noise_estimate.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kLargestClockOffset = 0.2;  // s
constexpr double kHuber = 4.0;               // sigmas
constexpr int kRobustRounds = 4;
constexpr double kWrongModel = 2.0;  // reduced chi-square of a recording
constexpr int kCoarseStride = 16;    // windows
constexpr std::size_t kTemperatureBins = 20;
constexpr double kMostWeight = 16.0;
constexpr double kMostBlind = 0.1;   // of the windows, without a temperature
constexpr double kLeastRange = 1.0;  // K
constexpr double kStrayTemperatures = 0.002;
constexpr double kColdest = -100.0;  // degC
constexpr double kHottest = 300.0;
constexpr double kNoiseStep = 1.0;  // s, of the residual series that the wander is estimated from

/// One recording as one block of the Ceres problem, in square-root information form: n + 1 residuals stand for all its
/// windows, with the same cost, gradient and J^T J, at a thousandth of the rows.
class RecordingCost final : public ceres::CostFunction {
 public:
  RecordingCost(const RecordingModel& model, const Layout& layout, const CalibrationValues& fixed)
      : model_(model), layout_(layout), fixed_(fixed) {
    mutable_parameter_block_sizes()->push_back(layout.size());
    set_num_residuals(layout.size() + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int n = layout_.size();
    Eigen::VectorXd scale(n);
    for (int i = 0; i < n; ++i) scale(i) = layout_.parameters[static_cast<std::size_t>(i)].scale;
    CalibrationValues values = fixed_;
    layout_.read(Eigen::Map<const Eigen::VectorXd>(parameters[0], n).cwiseProduct(scale), values);
    Eigen::Map<Eigen::VectorXd> r(residuals, n + 1);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      r.setZero();
      r(0) = std::sqrt(model_.evaluate(values, nullptr));
      return std::isfinite(r(0));
    }
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + 1, n + 1);
    model_.evaluate(values, &normal);
    if (!normal.allFinite()) return false;
    Eigen::VectorXd scale_1(n + 1);
    scale_1 << scale, 1.0;
    normal = scale_1.asDiagonal() * normal * scale_1.asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
    const Eigen::MatrixXd permutation = factor.transpositionsP() * Eigen::MatrixXd::Identity(n + 1, n + 1);
    Eigen::MatrixXd root = factor.matrixU();
    root = factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal() * root * permutation;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], n + 1, n);
    J = root.leftCols(n);
    r = root.col(n);
    return true;
  }

 private:
  const RecordingModel& model_;
  const Layout& layout_;
  const CalibrationValues& fixed_;
};

class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const Layout& layout, const Prior& prior)
      : size_(layout.size()), prior_(prior), scale_(layout.parameters[static_cast<std::size_t>(prior.index)].scale) {
    mutable_parameter_block_sizes()->push_back(size_);
    set_num_residuals(1);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = (parameters[0][prior_.index] * scale_ - prior_.mean) / prior_.sigma;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      std::fill_n(jacobians[0], size_, 0.0);
      jacobians[0][prior_.index] = scale_ / prior_.sigma;
    }
    return true;
  }

 private:
  int size_;
  Prior prior_;
  double scale_;
};

/// Of a symmetric matrix, by way of units in which its diagonal is one.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix, const std::vector<Parameter>& parameters) {
  Eigen::VectorXd unit(matrix.rows());
  for (Eigen::Index i = 0; i < unit.size(); ++i)
    unit(i) = matrix(i, i) > 0.0 ? 1.0 / std::sqrt(matrix(i, i)) : 1.0 / parameters[static_cast<std::size_t>(i)].scale;
  const Eigen::MatrixXd scaled = unit.asDiagonal() * matrix * unit.asDiagonal();
  const Eigen::MatrixXd inverse = scaled.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return unit.asDiagonal() * (0.5 * (inverse + inverse.transpose())) * unit.asDiagonal();
}

}  // namespace

TableProblem::TableProblem(const std::vector<TableRecording>& recordings, const Rig& rig, const Site& site,
                           const TableSolveOptions& options, bool running)
    : recordings_(recordings), rig_(rig), options_(options), temperature_(range_of(recordings)), layout_(request()) {
  if (recordings.size() > kMaxRecordings)
    throw Error(ExitCode::kInput, "more than " + std::to_string(kMaxRecordings) + " recordings in one run");
  start_.gravity = site.gravity;
  start_.clock_offset = options.clock_offset;
  if (layout_.thermal_order > 0) start_.unit.thermal.reference = temperature_.reference();
  for (std::size_t m = 0; m < kMaxMounts; ++m) start_.lever_arm[m] = rig.mount[m].lever_p;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    models_.push_back(std::make_unique<RecordingModel>(recordings[r], r, rig, site, layout_, options.clock_offset));
    const double ratio = models_.back()->force_at_rest() / site.gravity;
    if (ratio < 0.7 || ratio > 1.4) {
      throw Error(ExitCode::kInput, recordings[r].data.name + ": at rest the specific force is " +
                                        std::to_string(ratio) +
                                        " of gravity: wrong unit or nominal scale of the accelerometers");
    }
    if (models_.back()->windows() == 0) {
      throw Error(ExitCode::kInput, recordings[r].data.name +
                                        ": the encoders and the IMU do not overlap in time (IMU " +
                                        span(recordings[r]) + ")");
    }
  }
  for (const auto& model : models_) {
    const double ratio = model->rate_ratio();
    if (ratio < 0.7 || ratio > 1.4) {
      throw Error(ExitCode::kInput, recordings[model->index()].data.name + ": the gyros turn " + std::to_string(ratio) +
                                        " times as fast as the encoders: wrong unit or nominal scale of one of them");
    }
  }
  if (weighted()) weigh_evenly();
  priors_.push_back(gravity_prior(layout_, site));
  if (running) add_wide_priors();
}

Solution TableProblem::solve() {
  UnitNoise noise = options_.noise;
  if (options_.noise_from_data) noise = rest_noise();
  set_noise(noise);
  say("starting values");
  find_start();
  say("solving");
  reweigh();  // the coarse estimate is good enough to know an outlier by
  int iterations = minimise(start_);
  Eigen::VectorXd x;
  layout_.write(start_, x);
  if (!implausible(layout_.parameters, x).empty()) return conclude(noise, iterations);  // more rounds mend no mistake
  if (options_.noise_from_data) {
    for (int round = 0; round < 2; ++round) {
      say("noise from the residuals");
      reweigh();
      noise = residual_noise(noise);
      set_noise(noise);
      iterations += minimise(start_);
    }
  }
  for (int round = 0; round < kRobustRounds && reweigh(); ++round) {
    say("solving without outliers");
    iterations += minimise(start_);
  }
  say("covariance");
  return conclude(noise, iterations);
}

CalibrationValues TableProblem::estimate(const CalibrationValues& start, bool seek_heading) {
  start_ = start;
  set_noise(options_.noise_from_data ? rest_noise() : options_.noise);
  if (seek_heading) find_start();
  reweigh();
  minimise(start_);
  if (reweigh()) minimise(start_);
  return start_;
}

void TableProblem::add_wide_priors() {
  for (int i = 0; i < layout_.size(); ++i) {
    const Parameter& p = layout_.parameters[static_cast<std::size_t>(i)];
    if (i == layout_.gravity) continue;
    Eigen::VectorXd x;
    layout_.write(start_, x);
    priors_.push_back({i, x(i), i == layout_.heading ? scale(i) : kind_of(p.kind).largest / p.in_unit});
  }
}

LayoutRequest layout_request(const TableSolveOptions& options, const Rig& rig, const std::vector<int>& mounts,
                             double largest_rate) {
  LayoutRequest r;
  r.terms = options.terms;
  r.refuse_above = options.refuse_above;
  r.recordings = static_cast<int>(mounts.size());
  r.bias_per_recording = options.bias_per_recording;
  r.clock_offset = options.estimate_clock_offset;
  r.largest_rate = largest_rate;
  r.mounts = options.mount_names;
  for (int m = static_cast<int>(r.mounts.size()); m < rig.mounts; ++m)
    r.mounts.push_back("mount_" + std::to_string(m + 1));
  r.mount_used.assign(r.mounts.size(), false);
  for (const int mount : mounts) r.mount_used[static_cast<std::size_t>(mount)] = true;
  return r;
}

Prior gravity_prior(const Layout& layout, const Site& site) {
  return {layout.gravity, site.gravity, site.gravity_sigma};
}

void add_prior_information(const Layout& layout, const std::vector<Prior>& priors, Eigen::MatrixXd& information) {
  for (const Prior& prior : priors) information(prior.index, prior.index) += 1.0 / (prior.sigma * prior.sigma);
  const double circle = layout.parameters[static_cast<std::size_t>(layout.heading)].scale;
  information(layout.heading, layout.heading) += 1.0 / (circle * circle);
}

/// Temperatures that a recording stays at for long would carry a polynomial's fit: each twentieth of the range has the
/// same weight, be it long or short, within a factor of kMostWeight. The weights' mean is one.
/// docs/theory/calibration.md, eq. 38.
void TableProblem::weigh_evenly() {
  std::array<double, kTemperatureBins> count{};
  const auto bin = [&](double celsius) {
    const double at = (celsius - temperature_.lowest) / (temperature_.highest - temperature_.lowest);
    return std::min(static_cast<std::size_t>(kTemperatureBins * std::max(at, 0.0)), kTemperatureBins - 1);
  };
  double windows = 0.0;
  for (const auto& model : models_) {
    for (std::size_t k = 0; k < model->windows(); ++k) ++count[bin(model->window(k).temperature)];
    windows += static_cast<double>(model->windows());
  }
  const auto filled = static_cast<double>(std::count_if(count.begin(), count.end(), [](double n) { return n > 0.0; }));
  std::array<double, kTemperatureBins> weight{};
  double sum = 0.0;
  for (std::size_t b = 0; b < count.size(); ++b) {
    if (count[b] > 0.0) weight[b] = std::clamp(windows / filled / count[b], 1.0 / kMostWeight, kMostWeight);
    sum += count[b] * weight[b];
  }
  for (const auto& model : models_) {
    std::vector<float> weights(model->windows());
    for (std::size_t k = 0; k < weights.size(); ++k)
      weights[k] = static_cast<float>(weight[bin(model->window(k).temperature)] * windows / sum);
    model->set_weights(std::move(weights));
  }
}

TemperatureRange range_of(const std::vector<TableRecording>& recordings) {
  std::vector<double> all;
  for (const TableRecording& recording : recordings) {
    for (const ObservationWindow& window : recording.data.windows) {
      if (std::isfinite(window.temperature)) all.push_back(window.temperature);
    }
  }
  if (all.empty()) return {};
  const auto left_out = static_cast<std::ptrdiff_t>(kStrayTemperatures * static_cast<double>(all.size()));
  TemperatureRange range;
  std::nth_element(all.begin(), all.begin() + left_out, all.end());
  range.lowest = all[static_cast<std::size_t>(left_out)];
  std::nth_element(all.begin(), all.end() - 1 - left_out, all.end());
  range.highest = *(all.end() - 1 - left_out);
  return range;
}

std::string why_no_temperature(const std::vector<TableRecording>& recordings, const TemperatureRange& range) {
  for (const TableRecording& recording : recordings) {
    const auto& windows = recording.data.windows;
    const auto blind = std::count_if(windows.begin(), windows.end(),
                                     [&](const ObservationWindow& w) { return !range.holds(w.temperature); });
    if (static_cast<double>(blind) > kMostBlind * static_cast<double>(windows.size()))
      return recording.data.name + ": states no temperature" +
             (blind < static_cast<std::ptrdiff_t>(windows.size()) ? " for part of its time" : "");
  }
  char text[120];
  if (range.lowest < kColdest || range.highest > kHottest) {
    std::snprintf(text, sizeof text, "the temperatures are from %.1f to %.1f degC: are they in another unit?",
                  range.lowest, range.highest);
    return text;
  }
  if (range.highest - range.lowest > kLeastRange) return {};
  std::snprintf(text, sizeof text, "the temperature moves by %.2f K: too little to see what it does",
                range.highest - range.lowest);
  return text;
}

LayoutRequest TableProblem::request() const {
  std::vector<int> mounts;
  double largest_rate = 1e-3;
  for (const TableRecording& recording : recordings_) {
    mounts.push_back(recording.mount);
    for (const ObservationWindow& window : recording.data.windows)
      largest_rate = std::max(largest_rate, window.mean.w.cwiseAbs().maxCoeff());
  }
  if (options_.terms.temperature > 0) {
    const std::string why = why_no_temperature(recordings_, temperature_);
    if (!why.empty()) throw Error(ExitCode::kInput, why + " (model: temperature)");
  }
  LayoutRequest request = layout_request(options_, rig_, mounts, largest_rate);
  request.temperature = temperature_;
  return request;
}

std::string TableProblem::span(const TableRecording& recording) {
  const auto& windows = recording.data.windows;
  if (windows.empty()) return "has no samples";
  char text[128];
  std::snprintf(text, sizeof text, "%.3f s to %.3f s, encoders %.3f s to %.3f s", windows.front().t, windows.back().t,
                recording.data.course.begin(), recording.data.course.end());
  return text;
}

void TableProblem::say(const char* stage) const {
  if (options_.progress) options_.progress(stage);
}

void TableProblem::set_noise(const UnitNoise& noise) {
  for (auto& model : models_) model->set_noise(noise);
}

void TableProblem::set_stride(std::size_t stride) {
  for (auto& model : models_) model->set_stride(stride);
}

UnitNoise TableProblem::rest_noise() const {
  std::vector<double> gyro;
  std::vector<double> accel;
  for (const auto& model : models_) model->rest_noise(gyro, accel);
  if (gyro.size() < 300) {
    throw Error(ExitCode::kInput,
                "no sheet, and less than ten seconds at rest to tell the noise from: add a sheet, or rests to the run");
  }
  const auto density = [](std::vector<double>& v) {
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
    std::nth_element(v.begin(), middle, v.end());
    return *middle / 0.6744897501960817;
  };
  UnitNoise noise;
  noise.gyro.density = density(gyro);
  noise.accel.density = density(accel);
  if (!(noise.gyro.density > 0.0) || !(noise.accel.density > 0.0)) {
    throw Error(ExitCode::kInput, "the recordings are free of noise at rest: state the noise in a sheet");
  }
  return noise;
}

UnitNoise TableProblem::residual_noise(UnitNoise noise) const {
  std::vector<ResidualSeries> gyro;
  std::vector<ResidualSeries> accel;
  for (const auto& model : models_) {
    std::array<ResidualSeries, 6> series;
    std::array<double, 6> sum{};
    std::array<int, 6> count{};
    std::array<double, 6> until{};
    until.fill(model->window(0).t + kNoiseStep);
    model->residuals(start_, [&](std::size_t k, int row, double residual, double) {
      const auto c = static_cast<std::size_t>(row);
      const double t = model->window(k).t;
      if (t >= until[c]) {
        if (count[c] > 0) series[c].value.push_back(sum[c] / count[c]);
        sum[c] = 0.0;
        count[c] = 0;
        until[c] += kNoiseStep * std::max(1.0, std::floor((t - until[c]) / kNoiseStep) + 1.0);
      }
      if (model->inflation()[k][c] == 1.0F) {
        sum[c] += residual;
        ++count[c];
      }
    });
    for (std::size_t c = 0; c < 6; ++c) {
      series[c].step = kNoiseStep;
      (c < 3 ? gyro : accel).push_back(std::move(series[c]));
    }
  }
  noise.gyro = estimate_noise(gyro, noise.gyro.density);
  noise.accel = estimate_noise(accel, noise.accel.density);
  return noise;
}

/// A heading that may be anything: the best of four, on every sixteenth window.
void TableProblem::find_start() {
  set_stride(kCoarseStride);
  CalibrationValues best = start_;
  double lowest = std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    CalibrationValues candidate = start_;
    candidate.rig.heading = 0.5 * kPi * quarter;
    double cost = 0.0;
    minimise(candidate, &cost, 4);
    if (cost < lowest) {
      lowest = cost;
      best = candidate;
    }
  }
  set_stride(1);
  start_ = best;
  start_.rig.heading = std::remainder(start_.rig.heading, 2.0 * kPi);
}

int TableProblem::minimise(CalibrationValues& values, double* cost, int most_iterations) {
  Eigen::VectorXd x;
  layout_.write(values, x);
  const int n = layout_.size();
  for (int i = 0; i < n; ++i) x(i) /= scale(i);
  ceres::Problem problem;
  problem.AddParameterBlock(x.data(), n);
  for (const auto& model : models_)
    problem.AddResidualBlock(new RecordingCost(*model, layout_, values), nullptr, x.data());
  for (const Prior& prior : priors_) problem.AddResidualBlock(new PriorCost(layout_, prior), nullptr, x.data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.num_threads =
      options_.threads > 0 ? options_.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  solver.max_num_iterations = most_iterations;
  solver.initial_trust_region_radius = 1e8;
  solver.function_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-11;
  solver.gradient_tolerance = 1e-14;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  const bool failed = summary.termination_type == ceres::FAILURE;
  if (cost == nullptr) converged_ = !failed && summary.termination_type != ceres::NO_CONVERGENCE;
  for (int i = 0; i < n; ++i) x(i) *= scale(i);
  layout_.read(x, values);
  if (cost != nullptr) *cost = failed ? std::numeric_limits<double>::infinity() : summary.final_cost;
  return static_cast<int>(summary.iterations.size());
}

/// Huber weights from the innovations. @return whether more than one row in ten thousand changed by a tenth
bool TableProblem::reweigh() {
  std::size_t changed = 0;
  std::size_t rows = 0;
  for (auto& model : models_) {
    std::vector<std::array<float, 6>> next = model->inflation();
    model->residuals(start_, [&](std::size_t k, int row, double, double innovation) {
      float& inflation = next[k][static_cast<std::size_t>(row)];
      // the innovation was divided by an inflated sigma: undo that
      const double size = std::abs(innovation) * std::sqrt(static_cast<double>(inflation));
      const float before = inflation;
      inflation = size > kHuber ? static_cast<float>(size / kHuber * (size / kHuber)) : 1.0F;
      changed += std::abs(inflation - before) > 0.1F * inflation ? 1U : 0U;
      ++rows;
    });
    model->inflation() = std::move(next);
  }
  return changed * 10000 > rows;
}

/// What the fit says against the sigmas: none when it says that the model is wrong; wider ones when it says that the
/// noise is larger than stated.
void TableProblem::hold_against_the_data(Observability& observability, const Fit& worst, double chi_square) const {
  if (!converged_) {
    throw Error(
        ExitCode::kNumerics,
        "the solve did not converge; worst fit in " + worst.name +
            ". Look at the order of the encoder axes, their signs and units, and which mount each recording is of");
  }
  if (options_.estimate_clock_offset && std::abs(start_.clock_offset) > kLargestClockOffset) {
    throw Error(
        ExitCode::kInput,
        "the IMU's clock is more than 0.2 s off the encoder's: state clock.imu_to_encoder_offset in the run file");
  }
  if (worst.chi_square > kWrongModel) {
    throw Error(
        ExitCode::kNumerics,
        "the data do not fit the model: reduced chi-square " + std::to_string(worst.chi_square) + " in " + worst.name +
            ". Look at the mount of each recording, the signs and units of the encoders and a stated clock offset; "
            "then: the unit is noisier than its sheet (leave the sheet out), its clock drifts, the encoders fail, or "
            "the model lacks a term (solve --model auto looks for it)");
  }
  if (chi_square > 1.0) observability.covariance *= chi_square;
}

Solution TableProblem::conclude(const UnitNoise& noise, int iterations) {
  const int n = layout_.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd squared = Eigen::MatrixXd::Zero(n + 1, n + 1);  // of weighted rows, with the weights' squares
  double cost = 0.0;
  double rows = 0.0;
  Fit worst;
  for (const auto& model : models_) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + 1, n + 1);
    model->evaluate(start_, &normal);
    information += normal.topLeftCorner(n, n);
    if (weighted()) model->evaluate(start_, &squared, 2);
    cost += normal(n, n);
    rows += 6.0 * static_cast<double>(model->windows());
    const double chi_square = normal(n, n) / (6.0 * model->total_weight());
    if (chi_square > worst.chi_square) worst = {chi_square, recordings_[model->index()].data.name};
  }
  const double freedom = std::max(1.0, rows - n);
  add_prior_information(layout_, priors_, information);

  Solution solution;
  solution.parameters = layout_.parameters;
  layout_.write(start_, solution.x);
  solution.observability = judge(information, layout_.parameters);
  if (weighted() && solution.observability.refused.empty()) {
    Eigen::MatrixXd middle = squared.topLeftCorner(n, n);
    add_prior_information(layout_, priors_, middle);
    const Eigen::MatrixXd& C = solution.observability.covariance;
    // the information that a weighted estimate has: the gate and the covariance are of that
    solution.observability = judge(inverse_of(C * middle * C, layout_.parameters), layout_.parameters);
  }
  if (solution.observability.refused.empty()) {
    const std::string beyond = converged_ ? implausible(solution.parameters, solution.x) : std::string();
    if (!beyond.empty()) {
      throw Error(ExitCode::kInput,
                  "the solution is no small correction of what the files say; look at the rig's drawing (radians), the "
                  "mount of each recording, the zeros, signs and units of the encoders:\n" +
                      beyond);
    }
    hold_against_the_data(solution.observability, worst, cost / freedom);
  }
  solution.noise = noise;
  solution.gauge = {"pitch_encoder_zero", request().mounts.front() + "_datum"};
  CalibrationRecord& record = solution.record;
  record.value = start_;
  if (layout_.thermal_order > 0) {
    ThermalErrors<double>& thermal = record.value.unit.thermal;
    thermal.lowest = temperature_.highest;
    thermal.highest = temperature_.lowest;
    for (const auto& model : models_) {
      for (std::size_t k = 0; k < model->windows(); ++k) {
        thermal.lowest = std::min(thermal.lowest, model->window(k).temperature);
        thermal.highest = std::max(thermal.highest, model->window(k).temperature);
      }
    }
  }
  record.value.rig.heading = std::remainder(record.value.rig.heading, 2.0 * kPi);
  record.sigma = layout_.sigmas(solution.observability.covariance);
  record.has_rig = true;
  record.mounts = rig_.mounts;
  record.recordings = static_cast<int>(recordings_.size());
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const RecordingFigures& figures = recordings_[r].data.figures;
    record.recording_mount[r] = recordings_[r].mount;
    record.fit.samples += figures.samples;
    record.fit.windows += static_cast<long long>(models_[r]->windows());
    record.fit.outliers += figures.outliers + recordings_[r].data.course.outliers();
    for (const auto& inflation : models_[r]->inflation()) {
      record.fit.outliers +=
          std::any_of(inflation.begin(), inflation.end(), [](float row) { return row > 1.0F; }) ? 1 : 0;
    }
  }
  record.fit.reduced_chi_square = cost / freedom;
  record.fit.iterations = iterations;
  return solution;
}

}  // namespace trunnion::calibration
