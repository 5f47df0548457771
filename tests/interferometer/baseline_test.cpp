// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Double differences, the float and the fixed baseline, two baselines jointly: laws, then rates over random skies.

#include "trunnion/interferometer/baseline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "matchers/chi_square.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/interferometer/attitude_from_baselines.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace trunnion {
namespace {

using simulation::Gaussian;
constexpr int kMost = 16;
using Set = SingleDifferences<double, kMost>;

struct Noise {
  double code = 0.3, phase = 0.003;
};

/// Satellites at random above 10 deg, PDOP below 6, in one group or two.
Set random_sky(int n, const Noise& noise, Gaussian& random, int groups = 1) {
  for (;;) {
    Set sky;
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    while (sky.count < n) {
      SingleDifference<double> s;
      s.e = Vec3<double>(random(), random(), -std::abs(random())).normalized();
      if (s.e.z() > -std::sin(10.0 * kRadPerDeg)) continue;
      s.wavelength = 0.1902936727983649;
      s.code_sigma = noise.code;
      s.phase_sigma = noise.phase;
      s.group = sky.count % groups;
      s.satellite = sky.count;
      Eigen::Vector4d h;
      h << s.e, 1.0;
      sum += h * h.transpose();
      sky[sky.count++] = s;
    }
    const double pdop = std::sqrt(Eigen::Matrix4d(sum.inverse()).topLeftCorner<3, 3>().trace());
    if (pdop < 6.0) return sky;
  }
}

/// What both antennas' receivers add, the master's noise in every baseline; whole cycles and clocks at random.
template <std::size_t M>
std::array<Set, M> observe(const Set& sky, const std::array<Vec3<double>, M>& b, Gaussian& random,
                           double exactness = 1.0) {
  std::array<Set, M> sets;
  sets.fill(sky);
  std::array<std::array<double, kGroups>, M> clock{};
  for (auto& of : clock) {
    for (double& c : of) c = 3.0 * random();
  }
  for (int i = 0; i < sky.count; ++i) {
    const double code = sky[i].code_sigma * exactness * random();
    const double phase = sky[i].phase_sigma * exactness * random();
    for (std::size_t k = 0; k < M; ++k) {
      const double range = -sky[i].e.dot(b[k]) + clock[k][static_cast<std::size_t>(sky[i].group)];
      sets[k][i].code = range + sky[i].code_sigma * exactness * random() - code;
      sets[k][i].phase = (range + sky[i].phase_sigma * exactness * random() - phase) / sky[i].wavelength +
                         std::floor(100.0 * random());
    }
  }
  return sets;
}

/// The integers of the double differences that the truth has.
bool right(const Set& set, const std::array<double, kMost>& cycles, const Vec3<double>& b) {
  const DoubleDifferences<double, kMost> pairs(set);
  for (int k = 0; k < pairs.count(); ++k) {
    const auto& s = set[pairs.satellite(k)];
    const auto& r = set[pairs.reference(k)];
    const double whole = std::round(s.phase - r.phase + (s.e - r.e).dot(b) / s.wavelength);
    if (cycles[static_cast<std::size_t>(pairs.satellite(k))] - cycles[static_cast<std::size_t>(pairs.reference(k))] !=
        whole)
      return false;
  }
  return true;
}

/// Eq. (3) of double_difference.hpp is the double differences with all of their covariance, whatever the reference.
TEST(DoubleDifferences, AreClocksEliminated) {
  Gaussian random(1, 0);
  for (int trial = 0; trial < 100; ++trial) {
    Set set = random_sky(9, {}, random, 1 + trial % 2);
    for (int i = 0; i < set.count; ++i) {
      set[i].code_sigma *= 0.5 + random.uniform();
      set[i].code = random();
    }
    BaselineSum<double> sum;
    add_centred(
        set, [&](int i) { return set[i].code; }, [&](int i) { return 2.0 * set[i].code_sigma * set[i].code_sigma; },
        sum);
    const DoubleDifferences<double, kMost> pairs(set);
    ASSERT_EQ(pairs.count(), set.count - 1 - trial % 2);
    const Eigen::MatrixXd W = Eigen::MatrixXd(pairs.covariance([&](int i) { return set[i].code_sigma; })).inverse();
    Eigen::MatrixXd G(pairs.count(), 3);
    Eigen::VectorXd y(pairs.count());
    for (int k = 0; k < pairs.count(); ++k) {
      G.row(k) = -(set[pairs.satellite(k)].e - set[pairs.reference(k)].e).transpose();
      y(k) = set[pairs.satellite(k)].code - set[pairs.reference(k)].code;
    }
    EXPECT_LT((G.transpose() * W * G - sum.information).norm(), 1e-9 * sum.information.norm());
    EXPECT_LT((G.transpose() * W * y - sum.moment).norm(), 1e-9 * (1.0 + sum.moment.norm()));
    EXPECT_NEAR(y.dot(W * y), sum.square, 1e-9 * (1.0 + sum.square));
  }
}

TEST(Baseline, IsExactWithoutNoise) {
  Gaussian random(2, 0);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3<double> b(random(), random(), random());
    const Set sky = random_sky(6 + trial % 4, {}, random, 1 + trial % 2);
    const auto set = observe<1>(sky, {b}, random, 0.0)[0];
    const auto fix = resolve_baseline(set, KnownLength<double>{b.norm(), 0.001});
    ASSERT_TRUE(fix.ok());
    EXPECT_TRUE(right(set, fix.value().cycles, b));
    EXPECT_LT((fix.value().seen.value - b).norm(), 1e-9);
    EXPECT_LT((fix.value().float_b - b).norm(), 1e-9);
    EXPECT_LT(fix.value().misfit, 1e-9);
  }
}

