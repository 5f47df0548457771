// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/comparison/trial.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "trunnion/calibration/kalman_36.hpp"
#include "trunnion/calibration/multi_position_solve.hpp"
#include "trunnion/calibration/rate_test.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion::comparison {
namespace {

using calibration::Compressor;
using calibration::Solution;
using calibration::TableRecording;
using simulation::TableSequence;

constexpr double kDwell = 40.0;                      // s
constexpr double kSlowTurn = 10.0 * kRadPerDeg;      // rad/s
constexpr double kBiasTime = 60.0;                   // s at rest
constexpr std::uint64_t kNavigationSeeds = 1000000;  // apart from those of the calibrations

/// A run of all mounts, compressed.
struct TableLog {
  CalibrationValues truth;
  std::vector<TableRecording> recordings;
  double seconds = 0.0;
};

TableLog record(const TrialSettings& s, const simulation::TableRunSettings& run, const Rig& rig,
                const TableLimits& limits, const std::function<TableSequence(int)>& sequence_of) {
  TableLog log;
  log.truth = simulation::draw_truth(run, rig, s.site, rig.mounts);
  for (int m = 0; m < rig.mounts; ++m) {
    calibration::CompressOptions options;
    options.period = 1.0 / run.rate;
    options.name = "mount " + std::to_string(m + 1);
    Compressor compressor(options);
    const TableSequence sequence = sequence_of(m);
    simulation::run_table(run, log.truth, rig, s.site, simulation::motion_of(sequence, limits), m, m,
                          {[&](std::int64_t t, std::int64_t, const InertialSample<double>& x) { compressor.imu(t, x); },
                           [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
    log.recordings.push_back({compressor.finish(), m});
    log.seconds += simulation::duration_of(sequence);
  }
  return log;
}

double rms_off_diagonal(const Mat3<double>& error) {
  return std::sqrt((error.squaredNorm() - error.diagonal().squaredNorm()) / 6.0);
}

/// In the frame that both calibrations have without a table.
void score_aligned(const InertialUnit<double>& found, const InertialUnit<double>& truth, Outcome& outcome) {
  const InertialUnit<double> f = calibration::in_accelerometer_frame(found);
  const InertialUnit<double> t = calibration::in_accelerometer_frame(truth);
  outcome.aligned_deg = rms_off_diagonal(f.gyro.M - t.gyro.M) / kRadPerDeg;
  const Mat3<double> accel = f.accel.M - t.accel.M;
  // three of its entries are zero
  outcome.accel_aligned_deg = std::sqrt((accel.squaredNorm() - accel.diagonal().squaredNorm()) / 3.0) / kRadPerDeg;
  outcome.gyro_scale_ppm = 1e6 * (f.gyro.M - t.gyro.M).diagonal().norm() / std::sqrt(3.0);
  outcome.accel_scale_ppm = 1e6 * accel.diagonal().norm() / std::sqrt(3.0);
}

Outcome rate_tested(const TrialSettings& s, const TableLog& log, bool one_mount) {
  Outcome outcome;
  outcome.seconds = one_mount ? log.seconds / static_cast<double>(log.recordings.size()) : log.seconds;
  const std::vector<TableRecording> used(log.recordings.begin(),
                                         one_mount ? log.recordings.begin() + 1 : log.recordings.end());
  const calibration::RateTestResult result = calibration::rate_test(used, s.table, s.site);
  double cross = 0.0;
  double scale = 0.0;
  int crosses = 0;
  int scales = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!result.determined(i, j)) continue;
      const double error = result.gyro.M(i, j) - log.truth.unit.gyro.M(i, j);
      (i == j ? scale : cross) += error * error;
      ++(i == j ? scales : crosses);
    }
  }
  if (crosses > 0) outcome.installation_deg = std::sqrt(cross / crosses) / kRadPerDeg;
  if (scales > 0) outcome.gyro_scale_ppm = 1e6 * std::sqrt(scale / scales);
  return outcome;
}

Outcome solved(const TrialSettings& s, const simulation::TableRunSettings& run, const TableLog& log, const Rig& rig,
               CalibrationValues* found = nullptr) {
  Outcome outcome;
  outcome.seconds = log.seconds;
  calibration::TableSolveOptions options;
  options.noise = run.noise;
  options.threads = 1;
  const Solution solution = calibration::solve_table(log.recordings, rig, s.site, options);
  if (!solution.observability.refused.empty()) {
    outcome.failure = calibration::describe(solution.observability);
    return outcome;
  }
  const InertialUnit<double>& unit = solution.record.value.unit;
  score_aligned(unit, log.truth.unit, outcome);
  outcome.installation_deg = rms_off_diagonal(unit.gyro.M - log.truth.unit.gyro.M) / kRadPerDeg;
  if (found != nullptr) *found = solution.record.value;
  calibration::LayoutRequest request;
  request.recordings = static_cast<int>(log.recordings.size());
  for (int m = 0; m < rig.mounts; ++m) {
    request.mounts.push_back("mount " + std::to_string(m + 1));
    request.mount_used.push_back(true);
  }
  const calibration::Layout layout(request);
  Eigen::VectorXd truth;
  layout.write(log.truth, truth);
  Eigen::VectorXd error = solution.x - truth;
  error(layout.heading) = std::remainder(error(layout.heading), 2.0 * kPi);
  outcome.squared_pulls = error.dot(solution.observability.covariance.llt().solve(error));
  outcome.parameters = static_cast<int>(error.size());
  return outcome;
}

/// A gimbal's log as samples, for those that need no encoders.
template <class Sink>
CalibrationValues feed(const TrialSettings& s, const simulation::TableRunSettings& run, const TableSequence& sequence,
                       Sink& sink) {
  CalibrationValues truth = simulation::draw_truth(run, s.gimbal, s.site, 1);
  simulation::run_table(run, truth, s.gimbal, s.site, simulation::motion_of(sequence), 0, 0,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& x) { sink.imu(t, x); },
                         [](std::int64_t, std::int64_t, double, double) {}});
  return truth;
}

