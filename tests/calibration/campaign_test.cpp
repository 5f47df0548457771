// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Seeds 1-20 of the simulated experiment: accuracy, and whether the sigmas are true. Prints its figures.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "calibration/experiment.hpp"
#include "matchers/chi_square.hpp"

namespace trunnion::calibration {
namespace {

constexpr int kSeeds = 20;

const char* group_of(const Parameter& p) {
  if (p.name.find("mount_") == 0) return "mounts";
  if (p.name.find("lever") == 0) return "lever arms";
  if (p.name.find("gravity") == 0) return "gravity";
  if (p.name.find("heading") == 0) return "heading";
  if (p.name.find("base tilt") == 0) return "base tilt";
  if (p.name.find("eccentricity") != std::string::npos) return "eccentricity";
  if (p.name.find("non-orthogonality") != std::string::npos) return "non-orthogonality";
  return kind_of(p.kind).key;
}

struct Campaign {
  double nees = 0.0;
  int parameters = 0;
  std::map<std::string, std::pair<double, int>> group_nees;  // sum and degrees of freedom
  Eigen::VectorXd squared_error;                             // sum over seeds, by parameter
  double squared_pulls = 0.0;
  double squared_pulls_variance = 0.0;  // of the sum, from the correlations of the posterior
  std::vector<Parameter> names;

  /// 1 sigma of rms_pull() about one, where the posterior is true.
  [[nodiscard]] double rms_pull_sigma() const {
    return 0.5 * std::sqrt(squared_pulls_variance) / (kSeeds * parameters);
  }
  [[nodiscard]] double rms_pull() const { return std::sqrt(squared_pulls / (kSeeds * parameters)); }
  /// RMS over seeds and the entries of one kind, in the kind's unit.
  [[nodiscard]] double rms(Entry kind) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].kind != kind || names[i].unit != kind_of(kind).unit) continue;
      sum += squared_error(static_cast<Eigen::Index>(i)) * names[i].in_unit * names[i].in_unit;
      ++count;
    }
    return std::sqrt(sum / (count * kSeeds));
  }
};

Campaign run(const simulation::TableRunSettings& base, bool with_sheet) {
  Campaign campaign;
  const Site site = bench();
  for (int seed = 1; seed <= kSeeds; ++seed) {
    simulation::TableRunSettings settings = base;
    settings.seed = static_cast<std::uint64_t>(seed);
    const Experiment experiment = run_experiment(settings, site);
    TableSolveOptions options;
    options.noise = settings.noise;
    options.noise_from_data = !with_sheet;
    const Solution solution = solve_table(experiment.recordings, cyclic_rig(), site, options);
    EXPECT_TRUE(solution.observability.refused.empty()) << describe(solution.observability);
    const Eigen::VectorXd error = errors_of(solution, experiment);
    const Eigen::MatrixXd& P = solution.observability.covariance;
    campaign.nees += error.dot(P.llt().solve(error));
    campaign.parameters = static_cast<int>(error.size());
    campaign.names = solution.parameters;
    if (campaign.squared_error.size() == 0) campaign.squared_error.setZero(error.size());
    campaign.squared_error += error.cwiseAbs2();
    campaign.squared_pulls += error.cwiseAbs2().cwiseQuotient(P.diagonal()).sum();
    // pulls of one seed are correlated: Var(sum z_i^2) = 2 sum_ij rho_ij^2
    const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
    campaign.squared_pulls_variance += 2.0 * (scale.asDiagonal() * P * scale.asDiagonal()).squaredNorm();
    std::map<std::string, std::vector<Eigen::Index>> members;
    for (Eigen::Index i = 0; i < error.size(); ++i)
      members[group_of(solution.parameters[static_cast<std::size_t>(i)])].push_back(i);
    for (const auto& [name, index] : members) {
      const auto n = static_cast<Eigen::Index>(index.size());
      Eigen::VectorXd e(n);
      Eigen::MatrixXd C(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        e(i) = error(index[static_cast<std::size_t>(i)]);
        for (Eigen::Index j = 0; j < n; ++j)
          C(i, j) = P(index[static_cast<std::size_t>(i)], index[static_cast<std::size_t>(j)]);
      }
      auto& [sum, freedom] = campaign.group_nees[name];
      sum += e.dot(C.llt().solve(e));
      freedom += static_cast<int>(n);
    }
  }
  return campaign;
}

