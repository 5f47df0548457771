// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/strapdown/error_dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "matchers/chi_square.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

using simulation::PathTruth;
using simulation::Pose;
using Error = Eigen::Matrix<double, 15, 1>;
using State = NavigationState<double>;
using Wide = long double;

constexpr Wide kStep = 0.1L;

/// Level or not, at rest or along a parallel.
struct Steady {
  double speed = 0.0;

  template <class S>
  Pose<S> operator()(const S& t) const {
    const auto of = [](double v) { return S(static_cast<Wide>(v)); };
    return {of(0.7), of(0.2) + of(speed / (6.388e6 * std::cos(0.7))) * t, of(500.0), of(0.1), of(-0.2), of(2.0)};
  }
};

State narrow(const NavigationState<Wide>& wide) {
  return {static_cast<double>(wide.latitude), static_cast<double>(wide.longitude), static_cast<double>(wide.height),
          wide.velocity.cast<double>(), wide.attitude.cast<double>()};
}

/// @p truth with the errors @p x in it.
NavigationState<Wide> with_errors(const NavigationState<Wide>& truth, const Error& x) {
  NavigationState<Wide> state = truth;
  const Wide sl = std::sin(truth.latitude);
  const Ellipsoid<Wide> ellipsoid(sl * sl);
  state.latitude += static_cast<Wide>(x(kPositionError)) / (ellipsoid.north_radius + truth.height);
  state.longitude +=
      static_cast<Wide>(x(kPositionError + 1)) / (ellipsoid.east_radius + truth.height) / std::cos(truth.latitude);
  state.height -= static_cast<Wide>(x(kPositionError + 2));
  state.velocity += x.segment<3>(kVelocityError).cast<Wide>();
  state.attitude = quaternion_exp<Wide>(-x.segment<3>(kPhi).cast<Wide>()) * truth.attitude;
  return state;
}

/// Errors of @p state against @p truth; biases are not seen.
Error errors_of(const NavigationState<Wide>& state, const NavigationState<Wide>& truth) {
  const Wide sl = std::sin(truth.latitude);
  const Ellipsoid<Wide> ellipsoid(sl * sl);
  Error x = Error::Zero();
  x.segment<3>(kPhi) = quaternion_log<Wide>(truth.attitude * state.attitude.conjugate()).cast<double>();
  x.segment<3>(kVelocityError) = (state.velocity - truth.velocity).cast<double>();
  x(kPositionError) = static_cast<double>((state.latitude - truth.latitude) * (ellipsoid.north_radius + truth.height));
  x(kPositionError + 1) = static_cast<double>((state.longitude - truth.longitude) *
                                              (ellipsoid.east_radius + truth.height) * std::cos(truth.latitude));
  x(kPositionError + 2) = static_cast<double>(truth.height - state.height);
  return x;
}

/// Navigates 900 s from the errors @p x, biases among them.
Error navigate(const PathTruth<Steady>& truth, const Increment<Wide>& increment, const Error& x) {
  Navigator<PreviousSample<double>> navigator(with_errors(truth.state(0.0L), x), static_cast<double>(kStep));
  Increment<double> biased{increment.angle.cast<double>(), increment.velocity.cast<double>()};
  biased.angle += static_cast<double>(kStep) * x.segment<3>(kGyroBias);
  biased.velocity += static_cast<double>(kStep) * x.segment<3>(kAccelBias);
  for (int i = 0; i < 9000; ++i) EXPECT_EQ(navigator.add(biased), Status::kOk);
  return errors_of(navigator.state<Wide>(), truth.state(900.0L));
}

