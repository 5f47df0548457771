// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/multi_position_solve.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "multi_position_costs.hpp"
#include "trunnion/core/error.hpp"
#include "turn_rotation.hpp"

namespace trunnion::calibration {
namespace {

constexpr int kVarianceRounds = 2;
constexpr double kRoundTolerance = 1e-3;  // of the cost, while the variances are still moving
constexpr double kFinalTolerance = 1e-6;
// What a rest and a turn may scatter by at first: so wide that the first round meets no outlier, only curvature.
constexpr double kFirstForce = 0.02;  // m/s^2
constexpr double kFirstRate = 1e-3;   // rad/s
constexpr double kFirstTurn = 0.02;   // rad
constexpr double kHuber = 4.0;

enum Component : std::size_t { kRestForce, kRestRate, kTurns, kComponents };

class HandProblem {
 public:
  HandProblem(const std::vector<HandRecording>& recordings, const Site& site, const HandSolveOptions& options)
      : recordings_(recordings), site_(site), options_(options), layout_(request()) {
    for (std::size_t r = 0; r < recordings.size(); ++r) {
      first_rest_.push_back(attitude_.size());
      attitude_.resize(attitude_.size() + recordings[r].rests.size());
    }
    if (attitude_.empty())
      throw Error(ExitCode::kInput,
                  "no rest of a second or more was found in the recordings: lay the unit down between the turns");
    noise_ = options.noise;
    if (!options.has_noise) noise_ = pooled_noise();
    if (layout_.g_sensitivity >= 0) {
      for (int i = layout_.g_sensitivity; i < layout_.g_sensitivity + 9; ++i) {
        // what a prior fixes is not refused, unless a limit was asked for
        const auto kind = static_cast<std::size_t>(Entry::kGyroGSensitivity);
        if (options.refuse_above[kind] != default_refuse_above()[kind]) break;
        double& limit = layout_.parameters[static_cast<std::size_t>(i)].refuse_above;
        limit = std::max(limit, 1.01 * options.g_sensitivity_sigma);
      }
    }
    start();
  }

  HandSolution solve() {
    int iterations = 0;
    for (int round = 0; round < kVarianceRounds; ++round) {
      integrate_turns();
      iterations += minimise(kRoundTolerance);
      update_components();
    }
    integrate_turns();
    iterations += minimise(kFinalTolerance);
    return conclude(iterations);
  }

 private:
  LayoutRequest request() const {
    LayoutRequest r;
    r.terms = options_.terms;
    if (r.terms.asymmetry || r.terms.size_effect || r.terms.temperature > 0)
      throw Error(ExitCode::kInput,
                  "by hand the model has cubic, g_sensitivity and quadratic: asymmetry, size_effect and temperature "
                  "need a table");
    r.refuse_above = options_.refuse_above;
    r.recordings = static_cast<int>(recordings_.size());
    r.bias_per_recording = options_.bias_per_recording;
    r.accel_upper_triangular = true;
    r.rig = false;
    r.largest_rate = 1e-3;
    for (const HandRecording& recording : recordings_) {
      for (const Turn& turn : recording.turns) {
        for (const TurnStep& step : turn.steps)
          r.largest_rate = std::max(r.largest_rate, step.mean.w.cwiseAbs().maxCoeff());
      }
    }
    return r;
  }

  UnitNoise pooled_noise() const {
    UnitNoise noise;
    double weight = 0.0;
    for (const HandRecording& recording : recordings_) {
      const auto n = static_cast<double>(recording.rests.size());
      noise.gyro.density += n * recording.noise.gyro.density;
      noise.accel.density += n * recording.noise.accel.density;
      weight += n;
    }
    noise.gyro.density /= weight;
    noise.accel.density /= weight;
    if (!(noise.gyro.density > 0.0) || !(noise.accel.density > 0.0)) {
      throw Error(ExitCode::kInput, "the recordings are free of noise at rest: state the noise in a sheet");
    }
    return noise;
  }

  [[nodiscard]] double scale(int i) const { return layout_.parameters[static_cast<std::size_t>(i)].scale; }

