// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

namespace trunnion::calibration {
namespace {

constexpr double kRankLoss = 1e-15;        // of the largest eigenvalue
constexpr double kShareOfBlame = 0.25;     // of an entry's variance, for a direction to be named
constexpr double kShareOfDirection = 0.2;  // of the largest component, for an entry to be named
constexpr std::size_t kNamesPerDirection = 6;
constexpr double kHopeless = 1e6;  // a variance of this many limits squared: the figure would say nothing

std::string figure(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

Observability judge(const Eigen::MatrixXd& information, const std::vector<Parameter>& parameters) {
  const Eigen::Index n = information.rows();
  Eigen::VectorXd unit(n);
  for (Eigen::Index i = 0; i < n; ++i) unit(i) = parameters[static_cast<std::size_t>(i)].refuse_above;
  const Eigen::MatrixXd A = unit.asDiagonal() * information * unit.asDiagonal();
  // The eigenvalues of A span many decades; those of the matrix with unit diagonal do not. Rank is judged on the
  // latter.
  Eigen::VectorXd diagonal(n);
  for (Eigen::Index i = 0; i < n; ++i) diagonal(i) = A(i, i) > 0.0 ? 1.0 / std::sqrt(A(i, i)) : 1.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(diagonal.asDiagonal() * A * diagonal.asDiagonal());
  const Eigen::VectorXd& lambda = eigen.eigenvalues();
  const double floor = kRankLoss * static_cast<double>(n) * std::max(lambda(n - 1), std::numeric_limits<double>::min());

  Observability result;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd directions(n, n);  // columns sqrt(1/lambda) D V, in units of the limits
  for (Eigen::Index j = 0; j < n; ++j) {
    directions.col(j) = diagonal.cwiseProduct(eigen.eigenvectors().col(j)) / std::sqrt(std::max(lambda(j), floor));
  }
  covariance.noalias() = directions * directions.transpose();

  std::vector<bool> blamed(static_cast<std::size_t>(n), false);
  const auto in_lost_direction = [&](Eigen::Index i) {
    for (Eigen::Index j = 0; j < n && lambda(j) <= floor; ++j) {  // in increasing order
      if (std::abs(directions(i, j)) > kShareOfDirection * directions.col(j).cwiseAbs().maxCoeff()) return true;
    }
    return false;
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    if (covariance(i, i) <= 1.0 && !in_lost_direction(i)) continue;
    const Parameter& p = parameters[static_cast<std::size_t>(i)];
    double lost = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double share = directions(i, j) * directions(i, j) / covariance(i, i);
      if (share > kShareOfBlame) blamed[static_cast<std::size_t>(j)] = true;
      if (lambda(j) <= floor) lost += share;
    }
    const std::string sigma =
        lost > 0.5 || in_lost_direction(i) || covariance(i, i) > kHopeless
            ? "undetermined"
            : "1 sigma " + figure(std::sqrt(covariance(i, i)) * p.refuse_above * p.in_unit) + " " + p.unit;
    result.refused.push_back(p.name + ": " + sigma + ", limit " + figure(p.refuse_above * p.in_unit) + " " + p.unit);
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!blamed[static_cast<std::size_t>(j)] && lambda(j) > floor) continue;
    LostDirection direction;
    direction.sigma = lambda(j) <= floor ? std::numeric_limits<double>::infinity() : directions.col(j).norm();
    const Eigen::VectorXd size = directions.col(j).cwiseAbs();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return size(a) > size(b); });
    for (const Eigen::Index i : order) {
      if (size(i) < kShareOfDirection * size(order.front()) || direction.entries.size() == kNamesPerDirection) break;
      direction.entries.push_back(parameters[static_cast<std::size_t>(i)].name);
    }
    result.lost.push_back(direction);
  }
  result.covariance = unit.asDiagonal() * covariance * unit.asDiagonal();
  return result;
}

std::string describe(const Observability& observability) {
  if (observability.refused.empty()) return {};
  std::string text =
      "unobservable: " + std::to_string(observability.refused.size()) + " entries cannot be told from these data\n";
  for (const std::string& entry : observability.refused) text += "  " + entry + "\n";
  text += "the directions to blame:\n";
  for (const LostDirection& direction : observability.lost) {
    text += "  ";
    for (std::size_t i = 0; i < direction.entries.size(); ++i)
      text += (i == 0 ? "" : i == 1 ? " with " : ", ") + direction.entries[i];
    text += "\n";
  }
  return text;
}

}  // namespace trunnion::calibration
