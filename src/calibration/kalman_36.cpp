// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/kalman_36.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "trunnion/alignment/coarse.hpp"
#include "trunnion/calibration/channel.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/strapdown/body_motion.hpp"

namespace trunnion::calibration {
namespace {

constexpr double kBlock = 0.25;                // s, of the detector of rests
constexpr double kTurning = 0.3 * kRadPerDeg;  // rad/s
constexpr double kMargin = 1.0;                // s on both sides of a turn
constexpr double kAlignment = 10.0;            // s
constexpr double kStep = 0.1;                  // s, of the filter
constexpr double kRestVelocity = 1e-4;         // m/s, 1 sigma
constexpr double kHidden = 0.3;                // of the Earth's rate: gyros at rest that differ from it by more
constexpr double kLevelling = 2.0;             // s
constexpr int kFewestRests = 6;

enum Place : int {
  kPhi = 0,
  kVelocity = 3,
  kGyroBias = 6,
  kAccelBias = 9,
  kGyroMatrix = 12,
  kAccelMatrix = 21,
  kQuadratic = 27,
  kLeverY = 30,
  kLeverZ = 33,
  kStates = 36
};
using State = Eigen::Matrix<double, kStates, 1>;
using Covariance = Eigen::Matrix<double, kStates, kStates>;
using Rows = Eigen::Matrix<double, 3, kStates>;

constexpr std::array<std::array<int, 2>, 6> kUpper = {{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

using Algorithm = ExactSamples<double, 2>;

/// What the pass works on.
struct Data {
  const std::vector<InertialSample<double>>& samples;
  std::vector<bool> still;
  double period;
};

/// Of one pass over the data with one model of the unit.
class Pass {
 public:
  Pass(const Data& data, const Site& site, const Kalman36Options& options, const InertialUnit<double>& unit,
       const std::array<Vec3<double>, 2>& lever)
      : data_(data), site_(site), noise_(options.noise), correction_(unit), lever_(lever) {}

  void run() {
    corrected();
    const std::size_t start = align();
    w_ie_n_ = Vec3<double>(kEarthRate * std::cos(site_.latitude), 0.0, -kEarthRate * std::sin(site_.latitude));
    P_.setZero();
    x_.setZero();
    const auto prior = [&](int from, int count, double sigma) {
      for (int i = from; i < from + count; ++i) P_(i, i) = sigma * sigma;
    };
    prior(kPhi, 2, 0.02);
    prior(kPhi + 2, 1, heading_sigma_);
    prior(kVelocity, 3, 1e-3);
    prior(kGyroBias, 3, 1000.0 * kRadPerSPerDegPerH);
    prior(kAccelBias, 3, 0.02 * kStandardGravity);
    prior(kGyroMatrix, 9, 0.03);
    prior(kAccelMatrix, 6, 0.03);
    prior(kQuadratic, 3, 1e-3 / kStandardGravity);
    prior(kLeverY, 6, 0.1);

    const auto updates = static_cast<std::size_t>(std::max(1.0, std::round(kStep / (2.0 * data_.period))));
    std::size_t k = start;
    bool was_still = true;
    while (k + 2 * updates <= sample_.size()) {
      Rows on_phi = Rows::Zero();
      Rows on_velocity = Rows::Zero();
      Vec3<double> push = Vec3<double>::Zero();
      bool still = true;
      for (std::size_t u = 0; u < updates; ++u, k += 2) {
        still = still && data_.still[k] && data_.still[k + 1];
        advance(k, on_phi, on_velocity, push);
      }
      predict(static_cast<double>(2 * updates) * data_.period, on_phi, on_velocity, push);
      if (still && !was_still) level(k);
      was_still = still;
      if (still) at_rest();
    }
  }

  [[nodiscard]] const State& state() const { return x_; }
  [[nodiscard]] const Covariance& covariance() const { return P_; }

 private:
  /// Samples through the model, without the size effect that is known so far.
  void corrected() {
    sample_.reserve(data_.samples.size());
    for (const InertialSample<double>& reading : data_.samples) sample_.push_back(correction_.correct(reading));
    if (lever_[0].isZero(0.0) && lever_[1].isZero(0.0)) return;
    // it hangs on rates alone, which stay
    for (std::size_t k = 0; k < sample_.size(); ++k) {
      const Mat3<double> A = size_effect(k);
      sample_[k].f.y() -= A.row(1).dot(lever_[0]);
      sample_[k].f.z() -= A.row(2).dot(lever_[1]);
    }
  }

  /// dw/dt x + w x w x at sample @p k.
  [[nodiscard]] Mat3<double> size_effect(std::size_t k) const {
    const std::size_t a = k == 0 ? 0 : k - 1;
    const std::size_t b = std::min(k + 1, sample_.size() - 1);
    const Vec3<double> rate = (sample_[b].w - sample_[a].w) / (static_cast<double>(b - a) * data_.period);
    const Mat3<double> W = skew(sample_[k].w);
    return skew(rate) + W * W;
  }

  /// Level and heading from the first rest. @return the sample after it
  std::size_t align() {
    const auto count = static_cast<std::size_t>(std::lround(kAlignment / data_.period));
    InertialSample<double> mean;
    for (std::size_t k = 0; k < count; ++k) {
      mean.w += sample_[k].w / static_cast<double>(count);
      mean.f += sample_[k].f / static_cast<double>(count);
    }
    const double drift = std::hypot(noise_.gyro.density / std::sqrt(kAlignment), noise_.gyro.wander);
    const auto alignment =
        coarse_align<double>(mean, {drift, noise_.accel.density / std::sqrt(kAlignment)}, site_.latitude);
    heading_sigma_ = 1.0;  // a gyro whose bias hides the Earth
    if (alignment.ok()) {
      q_nb_ = alignment.value().q_nb;
      heading_sigma_ = std::min(1.0, 0.02 + 3.0 * std::sqrt(alignment.value().covariance(2, 2)));
    } else {
      q_nb_ = Quaternion<double>::FromTwoVectors(mean.f, Vec3<double>(0.0, 0.0, -1.0));
    }
    return count;
  }

  /// One update of two samples, and what the parameters do to it, eq. (3).
  void advance(std::size_t k, Rows& on_phi, Rows& on_velocity, Vec3<double>& push) {
    const double T = 2.0 * data_.period;
    for (std::size_t i = k; i < k + 2; ++i) {
      const double h = data_.period;
      // the attitude in the middle of the sample
      const Vec3<double> so_far =
          i == k ? Vec3<double>(0.5 * h * sample_[k].w) : Vec3<double>(h * sample_[k].w + 0.5 * h * sample_[k + 1].w);
      const Mat3<double> C = h * (q_nb_ * quaternion_exp<double>(so_far)).toRotationMatrix();
      // of the unit as it should be there: noise in what multiplies a parameter would pass for knowledge of it
      const Vec3<double> f = C.transpose() * Vec3<double>(0.0, 0.0, -site_.gravity / h);
      const Vec3<double> w = data_.still[i] ? Vec3<double>(C.transpose() * w_ie_n_ / h) : sample_[i].w;
      on_phi.middleCols<3>(kGyroBias) -= C;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) on_phi.col(kGyroMatrix + 3 * row + column) -= w(column) * C.col(row);
        on_velocity.col(kQuadratic + row) += f(row) * f(row) * C.col(row);
      }
      on_velocity.middleCols<3>(kAccelBias) += C;
      for (std::size_t e = 0; e < kUpper.size(); ++e)
        on_velocity.col(kAccelMatrix + static_cast<int>(e)) += f(kUpper[e][1]) * C.col(kUpper[e][0]);
      if (!data_.still[i]) {
        const Mat3<double> A = size_effect(i);
        on_velocity.middleCols<3>(kLeverY) += C.col(1) * A.row(1);
        on_velocity.middleCols<3>(kLeverZ) += C.col(2) * A.row(2);
      }
    }
    const BodyMotion<double> motion =
        algorithm_({increment_of(sample_[k], data_.period), increment_of(sample_[k + 1], data_.period)});
    const Vec3<double> dv = q_nb_ * motion.velocity;
    push += dv;
    v_ += dv - 0.5 * T * w_ie_n_.cross(dv) + T * (Vec3<double>(0.0, 0.0, site_.gravity) - 2.0 * w_ie_n_.cross(v_));
    const Quaternion<double> turned(1.0 + motion.rotation_w, motion.rotation_v.x(), motion.rotation_v.y(),
                                    motion.rotation_v.z());
    q_nb_ = (quaternion_exp<double>(Vec3<double>(-T * w_ie_n_)) * q_nb_ * turned).normalized();
  }

  /// Eq. (2) over one step.
  void predict(double t, const Rows& on_phi, Rows on_velocity, const Vec3<double>& push) {
    const Mat3<double> S = skew(push);
    on_velocity += 0.5 * S * on_phi;
    Covariance Phi = Covariance::Identity();
    Phi.topRows<3>() += on_phi;
    Phi.middleRows<3>(kVelocity) += on_velocity;
    Phi.block<3, 3>(kPhi, kPhi) -= t * skew(w_ie_n_);
    Phi.block<3, 3>(kVelocity, kPhi) += S;
    Phi.block<3, 3>(kVelocity, kVelocity) -= 2.0 * t * skew(w_ie_n_);
    x_ = Phi * x_;
    P_ = Phi * P_ * Phi.transpose();
    const auto add = [&](int from, double variance) {
      for (int i = from; i < from + 3; ++i) P_(i, i) += variance;
    };
    add(kPhi, noise_.gyro.density * noise_.gyro.density * t);
    add(kVelocity, noise_.accel.density * noise_.accel.density * t);
    add(kGyroBias, 2.0 * noise_.gyro.wander * noise_.gyro.wander / noise_.gyro.wander_correlation_time * t);
    add(kAccelBias, 2.0 * noise_.accel.wander * noise_.accel.wander / noise_.accel.wander_correlation_time * t);
  }

  /// Levels the frame anew by the force at rest from sample @p k on. It is the reference that moves, by a known angle:
  /// nothing is learnt, but the tilt that gyros gather in a thousand seconds stays small.
  void level(std::size_t k) {
    const std::size_t end = std::min(sample_.size(), k + static_cast<std::size_t>(kLevelling / data_.period));
    Vec3<double> f = Vec3<double>::Zero();
    for (; k < end && data_.still[k]; ++k) f += sample_[k].f;
    if (f.isZero(0.0)) return;
    const Vec3<double> tilt = (q_nb_ * f.normalized()).cross(Vec3<double>(0.0, 0.0, -1.0));
    q_nb_ = (quaternion_exp<double>(tilt) * q_nb_).normalized();
    x_.segment<3>(kPhi) -= tilt;
  }

  /// The velocity that is there is an error, which is taken out at once.
  void at_rest() {
    const Mat3<double> S =
        P_.block<3, 3>(kVelocity, kVelocity) + kRestVelocity * kRestVelocity * Mat3<double>::Identity();
    const Eigen::Matrix<double, kStates, 3> K = P_.middleCols<3>(kVelocity) * S.inverse();
    x_ += K * (v_ - x_.segment<3>(kVelocity));
    // Joseph: variances span twenty decades, and the short form loses their sign
    Covariance kept = Covariance::Identity();
    kept.middleCols<3>(kVelocity) -= K;
    P_ = kept * P_ * kept.transpose() + kRestVelocity * kRestVelocity * K * K.transpose();
    P_ = 0.5 * (P_ + P_.transpose()).eval();
    v_ -= x_.segment<3>(kVelocity);
    // the attitude keeps its error as a state: what it is thought to be wanders while little is known, and fed back
    // would turn the frame of all the rest
    x_.segment<3>(kVelocity).setZero();
  }

  const Data& data_;
  const Site& site_;
  UnitNoise noise_;
  UnitCorrection<double> correction_;
  std::array<Vec3<double>, 2> lever_;
  std::vector<InertialSample<double>> sample_;
  Algorithm algorithm_;
  Quaternion<double> q_nb_;
  Vec3<double> v_ = Vec3<double>::Zero();
  Vec3<double> w_ie_n_;
  double heading_sigma_ = 1.0;
  State x_;
  Covariance P_;
};

/// Where the unit stands, from its own rates. @return the number of rests
int find_rests(const std::vector<InertialSample<double>>& samples, double period, std::vector<bool>& still) {
  const auto block = static_cast<std::size_t>(std::max(1.0, std::round(kBlock / period)));
  const auto margin = static_cast<std::size_t>(std::ceil(kMargin / kBlock));
  const auto first = std::min(samples.size(), static_cast<std::size_t>(5.0 / period));
  Vec3<double> bias = Vec3<double>::Zero();
  for (std::size_t k = 0; k < first; ++k) bias += samples[k].w / static_cast<double>(first);
  const std::size_t blocks = samples.size() / block;
  std::vector<bool> turning(blocks, false);
  for (std::size_t b = 0; b < blocks; ++b) {
    Vec3<double> mean = Vec3<double>::Zero();
    for (std::size_t k = b * block; k < (b + 1) * block; ++k) mean += samples[k].w;
    turning[b] = (mean / static_cast<double>(block) - bias).norm() > kTurning;
  }
  still.assign(samples.size(), false);
  int rests = 0;
  bool before = false;
  for (std::size_t b = 0; b < blocks; ++b) {
    bool rest = true;
    for (std::size_t n = b > margin ? b - margin : 0; n < std::min(blocks, b + margin + 1); ++n)
      rest = rest && !turning[n];
    for (std::size_t k = b * block; k < (b + 1) * block; ++k) still[k] = rest;
    rests += rest && !before ? 1 : 0;
    before = rest;
  }
  return rests;
}

}  // namespace

void Kalman36::imu(std::int64_t utime, const InertialSample<double>& sample) {
  if (!utime_.empty() && utime <= utime_.back()) return;
  utime_.push_back(utime);
  samples_.push_back(sample);
}

Kalman36Result Kalman36::finish(const Site& site, const Kalman36Options& options) const {
  if (samples_.size() < 1000) throw Error(ExitCode::kInput, name_ + ": too few samples for a system-level calibration");
  std::vector<double> steps(utime_.size() - 1);
  for (std::size_t k = 0; k + 1 < utime_.size(); ++k) steps[k] = 1e-6 * static_cast<double>(utime_[k + 1] - utime_[k]);
  Data data{samples_, {}, sample_period(steps, name_)};
  Kalman36Result result;
  result.rests = find_rests(samples_, data.period, data.still);
  const auto first = static_cast<std::size_t>(kAlignment / data.period) + 1;
  if (samples_.size() <= first ||
      !std::all_of(data.still.begin(), data.still.begin() + static_cast<std::ptrdiff_t>(first),
                   [](bool s) { return s; }))
    throw Error(ExitCode::kInput, name_ + ": a system-level calibration begins with eleven seconds at rest");
  if (result.rests < kFewestRests)
    throw Error(ExitCode::kInput, name_ + ": " + std::to_string(result.rests) +
                                      " rests: a system-level calibration needs " + std::to_string(kFewestRests) +
                                      " at least, turned between");
  // gyros whose bias hides the Earth: what they read at rest is their bias, but for it
  Vec3<double> at_rest = Vec3<double>::Zero();
  for (std::size_t k = 0; k < first; ++k) at_rest += samples_[k].w / static_cast<double>(first);
  if (std::abs(at_rest.norm() - kEarthRate) > kHidden * kEarthRate) result.unit.gyro.bias = at_rest;
  for (result.rounds = 1; result.rounds <= options.most_rounds; ++result.rounds) {
    Pass pass(data, site, options, result.unit, result.lever);
    pass.run();
    const State& x = pass.state();
    result.covariance = pass.covariance().bottomRightCorner<kStates - 6, kStates - 6>();
    if (!x.allFinite()) throw Error(ExitCode::kNumerics, name_ + ": the system-level filter diverged");
    // (I + M) <- (I + M)(I + dM), b <- b + (I + M) db
    Mat3<double> dM_g;
    Mat3<double> dM_a = Mat3<double>::Zero();
    for (int i = 0; i < 9; ++i) dM_g(i / 3, i % 3) = x(kGyroMatrix + i);
    for (std::size_t e = 0; e < kUpper.size(); ++e)
      dM_a(kUpper[e][0], kUpper[e][1]) = x(kAccelMatrix + static_cast<int>(e));
    InertialUnit<double>& unit = result.unit;
    unit.gyro.bias += unit.gyro.matrix() * x.segment<3>(kGyroBias);
    unit.accel.bias += unit.accel.matrix() * x.segment<3>(kAccelBias);
    unit.gyro.M = (unit.gyro.matrix() * (Mat3<double>::Identity() + dM_g)) - Mat3<double>::Identity();
    unit.accel.M = (unit.accel.matrix() * (Mat3<double>::Identity() + dM_a)) - Mat3<double>::Identity();
    unit.accel.quadratic += x.segment<3>(kQuadratic);
    result.lever[0] += x.segment<3>(kLeverY);
    result.lever[1] += x.segment<3>(kLeverZ);
    const Eigen::VectorXd sigma = result.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
    const double change = x.tail<kStates - 6>().cwiseAbs().cwiseQuotient(sigma).maxCoeff();
    if (change < options.converged) return result;
  }
  throw Error(ExitCode::kNumerics,
              name_ + ": the system-level filter did not settle in " + std::to_string(options.most_rounds) + " rounds");
}

InertialUnit<double> in_accelerometer_frame(const InertialUnit<double>& unit) {
  // I + M_a = U Q with U upper triangular: from the QR of its rows turned about
  const Mat3<double> J = Mat3<double>::Identity().rowwise().reverse();
  const Eigen::HouseholderQR<Mat3<double>> qr((J * unit.accel.matrix()).transpose());
  const Mat3<double> Q = Mat3<double>(qr.householderQ()).transpose();
  Mat3<double> turned = J * Q;
  Mat3<double> U = unit.accel.matrix() * turned.transpose();
  for (int i = 0; i < 3; ++i) {
    if (U(i, i) < 0.0) turned.row(i) = -turned.row(i);
  }
  InertialUnit<double> same = unit;
  same.accel.M = unit.accel.matrix() * turned.transpose() - Mat3<double>::Identity();
  same.gyro.M = unit.gyro.matrix() * turned.transpose() - Mat3<double>::Identity();
  same.g_sensitivity = unit.g_sensitivity * turned.transpose();
  return same;
}

}  // namespace trunnion::calibration