// The law of (1)-(3): each cause alone, the non-linear navigator against the linear equations after 900 s, within 1 %
// of the largest error of its kind; at rest, and at 100 m/s east.
TEST(ErrorDynamics, AgreeWithTheNavigator) {
  for (const double speed : {0.0, 100.0}) {
    const PathTruth<Steady> truth(Steady{speed});
    const Increment<Wide> increment = truth.increment(0.0L, kStep);
    const Error none = navigate(truth, increment, Error::Zero());
    const State start = narrow(truth.state(0.0L));
    const InertialSample<Wide> sample = truth.sample(0.0L);
    const ErrorMatrix<double> F = error_dynamics<double>(start, start.attitude * sample.f.cast<double>());
    for (int cause = 0; cause < 15; ++cause) {
      Error x = Error::Zero();
      x(cause) = cause < 3 ? 1e-5 : cause < 6 ? 0.01 : cause < 9 ? 10.0 : cause < 12 ? 1e-8 : 1e-4;
      const Error found = navigate(truth, increment, x) - none;
      Error linear = x;
      const double dt = 0.5;
      for (int i = 0; i < 1800; ++i) {
        Error term = linear;
        for (int k = 1; k <= 4; ++k) {
          term = (F * term * (dt / k)).eval();
          linear += term;
        }
      }
      for (const ErrorState kind : {kPhi, kVelocityError, kPositionError}) {
        const double size = linear.segment<3>(kind).norm();
        const double off = (found.segment<3>(kind) - linear.segment<3>(kind)).norm();
        const double floor = kind == kPhi ? 1e-12 : 1e-6;
        EXPECT_LT(off, 0.01 * size + floor) << "cause " << cause << ", kind " << kind << ", speed " << speed;
      }
    }
  }
}

// Covariance against the sample: 300 navigators with random biases, white noise and starts for 300 s at rest; NEES of
// the nine states within its band of 1e-3.
TEST(ErrorDynamics, PropagatesAnHonestCovariance) {
  const PathTruth<Steady> truth(Steady{0.0});
  const Increment<Wide> increment = truth.increment(0.0L, kStep);
  const State start = narrow(truth.state(0.0L));
  const ErrorMatrix<double> F = error_dynamics<double>(start, start.attitude * truth.sample(0.0L).f.cast<double>());
  Error sigma;
  sigma << 1e-4, 1e-4, 1e-3, 0.01, 0.01, 0.01, 1.0, 1.0, 1.0, 1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3;
  Error density = Error::Zero();
  constexpr double kGyro = 1e-5;   // rad/s/rtHz
  constexpr double kAccel = 1e-3;  // m/s^2/rtHz
  density.segment<3>(kPhi).setConstant(kGyro * kGyro);
  density.segment<3>(kVelocityError).setConstant(kAccel * kAccel);
  constexpr int kUpdates = 3000;
  ErrorMatrix<double> P = sigma.cwiseAbs2().asDiagonal();
  const auto dt = static_cast<double>(kStep);
  for (int i = 0; i < kUpdates; ++i) P = propagate_covariance<double>(P, F, density, dt);
  const Eigen::Matrix<double, 9, 9> information = P.topLeftCorner<9, 9>().inverse();

  simulation::Gaussian gaussian(11, 6);
  constexpr int kRuns = 300;
  double nees = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Error x;
    for (int i = 0; i < 15; ++i) x(i) = sigma(i) * gaussian();
    Navigator<PreviousSample<double>> navigator(with_errors(truth.state(0.0L), x), dt);
    for (int i = 0; i < kUpdates; ++i) {
      Increment<double> noisy{increment.angle.cast<double>() + dt * x.segment<3>(kGyroBias),
                              increment.velocity.cast<double>() + dt * x.segment<3>(kAccelBias)};
      for (int k = 0; k < 3; ++k) {
        noisy.angle(k) += kGyro * std::sqrt(dt) * gaussian();
        noisy.velocity(k) += kAccel * std::sqrt(dt) * gaussian();
      }
      ASSERT_EQ(navigator.add(noisy), Status::kOk);
    }
    const Eigen::Matrix<double, 9, 1> error = errors_of(navigator.state<Wide>(), truth.state(0.0L)).head<9>();
    nees += error.dot(information * error);
  }
  const ChiSquareBand band = chi_square_band(9.0 * kRuns, 1e-3);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

}  // namespace
}  // namespace trunnion
