// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Attitudes from vectors: laws for every attitude, the covariance against what comes out, and the filters' algebra.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "attitude/three_antennas.hpp"
#include "matchers/chi_square.hpp"
#include "trunnion/attitude/fixed_interval_smoother.hpp"
#include "trunnion/attitude/quaternion_ekf.hpp"
#include "trunnion/simulation/attitude_path.hpp"

namespace trunnion {
namespace {

using simulation::Gaussian;

Quaternion<double> any_attitude(Gaussian& random) {
  return Quaternion<double>(random(), random(), random(), random()).normalized();
}

/// Attitudes that formulas trip over: no rotation, half turns about every axis, pitch up and down, and near them.
std::vector<Quaternion<double>> awkward_attitudes() {
  std::vector<Quaternion<double>> all;
  for (const double off : {0.0, 1e-12, 1e-8, 1e-4, -1e-6}) {
    for (const double yaw : {0.0, 0.5 * kPi, kPi, -kPi, 1.0}) {
      for (const double pitch : {0.0, 0.5 * kPi, -0.5 * kPi, kPi})
        all.push_back(quaternion_of_euler(off, pitch + off, yaw - off));
    }
    for (const Vec3<double>& axis : {Vec3<double>(1, 0, 0), Vec3<double>(0, 1, 0), Vec3<double>(0, 0, 1),
                                     Vec3<double>(1, 1, 1), Vec3<double>(-1, 2, 0.5)})
      all.push_back(quaternion_exp<double>((kPi + off) * axis.normalized()));
  }
  return all;
}

Mat3<double> random_information(Gaussian& random) {
  const Mat3<double> root = Mat3<double>::NullaryExpr([&] { return random(); });
  return 1e4 * (root * root.transpose() + 0.1 * Mat3<double>::Identity());
}

TEST(Wahba, FindsEveryAttitudeExactly) {
  Gaussian random(1, 0);
  std::vector<Quaternion<double>> attitudes = awkward_attitudes();
  for (int i = 0; i < 500; ++i) attitudes.push_back(any_attitude(random));
  for (const Quaternion<double>& truth : attitudes) {
    Eigen::Matrix<double, 3, 2> b;
    b << Vec3<double>(random(), random(), random()), Vec3<double>(random(), random(), random());
    const RigidVectors<double, 2> figure(b);
    VectorObservation<double, 2> seen;
    seen.value = figure.seen_from(truth.toRotationMatrix());
    seen.information.setIdentity();
    const auto found = wahba(seen, figure);
    ASSERT_TRUE(found.ok());
    EXPECT_LT(rotation_error(found.value(), truth).norm(), 1e-7);  // SVD of vectors that may be nearly in line
    const auto estimate = attitude_from_vectors(seen, figure);
    ASSERT_TRUE(estimate.ok());
    EXPECT_LT(rotation_error(estimate.value().q_nb, truth).norm(), 1e-9);
    EXPECT_EQ(estimate.value().observable, 3);
    const auto six = attitude_by_equation_six<double>(seen.value.head<3>(), seen.value.tail<3>(), b);
    if (six.ok()) {
      EXPECT_LT((six.value() - truth.toRotationMatrix()).norm(), 1e-6);
    }
  }
}

TEST(NearestRotation, IsARotationAndLeavesRotationsAlone) {
  Gaussian random(2, 0);
  for (int i = 0; i < 500; ++i) {
    const Mat3<double> C = any_attitude(random).toRotationMatrix();
    EXPECT_LT((nearest_rotation(C).value() - C).norm(), 1e-14);
    const Mat3<double> off = C + 0.2 * Mat3<double>::NullaryExpr([&] { return random(); });
    const auto R = nearest_rotation(off);
    ASSERT_TRUE(R.ok());
    EXPECT_LT((R.value().transpose() * R.value() - Mat3<double>::Identity()).norm(), 1e-13);
    EXPECT_NEAR(R.value().determinant(), 1.0, 1e-13);
    // none of its neighbours is nearer
    for (int axis = 0; axis < 3; ++axis) {
      for (const double step : {1e-3, -1e-3}) {
        const Mat3<double> neighbour = R.value() * rotation_exp<double>(step * Vec3<double>::Unit(axis));
        EXPECT_GT((neighbour - off).norm(), (R.value() - off).norm());
      }
    }
  }
}

TEST(NearestRotation, RefusesWhatLeavesAnAxisOpen) {
  EXPECT_EQ(nearest_rotation<double>(Mat3<double>::Zero()).status(), Status::kNotObservable);
  EXPECT_EQ(nearest_rotation<double>(Mat3<double>::Ones()).status(), Status::kNotObservable);
  // a reflection in a plane: the turn about its normal costs nothing
  EXPECT_EQ(nearest_rotation<double>(Vec3<double>(1, 1, -1).asDiagonal()).status(), Status::kNotObservable);
  Mat3<double> bad = Mat3<double>::Identity();
  bad(1, 2) = std::nan("");
  EXPECT_EQ(nearest_rotation(bad).status(), Status::kOutOfRange);
}

TEST(MostLikelyAttitude, IsTheMinimumAndItsCovarianceIsTrue) {
  Gaussian random(3, 0);
  double nees = 0.0;
  double cost = 0.0;
  constexpr int kTrials = 2000;
  const RigidVectors<double, 2> figure(ThreeAntennas::slaves());
  for (int i = 0; i < kTrials; ++i) {
    const Quaternion<double> truth = any_attitude(random);
    VectorObservation<double, 2> seen;
    const Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::NullaryExpr([&] { return random(); });
    seen.information = 1e5 * (root * root.transpose() + 0.1 * Eigen::Matrix<double, 6, 6>::Identity());
    const Eigen::Matrix<double, 6, 1> white = Eigen::Matrix<double, 6, 1>::NullaryExpr([&] { return random(); });
    seen.value = figure.seen_from(truth.toRotationMatrix()) + seen.information.llt().matrixU().solve(white);
    const auto found = attitude_from_vectors(seen, figure);
    ASSERT_TRUE(found.ok());
    const auto& estimate = found.value();
    const Vec3<double> off = rotation_error(estimate.q_nb, truth);
    nees += off.dot(estimate.information * off);
    cost += estimate.cost;
    const auto cost_at = [&](const Vec3<double>& phi) {
      const Eigen::Matrix<double, 6, 1> r =
          seen.value - figure.seen_from((estimate.q_nb * quaternion_exp(phi)).toRotationMatrix());
      return r.dot(seen.information * r);
    };
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3<double> step = 1e-4 * Vec3<double>::Unit(axis);
      EXPECT_GT(cost_at(step) + cost_at(-step), 2.0 * cost_at(Vec3<double>::Zero()));
    }
  }
  // one false alarm in a thousand each
  const ChiSquareBand band = chi_square_band(3.0 * kTrials, 1e-3);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
  EXPECT_GT(cost, band.low) << "six observations less three angles";
  EXPECT_LT(cost, band.high);
}

/// Figures differ from what was stated: eq. (4) is the inverse of the sum of the covariances.
TEST(RigidVectors, LoosenWhatTheirFigureDoesNotKnow) {
  Gaussian random(4, 0);
  for (int i = 0; i < 50; ++i) {
    const Mat3<double> C = any_attitude(random).toRotationMatrix();
    Eigen::Matrix<double, 3, 2> b;
    b << Vec3<double>(random(), random(), random()), Vec3<double>(random(), random(), random());
    const RigidVectors<double, 2> figure(b, 0.007);
    const Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::NullaryExpr([&] { return random(); });
    const Eigen::Matrix<double, 6, 6> N =
        1e5 * (root * root.transpose() + 0.1 * Eigen::Matrix<double, 6, 6>::Identity());
    const Eigen::Matrix<double, 6, 3> J = figure.turned_by(C);
    const Eigen::Matrix<double, 6, 6> P =
        Eigen::Matrix<double, 6, 6>::Identity() - J * (J.transpose() * J).inverse() * J.transpose();
    const Eigen::Matrix<double, 6, 6> expected = (N.inverse() + 0.007 * 0.007 * P).inverse();
    EXPECT_LT((figure.loosened(N, C) - expected).norm(), 1e-9 * N.norm());
  }
  // one vector: its length
  const RigidVectors<double, 1> one(Vec3<double>(2, 0, 0), 0.01);
  const Mat3<double> N = 1e6 * Mat3<double>::Identity();
  const Mat3<double> loose = one.loosened(N, Mat3<double>::Identity());
  EXPECT_NEAR(1.0 / loose(0, 0), 1e-6 + 1e-4, 1e-12);
  EXPECT_NEAR(loose(1, 1), 1e6, 1e-3);
  EXPECT_EQ(one.rank(), 2);
}

TEST(AttitudeFromVectors, OfOneVectorSaysWhichAxisIsFree) {
  Gaussian random(5, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3<double> b(random(), random(), i % 5 == 0 ? 10.0 * random() : 0.1 * random());
    const RigidVectors<double, 1> figure(b);
    const Quaternion<double> truth = any_attitude(random);
    VectorObservation<double, 1> seen;
    seen.value = truth * b;
    seen.information = random_information(random);
    const auto found = attitude_from_vectors(seen, figure);
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(found.value().observable, 2);
    EXPECT_NEAR(std::abs(found.value().free_axis.dot(b.normalized())), 1.0, 1e-9);
    EXPECT_LT((found.value().q_nb * b - seen.value).norm(), 1e-6 * b.norm());
  }
  // along x: heading and pitch, roll none
  VectorObservation<double, 1> seen;
  const Quaternion<double> truth = quaternion_of_euler(0.0, 0.3, 2.0);
  seen.value = truth * Vec3<double>(1, 0, 0);
  seen.information = 1e4 * Mat3<double>::Identity();
  const auto level = attitude_from_vectors(seen, RigidVectors<double, 1>(Vec3<double>(1, 0, 0)));
  EXPECT_LT(rotation_error(level.value().q_nb, truth).norm(), 1e-9);
}

TEST(AttitudeFromVectors, RefusesWhatIsNoFigure) {
  VectorObservation<double, 1> seen;
  seen.value << 1, 0, 0;
  const RigidVectors<double, 1> figure(Vec3<double>(1, 0, 0));
  EXPECT_EQ(attitude_from_vectors(seen, figure).status(), Status::kNotObservable) << "no information";
  seen.information.setIdentity();
  seen.value.x() = std::nan("");
  EXPECT_EQ(attitude_from_vectors(seen, figure).status(), Status::kOutOfRange);
  seen.value.setZero();
  EXPECT_EQ(attitude_from_vectors(seen, figure).status(), Status::kNotObservable);
  seen.value << 1, 0, 0;
  EXPECT_EQ(attitude_from_vectors(seen, RigidVectors<double, 1>(Vec3<double>::Zero())).status(), Status::kOutOfRange);
  EXPECT_EQ(attitude_from_vectors(seen, RigidVectors<double, 1>(Vec3<double>(1, 0, 0), -1.0)).status(),
            Status::kOutOfRange);
  const Quaternion<double> start = Quaternion<double>::Identity();
  EXPECT_TRUE(most_likely_attitude(start, seen, figure).ok());
  EXPECT_EQ(most_likely_attitude(start, seen, RigidVectors<double, 1>(Vec3<double>::Zero())).status(),
            Status::kOutOfRange);
  EXPECT_EQ(most_likely_attitude(Quaternion<double>(std::nan(""), 0, 0, 0), seen, figure).status(),
            Status::kOutOfRange);
}

/// Pitch through 90 deg and rotation through 180 deg, with and without filters: the error stays where it is elsewhere.
TEST(AttitudePaths, PassPitchUpAndHalfTurnsWithoutLoss) {
  struct Case {
    const char* name;
    Vec3<double> rate;  // deg/s
  };
  const Case cases[] = {{"elsewhere", Vec3<double>(0, 0, 0.2)},
                        {"pitch through +-90 deg", Vec3<double>(0, 3, 0)},
                        {"yaw through 180 deg", Vec3<double>(0, 0, 3)},
                        {"roll through 180 deg", Vec3<double>(3, 0, 0)}};
  double plain[3] = {};
  for (const Case& c : cases) {
    const Quaternion<double> start = &c == cases ? quaternion_of_euler(0.1, 0.1, 0.5) : Quaternion<double>::Identity();
    const simulation::AttitudePath path([&](double) { return Vec3<double>(c.rate * kRadPerDeg); }, start, 240.0);
    ThreeAntennas array(0.003);
    double sum[3] = {};
    int count = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Gaussian noise(seed, 6);
      AttitudeNoise<double> walk;
      walk.walk = 0.3 * kRadPerDeg;
      const auto first = array.observe(path.q_nb(0.0), noise);
      MultiplicativeEkf<double, 2> filter(attitude_from_vectors(first, array.figure()).value(), 0.0, 0.1, walk);
      QuaternionEkf<double> paper(path.q_nb(0.0), 0.0, walk.walk, 0.003 * 0.003, 0.1);
      for (int k = 1; k < 240; ++k) {
        const Quaternion<double> truth = path.q_nb(k);
        const auto seen = array.observe(truth, noise);
        (void)filter.predict(1.0);
        ASSERT_EQ(filter.update(seen, array.figure()), Status::kOk) << c.name << k;
        (void)paper.predict(1.0);
        const auto alone = attitude_from_vectors(seen, array.figure());
        Quaternion<double> computed = alone.value().q_nb;
        if (k % 2 == 0) computed.coeffs() *= -1.0;  // either sign
        (void)paper.update(computed);
        EXPECT_NEAR(paper.q_nb().norm(), 1.0, 1e-12);
        if (k < 20) continue;
        sum[0] += rotation_error(alone.value().q_nb, truth).squaredNorm();
        sum[1] += rotation_error(filter.state().q_nb, truth).squaredNorm();
        sum[2] += rotation_error(paper.q_nb(), truth).squaredNorm();
        ++count;
      }
    }
    double rms[3];
    for (int i = 0; i < 3; ++i) rms[i] = std::sqrt(sum[i] / (3.0 * count)) / kRadPerDeg;
    std::printf(
        "[ FIGURE ] %s, deg an axis: one epoch %.4f, multiplicative %.4f, the paper's on the best quaternion %.4f\n",
        c.name, rms[0], rms[1], rms[2]);
    for (int i = 0; i < 3; ++i) {
      if (&c == cases) plain[i] = rms[i];
      // a figure seen by the same satellites from another side: some attitudes are weaker, by the geometry alone
      EXPECT_LT(rms[i], 1.15 * plain[i]) << c.name << i;
    }
  }
}