/// b(a) of the search is the least squares of phases and codes with those integers.
TEST(Baseline, SearchesOverTheLeastSquaresItReports) {
  Gaussian random(3, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3<double> b(0.6, -0.7, 0.4);
    const auto set = observe<1>(random_sky(7, {}, random), {b}, random)[0];
    const FloatBaseline<double, kMost> real(set);
    ASSERT_EQ(real.status(), Status::kOk);
    BoundedVector<double, kMost> z(6);
    for (int k = 0; k < 6; ++k) z(k) = std::round(2.0 * random());
    const auto a = real.cycles(z);
    std::array<double, kMost> cycles{};
    for (int k = 0; k < 6; ++k) cycles[static_cast<std::size_t>(real.pairs().satellite(k))] = a(k);
    const auto sum = fixed_sum(set, cycles, real.code());
    EXPECT_LT((real.b_of(z) - sum.information.ldlt().solve(sum.moment)).norm(), 1e-8);
  }
}

/// The sigma of a fixed baseline is true: NEES over fixes that are right.
TEST(Baseline, HasTrueSigmas) {
  Gaussian random(4, 0);
  FixOptions<double> as_they_are;  // what leaves satellites out prefers fits that are better than they should be
  as_they_are.exclude = false;
  double nees = 0.0;
  double misfit = 0.0;
  double degrees = 0.0;
  int count = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3<double> b(0.6, -0.7, 0.4);
    const auto set = observe<1>(random_sky(8, {}, random), {b}, random)[0];
    const auto fix = resolve_baseline(set, KnownLength<double>{b.norm(), 0.001}, as_they_are);
    if (!fix.ok() || !fix.value().accepted) continue;
    const Vec3<double> off = fix.value().seen.value - b;
    nees += off.dot(fix.value().seen.information * off);
    misfit += fix.value().misfit;
    degrees += fix.value().degrees;
    ++count;
  }
  EXPECT_GT(count, 950);
  // one false alarm in a thousand each; those that were not accepted would have been a little worse
  const ChiSquareBand band = chi_square_band(3.0 * count, 1e-3);
  EXPECT_GT(nees, 0.99 * band.low);
  EXPECT_LT(nees, band.high);
  const ChiSquareBand fit = chi_square_band(degrees, 1e-3);
  EXPECT_GT(misfit, 0.99 * fit.low);
  EXPECT_LT(misfit, fit.high);
}

TEST(Baseline, RefusesAWrongLength) {
  Gaussian random(5, 0);
  int accepted = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3<double> b(0.6, -0.7, 0.4);
    const auto set = observe<1>(random_sky(9, {0.3, 0.002}, random), {b}, random)[0];
    const auto fix = resolve_baseline(set, KnownLength<double>{b.norm() + 0.15, 0.005});
    if (fix.ok() && fix.value().accepted) ++accepted;
  }
  EXPECT_LE(accepted, 5) << "15 cm off, nine satellites";
  std::printf("[ FIGURE ] length stated 15 cm wrong, nine satellites: %d of 500 accepted\n", accepted);
}