  /// Biases from the rests, attitudes from gravity and the turns.
  void start() {
    CalibrationValues values;
    values.gravity = site_.gravity;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const HandRecording& recording = recordings_[r];
      Vec3<double> bias = Vec3<double>::Zero();
      for (const Rest& rest : recording.rests) bias += rest.mean.w / static_cast<double>(recording.rests.size());
      values.recording_bias[r].w = bias;
      for (const Rest& rest : recording.rests) {
        const double ratio = rest.mean.f.norm() / site_.gravity;
        if (ratio < 0.7 || ratio > 1.4) {
          throw Error(ExitCode::kInput, recording.name + ": at rest at " + std::to_string(rest.begin) +
                                            " s the specific force is " + std::to_string(ratio) +
                                            " of gravity: wrong unit or nominal scale of the accelerometers");
        }
      }
    }
    layout_.write(values, x_);
    for (int i = 0; i < layout_.size(); ++i) x_(i) /= scale(i);
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const HandRecording& recording = recordings_[r];
      const InertialUnit<double> unit = unit_from(layout_, x_.data(), r);
      for (std::size_t k = 0; k < recording.rests.size(); ++k) {
        Quaternion<double> q_ub = Quaternion<double>::Identity();
        const auto turn = std::find_if(recording.turns.begin(), recording.turns.end(),
                                       [&](const Turn& t) { return t.from + 1 == k; });
        if (turn != recording.turns.end())
          q_ub = attitude_[first_rest_[r] + k - 1] * integrate(*turn, unit, Vec3<double>::Zero(), nullptr, r).q;
        // the least turn that takes the measured force to the vertical
        const Vec3<double> up = (q_ub * recording.rests[k].mean.f).normalized();
        attitude_[first_rest_[r] + k] =
            (Quaternion<double>::FromTwoVectors(up, Vec3<double>::UnitZ()) * q_ub).normalized();
        if (turn == recording.turns.end()) heads_.push_back(first_rest_[r] + k);
      }
    }
    head_start_.clear();
    for (const std::size_t head : heads_) head_start_.push_back(attitude_[head]);
  }

  [[nodiscard]] bool used(std::size_t turn) const {
    return options_.hold_out <= 0 ||
           turn % static_cast<std::size_t>(options_.hold_out) != static_cast<std::size_t>(options_.hold_out) - 1;
  }

  [[nodiscard]] double white_force(const Rest& rest) const {
    return noise_.accel.density * noise_.accel.density / (rest.end - rest.begin);
  }
  [[nodiscard]] double white_rate(const Rest& rest) const {
    return noise_.gyro.density * noise_.gyro.density / (rest.end - rest.begin);
  }
  [[nodiscard]] double white_turn(const TurnRotation& turn) const {
    return noise_.gyro.density * noise_.gyro.density * turn.duration;
  }

