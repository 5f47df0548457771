// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/modulation/residual.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/simulation/flicker.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

constexpr double kStep = 0.1;                             // s, of the noise
const ScheduleTiming<double> kTiming = {0.5 * kPi, 3.0};  // a half turn in 2 s, 3 s of rest

/// The attitude of every step of a cycle, from the table alone, by small turns.
struct Cycle {
  std::vector<Mat3<double>> attitude;  // C_bs in the middle of a step
  std::vector<Vec3<double>> rate;      // of the unit against the body, in the unit
  double step = 0.0;
};

template <std::size_t N>
Cycle cycle_of(const Schedule<N>& schedule, double step) {
  Cycle cycle;
  cycle.step = step;
  double outer = 0.0;
  double inner = 0.0;
  const auto push = [&](double w_outer, double w_inner) {
    const Eigen::AngleAxisd x(inner + 0.5 * w_inner * step, Vec3<double>::UnitX());
    const Eigen::AngleAxisd z(outer + 0.5 * w_outer * step, Vec3<double>::UnitZ());
    cycle.attitude.push_back((z * x).toRotationMatrix());
    cycle.rate.push_back(w_inner * Vec3<double>::UnitX() + w_outer * (x.inverse() * Vec3<double>::UnitZ()));
    outer += w_outer * step;
    inner += w_inner * step;
  };
  for (const ScheduleStep& s : schedule) {
    const double angle = 0.5 * kPi * s.quarter_turns;
    const auto moves = static_cast<int>(std::lround(std::abs(angle) / kTiming.rate / step));
    const double w = angle / (moves * step);
    for (int i = 0; i < moves; ++i) s.axis == ModulationAxis::kOuter ? push(w, 0.0) : push(0.0, w);
    for (int i = 0; s.rests && i < std::lround(kTiming.dwell / step); ++i) push(0.0, 0.0);
  }
  return cycle;
}

template <class Check>
void for_each_schedule(Check check) {
  check("continuous", kContinuous);
  check("reciprocating", kReciprocating);
  check("4-position", kFourPosition);
  check("8-position", kEightPosition);
  check("16-position", kSixteenPosition);
  check("64-position", kSixtyFourPosition);
}

/// Largest difference, against the size of what is compared or, where that has cancelled, of what went in.
double off(const Vec3<double>& formula, const Vec3<double>& simulated, double input) {
  return (formula - simulated).norm() / std::max(simulated.norm(), 1e-3 * input);
}

// Eq. (1) against the errors summed step by step: bias, scale and misalignment each by itself.
TEST(Residual, OfConstantErrorsIsWhatTheTurningLeaves) {
  const Vec3<double> input(0.3, -0.5, 0.8);
  double worst = 0.0;
  for_each_schedule([&](const char* name, const auto& schedule) {
    const Cycle cycle = cycle_of(schedule, 0.002);
    for (int cause = 0; cause < 12; ++cause) {
      for (const bool gyro : {true, false}) {
        Vec3<double> bias = Vec3<double>::Zero();
        Mat3<double> matrix = Mat3<double>::Zero();
        if (cause < 3) bias(cause) = 1.0;
        if (cause >= 3) matrix((cause - 3) / 3, (cause - 3) % 3) = 1.0;
        Vec3<double> sum = Vec3<double>::Zero();
        for (std::size_t i = 0; i < cycle.attitude.size(); ++i) {
          const Mat3<double>& C = cycle.attitude[i];
          Vec3<double> felt = C.transpose() * input;
          if (gyro) felt += cycle.rate[i];
          sum += C * (bias + matrix * felt);
        }
        sum /= static_cast<double>(cycle.attitude.size());
        const Vec3<double> formula = mean_error(schedule, kTiming, bias, matrix, input, gyro);
        worst = std::max(worst, off(formula, sum, 1.0));
        EXPECT_LT(off(formula, sum, 1.0), 0.05) << name << ' ' << cause << ' ' << gyro;
      }
    }
  });
  std::printf("[ FIGURE   ] residuals of bias, scale and misalignment: formula off by at most %.2f %%\n",
              100.0 * worst);
}

