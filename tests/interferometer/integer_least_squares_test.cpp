// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// LAMBDA against published vectors, against counting out every neighbour, and against Debian's lambda().

#include "trunnion/interferometer/integer_least_squares.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace trunnion {
namespace {

constexpr int kMost = 24;
using Vector = BoundedVector<double, kMost>;
using Matrix = BoundedMatrix<double, kMost>;

struct Problem {
  Vector a;
  Matrix Q;
  std::vector<double> best, second, norms;
  double success = 0.0;
};

Problem read_problem(const std::filesystem::path& path) {
  Problem problem;
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    std::vector<double> numbers;
    for (double number = 0.0; words >> number;) numbers.push_back(number);
    const auto n = static_cast<Eigen::Index>(numbers.size());
    if (key == "a") problem.a = Eigen::Map<Eigen::VectorXd>(numbers.data(), n);
    if (key == "Q") rows.push_back(numbers);
    if (key == "best") problem.best = numbers;
    if (key == "second") problem.second = numbers;
    if (key == "sqnorm") problem.norms = numbers;
    if (key == "ps_bootstrapped") problem.success = numbers.at(0);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  problem.Q.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    problem.Q.row(i) = Eigen::Map<Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(), n);
  return problem;
}

double norm_of(const Problem& problem, const Vector& a) {
  const Eigen::VectorXd off = problem.a - a;
  return off.dot(Eigen::MatrixXd(problem.Q).ldlt().solve(off));
}

/// As GNSS makes them: three unknowns of metres seen through phases of millimetres.
Problem random_problem(int n, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Problem problem;
  Eigen::MatrixXd G(n, 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 3; ++j) G(i, j) = 5.0 * normal(rng);
  }
  problem.Q = G * G.transpose() + 0.001 * (Eigen::MatrixXd::Identity(n, n) + Eigen::MatrixXd::Ones(n, n));
  problem.a.resize(n);
  for (int i = 0; i < n; ++i) problem.a(i) = 100.0 * normal(rng);
  return problem;
}

TEST(IntegerLeastSquares, FindsBothCandidatesOfEveryPublishedProblem) {
  const std::filesystem::path folder = std::filesystem::path(TRUNNION_DATA) / "lambda";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no problems: " << folder;
  int exact = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".txt") continue;
    const Problem problem = read_problem(entry.path());
    if (problem.a.size() == 0) {  // the covariance alone
      const Decorrelation<double, kMost> of(problem.Q);
      std::printf("[ FIGURE ] bootstrapped success of LAMBDA 4.0's example 3: %.2f %% (30.70)\n",
                  100.0 * of.bootstrapped_success());
      EXPECT_NEAR(100.0 * of.bootstrapped_success(), 30.70, 0.1);
      continue;
    }
    const auto fix = lambda(problem.a, problem.Q);
    ASSERT_TRUE(fix.ok()) << entry.path();
    for (Eigen::Index i = 0; i < problem.a.size(); ++i) {
      EXPECT_EQ(fix.value().best(i), problem.best[static_cast<std::size_t>(i)]) << entry.path();
      EXPECT_EQ(fix.value().second(i), problem.second[static_cast<std::size_t>(i)]) << entry.path();
    }
    EXPECT_NEAR(fix.value().best_norm, problem.norms[0], 1e-6 * std::max(1.0, problem.norms[0])) << entry.path();
    EXPECT_NEAR(fix.value().second_norm, problem.norms[1], 1e-6 * std::max(1.0, problem.norms[1])) << entry.path();
    EXPECT_NEAR(fix.value().bootstrapped_success, problem.success, 1e-6) << entry.path();
    ++exact;
  }
  EXPECT_EQ(exact, 8);
  std::printf("[ FIGURE ] integer least squares: %d of 8 published problems exact\n", exact);
}

TEST(Decorrelation, KeepsTheWholeNumbersWholeAndTheDeterminant) {
  std::mt19937_64 rng(1);
  for (int n = 1; n <= 16; ++n) {
    const Problem problem = random_problem(n, rng);
    const Decorrelation<double, kMost> of(problem.Q);
    ASSERT_EQ(of.status(), Status::kOk);
    const Eigen::MatrixXd product = of.back().transpose() * of.forth().transpose();
    EXPECT_TRUE(product.isIdentity(0.0)) << "whole numbers, exactly";
    const Eigen::MatrixXd D = of.variances().asDiagonal();
    const Eigen::MatrixXd Qz = of.forth() * problem.Q * of.forth().transpose();
    const Eigen::MatrixXd LDL = of.lower().transpose() * D * of.lower();
    EXPECT_LT((Qz - LDL).norm(), 1e-9 * problem.Q.norm());
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < i; ++j) EXPECT_LE(std::abs(of.lower()(i, j)), 0.5 + 1e-9);
    }
  }
}

