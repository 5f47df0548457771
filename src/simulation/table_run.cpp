// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/simulation/table_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion::simulation {
namespace {

constexpr int kSteps = 4;  // a sample
constexpr std::int64_t kStartUtime = 1700000000000000;

enum Stream : std::uint64_t {
  kTruth = 0,
  kWhite = 100,
  kWander = 200,
  kOutliers = 300,
  kDrops = 400,
  kFurtherTruth = 500
};

double quantised(double value, double quantum) { return quantum > 0.0 ? quantum * std::round(value / quantum) : value; }

/// First-order Gauss-Markov process, exact at the sample instants.
class Wander {
 public:
  Wander(const TriadNoise& noise, double period, Gaussian& gaussian)
      : phi_(std::exp(-period / noise.wander_correlation_time)), drive_(noise.wander * std::sqrt(1.0 - phi_ * phi_)) {
    for (int i = 0; i < 3; ++i) state_(i) = noise.wander * gaussian();
  }
  const Vec3<double>& next(Gaussian& gaussian) {
    for (int i = 0; i < 3; ++i) state_(i) = phi_ * state_(i) + drive_ * gaussian();
    return state_;
  }

 private:
  double phi_;
  double drive_;
  Vec3<double> state_;
};

/// Attitude and positions of the accelerometers in inertial space: of the first alone where all are in one place.
struct Pose {
  Quaternion<double> q_ip = Quaternion<double>::Identity();
  std::array<Vec3<double>, 3> r_i;
};

/// The true table, by quaternions.
class TrueTable {
 public:
  TrueTable(const CalibrationValues& truth, const Rig& rig, const Site& site, const TableMotion& motion, int mount)
      : motion_(motion),
        joint_o_(rig.geometry.pitch_joint_o),
        q_qp_(rig.geometry.C_qp),
        w_ie_u_(earth_rate_enu(site.latitude)) {
    const Mat3<double> C_pb = rig.mount[static_cast<std::size_t>(mount)].C_pb *
                              rotation_exp<double>(truth.mount_error[static_cast<std::size_t>(mount)]);
    for (int i = 0; i < 3; ++i)
      lever_p_[static_cast<std::size_t>(i)] =
          truth.lever_arm[static_cast<std::size_t>(mount)] + C_pb * truth.unit.accel_place.col(i);
    points_ = truth.unit.accel_place.isZero(0.0) ? 1 : 3;
    const Quaternion<double> tilt = quaternion_exp<double>(Vec3<double>(truth.rig.tilt_x, truth.rig.tilt_y, 0.0));
    const Quaternion<double> heading = quaternion_exp<double>(Vec3<double>(0.0, 0.0, truth.rig.heading));
    q_uo_ = tilt * heading * Quaternion<double>(rig.geometry.C_to);
    q_axes_ =
        quaternion_exp<double>(Vec3<double>(rig.geometry.nonorthogonality + truth.rig.nonorthogonality, 0.0, 0.0));
  }

  [[nodiscard]] Pose at(double t) const {
    const double azimuth = motion_.azimuth.angle(t);
    const double pitch = motion_.pitch.angle(t);
    const Quaternion<double> q_ui_turned = quaternion_exp<double>(w_ie_u_ * t);
    const Quaternion<double> q_io =
        q_ui_turned * q_uo_ * Quaternion<double>(std::cos(0.5 * azimuth), 0.0, 0.0, std::sin(0.5 * azimuth));
    Pose pose;
    pose.q_ip = q_io * q_axes_ * Quaternion<double>(std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0) * q_qp_;
    for (std::size_t i = 0; i < points_; ++i) pose.r_i[i] = q_io * joint_o_ + pose.q_ip * lever_p_[i];
    return pose;
  }

  [[nodiscard]] std::size_t points() const { return points_; }

  /// What an accelerometer at rest feels, in inertial space.
  [[nodiscard]] Vec3<double> reaction_i(double t, double gravity) const {
    return quaternion_exp<double>(w_ie_u_ * t) * Vec3<double>(0.0, 0.0, gravity);
  }