/// Phi of the filter is the derivative of its motion.
TEST(MultiplicativeEkf, PredictsWithTheDerivativeOfItsMotion) {
  Gaussian random(7, 0);
  for (int trial = 0; trial < 20; ++trial) {
    AttitudeNoise<double> noise;  // no noise: P moves by Phi alone
    noise.time = trial % 2 == 0 ? std::numeric_limits<double>::infinity() : 3.0;
    const Quaternion<double> q = any_attitude(random);
    const Vec3<double> gyro(random(), random(), random());
    const Vec3<double> w_in = 1e-4 * Vec3<double>(random(), random(), random());
    for (const bool has_gyro : {false, true}) {
      // a filter at the state (q, w), by way of an exact observation of the rate: start and one prediction cannot set w
      const auto moved = [&](const Vec3<double>& phi, const Vec3<double>& slow) {
        const Quaternion<double> from = (q * quaternion_exp(phi)).normalized();
        const double t = 0.7;
        if (has_gyro) {
          const Vec3<double> w = gyro - slow - from.conjugate() * w_in;
          return Quaternion<double>(from * quaternion_exp<double>(w * t));
        }
        const double effective = noise.time < 1e9 ? noise.time * (1.0 - std::exp(-t / noise.time)) : t;
        return Quaternion<double>(from * quaternion_exp<double>(slow * effective));
      };
      AttitudeEstimate<double> start;
      start.q_nb = q;
      start.covariance.setIdentity();
      MultiplicativeEkf<double, 1> filter(start, 0.0, 1.0, noise);
      ASSERT_EQ(has_gyro ? filter.predict(0.7, gyro, w_in) : filter.predict(0.7), Status::kOk);
      EXPECT_LT(rotation_error(filter.state().q_nb, moved(Vec3<double>::Zero(), Vec3<double>::Zero())).norm(), 1e-12);
      Eigen::Matrix<double, 3, 6> J;
      constexpr double kStep = 1e-5;
      for (int i = 0; i < 6; ++i) {
        Vec3<double> phi = Vec3<double>::Zero();
        Vec3<double> slow = Vec3<double>::Zero();
        (i < 3 ? phi : slow)(i % 3) = kStep;
        J.col(i) = rotation_error(moved(-phi, -slow), moved(phi, slow)) / (2.0 * kStep);
      }
      // the Earth's rate, seen from an attitude that errs, is left out of Phi: 1e-4 rad/s, as on Earth
      const double left_out = has_gyro ? 2e-3 : 1e-8;
      EXPECT_LT((filter.state().P.topLeftCorner<3, 3>() - J * J.transpose()).norm(), left_out);
    }
  }
}