TEST(IntegerLeastSquares, IsTheBestOfAllNeighboursCountedOut) {
  std::mt19937_64 rng(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    Problem problem;
    Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return 0.5 * normal(rng); });
    problem.Q = root * root.transpose() + 0.02 * Eigen::Matrix3d::Identity();
    problem.a = Eigen::Vector3d::NullaryExpr([&] { return 3.0 * normal(rng); });
    std::vector<double> norms;
    for (int i = -12; i <= 12; ++i) {
      for (int j = -12; j <= 12; ++j) {
        for (int k = -12; k <= 12; ++k) norms.push_back(norm_of(problem, Eigen::Vector3d(i, j, k)));
      }
    }
    std::partial_sort(norms.begin(), norms.begin() + 2, norms.end());
    const auto fix = lambda(problem.a, problem.Q);
    ASSERT_TRUE(fix.ok());
    EXPECT_NEAR(fix.value().best_norm, norms[0], 1e-9 * (1.0 + norms[0]));
    EXPECT_NEAR(fix.value().second_norm, norms[1], 1e-9 * (1.0 + norms[1]));
    EXPECT_NEAR(norm_of(problem, fix.value().best), norms[0], 1e-9 * (1.0 + norms[0]));
  }
}

/// Whole numbers added to the float ones are added to the fixed ones, whatever their size.
TEST(IntegerLeastSquares, MovesWithWholeNumbers) {
  std::mt19937_64 rng(3);
  for (int trial = 0; trial < 100; ++trial) {
    Problem problem = random_problem(5, rng);
    for (int i = 0; i < 5; ++i)
      problem.a(i) = std::round(problem.a(i)) + std::ldexp(std::round(std::ldexp(0.3 * i, 12)), -12);
    const auto fix = lambda(problem.a, problem.Q);
    const Vector shift = Eigen::Matrix<double, 5, 1>(1e9, -3e8, 7.0, 0.0, 1e7);
    const auto moved = lambda(Vector(problem.a + shift), problem.Q);
    ASSERT_TRUE(fix.ok() && moved.ok());
    EXPECT_EQ(moved.value().best, fix.value().best + shift);
    EXPECT_DOUBLE_EQ(moved.value().best_norm, fix.value().best_norm);
  }
}

TEST(IntegerLeastSquares, AgreesWithDebiansLambda) {
  // its library leaves three functions of its programs open
  void* const library = ::dlopen("libRTKLib.so.1", RTLD_LAZY);
  if (library == nullptr) GTEST_SKIP() << "no peer: libRTKLib.so.1 of Debian's librtklib1";
  using Lambda = int (*)(int, int, const double*, const double*, double*, double*);
  const auto peer = reinterpret_cast<Lambda>(::dlsym(library, "lambda"));
  ASSERT_NE(peer, nullptr);
  std::mt19937_64 rng(4);
  int same = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const int n = 3 + trial % 12;
    const Problem problem = random_problem(n, rng);
    const Eigen::MatrixXd Q = problem.Q;
    const Eigen::VectorXd a = problem.a;
    Eigen::MatrixXd F(n, 2);
    Eigen::Vector2d s;
    if (peer(n, 2, a.data(), Q.data(), F.data(), s.data()) != 0) continue;  // it gives up after 10000 nodes
    const auto fix = lambda(problem.a, problem.Q);
    ASSERT_TRUE(fix.ok());
    EXPECT_LE(fix.value().best_norm, s(0) * (1.0 + 1e-6));
    if ((F.col(0) - fix.value().best).norm() < 1e-3 && (F.col(1) - fix.value().second).norm() < 1e-3) ++same;
  }
  std::printf("[ FIGURE ] integer least squares: %d of 1000 random problems as Debian's lambda()\n", same);
  EXPECT_EQ(same, 1000);
}

TEST(IntegerLeastSquares, RefusesWhatIsNoProblem) {
  const double nan = std::nan("");
  const Matrix one = Matrix::Identity(2, 2);
  EXPECT_EQ(lambda(Vector(0), Matrix(0, 0)).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(nan, 0.0)), one).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(1e300, 0.0)), one).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(0.1, 0.2)), Matrix(nan * one)).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(0.1, 0.2)), Matrix(-one)).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(0.1, 0.2)), Matrix(Eigen::Matrix2d::Ones())).status(), Status::kOutOfRange);
  EXPECT_EQ(lambda(Vector(Eigen::Vector3d(0.1, 0.2, 0.3)), one).status(), Status::kOutOfRange);
  BoundedMatrix<double, kMost> huge = one;
  huge(0, 1) = huge(1, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(lambda(Vector(Eigen::Vector2d(0.1, 0.2)), huge).status(), Status::kOutOfRange);
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMost, 3> unknowns(2, 3);
  unknowns.setOnes();
  EXPECT_EQ((Decorrelation<double, kMost>(one, unknowns).status()), Status::kOk);
  unknowns(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ((Decorrelation<double, kMost>(one, unknowns).status()), Status::kOutOfRange);
  std::mt19937_64 rng(5);
  const Problem hard = random_problem(20, rng);
  EXPECT_EQ(lambda(hard.a, hard.Q, {10}).status(), Status::kTimeOut);
}

}  // namespace
}  // namespace trunnion