// What each schedule is for.
TEST(Residual, NamesWhatEachScheduleCures) {
  const auto bias = [](const auto& schedule) { return mean_attitude(schedule, kTiming).norm(); };
  EXPECT_NEAR(bias(kContinuous), 1.0, 1e-12);  // the axial bias
  EXPECT_GT(bias(kEightPosition), 0.1);        // of the moves
  EXPECT_LT(bias(kSixteenPosition), 1e-12);
  EXPECT_LT(bias(kSixtyFourPosition), 1e-12);
  const Vec3<double> none = Vec3<double>::Zero();
  const auto scale = [&none](const auto& schedule) {
    return mean_error<double>(schedule, kTiming, none, Vec3<double>(1e-3, 2e-3, 3e-3).asDiagonal(), none, true).norm();
  };
  EXPECT_NEAR(scale(kContinuous), 3e-3 * kTiming.rate, 1e-12);
  EXPECT_LT(scale(kReciprocating), 1e-15);
  EXPECT_LT(scale(kFourPosition), 1e-15);
  EXPECT_LT(scale(kSixteenPosition), 1e-15);
  Mat3<double> tilt = Mat3<double>::Zero();
  tilt(0, 2) = tilt(2, 0) = tilt(1, 0) = tilt(0, 1) = 1e-3;
  const auto tilted = [&](const auto& schedule) {
    return mean_error<double>(schedule, kTiming, none, tilt, none, true).norm();
  };
  EXPECT_LT(tilted(kEightPosition), 1e-15);
  EXPECT_LT(tilted(kSixtyFourPosition), 1e-15);
}

/// Root mean square over many runs of the integral of (C - c_0) n over some cycles; n: noise of three axes.
template <class Noise>
Vec3<double> rms_of_integral(const Cycle& cycle, int cycles, int runs, Noise make) {
  Vec3<double> squares = Vec3<double>::Zero();
  Mat3<double> mean = Mat3<double>::Zero();
  for (const Mat3<double>& C : cycle.attitude) mean += C / static_cast<double>(cycle.attitude.size());
  for (int run = 0; run < runs; ++run) {
    auto noise = make(run);
    Vec3<double> sum = Vec3<double>::Zero();
    for (int k = 0; k < cycles; ++k) {
      for (const Mat3<double>& C : cycle.attitude) sum += cycle.step * ((C - mean) * noise());
    }
    squares += sum.cwiseAbs2();
  }
  return (squares / runs).cwiseSqrt();
}

// Eq. (3) and (4) against noise turned step by step. 1600 runs: 1.8 % is one sigma of an axis; the root mean square of
// the modulated ones is compared.
TEST(Residual, OfNoiseIsWhatTheTurningLeaves) {
  constexpr int kRuns = 1600;
  const auto pooled = [](const Vec3<double>& v, bool one_axis) {
    return one_axis ? v.head<2>().norm() / std::sqrt(2.0) : v.norm() / std::sqrt(3.0);
  };
  for_each_schedule([&](const char* name, const auto& schedule) {
    const bool one_axis = schedule.size() <= 4;
    const Cycle cycle = cycle_of(schedule, kStep);
    const double length = cycle_time(schedule, kTiming);
    const int cycles = std::max(1, static_cast<int>(400.0 / length));
    const double span = cycles * length;
    const NoiseResidual<double> formula = noise_residual(schedule, kTiming, 400);
    const Vec3<double> walk = rms_of_integral(cycle, cycles, kRuns, [&](int run) {
      return [gaussian = simulation::Gaussian(static_cast<std::uint64_t>(run), 1),
              w = Vec3<double>(Vec3<double>::Zero())]() mutable {
        for (int i = 0; i < 3; ++i) w(i) += std::sqrt(kStep) * gaussian();
        return w;
      };
    });
    const double walk_off = pooled(walk, one_axis) / (pooled(formula.random_walk, one_axis) * std::sqrt(span)) - 1.0;
    const Vec3<double> flicker = rms_of_integral(cycle, cycles, kRuns, [&](int run) {
      const auto seed = static_cast<std::uint64_t>(run);
      return [x = simulation::Flicker(1.0, kStep, span, seed, 2), y = simulation::Flicker(1.0, kStep, span, seed, 3),
              z = simulation::Flicker(1.0, kStep, span, seed, 4)]() mutable { return Vec3<double>(x(), y(), z()); };
    });
    const double flicker_off = pooled(flicker, one_axis) / (pooled(formula.flicker, one_axis) * std::sqrt(span)) - 1.0;
    std::printf("[ FIGURE   ] %-13s simulated against formula: rate random walk %+.1f %%, 1/f %+.1f %%\n", name,
                100.0 * walk_off, 100.0 * flicker_off);
    EXPECT_LT(std::abs(walk_off), 0.05) << name;
    EXPECT_LT(std::abs(flicker_off), 0.05) << name;
  });
}

}  // namespace
}  // namespace trunnion