/// A half cycle or a code a hundred metres off in one satellite: left out, and told which.
TEST(Baseline, LeavesOutTheSatelliteThatDoesNotFit) {
  Gaussian random(6, 0);
  int found = 0;
  int wrong = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3<double> b(0.6, -0.7, 0.4);
    auto set = observe<1>(random_sky(9, {0.3, 0.002}, random), {b}, random)[0];
    const int bad = trial % 9;
    if (trial % 2 == 0)
      set[bad].phase += 0.5;
    else
      set[bad].code += 100.0;
    const auto fix = resolve_baseline(set, KnownLength<double>{b.norm(), 0.003});
    if (!fix.ok() || !fix.value().accepted) continue;
    if (fix.value().excluded == bad && (fix.value().seen.value - b).norm() < 0.03)
      ++found;
    else
      ++wrong;
  }
  std::printf(
      "[ FIGURE ] half a cycle or 100 m of code in one of nine satellites: %d of 500 left out, %d accepted wrongly\n",
      found, wrong);
  EXPECT_GT(found, 450);
  EXPECT_LE(wrong, 1);
}

TEST(Baseline, LeansOnAFiltersPrediction) {
  Gaussian random(7, 0);
  int alone = 0;
  int led = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3<double> b(0.6, -0.7, 0.4);
    const auto set = observe<1>(random_sky(4, {1.0, 0.003}, random), {b}, random)[0];
    VectorObservation<double, 1> prior;
    const double sigma = 0.02;
    prior.information = Mat3<double>::Identity() / (sigma * sigma);
    prior.value = b + sigma * Vec3<double>(random(), random(), random());
    const auto without = resolve_baseline(set, KnownLength<double>{b.norm(), 0.003});
    const auto with = resolve_baseline(set, KnownLength<double>{b.norm(), 0.003}, {}, &prior);
    alone += without.ok() && without.value().accepted;
    const bool good = with.ok() && with.value().accepted;
    led += good;
    if (good) {
      EXPECT_TRUE(right(set, with.value().cycles, b));
    }
  }
  EXPECT_LT(alone, 10);
  EXPECT_GT(led, 270);
}

TEST(Baseline, RefusesWhatIsNoSky) {
  Gaussian random(8, 0);
  const Vec3<double> b(1, 0, 0);
  const KnownLength<double> known{1.0, 0.005};
  EXPECT_EQ(resolve_baseline(Set(), known).status(), Status::kNotObservable);
  auto set = observe<1>(random_sky(8, {}, random), {b}, random)[0];
  set.count = 3;
  EXPECT_EQ(resolve_baseline(set, known).status(), Status::kNotObservable) << "three satellites";
  set.count = 8;
  Set split = set;
  for (int i = 0; i < 8; ++i) split[i].group = i / 2;
  EXPECT_EQ(resolve_baseline(split, known).ok(), true) << "eight in four groups: four double differences";
  for (int i = 0; i < 6; ++i) split[i].group = i;
  split.count = 7;
  EXPECT_EQ(resolve_baseline(split, known).status(), Status::kNotObservable) << "no two of a group";
  Set same = set;
  for (int i = 0; i < 8; ++i) same[i].e = set[0].e;
  EXPECT_EQ(resolve_baseline(same, known).status(), Status::kNotObservable);
  for (int what = 0; what < 7; ++what) {
    Set bad = set;
    if (what == 0) bad[3].phase = std::nan("");
    if (what == 1) bad[3].code = std::numeric_limits<double>::infinity();
    if (what == 2) bad[3].e.x() = std::nan("");
    if (what == 3) bad[3].wavelength = 0.0;
    if (what == 4) bad[3].phase_sigma = std::nan("");
    if (what == 5) bad[3].group = kGroups;
    if (what == 6) bad[3].phase = 1e300;
    EXPECT_EQ(resolve_baseline(bad, known).status(), Status::kOutOfRange) << what;
  }
  EXPECT_EQ(resolve_baseline(set, KnownLength<double>{-1.0, 0.005}).status(), Status::kOutOfRange);
  EXPECT_EQ(resolve_baseline(set, KnownLength<double>{1.0, std::nan("")}).status(), Status::kOutOfRange);
  FixOptions<double> few;
  few.limits.nodes = 3;
  const auto fix = resolve_baseline(set, known, few);
  EXPECT_TRUE(!fix.ok() || !fix.value().accepted) << "a search that was cut is no fix";
}

