// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The running estimate against the batch solve of the same windows.

#include "trunnion/calibration/sequential_solve.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "calibration/experiment.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::calibration {
namespace {

struct Live {
  Experiment experiment;
  std::vector<RunningEstimate> after;  // each mount
  double seconds = 0.0;                // of processor in update()
  int updates = 0;
};

/// The experiment, with an update every @p every seconds of it.
Live run_live(const simulation::TableRunSettings& settings, const TableSolveOptions& options, double every) {
  const Rig rig = cyclic_rig();
  const Site site = bench();
  Live live;
  live.experiment.truth = simulation::draw_truth(settings, rig, site, kMounts);
  SequentialSolve sequential(rig, site, options);
  for (int m = 0; m < kMounts; ++m) {
    CompressOptions compress;
    compress.name = "mount_" + std::to_string(m + 1);
    Compressor compressor(compress);
    sequential.begin(m);
    std::size_t taken = 0;
    std::int64_t next = 0;
    const auto update = [&] {
      CompressedRecording part = compressor.so_far(taken);
      taken += part.windows.size();
      const auto begin = std::chrono::steady_clock::now();
      sequential.update(std::move(part));
      live.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      ++live.updates;
    };
    simulation::run_table(settings, live.experiment.truth, rig, site,
                          simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, m)), m, m,
                          {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
                             compressor.imu(t, s);
                             if (next == 0) next = t + static_cast<std::int64_t>(1e6 * every);
                             if (t < next) return;
                             next += static_cast<std::int64_t>(1e6 * every);
                             update();
                           },
                           [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
    update();
    live.after.push_back(sequential.estimate());
    live.experiment.recordings.push_back({compressor.finish(), m});
  }
  return live;
}

TableSolveOptions with_sheet(const simulation::TableRunSettings& settings) {
  TableSolveOptions options;
  options.noise = settings.noise;
  return options;
}

TEST(SequentialSolve, EndsWhereTheBatchSolveDoes) {
  simulation::TableRunSettings settings;
  settings.seed = 5;
  const TableSolveOptions options = with_sheet(settings);
  const Live live = run_live(settings, options, 2.0);
  const Solution batch = solve_table(live.experiment.recordings, cyclic_rig(), bench(), options);
  const RunningEstimate& running = live.after.back();
  ASSERT_EQ(running.x.size(), batch.x.size());
  double worst = 0.0;
  double ratio = 0.0;
  for (Eigen::Index i = 0; i < batch.x.size(); ++i) {
    const double sigma = std::sqrt(batch.observability.covariance(i, i));
    double difference = running.x(i) - batch.x(i);
    if (batch.parameters[static_cast<std::size_t>(i)].name == "heading")
      difference = std::remainder(difference, 2.0 * kPi);
    worst = std::max(worst, std::abs(difference) / sigma);
    ratio = std::max(ratio, std::abs(running.sigma(i) / sigma - 1.0));
  }
  std::printf(
      "[ FIGURE   ] running estimate against the batch: %.4f sigma at most, sigmas within %.2f %%; %d updates, "
      "%.2f ms each, %d linearisations\n",
      worst, 100.0 * ratio, live.updates, 1e3 * live.seconds / live.updates, running.linearisations);
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(ratio, 0.02);
  EXPECT_LT(running.chi_square, 2.0);
  for (Eigen::Index i = 0; i < 9; ++i) {  // of the gyro's matrix, from mount to mount
    EXPECT_LT(live.after[1].sigma(i), live.after[0].sigma(i));
    EXPECT_LT(live.after[2].sigma(i), live.after[1].sigma(i));
  }
}

TEST(SequentialSolve, WithoutASheetItWaitsForRests) {
  simulation::TableRunSettings settings;
  TableSolveOptions options;
  options.noise_from_data = true;
  const Rig rig = cyclic_rig();
  const Site site = bench();
  const CalibrationValues truth = simulation::draw_truth(settings, rig, site, 1);
  SequentialSolve sequential(rig, site, options);
  Compressor compressor({});
  simulation::run_table(settings, truth, rig, site,
                        simulation::motion_of(simulation::rest_only(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg)), 0, 0,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) { compressor.imu(t, s); },
                         [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
  sequential.begin(0);
  CompressedRecording part = compressor.so_far(0);
  const std::vector<ObservationWindow> later(part.windows.begin() + 70, part.windows.end());
  part.windows.resize(70);
  EXPECT_REFUSES(ExitCode::kInput, "less than ten seconds at rest", sequential.update(std::move(part)));
  part = compressor.so_far(0);
  part.windows = later;
  EXPECT_FALSE(sequential.update(std::move(part)).parameters.empty());
}

}  // namespace
}  // namespace trunnion::calibration