/// One arm of a navigation trial.
class Arm {
 public:
  Arm(const InertialUnit<double>& unit, double period) : correction_(without_bias(unit)), period_(period) {}

  void rest(const InertialSample<double>& reading) {
    const InertialSample<double> x = correction_.correct(reading);
    mean_.w += x.w;
    mean_.f += x.f;
    ++count_;
  }
  void start(const InertialSample<double>& expected, const NavigationState<double>& state) {
    bias_.w = mean_.w / count_ - expected.w;
    bias_.f = mean_.f / count_ - expected.f;
    navigator_.emplace_back(state, period_);
  }
  void go(const InertialSample<double>& reading) {
    InertialSample<double> x = correction_.correct(reading);
    x.w -= bias_.w;
    x.f -= bias_.f;
    if (navigator_.front().add(increment_of(x, period_)) != Status::kOk)
      throw Error(ExitCode::kNumerics, "a navigation trial turns by more than a radian a sample");
  }
  [[nodiscard]] NavigationOutcome::Error error(const NavigationState<double>& truth) const {
    const NavigationState<double> s = navigator_.front().state();
    const Ellipsoid<double> ellipsoid(std::pow(std::sin(truth.latitude), 2.0));
    NavigationOutcome::Error e;
    e.position_m = std::hypot((s.latitude - truth.latitude) * (ellipsoid.north_radius + truth.height),
                              std::remainder(s.longitude - truth.longitude, 2.0 * kPi) *
                                  (ellipsoid.east_radius + truth.height) * std::cos(truth.latitude));
    e.velocity_m_s = (s.velocity - truth.velocity).head<2>().norm();
    e.attitude_deg = quaternion_log<double>(truth.attitude.conjugate() * s.attitude).norm() / kRadPerDeg;
    return e;
  }

