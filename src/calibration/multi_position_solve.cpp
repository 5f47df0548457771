// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/multi_position_solve.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

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
constexpr double kFlatHeadingSigma = kPi / 1.7320508075688772;

/// The unit that the scaled unknowns @p x describe.
template <class T>
InertialUnit<T> unit_from(const Layout& layout, const T* x, std::size_t recording) {
  const auto value = [&](int i) { return x[i] * T(layout.parameters[static_cast<std::size_t>(i)].scale); };
  InertialUnit<T> unit;
  for (int i = 0; i < 3; ++i) {
    unit.gyro.bias(i) = value(layout.gyro_bias[recording] + i);
    unit.accel.bias(i) = value(layout.accel_bias[recording] + i);
    if (layout.gyro_cubic >= 0) unit.gyro.cubic(i) = value(layout.gyro_cubic + i);
    if (layout.accel_quadratic >= 0) unit.accel.quadratic(i) = value(layout.accel_quadratic + i);
    for (int j = 0; j < 3; ++j) {
      unit.gyro.M(i, j) = value(layout.gyro_matrix + 3 * i + j);
      if (layout.g_sensitivity >= 0) unit.g_sensitivity(i, j) = value(layout.g_sensitivity + 3 * i + j);
      if (layout.accel_matrix[i][j] >= 0) unit.accel.M(i, j) = value(layout.accel_matrix[i][j]);
    }
  }
  return unit;
}

/// Rotation of a turn at given unknowns, and its derivative to the scaled unknowns (right perturbation).
struct TurnRotation {
  Quaternion<double> q = Quaternion<double>::Identity();
  Eigen::Matrix<double, 3, Eigen::Dynamic> J;
  double duration = 0.0;
};

/// Jacobian of Exp: Exp(phi + d) = Exp(phi) Exp(Jr d), second order in phi.
Mat3<double> right_jacobian(const Vec3<double>& phi) {
  const Mat3<double> S = skew(phi);
  return Mat3<double>::Identity() - 0.5 * S + S * S / 6.0;
}

/// Integrates eq. (2). @param w_ie_b Earth rate in the case at the start; @param layout null: no derivative
TurnRotation integrate(const Turn& turn, const InertialUnit<double>& unit, const Vec3<double>& w_ie_b,
                       const Layout* layout, std::size_t recording) {
  TurnRotation rotation;
  const UnitCorrection<double> correction(unit);
  const Mat3<double> K = unit.gyro.matrix();
  const Mat3<double> K_inverse = K.inverse();
  // sums of C_0k d(phi_k)/d(column i of bias) times what the column is multiplied with: 1, w_j, f_j, w_i^3
  Mat3<double> of_bias = Mat3<double>::Zero();
  Mat3<double> of_cubic = Mat3<double>::Zero();
  std::array<Mat3<double>, 3> of_rate = {of_bias, of_bias, of_bias};
  std::array<Mat3<double>, 3> of_force = of_rate;
  Vec3<double> before = Vec3<double>::Zero();
  for (const TurnStep& step : turn.steps) {
    const InertialSample<double> input = correction.correct(step.mean);
    const Vec3<double> angle = (input.w - rotation.q.conjugate() * w_ie_b) * step.dt;
    const Vec3<double> phi =
        angle + before.cross(angle) / 12.0;  // coning over this and the previous step: Savage 1998, eq. (43)
    before = angle;
    const Quaternion<double> turned = quaternion_exp<double>(phi);
    rotation.q = rotation.q * turned;
    rotation.duration += step.dt;
    if (layout == nullptr) continue;
    // (K + 3 N w^2)^-1 to first order in N
    const Mat3<double> inverse =
        K_inverse - K_inverse * (3.0 * unit.gyro.cubic.cwiseProduct(input.w.cwiseAbs2())).asDiagonal() * K_inverse;
    const Mat3<double> gain = rotation.q.toRotationMatrix() * (right_jacobian(phi) * inverse) * -step.dt;
    of_bias += gain;
    of_cubic += gain * input.w.cwiseProduct(input.w.cwiseAbs2()).asDiagonal();
    for (std::size_t j = 0; j < 3; ++j) {
      of_rate[j] += gain * input.w(static_cast<Eigen::Index>(j));
      of_force[j] += gain * input.f(static_cast<Eigen::Index>(j));
    }
  }
  rotation.q.normalize();
  if (layout == nullptr) return rotation;
  rotation.J = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, layout->size());
  const Mat3<double> C_end = rotation.q.conjugate().toRotationMatrix();
  const auto set = [&](int place, const Vec3<double>& column) {
    rotation.J.col(place) = C_end * column * layout->parameters[static_cast<std::size_t>(place)].scale;
  };
  for (int i = 0; i < 3; ++i) {
    set(layout->gyro_bias[recording] + i, of_bias.col(i));
    if (layout->gyro_cubic >= 0) set(layout->gyro_cubic + i, of_cubic.col(i));
    for (int j = 0; j < 3; ++j) {
      set(layout->gyro_matrix + 3 * i + j, of_rate[static_cast<std::size_t>(j)].col(i));
      if (layout->g_sensitivity >= 0)
        set(layout->g_sensitivity + 3 * i + j, of_force[static_cast<std::size_t>(j)].col(i));
    }
  }
  return rotation;
}