TEST(MultiplicativeEkf, LearnsNothingFromNoInformation) {
  AttitudeEstimate<double> start;
  start.covariance = 0.01 * Mat3<double>::Identity();
  AttitudeNoise<double> noise;
  MultiplicativeEkf<double, 2> filter(start, 0.0, 0.1, noise);
  const auto before = filter.state();
  VectorObservation<double, 2> seen;
  seen.value.setConstant(3.0);
  const RigidVectors<double, 2> figure(ThreeAntennas::slaves());
  ASSERT_EQ(filter.update(seen, figure), Status::kOk);
  EXPECT_EQ(filter.state().q_nb.coeffs(), before.q_nb.coeffs());
  EXPECT_LT((filter.state().P - before.P).norm(), 1e-15);
  // information about x_1's z alone, and nothing else: pitch
  seen.value = figure.seen_from(Mat3<double>::Identity());
  seen.information(2, 2) = 1e6;
  ASSERT_EQ(filter.update(seen, figure), Status::kOk);
  EXPECT_NEAR(filter.state().P(1, 1), 1.0 / (1e6 + 100.0), 1e-9);
  EXPECT_NEAR(filter.state().P(0, 0), 0.01, 1e-9);
  EXPECT_NEAR(filter.state().P(2, 2), 0.01, 1e-9);
}

