// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/prediction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "table_problem.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kWindow = 0.1;  // s

/// Gauss-Legendre weights of the nodes of a window that is whole.
std::array<double, kWindowNodes> whole_window() {
  std::array<double, kWindowNodes> moment{};
  for (std::size_t j = 0; j < moment.size(); j += 2) moment[j] = 1.0 / static_cast<double>(j + 1);
  return quadrature_weights(moment);
}

TemperatureRange range_of(const Soak& soak) { return {std::min(soak.from, soak.to), std::max(soak.from, soak.to)}; }

}  // namespace

struct Predictor::State {
  State(const Rig& r, const Site& s, const std::vector<int>& m, const PredictionOptions& o)
      : rig(r), site(s), mounts(m), options(o), layout(request_of(r, m, o)) {
    at.gravity = site.gravity;
    at.clock_offset = options.solve.clock_offset;
    if (layout.thermal_order > 0) at.unit.thermal.reference = range_of(options.soak).reference();
    for (std::size_t i = 0; i < kMaxMounts; ++i) at.lever_arm[i] = rig.mount[i].lever_p;
    scale.resize(layout.size());
    for (int i = 0; i < layout.size(); ++i) scale(i) = layout.parameters[static_cast<std::size_t>(i)].scale;
  }

  static LayoutRequest request_of(const Rig& rig, const std::vector<int>& mounts, const PredictionOptions& options) {
    LayoutRequest request = layout_request(options.solve, rig, mounts, options.largest_rate);
    if (options.solve.terms.temperature > 0) {
      if (!options.soak.is_known())
        throw Error(ExitCode::kInput, "the model has terms of temperature: what will the temperature be? State a soak");
      request.temperature = range_of(options.soak);
    }
    return request;
  }

  const Rig& rig;
  Site site;
  std::vector<int> mounts;
  PredictionOptions options;
  Layout layout;
  CalibrationValues at;
  Eigen::VectorXd scale;
};

Predictor::Predictor(const Rig& rig, const Site& site, const std::vector<int>& mounts, const PredictionOptions& options)
    : state_(std::make_unique<State>(rig, site, mounts, options)) {}
Predictor::~Predictor() = default;

const std::vector<Parameter>& Predictor::parameters() const { return state_->layout.parameters; }

Eigen::MatrixXd Predictor::information(std::size_t r, const PlannedMotion& motion) const {
  const State& s = *state_;
  TableRecording recording;
  recording.mount = s.mounts[r];
  recording.data.figures.period = 1.0 / s.options.rate;
  const double quantum = s.options.encoder_quantum;
  const auto reading = [&](double angle) { return quantum > 0.0 ? quantum * std::round(angle / quantum) : angle; };
  // the encoders are there a little before the unit and after it, so that its first and last windows count
  constexpr double kAround = 1.0;
  const auto readings = static_cast<long long>(std::ceil((motion.duration + 2.0 * kAround) * s.options.encoder_rate));
  for (long long k = 0; k <= readings; ++k) {
    const double t = static_cast<double>(k) / s.options.encoder_rate - kAround;
    const std::array<double, 2> angle = motion.angles(std::clamp(t, 0.0, motion.duration));
    recording.data.course.add(t, reading(angle[0]), reading(angle[1]));
  }
  recording.data.course.finish();
  ObservationWindow window;
  window.half_width = 0.5 * kWindow;
  window.weight = whole_window();
  window.samples = std::max(1, static_cast<int>(std::lround(kWindow * s.options.rate)));
  for (double t = kWindow; t <= motion.duration + 1e-9; t += kWindow) {
    window.t = t - window.half_width;
    if (s.options.soak.is_known()) window.temperature = s.options.soak.at(motion.begin + window.t);
    recording.data.windows.push_back(window);
  }
  RecordingModel model(recording, r, s.rig, s.site, s.layout, s.options.solve.clock_offset);
  model.set_noise(s.options.solve.noise);
  const int n = s.layout.size();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n + 1, n + 1);
  model.evaluate(s.at, &normal);
  return normal.topLeftCorner(n, n);
}

Observability Predictor::conclude(const Eigen::MatrixXd& information) const {
  Eigen::MatrixXd all = information;
  add_prior_information(state_->layout, {gravity_prior(state_->layout, state_->site)}, all);
  return judge(all, state_->layout.parameters);
}

Eigen::VectorXd Predictor::sigmas(const Eigen::MatrixXd& information) const {
  const State& s = *state_;
  Eigen::MatrixXd all = information;
  add_prior_information(s.layout, {gravity_prior(s.layout, s.site)}, all);
  all = s.scale.asDiagonal() * all * s.scale.asDiagonal();
  // the diagonal alone spans many decades
  Eigen::VectorXd root(all.rows());
  for (Eigen::Index i = 0; i < all.rows(); ++i) root(i) = all(i, i) > 0.0 ? 1.0 / std::sqrt(all(i, i)) : 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(root.asDiagonal() * all * root.asDiagonal());
  if (factor.info() != Eigen::Success)
    return Eigen::VectorXd::Constant(all.rows(), std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd L_inverse = factor.matrixL().solve(Eigen::MatrixXd::Identity(all.rows(), all.rows()));
  return s.scale.cwiseProduct(root).cwiseProduct(L_inverse.colwise().norm().transpose());
}

Entanglement worst_entanglement(const Eigen::MatrixXd& covariance, const std::vector<Parameter>& parameters) {
  Entanglement worst;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!is_of_unit(parameters[i].kind)) continue;
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      if (i == j) continue;
      const auto a = static_cast<Eigen::Index>(i);
      const auto b = static_cast<Eigen::Index>(j);
      const double correlation = covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
      const double price = 1.0 / std::sqrt(std::max(1e-12, 1.0 - correlation * correlation));
      if (price > worst.price) worst = {i, j, correlation, price};
    }
  }
  return worst;
}

}  // namespace trunnion::calibration