 private:
  static InertialUnit<double> without_bias(InertialUnit<double> unit) {
    unit.gyro.bias.setZero();
    unit.accel.bias.setZero();
    return unit;
  }

  UnitCorrection<double> correction_;
  double period_;
  InertialSample<double> mean_;
  InertialSample<double> bias_;
  double count_ = 0.0;
  std::vector<Navigator<ExactSamples<double, 2>>> navigator_;  // one, once it starts
};

/// A minute at rest, then the experiment again and again.
TableSequence navigation_motion(const TrialSettings& s, int variant) {
  const AxisLimits& pitch = s.limits[kPitch];
  TableSequence moves = simulation::experiment(pitch.lowest, pitch.highest, variant);
  moves.insert(moves.begin() + 1, {kBiasTime, 1.0, moves.front().axis});
  while (simulation::duration_of(moves) < kBiasTime + s.navigation_time) {
    const TableSequence more = simulation::experiment(pitch.lowest, pitch.highest, ++variant % 5);
    moves.insert(moves.end(), more.begin() + 1, more.end());
  }
  return moves;
}

NavigationOutcome navigate(const TrialSettings& s, const CalibrationValues& of_calibration,
                           const CalibrationValues& found, std::uint64_t seed, int number) {
  simulation::TableRunSettings run = s.run;
  run.seed = kNavigationSeeds + 1000 * seed + static_cast<std::uint64_t>(number);
  run.rate = s.navigation_rate;
  run.encoder_rate = 1.0;
  // the unit and the table of the calibration, with other noise
  CalibrationValues truth = of_calibration;
  truth.gravity = s.site.gravity;
  truth.clock_offset = 0.0;
  const simulation::TableMotion motion = simulation::motion_of(navigation_motion(s, number), s.limits);
  const double period = 1.0 / run.rate;

  const TwoAxisTable<double> table(s.table.geometry, truth.rig, s.site.latitude, truth.gravity);
  const Mat3<double> C_pb = s.table.mount[0].C_pb;
  const auto state_at = [&](double t) {
    NavigationState<double> state;
    state.latitude = s.site.latitude;
    state.height = s.height;
    Mat3<double> C_nu;
    C_nu << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
    state.attitude =
        Quaternion<double>(C_nu * table.attitude(motion.azimuth.angle(t), motion.pitch.angle(t)) * C_pb).normalized();
    return state;
  };
  const auto expected_at = [&](double t) {
    // of the true angles: the encoders' eccentricity does not come in
    TwoAxisErrors<double> errors = truth.rig;
    errors.eccentricity = {};
    const TwoAxisTable<double> true_table(s.table.geometry, errors, s.site.latitude, truth.gravity);
    const InertialSample<double> p =
        true_table.input({motion.azimuth.angle(t), 0.0, 0.0}, {motion.pitch.angle(t), 0.0, 0.0}, truth.lever_arm[0]);
    return InertialSample<double>{C_pb.transpose() * p.w, C_pb.transpose() * p.f};
  };

  std::array<Arm, 3> arm = {Arm(InertialUnit<double>(), period), Arm(found.unit, period), Arm(truth.unit, period)};
  const auto rest = static_cast<std::int64_t>(std::llround(kBiasTime * run.rate));
  const auto last = static_cast<std::int64_t>(std::llround((kBiasTime + s.navigation_time) * run.rate));
  NavigationOutcome outcome;
  simulation::run_table(run, truth, s.table, s.site, motion, 0, 0,
                        {[&](std::int64_t, std::int64_t sequence, const InertialSample<double>& x) {
                           if (sequence >= last) return;
                           for (Arm& one : arm) sequence < rest ? one.rest(x) : one.go(x);
                           if (sequence + 1 == rest) {
                             for (Arm& one : arm) one.start(expected_at(0.5 * kBiasTime), state_at(kBiasTime));
                           }
                           if (sequence + 1 == last) {
                             const NavigationState<double> truth_then = state_at(kBiasTime + s.navigation_time);
                             outcome.raw = arm[0].error(truth_then);
                             outcome.calibrated = arm[1].error(truth_then);
                             outcome.floor = arm[2].error(truth_then);
                           }
                         },
                         [](std::int64_t, std::int64_t, double, double) {}});
  return outcome;
}

}  // namespace