TEST(MultiplicativeEkf, RefusesAndStaysAsItWas) {
  AttitudeEstimate<double> start;
  start.covariance = 1e-6 * Mat3<double>::Identity();
  AttitudeNoise<double> noise;
  MultiplicativeEkf<double, 1> filter(start, 0.0, 0.1, noise);
  const RigidVectors<double, 1> figure(Vec3<double>(1, 0, 0));
  VectorObservation<double, 1> seen;
  seen.information = 1e6 * Mat3<double>::Identity();
  seen.value << 0.9, 0.4, 0.0;  // 24 deg off, at 0.1 deg
  Innovation<double> innovation;
  EXPECT_EQ(filter.update(seen, figure, kOneInMillion, &innovation), Status::kInconsistent);
  EXPECT_GT(innovation.nis, 1000.0);
  EXPECT_EQ(filter.state().q_nb.w(), 1.0);
  seen.value.x() = std::nan("");
  EXPECT_EQ(filter.update(seen, figure), Status::kOutOfRange);
  EXPECT_EQ(filter.predict(-1.0), Status::kOutOfRange);
  EXPECT_EQ(filter.predict(std::nan("")), Status::kOutOfRange);
  EXPECT_EQ(filter.predict(1.0, Vec3<double>(std::nan(""), 0, 0), Vec3<double>::Zero()), Status::kOutOfRange);
  EXPECT_EQ(filter.state().q_nb.w(), 1.0);
}