struct RestResidual {
  const Layout* layout;
  const Site* site;
  const Rest* rest;
  std::size_t recording;
  Vec3<double> w_ie_u;
  double sigma_f;
  double sigma_w;

  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const InertialUnit<T> unit = unit_from(*layout, parameters[0], recording);
    const Eigen::Map<const Quaternion<T>> q_ub(parameters[1]);
    const T gravity =
        parameters[0][layout->gravity] * T(layout->parameters[static_cast<std::size_t>(layout->gravity)].scale);
    InertialSample<T> input;
    input.f = q_ub.conjugate() * Vec3<T>(T(0), T(0), gravity);
    input.w = q_ub.conjugate() * w_ie_u.cast<T>();
    const InertialSample<T> reading = unit.distort(input);
    const Vec3<T> r_f = (rest->mean.f.cast<T>() - reading.f) / T(sigma_f);
    const Vec3<T> r_w = (rest->mean.w.cast<T>() - reading.w) / T(sigma_w);
    for (int i = 0; i < 3; ++i) {
      residual[i] = r_f(i);
      residual[3 + i] = r_w(i);
    }
    return true;
  }
};

/// log((q_before turn exp(correction))^-1 q_after) / sigma
struct TurnResidual {
  const TurnRotation* rotation;
  double sigma;

  template <class T>
  bool operator()(const T* correction, const T* before, const T* after, T* residual) const {
    const Quaternion<T> predicted = Eigen::Map<const Quaternion<T>>(before) * rotation->q.cast<T>() *
                                    quaternion_exp<T>(Eigen::Map<const Vec3<T>>(correction));
    Eigen::Map<Vec3<T>> r(residual);
    r = quaternion_log<T>(Quaternion<T>(predicted.conjugate() * Eigen::Map<const Quaternion<T>>(after))) / T(sigma);
    return true;
  }
};

/// TurnResidual of correction = J (x - x0): differentiated by three corrections, not by all unknowns.
class TurnCost final : public ceres::CostFunction {
 public:
  TurnCost(const TurnRotation* rotation, const double* x0, double sigma)
      : rotation_(rotation), x0_(x0, rotation->J.cols()), by_correction_(new TurnResidual{rotation, sigma}) {
    set_num_residuals(3);
    *mutable_parameter_block_sizes() = {static_cast<int>(rotation->J.cols()), 4, 4};
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], x0_.size());
    const Vec3<double> correction = rotation_->J * (x - x0_);
    const double* blocks[] = {correction.data(), parameters[1], parameters[2]};
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> J;
    double* by[] = {J.data(), nullptr, nullptr};
    if (jacobians != nullptr) {
      by[1] = jacobians[1];
      by[2] = jacobians[2];
    }
    if (!by_correction_.Evaluate(blocks, residuals, jacobians != nullptr ? by : nullptr)) return false;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], 3, x0_.size()).noalias() =
          J * rotation_->J;
    }
    return true;
  }

 private:
  const TurnRotation* rotation_;
  Eigen::Map<const Eigen::VectorXd> x0_;
  ceres::AutoDiffCostFunction<TurnResidual, 3, 3, 4, 4> by_correction_;
};

/// (x - mean) / sigma of one scaled unknown.
struct UnknownPrior {
  int index;
  double mean;
  double sigma;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    residual[0] = (parameters[0][index] - T(mean)) / T(sigma);
    return true;
  }
};

/// Keeps the heading of a chain of rests within the circle: a flat prior as its standard deviation.
struct HeadingPrior {
  Quaternion<double> q0;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const Eigen::Map<const Quaternion<T>> q(parameters[0]);
    residual[0] = quaternion_log<T>(Quaternion<T>(q * q0.conjugate().cast<T>())).z() / T(kFlatHeadingSigma);
    return true;
  }
};

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
        add(new RestResidual{&layout_, &site_, &rest, r, w_ie_u, sigma_f, sigma_w}, 6, new ceres::HuberLoss(kHuber),
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