/// NEES of the whole and of every group within bands whose family-wise false alarm is one per cent.
void expect_consistent(const Campaign& campaign, const char* name) {
  const double level = 0.01 / static_cast<double>(campaign.group_nees.size() + 1);
  const auto check = [&](const std::string& group, double nees, int freedom) {
    const ChiSquareBand band = chi_square_band(freedom, level);
    std::printf("[ FIGURE   ] %s: NEES of %-36s %8.1f in [%.1f, %.1f]\n", name, group.c_str(), nees, band.low,
                band.high);
    EXPECT_GT(nees, band.low) << group;
    EXPECT_LT(nees, band.high) << group;
  };
  check("all", campaign.nees, kSeeds * campaign.parameters);
  for (const auto& [group, nees] : campaign.group_nees) check(group, nees.first, nees.second);
  std::printf("[ FIGURE   ] %s: rms pull %.4f, installation %.6f deg, gyro scale %.2f ppm\n", name, campaign.rms_pull(),
              campaign.rms(Entry::kGyroCrossCoupling), campaign.rms(Entry::kGyroScale));
}

const Campaign& with_sheet() {
  static const Campaign campaign = run(simulation::TableRunSettings(), true);
  return campaign;
}

TEST(Campaign, WithTheSheetsWander) {
  expect_consistent(with_sheet(), "sheet");
  EXPECT_LE(with_sheet().rms(Entry::kGyroCrossCoupling), 0.001);
  EXPECT_LE(with_sheet().rms(Entry::kGyroScale), 15.0);
}

// RMS of error / Cramer-Rao bound over all parameters and seeds. How far chance takes it from one follows from the
// posterior's correlations; the band leaves a false alarm of one per cent.
TEST(Campaign, WhiteNoiseAloneReachesTheCramerRaoBound) {
  simulation::TableRunSettings settings;
  settings.noise.gyro.wander = 0.0;
  settings.noise.accel.wander = 0.0;
  settings.encoder_bits = 0;
  const Campaign campaign = run(settings, true);
  expect_consistent(campaign, "white");
  std::printf("[ FIGURE   ] white: rms pull %.4f, chance alone scatters it by %.4f\n", campaign.rms_pull(),
              campaign.rms_pull_sigma());
  EXPECT_NEAR(campaign.rms_pull(), 1.0, 2.576 * campaign.rms_pull_sigma());
}

TEST(Campaign, WithoutASheet) {
  const Campaign campaign = run(simulation::TableRunSettings(), false);
  std::printf("[ FIGURE   ] no sheet: rms pull %.4f, installation %.6f deg, gyro scale %.2f ppm\n", campaign.rms_pull(),
              campaign.rms(Entry::kGyroCrossCoupling), campaign.rms(Entry::kGyroScale));
  EXPECT_GE(campaign.rms_pull(), 0.8);
  EXPECT_LE(campaign.rms_pull(), 1.25);
}

// The same draws with a sample in a thousand off by 1 rad/s and 5 m/s^2 and one in a hundred lost.
TEST(Campaign, OutliersAndDropsCostLittle) {
  simulation::TableRunSettings settings;
  settings.outlier_fraction = 1e-3;
  settings.dropped_fraction = 1e-2;
  const Campaign dirty = run(settings, true);
  double worst = 0.0;
  for (std::size_t i = 0; i < kEntries; ++i) {
    const auto kind = static_cast<Entry>(i);
    const double clean_rms = with_sheet().rms(kind);
    if (!(clean_rms > 0.0)) continue;
    const double ratio = dirty.rms(kind) / clean_rms;
    worst = std::max(worst, ratio);
    std::printf("[ FIGURE   ] outliers and drops: RMS ratio of %-36s %.4f\n", kind_of(kind).key, ratio);
    EXPECT_LE(ratio, 1.10) << kind_of(kind).key;
  }
  double worst_single = 0.0;
  for (Eigen::Index i = 0; i < dirty.squared_error.size(); ++i) {
    worst_single = std::max(worst_single, std::sqrt(dirty.squared_error(i) / with_sheet().squared_error(i)));
  }
  std::printf("[ FIGURE   ] outliers and drops: worst ratio of a kind %.4f, of a single parameter %.4f\n", worst,
              worst_single);
}

}  // namespace
}  // namespace trunnion::calibration
