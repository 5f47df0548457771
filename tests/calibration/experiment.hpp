// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The simulated experiment of docs/theory/calibration.md, section 2, straight into the solver.

#pragma once

#include <cmath>
#include <vector>

#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/positions/twelve.hpp"
#include "trunnion/simulation/table_run.hpp"

namespace trunnion::calibration {

inline Rig cyclic_rig() {
  Rig rig;
  rig.mounts = kMounts;
  for (int m = 0; m < kMounts; ++m) rig.mount[static_cast<std::size_t>(m)].C_pb = cyclic_mount(m);
  return rig;
}

inline Site bench() {
  Site site;
  site.latitude = 43.88 * kRadPerDeg;
  site.gravity = normal_gravity(site.latitude, 220.0);
  site.gravity_sigma = 1e-5;
  return site;
}

struct Experiment {
  CalibrationValues truth;
  std::vector<TableRecording> recordings;
};

/// Records mounts 0 .. mounts-1.
inline Experiment run_experiment(const simulation::TableRunSettings& settings, const Site& site, int mounts = kMounts) {
  const Rig rig = cyclic_rig();
  Experiment experiment;
  experiment.truth = simulation::draw_truth(settings, rig, site, mounts);
  for (int m = 0; m < mounts; ++m) {
    CompressOptions options;
    options.name = "mount_" + std::to_string(m + 1);
    Compressor compressor(options);
    simulation::run_table(settings, experiment.truth, rig, site,
                          simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, m)), m, m,
                          {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) { compressor.imu(t, s); },
                           [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
    experiment.recordings.push_back({compressor.finish(), m});
  }
  return experiment;
}

/// Estimate minus truth over the solution's parameters; the heading's difference is wrapped.
inline Eigen::VectorXd errors_of(const Solution& solution, const Experiment& experiment) {
  LayoutRequest request;
  request.recordings = static_cast<int>(experiment.recordings.size());
  request.mounts = {"mount_1", "mount_2", "mount_3"};
  for (std::size_t m = 0; m < 3; ++m) request.mount_used.push_back(m < experiment.recordings.size());
  const Layout layout(request);
  Eigen::VectorXd truth;
  layout.write(experiment.truth, truth);
  Eigen::VectorXd error = solution.x - truth;
  error(layout.heading) = std::remainder(error(layout.heading), 2.0 * kPi);
  return error;
}

}  // namespace trunnion::calibration