Trial run_trial(const TrialSettings& s, const std::vector<Method>& methods, std::uint64_t seed) {
  Trial trial;
  trial.seed = seed;
  simulation::TableRunSettings run = s.run;
  run.seed = seed;
  const AxisLimits& pitch = s.limits[kPitch];
  const auto wanted = [&](Method method) { return std::find(methods.begin(), methods.end(), method) != methods.end(); };
  const auto add = [&](Method method, const std::function<Outcome()>& work) {
    if (!wanted(method)) return;
    Outcome outcome;
    try {
      outcome = work();
    } catch (const Error& e) {
      outcome.failure = e.what();
    }
    trial.methods.emplace_back(method, outcome);
  };

  if (wanted(Method::kTraditional) || wanted(Method::kRateTest) || wanted(Method::kTwelvePosition)) {
    const TableLog log = record(s, run, s.table, s.limits, [&](int) { return simulation::design_run(pitch); });
    add(Method::kTraditional, [&] { return rate_tested(s, log, true); });
    add(Method::kRateTest, [&] { return rate_tested(s, log, false); });
    add(Method::kTwelvePosition, [&] { return solved(s, run, log, s.table); });
  }
  CalibrationValues truth;
  CalibrationValues found;
  if (wanted(Method::kExperiment)) {
    const TableLog log = record(s, run, s.table, s.limits,
                                [&](int m) { return simulation::experiment(pitch.lowest, pitch.highest, m); });
    truth = log.truth;
    add(Method::kExperiment, [&] { return solved(s, run, log, s.table, &found); });
    for (int n = 0; n < s.navigations && trial.methods.back().second.failure.empty(); ++n)
      trial.navigations.push_back(navigate(s, truth, found, seed, n));
  }
  if (wanted(Method::kKalman36)) {
    add(Method::kKalman36, [&] {
      const TableSequence sequence = simulation::nineteen_positions(kDwell, kSlowTurn);
      calibration::Kalman36 filter("nineteen positions");
      const CalibrationValues unit = feed(s, run, sequence, filter);
      calibration::Kalman36Options options;
      options.noise = run.noise;
      // to its gyros, forces that they feel are a bias that moves with every turn: told so, it does better
      options.noise.gyro.wander = std::hypot(run.noise.gyro.wander, run.gyro_g_sensitivity * kStandardGravity);
      Outcome outcome;
      outcome.seconds = simulation::duration_of(sequence);
      score_aligned(filter.finish(s.site, options).unit, unit.unit, outcome);
      return outcome;
    });
  }
  add(Method::kByHand, [&] {
    const TableSequence sequence = simulation::nineteen_positions(kDwell, kSlowTurn);
    calibration::RestsAndTurns parts("nineteen positions");
    const CalibrationValues unit = feed(s, run, sequence, parts);
    calibration::HandSolveOptions options;
    options.terms.cubic = false;
    options.has_noise = true;
    options.noise = run.noise;
    Outcome outcome;
    outcome.seconds = simulation::duration_of(sequence);
    const calibration::HandSolution hand = calibration::solve_by_hand({parts.finish({})}, s.site, options);
    if (hand.solution.observability.refused.empty())
      score_aligned(hand.solution.record.value.unit, unit.unit, outcome);
    else
      outcome.failure = calibration::describe(hand.solution.observability);
    return outcome;
  });
  if (wanted(Method::kThreeAxis)) {
    const TableLog log =
        record(s, run, s.gimbal, TableLimits{}, [&](int) { return simulation::sixteen_positions(kDwell, kSlowTurn); });
    add(Method::kThreeAxis, [&] { return solved(s, run, log, s.gimbal); });
  }
  return trial;
}

}  // namespace trunnion::comparison