 private:
  const TableMotion& motion_;
  std::array<Vec3<double>, 3> lever_p_;
  std::size_t points_;
  Vec3<double> joint_o_;
  Quaternion<double> q_uo_;
  Quaternion<double> q_axes_;
  Quaternion<double> q_qp_;
  Vec3<double> w_ie_u_;
};

}  // namespace

TableRunSettings::TableRunSettings()
    : gyro_bias(200.0 * kRadPerSPerDegPerH),
      gyro_turn_on_bias(10.0 * kRadPerSPerDegPerH),
      gyro_scale(2000e-6),
      gyro_cross_coupling(0.2 * kRadPerDeg),
      gyro_cubic(2e-5),
      gyro_g_sensitivity(5.0 * kRadPerSPerDegPerH / kStandardGravity),
      accel_bias(2000.0 * kMetresPerS2PerMicroG),
      accel_turn_on_bias(300.0 * kMetresPerS2PerMicroG),
      accel_scale(1000e-6),
      accel_cross_coupling(0.2 * kRadPerDeg),
      tilt(0.05 * kRadPerDeg),
      nonorthogonality(0.02 * kRadPerDeg),
      mount_error(0.05 * kRadPerDeg),
      eccentricity(15e-6),
      lever_arm(0.04),
      largest_clock_offset(0.004),
      gyro_thermal_bias(100.0 * kRadPerSPerDegPerH),
      gyro_thermal_scale(500e-6),
      accel_thermal_bias(1000.0 * kMetresPerS2PerMicroG),
      accel_thermal_scale(300e-6) {
  noise.gyro = {5.0 * kRadPerSPerDegPerH, 1.5 * kRadPerSPerDegPerH, 200.0};
  noise.accel = {25.0 * kMetresPerS2PerMicroG, 20.0 * kMetresPerS2PerMicroG, 200.0};
}

TableRunSettings TableRunSettings::noise_free() const {
  TableRunSettings clean = *this;
  clean.noise = UnitNoise{};
  clean.encoder_bits = 0;
  clean.gyro_quantum = 0.0;
  clean.accel_quantum = 0.0;
  clean.outlier_fraction = 0.0;
  clean.dropped_fraction = 0.0;
  clean.exact_gravity = true;
  return clean;
}