  /// Integrates every turn that is used at the present estimate.
  void integrate_turns() {
    const Vec3<double> w_ie_u = earth_rate_enu(site_.latitude);
    x0_ = x_;
    rotations_.clear();
    std::size_t index = 0;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const InertialUnit<double> unit = unit_from(layout_, x_.data(), r);
      for (const Turn& turn : recordings_[r].turns) {
        if (used(index++))
          rotations_.push_back(
              integrate(turn, unit, attitude_[first_rest_[r] + turn.from].conjugate() * w_ie_u, &layout_, r));
      }
    }
  }

  /// Builds the problem; rows in the order rests, turns, priors.
  void build(ceres::Problem& problem) {
    const Vec3<double> w_ie_u = earth_rate_enu(site_.latitude);
    const int n = layout_.size();
    rows_.clear();
    problem.AddParameterBlock(x_.data(), n);
    for (Quaternion<double>& q : attitude_)
      problem.AddParameterBlock(q.coeffs().data(), 4, new ceres::EigenQuaternionManifold);
    const auto add = [&](auto* functor, int residuals, ceres::LossFunction* loss, const std::vector<double*>& blocks,
                         const std::vector<int>& sizes) {
      auto* cost = new ceres::DynamicAutoDiffCostFunction<std::remove_pointer_t<decltype(functor)>, 8>(functor);
      for (const int size : sizes) cost->AddParameterBlock(size);
      cost->SetNumResiduals(residuals);
      problem.AddResidualBlock(cost, loss, blocks);
    };
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      for (std::size_t k = 0; k < recordings_[r].rests.size(); ++k) {
        const Rest& rest = recordings_[r].rests[k];
        const double sigma_f = std::sqrt(white_force(rest) + component_[kRestForce]);
        const double sigma_w = std::sqrt(white_rate(rest) + component_[kRestRate]);
        add(new RestResidual{&layout_, &rest, r, w_ie_u, sigma_f, sigma_w}, 6, new ceres::HuberLoss(kHuber),
            {x_.data(), attitude_[first_rest_[r] + k].coeffs().data()}, {n, 4});
        for (int i = 0; i < 6; ++i)
          rows_.push_back({i < 3 ? kRestForce : kRestRate, i < 3 ? white_force(rest) : white_rate(rest)});
      }
    }
    std::size_t index = 0;
    auto rotation = rotations_.begin();
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      for (const Turn& turn : recordings_[r].turns) {
        if (!used(index++)) continue;
        Quaternion<double>& before = attitude_[first_rest_[r] + turn.from];
        Quaternion<double>& after = attitude_[first_rest_[r] + turn.from + 1];
        const double white = white_turn(*rotation);
        problem.AddResidualBlock(new TurnCost(&*rotation++, x0_.data(), std::sqrt(white + component_[kTurns])),
                                 new ceres::HuberLoss(kHuber), x_.data(), before.coeffs().data(),
                                 after.coeffs().data());
        for (int i = 0; i < 3; ++i) rows_.push_back({kTurns, white});
      }
    }
    add(new UnknownPrior{layout_.gravity, site_.gravity / scale(layout_.gravity),
                         site_.gravity_sigma / scale(layout_.gravity)},
        1, nullptr, {x_.data()}, {n});
    for (int i = layout_.g_sensitivity; layout_.g_sensitivity >= 0 && i < layout_.g_sensitivity + 9; ++i) {
      add(new UnknownPrior{i, 0.0, options_.g_sensitivity_sigma / scale(i)}, 1, nullptr, {x_.data()}, {n});
    }
    for (std::size_t h = 0; h < heads_.size(); ++h)
      add(new HeadingPrior{head_start_[h]}, 1, nullptr, {attitude_[heads_[h]].coeffs().data()}, {4});
  }

  int minimise(double tolerance) {
    ceres::Problem problem;
    build(problem);
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = 30;
    solver.initial_trust_region_radius = 1e8;
    solver.function_tolerance = tolerance;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) throw Error(ExitCode::kNumerics, "the solve did not converge: " + summary.message);
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    for (Quaternion<double>& q : attitude_) q.normalize();
    return static_cast<int>(summary.iterations.size());
  }

  struct RowOf {
    Component component;
    double white;
  };

  /// Whitened Jacobian at the estimate, unknowns first, then three columns an attitude, with its J^T J.
  struct Linearised {
    Eigen::SparseMatrix<double, Eigen::RowMajor> J;
    Eigen::VectorXd residual;
    Eigen::MatrixXd information;
  };

  Linearised linearise() {
    ceres::Problem problem;
    build(problem);
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks.push_back(x_.data());
    for (Quaternion<double>& q : attitude_) options.parameter_blocks.push_back(q.coeffs().data());
    std::vector<double> r;
    ceres::CRSMatrix J;
    problem.Evaluate(options, nullptr, &r, nullptr, &J);
    Linearised linear;
    linear.J = Eigen::Map<Eigen::SparseMatrix<double, Eigen::RowMajor>>(J.num_rows, J.num_cols,
                                                                        static_cast<Eigen::Index>(J.values.size()),
                                                                        J.rows.data(), J.cols.data(), J.values.data());
    linear.residual = Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
    linear.information = Eigen::SparseMatrix<double>(linear.J.transpose() * linear.J);
    return linear;
  }

  /// Helmert: the variance of each component is such that its whitened squares sum to its redundancy.
  void update_components() {
    Linearised linear = linearise();
    const Eigen::VectorXd& residual = linear.residual;
    linear.information.diagonal().array() += 1e-12;  // directions that the data do not fix carry no redundancy
    const Eigen::MatrixXd covariance =
        linear.information.llt().solve(Eigen::MatrixXd::Identity(linear.J.cols(), linear.J.cols()));
    const auto leverage = [&](Eigen::Index row) {
      double sum = 0.0;
      for (decltype(linear.J)::InnerIterator a(linear.J, row); a; ++a) {
        for (decltype(linear.J)::InnerIterator b(linear.J, row); b; ++b)
          sum += a.value() * b.value() * covariance(a.col(), b.col());
      }
      return sum;
    };
    for (std::size_t c = 0; c < kComponents; ++c) {
      double redundancy = 0.0;
      std::vector<std::pair<double, double>> squares;  // raw square and white variance
      for (std::size_t row = 0; row < rows_.size(); ++row) {
        if (rows_[row].component != c) continue;
        const auto i = static_cast<Eigen::Index>(row);
        redundancy += 1.0 - leverage(i);
        squares.emplace_back(residual(i) * residual(i) * (rows_[row].white + component_[c]), rows_[row].white);
      }
      if (redundancy < 3.0) continue;
      const auto excess = [&](double variance) {
        double sum = 0.0;
        for (const auto& [square, white] : squares) sum += square / (white + variance);
        return sum - redundancy;
      };
      double low = 0.0;
      double high = 0.0;
      for (const auto& [square, white] : squares) high += square / redundancy;
      if (excess(0.0) <= 0.0) {
        component_[c] = 0.0;
        continue;
      }
      for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (excess(middle) > 0.0 ? low : high) = middle;
      }
      component_[c] = high;
    }
  }

  HandSolution conclude(int iterations) {
    const int n = layout_.size();
    const Linearised linear = linearise();
    const Eigen::Index attitudes = linear.J.cols() - n;
    // attitudes out: Schur complement
    Eigen::MatrixXd A_qq = linear.information.bottomRightCorner(attitudes, attitudes);
    A_qq.diagonal().array() += 1e-12;
    const Eigen::MatrixXd A_qx = linear.information.bottomLeftCorner(attitudes, n);
    Eigen::MatrixXd information = linear.information.topLeftCorner(n, n) - A_qx.transpose() * A_qq.llt().solve(A_qx);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) information(i, j) /= scale(i) * scale(j);
    }
    HandSolution result;
    Solution& s = result.solution;
    s.parameters = layout_.parameters;
    s.x = x_;
    for (int i = 0; i < n; ++i) s.x(i) *= scale(i);
    s.observability = judge(information, layout_.parameters);
    // along a direction that the data do not hold, the steps never end: the gate names it
    if (!converged_ && s.observability.refused.empty())
      throw Error(ExitCode::kNumerics, "the solve did not converge in " + std::to_string(iterations) + " iterations");
    const std::string beyond = s.observability.refused.empty() ? implausible(s.parameters, s.x) : std::string();
    if (!beyond.empty()) {
      throw Error(ExitCode::kInput,
                  "the solution is no small correction of the nominal scales; look at the units, the counts' scale and "
                  "zero, the order and the signs of the axes:\n" +
                      beyond);
    }
    s.noise = noise_;
    s.gauge = {"accelerometer_z_along_case_z", "accelerometer_y_in_case_yz_plane"};
    CalibrationRecord& record = s.record;
    layout_.read(s.x, record.value);
    record.sigma = layout_.sigmas(s.observability.covariance);
    record.recordings = static_cast<int>(recordings_.size());
    std::size_t index = 0;
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      record.fit.samples += recordings_[r].figures.samples;
      record.fit.windows += static_cast<long long>(recordings_[r].rests.size() + recordings_[r].turns.size());
      result.rests += static_cast<int>(recordings_[r].rests.size());
      result.turns += static_cast<int>(recordings_[r].turns.size());
      if (options_.hold_out <= 0) continue;
      for (const double error : turn_errors(recordings_[r], unit_from(layout_, x_.data(), r))) {
        if (!used(index++)) result.held_out.push_back(error);
      }
    }
    record.fit.reduced_chi_square = linear.residual.squaredNorm() /
                                    static_cast<double>(std::max<Eigen::Index>(1, linear.J.rows() - linear.J.cols()));
    record.fit.iterations = iterations;
    result.rest_scatter = std::sqrt(component_[kRestForce]);
    result.turn_scatter = std::sqrt(component_[kTurns]);
    return result;
  }

  const std::vector<HandRecording>& recordings_;
  const Site& site_;
  const HandSolveOptions& options_;
  Layout layout_;
  UnitNoise noise_;
  Eigen::VectorXd x_;                         // scaled unknowns
  Eigen::VectorXd x0_;                        // where the turns were integrated
  std::vector<Quaternion<double>> attitude_;  // q_ub of every rest
  std::vector<std::size_t> first_rest_;       // of each recording
  std::vector<std::size_t> heads_;            // rests that no turn leads to
  std::vector<Quaternion<double>> head_start_;
  std::vector<TurnRotation> rotations_;
  std::vector<RowOf> rows_;
  bool converged_ = false;
  std::array<double, kComponents> component_ = {kFirstForce * kFirstForce, kFirstRate* kFirstRate,
                                                kFirstTurn* kFirstTurn};
};

}  // namespace

HandSolution solve_by_hand(const std::vector<HandRecording>& recordings, const Site& site,
                           const HandSolveOptions& options) {
  if (recordings.empty()) throw Error(ExitCode::kInput, "no recordings to solve");
  if (recordings.size() > kMaxRecordings)
    throw Error(ExitCode::kInput, "more than " + std::to_string(kMaxRecordings) + " recordings in one run");
  HandProblem problem(recordings, site, options);
  return problem.solve();
}

std::vector<double> turn_errors(const HandRecording& recording, const InertialUnit<double>& unit) {
  const UnitCorrection<double> correction(unit);
  std::vector<double> errors;
  for (const Turn& turn : recording.turns) {
    const Vec3<double> before = correction.correct(recording.rests[turn.from].mean).f.normalized();
    const Vec3<double> after = correction.correct(recording.rests[turn.from + 1].mean).f.normalized();
    const Vec3<double> predicted = integrate(turn, unit, Vec3<double>::Zero(), nullptr, 0).q.conjugate() * before;
    errors.push_back(std::atan2(predicted.cross(after).norm(), predicted.dot(after)));
  }
  return errors;
}

}  // namespace trunnion::calibration