/// A gyro at 100 Hz and GNSS at 1 Hz: the error, and the bound along the same way.
TEST(MultiplicativeEkf, WithAGyroStandsOnItsBound) {
  constexpr double kArw = 0.005 * kRadPerDeg;  // rad/s/sqrt(Hz)
  constexpr double kBias = 0.05 * kRadPerDeg;
  constexpr double kBiasWalk = 1e-4 * kRadPerDeg;
  constexpr int kEpochs = 200;
  const Vec3<double> w_in(4e-5, 0, -5e-5);
  const simulation::AttitudePath path = simulation::example_1_stand_in(simulation::PlatformMotion::kFast, kEpochs);
  AttitudeNoise<double> noise;
  noise.walk = kBiasWalk;
  noise.gyro = kArw;
  double nees = 0.0;
  double square = 0.0;
  double bound = 0.0;
  long count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Gaussian random(seed, 8);
    ThreeAntennas array(0.003);
    Vec3<double> bias = kBias * Vec3<double>(random(), random(), random());
    MultiplicativeEkf<double, 2> filter(
        attitude_from_vectors(array.observe(path.q_nb(0.0), random), array.figure()).value(), 0.0, kBias, noise);
    for (int k = 1; k < kEpochs; ++k) {
      for (int i = 0; i < 100; ++i) {
        const double from = k - 1 + 0.01 * i;
        const Vec3<double> w_nb = rotation_error(path.q_nb(from), path.q_nb(from + 0.01)) / 0.01;
        bias += kBiasWalk * 0.1 * Vec3<double>(random(), random(), random());
        const Vec3<double> gyro = w_nb + path.q_nb(from + 0.005).conjugate() * w_in + bias +
                                  kArw * 10.0 * Vec3<double>(random(), random(), random());
        ASSERT_EQ(filter.predict(0.01, gyro, w_in), Status::kOk);
      }
      ASSERT_EQ(filter.update(array.observe(path.q_nb(k), random), array.figure()), Status::kOk);
      if (k < 50) continue;
      const Vec3<double> off = rotation_error(filter.state().q_nb, path.q_nb(k));
      const Mat3<double> P = filter.state().P.topLeftCorner<3, 3>();
      nees += off.dot(P.ldlt().solve(off));
      square += off.squaredNorm();
      bound += P.trace();
      ++count;
    }
  }
  const double n = static_cast<double>(count);
  std::printf(
      "[ FIGURE ] gyro of 0.005 deg/s/sqrt(Hz) at 100 Hz, GNSS of 3 mm at 1 Hz, fast: %.4f deg an axis, bound %.4f, "
      "NEES/3 %.3f\n",
      std::sqrt(square / (3.0 * n)) / kRadPerDeg, std::sqrt(bound / (3.0 * n)) / kRadPerDeg, nees / (3.0 * n));
  EXPECT_LT(std::sqrt(square), 1.05 * std::sqrt(bound));
  // errors hold for some 20 epochs: 150 independent ones, one false alarm in a thousand
  const ChiSquareBand band = chi_square_band(3.0 * 150, 1e-3);
  EXPECT_GT(nees / (3.0 * n), band.low / 450.0);
  EXPECT_LT(nees / (3.0 * n), band.high / 450.0);
}