CalibrationValues draw_truth(const TableRunSettings& s, const Rig& rig, const Site& site, int recordings) {
  Gaussian draw(s.seed, kTruth);
  CalibrationValues truth;
  const auto vector = [&](double sigma) {
    Vec3<double> v;
    for (int i = 0; i < 3; ++i) v(i) = sigma * draw();
    return v;
  };
  const auto matrix = [&](double scale, double cross) {
    Mat3<double> M;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) M(i, j) = (i == j ? scale : cross) * draw();
    }
    return M;
  };
  const Vec3<double> gyro_bias = vector(s.gyro_bias);
  truth.unit.gyro.M = matrix(s.gyro_scale, s.gyro_cross_coupling);
  truth.unit.gyro.cubic = vector(s.gyro_cubic);
  truth.unit.g_sensitivity = matrix(s.gyro_g_sensitivity, s.gyro_g_sensitivity);
  const Vec3<double> accel_bias = vector(s.accel_bias);
  truth.unit.accel.M = matrix(s.accel_scale, s.accel_cross_coupling);
  truth.unit.accel.quadratic = vector(s.accel_quadratic);
  truth.rig.tilt_x = s.tilt * draw();
  truth.rig.tilt_y = s.tilt * draw();
  truth.rig.heading = kPi * (2.0 * draw.uniform() - 1.0);
  truth.rig.nonorthogonality = s.nonorthogonality * draw();
  for (auto& eccentricity : truth.rig.eccentricity) {
    eccentricity.cosine = s.eccentricity * draw();
    eccentricity.sine = s.eccentricity * draw();
  }
  for (std::size_t m = 0; m < static_cast<std::size_t>(rig.mounts); ++m) {
    const Vec3<double> error = vector(s.mount_error);
    if (m > 0) truth.mount_error[m] = error;
    Vec3<double> direction = vector(1.0);
    while (direction.norm() < 0.1) direction = vector(1.0);
    truth.lever_arm[m] = rig.mount[m].lever_p + s.lever_arm * direction.normalized();
  }
  Gaussian further(s.seed, kFurtherTruth);
  const auto further_vector = [&](double sigma) {
    Vec3<double> v;
    for (int i = 0; i < 3; ++i) v(i) = sigma * further();
    return v;
  };
  truth.unit.gyro.asymmetry = further_vector(s.gyro_asymmetry);
  truth.unit.accel.asymmetry = further_vector(s.accel_asymmetry);
  for (int i = 1; i < 3; ++i) truth.unit.accel_place.col(i) = further_vector(s.accel_place);
  if (s.soak.is_known()) {
    ThermalErrors<double>& thermal = truth.unit.thermal;
    thermal.reference = std::round(0.5 * (s.soak.from + s.soak.to));
    double power = 1.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.thermal_order); ++k) {
      power *= std::max(std::abs(s.soak.from - thermal.reference), std::abs(s.soak.to - thermal.reference));
      thermal.bias[k].w = further_vector(s.gyro_thermal_bias / power);
      thermal.bias[k].f = further_vector(s.accel_thermal_bias / power);
      thermal.scale[k].w = further_vector(s.gyro_thermal_scale / power);
      thermal.scale[k].f = further_vector(s.accel_thermal_scale / power);
    }
  }
  truth.clock_offset = 1e-6 * std::round(1e6 * s.largest_clock_offset * (2.0 * draw.uniform() - 1.0));
  truth.gravity = site.gravity + (s.exact_gravity ? 0.0 : site.gravity_sigma * draw());
  for (int r = 0; r < recordings; ++r) {
    auto& bias = truth.recording_bias[static_cast<std::size_t>(r)];
    bias.w = gyro_bias + vector(s.gyro_turn_on_bias);
    bias.f = accel_bias + vector(s.accel_turn_on_bias);
    truth.unit.gyro.bias += bias.w / recordings;
    truth.unit.accel.bias += bias.f / recordings;
  }
  return truth;
}

