// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What plans foretell, held against simulated runs of seeds that no search has seen. Prints its figures.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>
#include <map>
#include <thread>

#include "calibration/experiment.hpp"
#include "calibration/gimbal.hpp"
#include "matchers/chi_square.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/planning/plan_search.hpp"

namespace trunnion::planning {
namespace {

constexpr int kSeeds = 10;
constexpr std::uint64_t kFirstSeed = 501;

struct Named {
  const char* name;
  const Rig* rig;
  std::vector<TableSequence> sequences;
  TableLimits limits;
};

TableLimits table_limits() {
  TableLimits limits;
  limits[kPitch].lowest = -10.0 * kRadPerDeg;
  limits[kPitch].highest = 70.0 * kRadPerDeg;
  return limits;
}

Bench bench_of(const Named& named) {
  const simulation::TableRunSettings settings;
  Bench b;
  b.rig = named.rig;
  b.site = calibration::bench();
  for (int m = 0; m < named.rig->mounts; ++m) b.mounts.push_back(m);
  b.limits = named.limits;
  b.prediction.solve.noise = settings.noise;
  b.prediction.encoder_quantum = 2.0 * kPi / std::ldexp(1.0, settings.encoder_bits);
  return b;
}

const char* group_of(const calibration::Parameter& p) {
  if (is_of_unit(p.kind) && p.name != "gravity") return kind_of(p.kind).key;
  return "table";
}

struct Achieved {
  std::map<std::string, std::pair<double, int>> nees;  ///< with the predicted covariance
  std::map<std::string, double> squares;               ///< of errors, in units
};

Achieved achieve(const Named& named, const Plan& plan) {
  Achieved achieved;
  for (int k = 0; k < kSeeds; ++k) {
    simulation::TableRunSettings settings;
    settings.seed = kFirstSeed + static_cast<std::uint64_t>(k);
    calibration::Experiment run;
    run.truth = simulation::draw_truth(settings, *named.rig, calibration::bench(), named.rig->mounts);
    for (int m = 0; m < named.rig->mounts; ++m) {
      calibration::CompressOptions options;
      calibration::Compressor compressor(options);
      simulation::run_table(
          settings, run.truth, *named.rig, calibration::bench(),
          simulation::motion_of(named.sequences[static_cast<std::size_t>(m)], named.limits), m, m,
          {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) { compressor.imu(t, s); },
           [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
      run.recordings.push_back({compressor.finish(), m});
    }
    calibration::TableSolveOptions options;
    options.noise = settings.noise;
    const calibration::Solution solution =
        calibration::solve_table(run.recordings, *named.rig, calibration::bench(), options);
    EXPECT_TRUE(solution.observability.refused.empty()) << named.name << calibration::describe(solution.observability);
    calibration::LayoutRequest request;
    request.recordings = named.rig->mounts;
    for (int m = 0; m < named.rig->mounts; ++m) {
      request.mounts.push_back("mount_" + std::to_string(m + 1));
      request.mount_used.push_back(true);
    }
    const calibration::Layout layout(request);
    Eigen::VectorXd truth;
    layout.write(run.truth, truth);
    Eigen::VectorXd error = solution.x - truth;
    error(layout.heading) = std::remainder(error(layout.heading), 2.0 * kPi);
    std::map<std::string, std::vector<Eigen::Index>> members;
    for (Eigen::Index i = 0; i < error.size(); ++i) {
      const calibration::Parameter& p = plan.parameters[static_cast<std::size_t>(i)];
      // the heading decides which horizontal axis sees the Earth turn, and was not known
      if (p.name == "heading" || p.name.find("base tilt") == 0) continue;
      members[group_of(p)].push_back(i);
      achieved.squares[group_of(p)] += error(i) * error(i) * p.in_unit * p.in_unit;
    }
    for (const auto& [group, index] : members) {
      const auto n = static_cast<Eigen::Index>(index.size());
      Eigen::VectorXd e(n);
      Eigen::MatrixXd P(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        e(i) = error(index[static_cast<std::size_t>(i)]);
        for (Eigen::Index j = 0; j < n; ++j)
          P(i, j) = plan.predicted.covariance(index[static_cast<std::size_t>(i)], index[static_cast<std::size_t>(j)]);
      }
      auto& [sum, freedom] = achieved.nees[group];
      sum += e.dot(P.llt().solve(e));
      freedom += static_cast<int>(n);
    }
  }
  return achieved;
}

// Two plans of the paper, the shipped one that a search has made, and sixteen positions on a level gimbal: every
// group's NEES with the *predicted* covariance within its band, one false alarm in a hundred over all of them.
TEST(PlanCampaign, WhatIsPredictedIsAchieved) {
  const Rig table = calibration::cyclic_rig();
  const Rig gimbal = calibration::level_gimbal();
  const TableLimits limits = table_limits();
  std::vector<Named> plans = {{"experiment", &table, {}, limits}, {"design run", &table, {}, limits}};
  for (int m = 0; m < 3; ++m) {
    plans[0].sequences.push_back(simulation::experiment(limits[kPitch].lowest, limits[kPitch].highest, m));
    plans[1].sequences.push_back(simulation::design_run(limits[kPitch]));
  }
  plans.push_back({"searched", &table,
                   io::read_table_moves(std::string(TRUNNION_SHARE) + "/plans/as_good_as_the_experiment.csv", 3),
                   limits});
  plans.push_back(
      {"sixteen positions", &gimbal, {simulation::sixteen_positions(40.0, 10.0 * kRadPerDeg)}, TableLimits{}});
  TableLimits table_can = limits;
  for (AxisLimits& axis : table_can) axis.rate = axis.acceleration = 50.0 * kRadPerDeg;
  for (const TableSequence& sequence : plans[2].sequences)
    EXPECT_NO_THROW(simulation::check_limits(sequence, table_can, "the shipped plan"));
  std::vector<Plan> predicted;
  std::vector<Achieved> achieved(plans.size());
  for (const Named& named : plans) predicted.push_back(predict(bench_of(named), named.sequences));
  std::thread second([&] {
    for (std::size_t i = 1; i < plans.size(); i += 2) achieved[i] = achieve(plans[i], predicted[i]);
  });
  for (std::size_t i = 0; i < plans.size(); i += 2) achieved[i] = achieve(plans[i], predicted[i]);
  second.join();
  std::size_t groups = 0;
  for (const Achieved& one : achieved) groups += one.nees.size();
  for (std::size_t i = 0; i < plans.size(); ++i) {
    for (const auto& [group, nees] : achieved[i].nees) {
      const ChiSquareBand band = chi_square_band(nees.second, 0.01 / static_cast<double>(groups));
      std::printf("[ FIGURE   ] %s, %.0f s: NEES of %s %.1f in [%.1f, %.1f]\n", plans[i].name, predicted[i].duration(),
                  group.c_str(), nees.first, band.low, band.high);
      EXPECT_GT(nees.first, band.low) << plans[i].name << ' ' << group;
      EXPECT_LT(nees.first, band.high) << plans[i].name << ' ' << group;
    }
  }
  // the accuracy of the experiment in half its time: all that a unit keeps when it is switched off
  EXPECT_LE(predicted[2].duration(), 0.5 * predicted[0].duration());
  const WantedSigmas wanted = sigmas_of(predicted[0]);
  const WantedSigmas got = sigmas_of(predicted[2]);
  for (const Entry kind : {Entry::kGyroScale, Entry::kGyroCrossCoupling, Entry::kGyroCubic, Entry::kGyroGSensitivity,
                           Entry::kAccelScale, Entry::kAccelCrossCoupling}) {
    const auto i = static_cast<std::size_t>(kind);
    const std::string key = kind_of(kind).key;
    std::printf("[ FIGURE   ] the shipped plan: %s predicted %.3g of %.3g, rms error %.2f of the experiment's\n",
                key.c_str(), got[i], wanted[i], std::sqrt(achieved[2].squares[key] / achieved[0].squares[key]));
    EXPECT_LE(got[i], wanted[i] * (1.0 + 1e-9)) << key;
  }
}

}  // namespace
}  // namespace trunnion::planning
