// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/sequential_solve.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>

#include "table_problem.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::calibration {
namespace {

constexpr std::size_t kEnough = 50;  // windows of a recording
constexpr double kGrown = 1.33;      // windows since the last linearisation
constexpr double kSettled = 1.1;     // ... before a move of the estimate is followed
constexpr double kMoved = 0.5;       // sigmas
constexpr double kMisfit = 3.0;      // reduced chi-square of the last windows: the estimate does not know them yet
constexpr double kLargestSquare = 1e6;
constexpr std::size_t kRecent = 50;    // windows
constexpr double kKnownHeading = 0.1;  // rad, 1 sigma: no other quarter can be meant
constexpr double kFloor = 1e-300;

}  // namespace

struct SequentialSolve::State {
  State(const Rig& r, const Site& s, TableSolveOptions o) : rig(r), site(s), options(std::move(o)) {
    options.terms.temperature = 0;  // its range is not known before the end
  }

  [[nodiscard]] std::size_t usable() const {
    std::size_t windows = 0;
    for (const auto& model : problem->models()) windows += model->windows();
    return windows;
  }

  /// From the estimate so far, over all windows.
  void linearise() {
    linearisations.clear();
    problem.reset();
    auto next = std::make_unique<TableProblem>(recordings, rig, site, options, true);
    at = next->estimate(estimate.values, !(heading_sigma < kKnownHeading));
    problem = std::move(next);
    for (const auto& model : problem->models()) linearisations.emplace_back(*model, at);
    recent.clear();
    extend();
    estimate.chi_square = recent_chi_square();
    linearised = usable();
    ++estimate.linearisations;
  }

  /// Adds the windows that came to the normal equations, and looks how the last recording's last ones fit.
  void extend() {
    for (std::size_t r = 0; r < linearisations.size(); ++r) {
      const bool last = r + 1 == linearisations.size();
      const RecordingModel& model = *problem->models()[r];
      linearisations[r].extend([&](std::size_t window, int row, double, double innovation) {
        if (!last) return;
        // as if it had full weight
        const auto inflation = static_cast<double>(model.inflation()[window][static_cast<std::size_t>(row)]);
        recent.push_back(std::min(innovation * innovation * inflation, kLargestSquare));
        if (recent.size() > 6 * kRecent) recent.pop_front();
      });
    }
  }

  [[nodiscard]] double recent_chi_square() const {
    if (recent.size() < 6 * kRecent) return 0.0;
    return std::accumulate(recent.begin(), recent.end(), 0.0) / static_cast<double>(recent.size());
  }

  /// Eq. (1).
  void solve() {
    const Layout& layout = problem->layout();
    const int n = layout.size();
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + 1, n + 1);
    for (auto& linearisation : linearisations) linearisation.add_to(normal);
    Eigen::VectorXd x;
    layout.write(at, x);
    Eigen::VectorXd scale(n);
    for (int i = 0; i < n; ++i) scale(i) = layout.parameters[static_cast<std::size_t>(i)].scale;
    Eigen::MatrixXd N = scale.asDiagonal() * normal.topLeftCorner(n, n) * scale.asDiagonal();
    Eigen::VectorXd b = scale.cwiseProduct(normal.topRightCorner(n, 1));
    for (const Prior& prior : problem->priors()) {
      const double weight = scale(prior.index) / prior.sigma;
      N(prior.index, prior.index) += weight * weight;
      b(prior.index) += weight * (x(prior.index) - prior.mean) / prior.sigma;
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(N);
    const Eigen::VectorXd step = -scale.cwiseProduct(factor.solve(b));
    const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd::Identity(n, n));
    estimate.parameters = layout.parameters;
    estimate.sigma = scale.cwiseProduct(covariance.diagonal().cwiseMax(kFloor).cwiseSqrt());
    moved = (step.cwiseQuotient(estimate.sigma)).cwiseAbs().maxCoeff();
    estimate.x = x + step;
    estimate.values = at;
    layout.read(estimate.x, estimate.values);
    estimate.recordings = recordings.size();
    heading_sigma = estimate.sigma(layout.heading);
  }

  const Rig& rig;
  const Site& site;
  TableSolveOptions options;
  std::vector<TableRecording> recordings;
  std::optional<TableRecording> waiting;  // has too few windows yet
  std::unique_ptr<TableProblem> problem;
  std::vector<RecordingModel::Linearisation> linearisations;
  CalibrationValues at;  // x_0
  std::size_t linearised = 0;
  double heading_sigma = kPi;
  double moved = 0.0;
  std::deque<double> recent;  // squared innovations of the last windows
  RunningEstimate estimate;
};

SequentialSolve::SequentialSolve(const Rig& rig, const Site& site, TableSolveOptions options)
    : state_(std::make_unique<State>(rig, site, std::move(options))) {
  state_->options.threads = 1;
  CalibrationValues& start = state_->estimate.values;
  start.gravity = site.gravity;
  start.clock_offset = state_->options.clock_offset;
  for (std::size_t m = 0; m < kMaxMounts; ++m) start.lever_arm[m] = rig.mount[m].lever_p;
}

SequentialSolve::~SequentialSolve() = default;

const RunningEstimate& SequentialSolve::estimate() const { return state_->estimate; }

void SequentialSolve::begin(int mount) {
  state_->waiting.emplace();
  state_->waiting->mount = mount;
}

void SequentialSolve::abandon() {
  State& s = *state_;
  s.linearisations.clear();
  s.problem.reset();
  if (!s.waiting && !s.recordings.empty()) s.recordings.pop_back();
  s.heading_sigma = kPi;  // what it was found from may have been the bad one
  s.waiting.reset();
}

const RunningEstimate& SequentialSolve::update(CompressedRecording part) {
  State& s = *state_;
  const bool joins = s.waiting.has_value();
  if (!joins && s.recordings.empty()) return s.estimate;  // nothing was begun
  CompressedRecording& into = joins ? s.waiting->data : s.recordings.back().data;
  into.windows.insert(into.windows.end(), part.windows.begin(), part.windows.end());
  into.name = part.name;
  into.course = std::move(part.course);
  into.figures = part.figures;
  if (joins) {
    if (into.windows.size() < kEnough || into.course.end() < into.windows[kEnough - 1].t + 1.0) return s.estimate;
    // what the unit's turn-on biases are is best guessed from the last recording
    const std::size_t r = s.recordings.size();
    if (r > 0 && r < kMaxRecordings && s.options.bias_per_recording)
      s.estimate.values.recording_bias[r] = s.estimate.values.recording_bias[r - 1];
    s.linearisations.clear();
    s.problem.reset();  // it refers to the recordings
    s.recordings.push_back(std::move(*s.waiting));
    s.waiting.reset();
  }
  if (!s.problem) {
    s.linearise();
    s.solve();
    return s.estimate;
  }
  s.problem->models().back()->refresh();
  s.extend();
  s.solve();
  const auto grown = static_cast<double>(s.usable());
  if (grown > kGrown * static_cast<double>(s.linearised) ||
      (s.recent_chi_square() > kMisfit && grown > static_cast<double>(s.linearised + kRecent)) ||
      (s.moved > kMoved && grown > kSettled * static_cast<double>(s.linearised) + 20.0)) {
    s.linearise();
    s.solve();
  }
  return s.estimate;
}

}  // namespace trunnion::calibration
