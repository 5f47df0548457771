// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/twelve_position_solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/experiment.hpp"
#include "matchers/refuses.hpp"

namespace trunnion::calibration {
namespace {

using testing::HasSubstr;

const simulation::TableRunSettings& settings() {
  static const simulation::TableRunSettings instance;
  return instance;
}

/// The experiment with noise, recorded once for the tests below.
const Experiment& noisy() {
  static const Experiment experiment = run_experiment(settings(), bench());
  return experiment;
}

Solution solve(const Experiment& experiment, const Site& site = bench()) {
  TableSolveOptions options;
  options.noise = settings().noise;
  return solve_table(experiment.recordings, cyclic_rig(), site, options);
}

// Noise-free data come back exact: the simulation goes by attitude differences, the solve by the rate model.
TEST(SolveTable, NoiseFreeDataComeBackExact) {
  Site site = bench();
  site.gravity_sigma = 1e-9;
  for (const std::uint64_t seed : {1U, 2U}) {
    simulation::TableRunSettings clean = settings().noise_free();
    clean.seed = seed;
    const Experiment experiment = run_experiment(clean, site);
    const Solution solution = solve(experiment, site);
    const Eigen::VectorXd error = errors_of(solution, experiment);
    for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
      const Parameter& p = solution.parameters[i];
      const double e = std::abs(error(static_cast<Eigen::Index>(i))) * p.in_unit;
      if (p.kind == Entry::kGyroScale || (p.kind == Entry::kAccelScale && p.unit == "ppm")) {
        EXPECT_LT(e, 1.0) << p.name;
      } else if (p.kind == Entry::kGyroCrossCoupling || p.kind == Entry::kAccelCrossCoupling) {
        EXPECT_LT(e, 1e-5) << p.name;
      }
    }
    // and everything else to a fiftieth of its sigma, but gravity: that is the prior's alone, and last
    const Eigen::VectorXd sigma = solution.observability.covariance.diagonal().cwiseSqrt();
    const Eigen::Index others = error.size() - 1;
    ASSERT_EQ(solution.parameters.back().name, "gravity");
    EXPECT_LT(error.head(others).cwiseQuotient(sigma.head(others)).cwiseAbs().maxCoeff(), 0.02);
  }
}

// A dropped sample leaves a hole that the windows' weights know: still exact.
TEST(SolveTable, NoiseFreeDataWithHolesComeBackExact) {
  Site site = bench();
  site.gravity_sigma = 1e-9;
  simulation::TableRunSettings clean = settings().noise_free();
  clean.dropped_fraction = 0.05;
  const Experiment experiment = run_experiment(clean, site);
  const Solution solution = solve(experiment, site);
  const Eigen::VectorXd error = errors_of(solution, experiment);
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    const Parameter& p = solution.parameters[i];
    const double e = std::abs(error(static_cast<Eigen::Index>(i))) * p.in_unit;
    if (p.kind == Entry::kGyroScale) {
      EXPECT_LT(e, 1.0) << p.name;
    } else if (p.kind == Entry::kGyroCrossCoupling) {
      EXPECT_LT(e, 1e-5) << p.name;
    }
  }
}

TEST(SolveTable, TheSameDataGiveTheSameBits) {
  const Solution a = solve(noisy());
  const Solution b = solve(noisy());
  EXPECT_EQ(a.x, b.x);
}

TEST(SolveTable, TheBiasIsTheMeanOfTheTurnOnBiases) {
  const Solution solution = solve(noisy());
  const CalibrationValues& v = solution.record.value;
  const Vec3<double> mean = (v.recording_bias[0].w + v.recording_bias[1].w + v.recording_bias[2].w) / 3.0;
  EXPECT_LT((v.unit.gyro.bias - mean).norm(), 1e-18);
  EXPECT_NEAR(solution.record.fit.reduced_chi_square, 1.0, 0.02);  // 127,000 rows: 0.004, five sigma
  EXPECT_THAT(solution.gauge, testing::Contains("pitch_encoder_zero"));
}

// One mount: gravity never lies along the pitch axis, so what answers to it cannot be told; the names say so.
TEST(SolveTable, OneMountIsRefusedByName) {
  Experiment one;
  one.truth = noisy().truth;
  one.recordings.push_back(noisy().recordings.front());
  const Solution solution = solve(one);
  EXPECT_FALSE(solution.observability.refused.empty());
  const std::string text = describe(solution.observability);
  EXPECT_THAT(text, HasSubstr("accelerometer y scale"));
}

TEST(SolveTable, ThreeMountsAreNot) { EXPECT_TRUE(solve(noisy()).observability.refused.empty()); }

// Encoder and unit recorded at different times.
TEST(SolveTable, RefusesARecordingWithoutCommonTime) {
  CompressOptions options;
  options.name = "apart";
  Compressor compressor(options);
  for (int i = 0; i < 2000; ++i) compressor.imu(1000000 + 2500 * i, {Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)});
  for (int i = 0; i < 2000; ++i) compressor.encoder(100000000 + 5000 * i, 0.0, 0.0);
  std::vector<TableRecording> recordings;
  recordings.push_back({compressor.finish(), 0});
  TableSolveOptions solve_options;
  solve_options.noise = settings().noise;
  EXPECT_REFUSES(ExitCode::kInput, "apart: the encoders and the IMU do not overlap in time",
                 solve_table(recordings, cyclic_rig(), bench(), solve_options));
}

// A unit that reads g where m/s^2 is expected is no unit with a scale error of -900,000 ppm.
TEST(SolveTable, RefusesAWrongUnitOfTheAccelerometers) {
  std::vector<TableRecording> in_g = noisy().recordings;
  for (TableRecording& recording : in_g) {
    for (ObservationWindow& window : recording.data.windows) window.mean.f /= kStandardGravity;
  }
  TableSolveOptions options;
  options.noise = settings().noise;
  EXPECT_REFUSES(ExitCode::kInput, "wrong unit or nominal scale of the accelerometers",
                 solve_table(in_g, cyclic_rig(), bench(), options));
}

// A sheet that promises a tenth of the noise: the fit says so, and no sigma is printed.
TEST(SolveTable, RefusesDataThatDoNotFitTheirSheet) {
  TableSolveOptions options;
  options.noise = settings().noise;
  options.noise.gyro.density *= 0.1;
  options.noise.accel.density *= 0.1;
  EXPECT_REFUSES(ExitCode::kNumerics, "the data do not fit the model",
                 solve_table(noisy().recordings, cyclic_rig(), bench(), options));
}

// A clock offset that the run file states is taken as it is.
TEST(SolveTable, AStatedClockOffsetIsNotEstimated) {
  TableSolveOptions options;
  options.noise = settings().noise;
  options.estimate_clock_offset = false;
  options.clock_offset = noisy().truth.clock_offset;
  const Solution solution = solve_table(noisy().recordings, cyclic_rig(), bench(), options);
  EXPECT_EQ(solution.record.value.clock_offset, noisy().truth.clock_offset);
  EXPECT_EQ(solution.record.sigma.clock_offset, 0.0);
  EXPECT_TRUE(solution.observability.refused.empty());
}

}  // namespace
}  // namespace trunnion::calibration