/// Errors of the phases that hold for half a minute: white, they make the filter too sure; as states they do not.
TEST(MultiplicativeEkf, KnowsColouredNoiseWhenTold) {
  constexpr int kEpochs = 400;
  constexpr double kTime = 30.0;
  double nees[2] = {};
  double square[2] = {};
  double early = 0.0;
  long count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Gaussian random(seed, 9);
    ThreeAntennas array(0.002);
    AttitudeNoise<double> white;
    white.walk = 0.002 * kRadPerDeg;
    AttitudeNoise<double> told = white;
    told.coloured = 1.0;
    told.coloured_time = kTime;
    const Quaternion<double> truth = any_attitude(random);
    Eigen::Matrix<double, 6, 1> m = Eigen::Matrix<double, 6, 1>::Zero();
    auto seen = array.observe(truth, random);
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> root(seen.information);
    const auto colour = [&] {
      const Eigen::Matrix<double, 6, 1> w = Eigen::Matrix<double, 6, 1>::NullaryExpr([&] { return random(); });
      return Eigen::Matrix<double, 6, 1>(root.matrixU().solve(w));
    };
    m = colour();
    seen.value += m;
    const auto start = attitude_from_vectors(seen, array.figure()).value();
    MultiplicativeEkf<double, 2> plain(start, 0.0, 1e-3, white);
    MultiplicativeEkf<double, 2, true> aware(start, 0.0, 1e-3, told, seen, array.figure());
    for (int k = 1; k < kEpochs; ++k) {
      const double kept = std::exp(-1.0 / kTime);
      m = kept * m + std::sqrt(1.0 - kept * kept) * colour();
      seen = array.observe(truth, random);
      seen.value += m;
      (void)plain.predict(1.0);
      (void)aware.predict(1.0);
      ASSERT_EQ(plain.update(seen, array.figure()), Status::kOk);
      ASSERT_EQ(aware.update(seen, array.figure()), Status::kOk);
      if (k == 3) {  // the start knows of them already
        const Vec3<double> off = rotation_error(aware.state().q_nb, truth);
        const Mat3<double> P = aware.state().P.topLeftCorner<3, 3>();
        early += off.dot(P.ldlt().solve(off));
      }
      if (k < 100 || k % 10 != 0) continue;
      const auto score = [&](const auto& state, int i) {
        const Vec3<double> off = rotation_error(state.q_nb, truth);
        const Mat3<double> P = state.P.template topLeftCorner<3, 3>();
        nees[i] += off.dot(P.ldlt().solve(off));
        square[i] += off.squaredNorm();
      };
      score(plain.state(), 0);
      score(aware.state(), 1);
      ++count;
    }
  }
  const double n = static_cast<double>(count);
  std::printf(
      "[ FIGURE ] half the noise coloured, 30 s: white filter %.4f deg, NEES/3 %.2f; told %.4f deg, NEES/3 %.2f\n",
      std::sqrt(square[0] / (3.0 * n)) / kRadPerDeg, nees[0] / (3.0 * n), std::sqrt(square[1] / (3.0 * n)) / kRadPerDeg,
      nees[1] / (3.0 * n));
  EXPECT_GT(nees[0] / (3.0 * n), 3.0);
  // some three independent errors a run, 40 runs: one false alarm in a thousand
  const ChiSquareBand band = chi_square_band(3.0 * 120, 1e-3);
  EXPECT_GT(nees[1] / (3.0 * n), band.low / 360.0);
  EXPECT_LT(nees[1] / (3.0 * n), band.high / 360.0);
  const ChiSquareBand first = chi_square_band(3.0 * 40, 1e-3);
  EXPECT_GT(early, first.low);
  EXPECT_LT(early, first.high);
  EXPECT_LE(square[1], 1.02 * square[0]);
}

