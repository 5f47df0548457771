// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Stand-ins for the paper's examples: three rates and three noises, one epoch alone, the paper's filter, the
/// multiplicative filter and the smoother; and the bound that no filter passes. Fixed seeds.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "attitude/three_antennas.hpp"
#include "trunnion/attitude/fixed_interval_smoother.hpp"
#include "trunnion/attitude/quaternion_ekf.hpp"
#include "trunnion/simulation/attitude_path.hpp"

namespace trunnion {
namespace {

using simulation::AttitudePath;
using simulation::Gaussian;
using simulation::PlatformMotion;
using Filter = MultiplicativeEkf<double, 2>;

constexpr int kEpochs = 200;  // of 1 s
constexpr int kRuns = 10;

struct Flight {
  std::vector<Quaternion<double>> truth;
  std::vector<VectorObservation<double, 2>> seen;
  std::vector<Quaternion<double>> computed;           ///< the paper's: equations (5) without weights, (6), (14)
  std::vector<Quaternion<double>> weighted_computed;  ///< the same from weighted baselines
};

Quaternion<double> computed_quaternion(const Eigen::Matrix<double, 3, 2>& x) {
  const auto C = attitude_by_equation_six<double>(x.col(0), x.col(1), ThreeAntennas::slaves());
  return Quaternion<double>(C.value()).normalized();
}

std::vector<Flight> runs_of(const AttitudePath& path, ThreeAntennas& array, std::uint64_t stream) {
  std::vector<Flight> runs;
  for (int r = 0; r < kRuns; ++r) {
    Gaussian noise(static_cast<std::uint64_t>(r), stream);
    Flight run;
    for (int k = 0; k < kEpochs && k <= path.duration(); ++k) {
      run.truth.push_back(path.q_nb(k));
      run.seen.push_back(array.observe(run.truth.back(), noise));
      run.computed.push_back(computed_quaternion(array.plain()));
      run.weighted_computed.push_back(
          computed_quaternion(Eigen::Map<const Eigen::Matrix<double, 3, 2>>(run.seen.back().value.data())));
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

/// RMS of roll, pitch and yaw, and of a component of the rotation vector, over all that was added.
class Score {
 public:
  void add(const Quaternion<double>& estimate, const Quaternion<double>& truth) {
    Vec3<double> off = euler_angles(estimate) - euler_angles(truth);
    for (int i = 0; i < 3; ++i) off(i) = std::remainder(off(i), 2.0 * kPi);
    euler_ += off.squaredNorm();
    vector_ += rotation_error(estimate, truth).squaredNorm();
    ++count_;
  }
  [[nodiscard]] double euler_deg() const { return std::sqrt(euler_ / (3.0 * count_)) / kRadPerDeg; }
  [[nodiscard]] double axis_deg() const { return std::sqrt(vector_ / (3.0 * count_)) / kRadPerDeg; }

 private:
  double euler_ = 0.0, vector_ = 0.0;
  int count_ = 0;
};

Score of_single_epochs(const std::vector<Flight>& runs, const ThreeAntennas& array, bool likely) {
  Score score;
  for (const Flight& run : runs) {
    for (std::size_t k = 0; k < run.seen.size(); ++k)
      score.add(likely ? attitude_from_vectors(run.seen[k], array.figure()).value().q_nb : run.computed[k],
                run.truth[k]);
  }
  return score;
}

/// The paper's filter; @p settle epochs at the start are not scored.
Score of_paper(const std::vector<Flight>& runs, bool weighted, double beta, double walk, double sigma_q, int settle) {
  Score score;
  for (const Flight& run : runs) {
    const std::vector<Quaternion<double>>& z = weighted ? run.weighted_computed : run.computed;
    QuaternionEkf<double> filter(z[0], beta, walk, sigma_q * sigma_q, 0.35);
    for (std::size_t k = 0; k < z.size(); ++k) {
      if (k > 0) {
        (void)filter.predict(1.0);
        (void)filter.update(z[k]);
      }
      if (static_cast<int>(k) >= settle) score.add(filter.q_nb(), run.truth[k]);
    }
  }
  return score;
}

/// The multiplicative filter and its smoother. @return RMS [deg]; infinite where an update did not settle: its noise is
/// far too small for the motion
std::array<double, 2> of_filter(const std::vector<Flight>& runs, const ThreeAntennas& array, double walk, int settle) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  Score score;
  Score smoothed;
  AttitudeNoise<double> noise;
  noise.walk = walk;
  for (const Flight& run : runs) {
    Filter filter(attitude_from_vectors(run.seen[0], array.figure()).value(), 0.0, 0.35, noise);
    std::vector<Filter::Record> records = {filter.record()};
    for (std::size_t k = 0; k < run.seen.size(); ++k) {
      if (k > 0) {
        (void)filter.predict(1.0);
        if (filter.update(run.seen[k], array.figure()) != Status::kOk) return {kNever, kNever};
        records.push_back(filter.record());
      }
      if (static_cast<int>(k) >= settle) score.add(filter.state().q_nb, run.truth[k]);
    }
    if (smooth(records.data(), static_cast<long>(records.size())) != Status::kOk) return {score.euler_deg(), kNever};
    for (std::size_t k = static_cast<std::size_t>(settle); k < records.size(); ++k)
      smoothed.add(records[k].after.q_nb, run.truth[k]);
  }
  return {score.euler_deg(), smoothed.euler_deg()};
}

/// Every filter's noise is tuned on the truth: each at its best [deg].
struct Best {
  double paper = std::numeric_limits<double>::infinity();
  double paper_weighted = paper;
  double filter = paper;
  double smoother = paper;
};

Best best_of(const std::vector<Flight>& runs, const ThreeAntennas& array, double sigma, int settle) {
  Best best;
  for (const double walk_deg : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0}) {
    const double walk = walk_deg * kRadPerDeg;
    for (const double factor : {0.5, 1.0, 2.0, 4.0}) {
      for (const double beta : {0.0, 1.0 / 60.0}) {  // random walk and Gauss-Markov
        best.paper = std::min(best.paper, of_paper(runs, false, beta, walk, factor * sigma, settle).euler_deg());
        best.paper_weighted =
            std::min(best.paper_weighted, of_paper(runs, true, beta, walk, factor * sigma, settle).euler_deg());
      }
    }
    const auto [filter, smoother] = of_filter(runs, array, walk, settle);
    best.filter = std::min(best.filter, filter);
    best.smoother = std::min(best.smoother, smoother);
  }
  return best;
}

TEST(Example1StandIn, TheMultiplicativeFilterBeatsThePapers) {
  constexpr int kSettle = 20;
  const char* const names[] = {"slow", "medium", "fast"};
  const double asked[] = {1.2, 2.0, 2.5};
  for (int motion = 0; motion < 3; ++motion) {
    const AttitudePath path = simulation::example_1_stand_in(static_cast<PlatformMotion>(motion), kEpochs);
    for (const double sigma : {0.001, 0.003, 0.005}) {
      ThreeAntennas array(sigma);
      const std::vector<Flight> runs = runs_of(path, array, 10U + static_cast<unsigned>(motion));
      const double raw = of_single_epochs(runs, array, false).euler_deg();
      const double single = of_single_epochs(runs, array, true).euler_deg();
      const Best best = best_of(runs, array, sigma, kSettle);
      std::printf(
          "[ FIGURE ] example 1 (stand-in), %s, %.0f mm, rms deg: equation (6) %.3f, one epoch %.3f, the paper's "
          "filter %.3f "
          "(%.3f on weighted baselines), multiplicative %.3f, smoother %.3f: %.2f times better than the paper's "
          "(%.1f)\n",
          names[motion], 1e3 * sigma, raw, single, best.paper, best.paper_weighted, best.filter, best.smoother,
          best.paper / best.filter, asked[motion]);
      EXPECT_GT(best.paper / best.filter, asked[motion]) << names[motion] << sigma;
      EXPECT_LT(best.smoother, 1.01 * best.filter);
      EXPECT_LT(single, raw / 1.5);
    }
  }
}

TEST(Example2StandIn, TheMultiplicativeFilterBeatsThePapers) {
  // 0.05 wavelengths, as the paper's toolbox has it
  const double sigma = 0.00951;
  ThreeAntennas array(sigma);
  const std::vector<Flight> runs = runs_of(simulation::example_2_stand_in(), array, 20);
  const double raw = of_single_epochs(runs, array, false).euler_deg();
  const double single = of_single_epochs(runs, array, true).euler_deg();
  const Best best = best_of(runs, array, sigma, 5);
  std::printf(
      "[ FIGURE ] flight-110 (stand-in), 9.51 mm, rms deg: equation (6) %.2f (2.05), one epoch %.2f, the paper's "
      "filter "
      "%.2f (1.87), multiplicative %.2f (1.69), smoother %.2f\n",
      raw, single, best.paper, best.filter, best.smoother);
  EXPECT_LT(best.filter, best.paper);
}

/// The bound: truth drawn from the filter's own model, and the Riccati recursion along it.
TEST(MultiplicativeEkf, StandsOnItsBoundAndItsSigmasAreTrue) {
  constexpr int kDraws = 40;
  for (const double walk_deg : {0.02, 0.2, 1.0}) {
    for (const double sigma : {0.001, 0.003, 0.005}) {
      ThreeAntennas array(sigma);
      AttitudeNoise<double> noise;
      noise.walk = walk_deg * kRadPerDeg;
      double bound = 0.0;
      double smoother_bound = 0.0;
      double nees = 0.0;
      double smoother_nees = 0.0;
      double nis = 0.0;
      long count = 0;
      Score filtered;
      Score smoothed;
      for (int draw = 0; draw < kDraws; ++draw) {
        Gaussian random(static_cast<std::uint64_t>(draw), 30U + static_cast<unsigned>(1e3 * sigma));
        Vec3<double> w(random(), random(), random());
        w *= 0.01;
        Quaternion<double> q(random(), random(), random(), random());
        q.normalize();
        std::optional<Filter> filter;
        std::optional<Filter> along;  // linearised at the truth: its covariance is the bound
        std::vector<Filter::Record> records;
        std::vector<Filter::Record> bounds;
        std::vector<Quaternion<double>> truth;
        for (int k = 0; k < kEpochs; ++k) {
          const auto seen = array.observe(q, random);
          VectorObservation<double, 2> exact = seen;
          exact.value = array.figure().seen_from(q.toRotationMatrix());
          if (!filter) {
            const auto start = attitude_from_vectors(seen, array.figure());
            AttitudeEstimate<double> there = attitude_from_vectors(exact, array.figure()).value();
            filter.emplace(start.value(), 0.0, 0.01, noise);
            along.emplace(there, 0.0, 0.01, noise);
          } else {
            Innovation<double> innovation;
            (void)filter->predict(1.0);
            ASSERT_EQ(filter->update(seen, array.figure(), 0.0, &innovation), Status::kOk);
            (void)along->predict(1.0);
            ASSERT_EQ(along->update(exact, array.figure()), Status::kOk);
            nis += innovation.nis;
          }
          records.push_back(filter->record());
          bounds.push_back(along->record());
          truth.push_back(q);
          if (k >= 20) {
            const Vec3<double> off = rotation_error(filter->state().q_nb, q);
            const Mat3<double> P = filter->state().P.topLeftCorner<3, 3>();
            nees += off.dot(P.ldlt().solve(off));
            filtered.add(filter->state().q_nb, q);
            bound += along->state().P.topLeftCorner<3, 3>().trace();
            ++count;
          }
          // the truth, in small steps
          constexpr int kParts = 20;
          for (int part = 0; part < kParts; ++part) {
            const Vec3<double> before = w;
            w += noise.walk * std::sqrt(1.0 / kParts) * Vec3<double>(random(), random(), random());
            q = (q * quaternion_exp<double>((before + w) * (0.5 / kParts))).normalized();
          }
        }
        ASSERT_EQ(smooth(records.data(), kEpochs), Status::kOk);
        ASSERT_EQ(smooth(bounds.data(), kEpochs), Status::kOk);
        for (std::size_t k = 20; k < kEpochs; ++k) {
          smoothed.add(records[k].after.q_nb, truth[k]);
          const Vec3<double> off = rotation_error(records[k].after.q_nb, truth[k]);
          const Mat3<double> P = records[k].after.P.topLeftCorner<3, 3>();
          smoother_nees += off.dot(P.ldlt().solve(off));
          smoother_bound += bounds[k].after.P.topLeftCorner<3, 3>().trace();
        }
      }
      const double n = static_cast<double>(count);
      const double bound_deg = std::sqrt(bound / (3.0 * n)) / kRadPerDeg;
      const double smoother_bound_deg = std::sqrt(smoother_bound / (3.0 * n)) / kRadPerDeg;
      std::printf(
          "[ FIGURE ] %.2f deg/s/sqrt(s), %.0f mm: multiplicative filter %.4f deg, bound %.4f: %.3f of it (1.03), "
          "NEES/3 "
          "%.3f (0.95-1.05), NIS/6 %.3f; smoother %.4f, bound %.4f, NEES/3 %.3f\n",
          walk_deg, 1e3 * sigma, filtered.axis_deg(), bound_deg, filtered.axis_deg() / bound_deg, nees / (3.0 * n),
          nis / (6.0 * kDraws * (kEpochs - 1)), smoothed.axis_deg(), smoother_bound_deg, smoother_nees / (3.0 * n));
      EXPECT_LT(filtered.axis_deg(), 1.03 * bound_deg);
      EXPECT_GT(nees / (3.0 * n), 0.95);
      EXPECT_LT(nees / (3.0 * n), 1.05);
      EXPECT_NEAR(nis / (6.0 * kDraws * (kEpochs - 1)), 1.0, 0.03);
      EXPECT_LT(smoothed.axis_deg(), 1.05 * smoother_bound_deg);
    }
  }
}

}  // namespace
}  // namespace trunnion