void run_table(const TableRunSettings& s, const CalibrationValues& truth, const Rig& rig, const Site& site,
               const TableMotion& motion, int mount, int index, const TableSinks& sinks) {
  const auto id = static_cast<std::uint64_t>(index);
  Gaussian white(s.seed, kWhite + id);
  Gaussian wandering(s.seed, kWander + id);
  Gaussian outlier(s.seed, kOutliers + id);
  Gaussian drop(s.seed, kDrops + id);
  const double period = 1.0 / s.rate;
  const double h = period / kSteps;
  Wander gyro_wander(s.noise.gyro, period, wandering);
  Wander accel_wander(s.noise.accel, period, wandering);
  const double gyro_white = s.noise.gyro.density / std::sqrt(period);
  const double accel_white = s.noise.accel.density / std::sqrt(period);
  const double encoder_quantum = s.encoder_bits > 0 ? 2.0 * kPi / std::ldexp(1.0, s.encoder_bits) : 0.0;
  const auto& bias = truth.recording_bias[static_cast<std::size_t>(index)];

  const TrueTable table(truth, rig, site, motion, mount);
  const Mat3<double> C_bp = (rig.mount[static_cast<std::size_t>(mount)].C_pb *
                             rotation_exp<double>(truth.mount_error[static_cast<std::size_t>(mount)]))
                                .transpose();
  InertialUnit<double> unit = truth.unit;
  unit.gyro.bias = bias.w;
  unit.accel.bias = bias.f;
  const bool soaked = s.soak.is_known();
  InertialUnit<double> warm;

  const auto samples = static_cast<long long>(std::floor(motion.duration * s.rate));
  const auto utime_of = [&](double t) { return kStartUtime + static_cast<std::int64_t>(std::llround(1e6 * t)); };
  const double encoder_period = 1.0 / s.encoder_rate;
  long long encoder_index = 0;
  const auto publish_encoder = [&](double until) {
    for (;; ++encoder_index) {
      const double t = static_cast<double>(encoder_index) * encoder_period;
      if (t > until) return;
      const double azimuth =
          quantised(truth.rig.eccentricity[kAzimuth].distort(motion.azimuth.angle(t)), encoder_quantum);
      const double pitch = quantised(truth.rig.eccentricity[kPitch].distort(motion.pitch.angle(t)), encoder_quantum);
      sinks.encoder(utime_of(t), encoder_index, azimuth - 2.0 * kPi * std::floor(azimuth / (2.0 * kPi)), pitch);
    }
  };

  // poses at -h, 0, h, ... : specific force at a step needs its neighbours
  std::array<Pose, 3> pose = {table.at(-h), table.at(0.0), table.at(h)};
  const std::size_t points = table.points();
  std::array<Vec3<double>, 3> f_last;
  const auto look_at_force = [&](double t) {
    for (std::size_t i = 0; i < points; ++i) {
      const Vec3<double> r_ddot = (pose[2].r_i[i] - 2.0 * pose[1].r_i[i] + pose[0].r_i[i]) / (h * h);
      f_last[i] = pose[1].q_ip.conjugate() * (r_ddot + table.reaction_i(t, truth.gravity));
    }
  };
  look_at_force(0.0);
  for (long long k = 1; k <= samples; ++k) {
    const double t_begin = static_cast<double>(k - 1) * period;
    Vec3<double> angle = Vec3<double>::Zero();
    std::array<Vec3<double>, 3> f_sum = f_last;  // Simpson: 1 4 2 4 1
    for (int step = 1; step <= kSteps; ++step) {
      angle += quaternion_log<double>(pose[1].q_ip.conjugate() * pose[2].q_ip);
      const double t = t_begin + step * h;
      pose = {pose[1], pose[2], table.at(t + h)};
      look_at_force(t);
      for (std::size_t i = 0; i < points; ++i)
        f_sum[i] += (step == kSteps ? 1.0 : step % 2 == 1 ? 4.0 : 2.0) * f_last[i];
    }
    InertialSample<double> input;
    input.w = C_bp * (angle / period);
    input.f = C_bp * (f_sum[0] / (3.0 * kSteps));
    const double celsius = s.soak.at(t_begin + 0.5 * period);
    const InertialUnit<double>& now = soaked ? (warm = unit.at(celsius)) : unit;
    InertialSample<double> reading = now.distort(input);
    for (std::size_t i = 1; i < points; ++i) {
      input.f = C_bp * (f_sum[i] / (3.0 * kSteps));
      reading.f(static_cast<int>(i)) = now.distort(input).f(static_cast<int>(i));
    }
    reading.w += gyro_wander.next(wandering);
    reading.f += accel_wander.next(wandering);
    for (int i = 0; i < 3; ++i) {
      reading.w(i) = quantised(reading.w(i) + gyro_white * white(), s.gyro_quantum);
      reading.f(i) = quantised(reading.f(i) + accel_white * white(), s.accel_quantum);
    }
    if (outlier.uniform() < s.outlier_fraction) {
      const int axis = static_cast<int>(3.0 * outlier.uniform());
      const double sign = outlier.uniform() < 0.5 ? -1.0 : 1.0;
      reading.w(axis) += sign * s.gyro_outlier;
      reading.f(axis) += sign * s.accel_outlier;
    }
    const double t = static_cast<double>(k) * period;
    publish_encoder(t);
    if (drop.uniform() < s.dropped_fraction) continue;
    if (soaked && sinks.temperature) sinks.temperature(celsius);
    sinks.imu(utime_of(t + truth.clock_offset), k - 1, reading);
  }
  publish_encoder(motion.duration + encoder_period);
}

}  // namespace trunnion::simulation