TEST(Smoother, EndsWhereTheFilterEndsAndIsNeverLessSure) {
  Gaussian random(10, 0);
  ThreeAntennas array(0.003);
  const auto path = simulation::example_1_stand_in(simulation::PlatformMotion::kMedium, 100.0);
  AttitudeNoise<double> noise;
  noise.walk = 0.3 * kRadPerDeg;
  using Filter = MultiplicativeEkf<double, 2>;
  Filter filter(attitude_from_vectors(array.observe(path.q_nb(0.0), random), array.figure()).value(), 0.0, 0.1, noise);
  std::vector<Filter::Record> records = {filter.record()};
  for (int k = 1; k < 100; ++k) {
    (void)filter.predict(0.4);
    (void)filter.predict(0.6);
    (void)filter.update(array.observe(path.q_nb(k), random), array.figure());
    records.push_back(filter.record());
  }
  const std::vector<Filter::Record> filtered = records;
  ASSERT_EQ(smooth(records.data(), static_cast<long>(records.size())), Status::kOk);
  EXPECT_EQ(records.back().after.q_nb.coeffs(), filtered.back().after.q_nb.coeffs());
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Eigen::Matrix<double, 6, 6> gain = filtered[k].after.P - records[k].after.P;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Filter::State::Square>(gain).eigenvalues()(0),
              -1e-2 * filtered[k].after.P.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Filter::State::Square>(records[k].after.P).eigenvalues()(0), 0.0);
  }
  EXPECT_EQ(smooth(records.data(), 0), Status::kOk);
}

TEST(QuaternionEkf, DoesNotMindTheSignOfWhatItIsGiven) {
  const Quaternion<double> q = quaternion_of_euler(0.1, 0.2, 3.0);
  QuaternionEkf<double> a(q, 0.1, 0.01, 1e-4, 0.1);
  QuaternionEkf<double> b(q, 0.1, 0.01, 1e-4, 0.1);
  for (int k = 0; k < 50; ++k) {
    const Quaternion<double> z = quaternion_of_euler(0.1, 0.2, 3.0 + 0.02 * k);
    Quaternion<double> other = z;
    other.coeffs() *= -1.0;
    ASSERT_EQ(a.predict(1.0), Status::kOk);
    ASSERT_EQ(b.predict(1.0), Status::kOk);
    ASSERT_EQ(a.update(z), Status::kOk);
    ASSERT_EQ(b.update(k % 2 == 0 ? z : other), Status::kOk);
    EXPECT_EQ(a.q_nb().coeffs(), b.q_nb().coeffs());
    EXPECT_NEAR(a.q_nb().norm(), 1.0, 1e-14);
  }
  EXPECT_EQ(a.update(Quaternion<double>(std::nan(""), 0, 0, 0)), Status::kOutOfRange);
  EXPECT_EQ(a.predict(-1.0), Status::kOutOfRange);
}

}  // namespace
}  // namespace trunnion
