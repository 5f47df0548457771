// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/verification.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "recording_model.hpp"
#include "table_problem.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::calibration {
namespace {

/// Differences of one recording from the input of a perfect unit on the calibrated table, by window and sensor.
std::vector<std::array<double, 6>> differences(const CompressedRecording& data, int mount,
                                               const CalibrationValues& rig_values, const Rig& rig, const Site& site,
                                               std::vector<double>& t) {
  TableRecording recording{data, mount};
  TableSolveOptions options;
  options.terms = {false, false, false};
  const Layout layout(layout_request(options, rig, {mount}, 1.0));
  RecordingModel model(recording, 0, rig, site, layout, rig_values.clock_offset);
  UnitNoise unit_weights;
  unit_weights.gyro.density = unit_weights.accel.density = 1.0;
  model.set_noise(unit_weights);
  std::vector<std::array<double, 6>> all(model.windows());
  model.residuals(rig_values, [&](std::size_t k, int row, double residual, double) {
    all[k][static_cast<std::size_t>(row)] = residual;
  });
  t.clear();
  for (std::size_t k = 0; k < model.windows(); ++k) t.push_back(model.window(k).t);
  return all;
}

double floor_of(const TriadNoise& noise, double window, double duration) {
  const double u = noise.wander_correlation_time / duration;
  const double share = 1.0 - 2.0 * u * (1.0 - u * (1.0 - std::exp(-1.0 / u)));
  return std::sqrt(noise.density * noise.density / window + noise.wander * noise.wander * std::max(0.0, share));
}

/// Eq. (3) of one triad. @param d differences after correction, by window; @param u true inputs
void find_left(const std::vector<Vec3<double>>& d, const std::vector<Vec3<double>>& u, const TriadNoise& noise,
               double window, Mat3<double>& left, Mat3<double>& sigma) {
  constexpr double kRankLoss = 1e-12;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t k = 0; k < d.size(); ++k) {
    const Eigen::Vector4d row(u[k](0), u[k](1), u[k](2), 1.0);
    normal += row * row.transpose();
    right += row * d[k].transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(normal);
  const double floor = kRankLoss * std::max(eigen.eigenvalues()(3), std::numeric_limits<double>::min());
  const Eigen::Matrix4d inverse = eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseMax(floor).cwiseInverse().asDiagonal() *
                                  eigen.eigenvectors().transpose();
  left = (inverse * right).topRows<3>().transpose();
  const double density =
      noise.density * noise.density + 2.0 * noise.wander * noise.wander * noise.wander_correlation_time;
  for (int j = 0; j < 3; ++j) sigma.col(j).setConstant(std::sqrt(density / window * inverse(j, j)));
}

}  // namespace

Verification verify(const CompressedRecording& before, const CompressedRecording& after, int mount,
                    const CalibrationValues& values, const Rig& rig, const Site& site, const UnitNoise& noise) {
  // the table as calibrated, a unit without errors
  CalibrationValues table = values;
  table.unit = InertialUnit<double>();
  for (auto& bias : table.recording_bias) bias = {};
  table.gravity = site.gravity;  // a calibration does not keep its own
  std::vector<double> t;
  std::vector<double> t_after;
  const std::vector<std::array<double, 6>> d_before = differences(before, mount, table, rig, site, t);
  const std::vector<std::array<double, 6>> d_after = differences(after, mount, table, rig, site, t_after);
  if (t.empty()) throw Error(ExitCode::kInput, before.name + ": the encoders and the IMU do not overlap in time");
  if (t != t_after) throw Error(ExitCode::kInput, before.name + ": its corrected samples make other windows");
  Verification v;
  v.windows = static_cast<long long>(t.size());
  v.window = 2.0 * before.windows.front().half_width;
  const auto n = static_cast<double>(t.size());
  for (std::size_t axis = 0; axis < 6; ++axis) {
    AxisVerification& one = v.axis[axis];
    for (std::size_t k = 0; k < t.size(); ++k) {
      one.mean_before += d_before[k][axis] / n;
      one.mean_after += d_after[k][axis] / n;
    }
    for (std::size_t k = 0; k < t.size(); ++k) {
      one.before += std::pow(d_before[k][axis] - one.mean_before, 2.0) / n;
      one.after += std::pow(d_after[k][axis] - one.mean_after, 2.0) / n;
    }
    one.before = std::sqrt(one.before);
    one.after = std::sqrt(one.after);
    one.floor = floor_of(axis < 3 ? noise.gyro : noise.accel, v.window, before.figures.duration);
  }
  std::array<std::vector<Vec3<double>>, 2> d;
  std::array<std::vector<Vec3<double>>, 2> u;
  std::size_t at = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    while (after.windows[at].t != t[k]) ++at;
    for (std::size_t triad = 0; triad < 2; ++triad) {
      const Vec3<double> difference(d_after[k][3 * triad], d_after[k][3 * triad + 1], d_after[k][3 * triad + 2]);
      d[triad].push_back(difference);
      u[triad].push_back((triad == 0 ? after.windows[at].mean.w : after.windows[at].mean.f) - difference);
    }
  }
  for (std::size_t triad = 0; triad < 2; ++triad)
    find_left(d[triad], u[triad], triad == 0 ? noise.gyro : noise.accel, v.window, v.left[triad], v.left_sigma[triad]);
  for (std::size_t k = 0; k < t.size(); ++k) {
    v.course.emplace_back();
    v.course.back()[0] = t[k];
    for (std::size_t axis = 0; axis < 6; ++axis) {
      v.course.back()[1 + axis] = d_before[k][axis];
      v.course.back()[7 + axis] = d_after[k][axis];
    }
  }
  return v;
}

}  // namespace trunnion::calibration