/// Rates of right fixes over random skies: one baseline, plain and with its length, and three antennas jointly.
TEST(Interferometer, FixesMoreTheMoreItKnows) {
  Eigen::Matrix<double, 3, 2> slaves;
  slaves << 1, 0, 0, 1, 0, 0;
  const RigidVectors<double, 2> figure(slaves, 0.001);
  struct Rates {
    int n;
    Noise noise;
    double plain, length, joint;  // per cent, of an independent program
  };
  const Rates cases[] = {{5, {0.3, 0.003}, 3.6, 69.6, 96.9},
                         {6, {0.3, 0.003}, 22.7, 93.5, 99.8},
                         {7, {0.3, 0.003}, 66.4, 99.2, 100},
                         {5, {0.15, 0.003}, 19.5, 87.0, 99.2},
                         {6, {0.15, 0.003}, 60.6, 98.2, 100}};
  for (const Rates& c : cases) {
    Gaussian random(9, static_cast<std::uint64_t>(100 * c.n + 1000 * c.noise.code));
    constexpr int kTrials = 1000;
    int plain = 0;
    int length = 0;
    int joint = 0;
    int accepted = 0;
    int wrong = 0;
    double nees = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Quaternion<double> q = Quaternion<double>(random(), random(), random(), random()).normalized();
      const std::array<Vec3<double>, 2> b = {q * Vec3<double>(slaves.col(0)), q * Vec3<double>(slaves.col(1))};
      const auto sets = observe<2>(random_sky(c.n, c.noise, random), b, random);
      const auto one = resolve_baseline(sets[0], KnownLength<double>());
      const auto two = resolve_baseline(sets[0], KnownLength<double>{1.0, 0.001});
      const auto three = resolve_array(sets[0], sets[1], figure);
      plain += one.ok() && right(sets[0], one.value().cycles, b[0]);
      length += two.ok() && right(sets[0], two.value().cycles, b[0]);
      if (!three.ok()) continue;
      const bool good = right(sets[0], three.value().cycles[0], b[0]) && right(sets[1], three.value().cycles[1], b[1]);
      joint += good;
      if (!three.value().accepted) continue;
      ++accepted;
      wrong += !good;
      const Vec3<double> off = quaternion_log<double>(three.value().attitude.q_nb.conjugate() * q);
      nees += off.dot(three.value().attitude.information * off);
    }
    const double percent = 100.0 / kTrials;
    std::printf(
        "[ FIGURE ] %d satellites, code %.2f m, phase 3 mm: plain %.1f %% (%.1f), with its length %.1f %% (%.1f), "
        "three "
        "antennas %.1f %% (%.1f), accepted %.1f %%, of these wrong %d, NEES/3 %.3f\n",
        c.n, c.noise.code, percent * plain, c.plain, percent * length, c.length, percent * joint, c.joint,
        percent * accepted, wrong, nees / (3.0 * accepted));
    // four sigmas of a rate over 1000, and a tenth of a point for what 100 % means
    const auto band = [&](double rate) { return 4.0 * std::sqrt(rate * (100.0 - rate) / kTrials) + 0.3; };
    EXPECT_NEAR(percent * plain, c.plain, band(c.plain));
    EXPECT_NEAR(percent * length, c.length, band(c.length));
    EXPECT_NEAR(percent * joint, c.joint, band(c.joint));
    EXPECT_LE(wrong, 1);
    if (accepted > 500) {
      const ChiSquareBand sure = chi_square_band(3.0 * accepted, 1e-3);
      EXPECT_GT(nees, 0.99 * sure.low);
      EXPECT_LT(nees, sure.high);
    }
  }
}

TEST(Interferometer, RefusesSetsThatDoNotMatchAndFiguresInALine) {
  Gaussian random(10, 0);
  Eigen::Matrix<double, 3, 2> slaves;
  slaves << 1, 0, 0, 1, 0, 0;
  const std::array<Vec3<double>, 2> b = {slaves.col(0), slaves.col(1)};
  auto sets = observe<2>(random_sky(7, {}, random), b, random);
  slaves.col(1) = 2.0 * slaves.col(0);
  EXPECT_EQ(resolve_array(sets[0], sets[1], RigidVectors<double, 2>(slaves)).status(), Status::kNotObservable);
  slaves.col(1) = b[1];
  sets[1][2].satellite = 77;
  EXPECT_EQ(resolve_array(sets[0], sets[1], RigidVectors<double, 2>(slaves)).status(), Status::kOutOfRange);
  sets[1].count = 5;
  EXPECT_EQ(resolve_array(sets[0], sets[1], RigidVectors<double, 2>(slaves)).status(), Status::kOutOfRange);
}

}  // namespace
}  // namespace trunnion
