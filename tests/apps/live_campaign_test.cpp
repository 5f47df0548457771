// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Ten live calibrations of ten units: faster than twenty times real time, none loses a sample, each ends where the
/// batch solve of its own recordings does, and their sigmas are true.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "live_bench.hpp"
#include "matchers/chi_square.hpp"

namespace trunnion::app {
namespace {

constexpr int kSeeds = 10;

TEST(LiveCampaign, SigmasAreTrueAndTheAnswerIsThatOfTheRecordings) {
  double nees = 0.0;
  double worst = 0.0;
  double recorded = 0.0;
  double took = 0.0;
  long long lost = 0;
  int freedom = 0;
  for (int seed = 101; seed < 101 + kSeeds; ++seed) {
    const LiveBench bench(static_cast<std::uint64_t>(seed));
    std::vector<std::vector<BusMessage>> published;
    for (int mount = 0; mount < 3; ++mount) published.push_back(bench.messages(mount));
    const auto begin = std::chrono::steady_clock::now();
    LiveRun live(bench);
    for (int mount = 0; mount < 3; ++mount) {
      live.press();
      live.publish(published[static_cast<std::size_t>(mount)]);
      EXPECT_EQ(live.press(), mount < 2);
    }
    const calibration::TableSolveOptions options = table_options(bench.run, bench.mounts);
    const calibration::Solution solution =
        calibration::solve_table(live.session.recordings(), bench.rig.rig, bench.run.site, options);
    took += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (const auto& recording : live.session.recordings()) recorded += recording.data.figures.duration;
    lost += live.session.inputs().losses.samples;

    RunInputs inputs;
    const calibration::Solution batch = calibration::solve_table(read_table_recordings(bench.run, bench.mounts, inputs),
                                                                 bench.rig.rig, bench.run.site, options);
    EXPECT_EQ(inputs.digests, live.session.inputs().digests);
    ASSERT_EQ(solution.x.size(), batch.x.size());
    for (Eigen::Index i = 0; i < batch.x.size(); ++i)
      worst = std::max(worst, std::abs(solution.x(i) - batch.x(i)) / std::max(1e-300, std::abs(batch.x(i))));

    calibration::LayoutRequest request;
    request.recordings = 3;
    request.mounts = bench.mounts;
    request.mount_used.assign(3, true);
    const calibration::Layout layout(request);
    Eigen::VectorXd truth;
    layout.write(bench.truth, truth);
    Eigen::VectorXd error = solution.x - truth;
    error(layout.heading) = std::remainder(error(layout.heading), 2.0 * kPi);
    nees += error.dot(solution.observability.covariance.ldlt().solve(error));
    freedom += static_cast<int>(error.size());
  }
  std::printf(
      "[ FIGURE   ] live: %d seeds at %.0f times real time, %lld samples lost, largest relative difference to the "
      "batch of its own recordings %.1e, NEES %.1f of %d\n",
      kSeeds, recorded / took, lost, worst, nees, freedom);
  EXPECT_EQ(lost, 0);
  EXPECT_LE(worst, 1e-12);
  const ChiSquareBand band = chi_square_band(freedom, 0.01);  // one false alarm in a hundred draws of seeds
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

}  // namespace
}  // namespace trunnion::app
