// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/strapdown/body_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

template <class T>
Quaternion<T> rotation_of(const BodyMotion<T>& motion) {
  return Quaternion<T>(T(1) + motion.rotation_w, motion.rotation_v.x(), motion.rotation_v.y(), motion.rotation_v.z());
}

/// One update from samples that sample(i) makes, i counted from the start of the run.
template <class Algorithm, class Sample>
BodyMotion<typename Algorithm::Scalar> update(Algorithm& algorithm, long long first, const Sample& sample) {
  std::array<Increment<typename Algorithm::Scalar>, static_cast<std::size_t>(Algorithm::kSamples)> samples;
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = sample(first + static_cast<long long>(i));
  return algorithm(samples);
}

template <class Algorithm>
class EveryAlgorithm : public testing::Test {};

using Algorithms =
    testing::Types<PreviousSample<double>, MultiSample<double, 1>, MultiSample<double, 2>, MultiSample<double, 3>,
                   MultiSample<double, 4>, ExactSamples<double, 2>, ExactSamples<double, 3>, ExactSamples<double, 4>,
                   ExactSamples<double, 5>, ExactSamples<double, 6>, ExactSamples<double, 7>, ExactSamples<double, 8>,
                   ExactSamples<float, 6>, PreviousSample<float>, ExactSamples<long double, 6>>;
TYPED_TEST_SUITE(EveryAlgorithm, Algorithms, );

// The law: at a constant rate and force, rotation and velocity are those of eq. (2) of core/rotation.hpp and its
// integral, from a millionth of a radian a sample to a quarter of a turn an update.
TYPED_TEST(EveryAlgorithm, IsExactAtAConstantRate) {
  using T = typename TypeParam::Scalar;
  const T rounding = std::numeric_limits<T>::epsilon();
  for (int decade = -6; decade <= 0; ++decade) {
    const double size = std::min(std::pow(10.0, decade), 0.5 * kPi) / TypeParam::kSamples;
    const Vec3<T> w = (size * Vec3<double>(0.48, -0.6, 0.64)).template cast<T>();
    const Vec3<T> f(T(0.3), T(-0.2), T(1.0));
    TypeParam algorithm;
    static_cast<void>(update(algorithm, 0, [&](long long) { return Increment<T>{w, f}; }));
    const BodyMotion<T> motion = update(algorithm, 1, [&](long long) { return Increment<T>{w, f}; });
    const Vec3<double> phi = TypeParam::kSamples * w.template cast<double>();
    const Quaternion<double> q = quaternion_exp<double>(phi);
    EXPECT_LT((motion.rotation_v.template cast<double>() - q.vec()).norm(),
              8.0 * static_cast<double>(rounding) * phi.norm() + 4e-16)
        << size;
    EXPECT_NEAR(static_cast<double>(motion.rotation_w), q.w() - 1.0,
                8.0 * static_cast<double>(rounding) * phi.squaredNorm() + 2e-16);
    // integral of Exp(phi s) f over s in [0, 1], by Simpson on 2000 steps: 1e-14
    Vec3<double> v = Vec3<double>::Zero();
    for (int i = 0; i <= 2000; ++i)
      v += (i == 0 || i == 2000 ? 1.0
            : i % 2 == 1        ? 4.0
                                : 2.0) /
           6000.0 * (quaternion_exp<double>(phi * (i / 2000.0)) * f.template cast<double>());
    EXPECT_LT((motion.velocity.template cast<double>() - TypeParam::kSamples * v).norm(),
              20.0 * static_cast<double>(rounding) * TypeParam::kSamples + 1e-13);
  }
}

// Increments of a motion that is turned with the table are turned: R (dq, dv) of the increments are those of R
// increments.
TYPED_TEST(EveryAlgorithm, HasNoPreferredAxes) {
  using T = typename TypeParam::Scalar;
  const Quaternion<T> R = quaternion_exp<T>(Vec3<T>(T(0.3), T(-1.1), T(0.7)));
  const auto sample = [](long long i) {
    const T x = static_cast<T>(i);
    return Increment<T>{Vec3<T>(T(0.01) + T(0.002) * x, T(-0.02), T(0.003) * x * x),
                        Vec3<T>(T(0.1), T(0.2) * x, T(-1))};
  };
  TypeParam plain;
  TypeParam turned;
  const BodyMotion<T> a = update(plain, 0, sample);
  const BodyMotion<T> b = update(turned, 0, [&](long long i) {
    const Increment<T> s = sample(i);
    return Increment<T>{R * s.angle, R * s.velocity};
  });
  const double rounding = 50.0 * static_cast<double>(std::numeric_limits<T>::epsilon());
  EXPECT_LT(static_cast<double>((R * a.rotation_v - b.rotation_v).norm()), rounding);
  EXPECT_LT(static_cast<double>((R * a.velocity - b.velocity).norm()), 10.0 * rounding);
}

// ---- coning and sculling against their closed forms, in long double: rounding and terms of a^4 do not show -------

using Wide = long double;
constexpr Wide kRate = 200.0L;                                                  // W, rad/s
constexpr Wide kPhase = 2.0L * 3.14159265358979323846264338327950288L / 13.0L;  // W h
constexpr Wide kStep = kPhase / kRate;
constexpr Wide kCone = 3.5e-5L;           // rad
constexpr long long kSamples = 13 * 840;  // whole cycles, and whole updates of 1, 2, 3, 4, 6 and 8 samples

/// Drift about the axis of the cone, in units of a^2 W.
template <class Algorithm>
double coning_drift(Wide cone, Wide rate, Wide step, long long samples) {
  Algorithm algorithm;
  const auto sample = [&](long long i) {
    const Wide m = rate * step * (static_cast<Wide>(i) + 0.5L);
    const Wide s = 2.0L * std::sin(cone) * std::sin(0.5L * rate * step);
    const Wide half = std::sin(0.5L * cone);
    return Increment<Wide>{Vec3<Wide>(-2.0L * rate * half * half * step, -s * std::sin(m), s * std::cos(m)),
                           Vec3<Wide>::Zero()};
  };
  const auto attitude = [&](Wide angle) {
    return Quaternion<Wide>(std::cos(0.5L * cone), 0.0L, std::sin(0.5L * cone) * std::cos(angle),
                            std::sin(0.5L * cone) * std::sin(angle));
  };
  // an update before the start, so that the sample before the first is one of the motion
  static_cast<void>(update(algorithm, -Algorithm::kSamples, sample));
  Quaternion<Wide> q = attitude(0.0L);
  for (long long i = 0; i < samples; i += Algorithm::kSamples) q = q * rotation_of(update(algorithm, i, sample));
  const Wide time = static_cast<Wide>(samples) * step;
  const Quaternion<Wide> error = attitude(rate * time).conjugate() * q;
  return static_cast<double>(std::abs(2.0L * error.x()) / time / (cone * cone * rate));
}

/// Mean acceleration that is missed, in units of a A: theta = a sin Wt about x, f_y = A sin Wt.
template <class Algorithm>
double sculling_residual() {
  Algorithm algorithm;
  const auto sample = [](long long i) {
    const Wide from = kPhase * static_cast<Wide>(i);
    const Wide to = kPhase * static_cast<Wide>(i + 1);
    return Increment<Wide>{Vec3<Wide>(kCone * (std::sin(to) - std::sin(from)), 0.0L, 0.0L),
                           Vec3<Wide>(0.0L, (std::cos(from) - std::cos(to)) / kRate, 0.0L)};
  };
  static_cast<void>(update(algorithm, -Algorithm::kSamples, sample));
  Wide velocity = 0.0L;
  for (long long i = 0; i < kSamples; i += Algorithm::kSamples) {
    const Wide angle = kCone * std::sin(kPhase * static_cast<Wide>(i));
    const BodyMotion<Wide> motion = update(algorithm, i, sample);
    velocity += std::sin(angle) * motion.velocity.y() + std::cos(angle) * motion.velocity.z();
  }
  const Wide mean = velocity / (static_cast<Wide>(kSamples) * kStep);
  return static_cast<double>(std::abs(mean - std::cyl_bessel_j(1.0L, kCone)) / kCone);
}

/// What coefficients k_i leave of coning: true (N Wh - sin N Wh) / 2 an update, found 4 sin^2(Wh/2) sum k_i sin(lag
/// Wh).
double closed_form(std::initializer_list<double> k, double samples) {
  const auto wh = static_cast<double>(kPhase);
  const double s = 2.0 * std::sin(0.5 * wh);
  double found = 0.0;
  double lag = static_cast<double>(k.size());
  for (const double ki : k) found += ki * s * s * std::sin(lag-- * wh);
  return std::abs((samples * wh - std::sin(samples * wh)) / 2.0 - found) / (samples * wh);
}

void expect_formula(const char* name, double coning, double sculling, double formula, double leading) {
  std::printf(
      "[ FIGURE   ] W h = %.3f, %s: coning %.4e a^2 W, sculling %.4e a A; closed form %.4e, its first term %.4e\n",
      static_cast<double>(kPhase), name, coning, sculling, formula, leading);
  EXPECT_NEAR(coning / formula, 1.0, 1e-3) << name;
  EXPECT_NEAR(sculling / formula, 1.0, 1e-3) << name;
}

template <class Algorithm>
double coning_here() {
  return coning_drift<Algorithm>(kCone, kRate, kStep, kSamples);
}

TEST(ConingAndSculling, LeaveWhatTheClosedFormsSay) {
  const auto wh = static_cast<double>(kPhase);
  expect_formula("no correction", coning_here<MultiSample<Wide, 1>>(), sculling_residual<MultiSample<Wide, 1>>(),
                 closed_form({}, 1.0), std::pow(wh, 2) / 12.0);
  expect_formula("1 and previous", coning_here<PreviousSample<Wide>>(), sculling_residual<PreviousSample<Wide>>(),
                 closed_form({1.0 / 12.0}, 1.0), std::pow(wh, 4) / 60.0);
  expect_formula("2 samples", coning_here<MultiSample<Wide, 2>>(), sculling_residual<MultiSample<Wide, 2>>(),
                 closed_form({2.0 / 3.0}, 2.0), std::pow(wh, 4) / 60.0);
  expect_formula("3 samples", coning_here<MultiSample<Wide, 3>>(), sculling_residual<MultiSample<Wide, 3>>(),
                 closed_form({9.0 / 20.0, 27.0 / 20.0}, 3.0), std::pow(wh, 6) / 280.0);
  expect_formula("4 samples", coning_here<MultiSample<Wide, 4>>(), sculling_residual<MultiSample<Wide, 4>>(),
                 closed_form({54.0 / 105.0, 92.0 / 105.0, 214.0 / 105.0}, 4.0), std::pow(wh, 8) / 1260.0);
}

// A cone of 1 deg at 10 Hz, 400 samples/s, where the dropped term of Bortz's equation is the floor of the tuned
// algorithms. Measured elsewhere on the same motion: 6.2e-4, 1.07e-5 and 1.9e-7 deg/h for N = 4, 6, 8.
TEST(ConingAndSculling, ExactSamplesGoOnWhereTunedOnesStop) {
  const Wide cone = static_cast<Wide>(kRadPerDeg);
  const Wide rate = 20.0L * static_cast<Wide>(kPi);
  const Wide step = 0.0025L;
  constexpr long long kHalfMinute = 12000;
  const double unit = static_cast<double>(cone * cone * rate) / kRadPerSPerDegPerH;
  const double four = unit * coning_drift<ExactSamples<Wide, 4>>(cone, rate, step, kHalfMinute);
  const double six = unit * coning_drift<ExactSamples<Wide, 6>>(cone, rate, step, kHalfMinute);
  const double eight = unit * coning_drift<ExactSamples<Wide, 8>>(cone, rate, step, kHalfMinute);
  const double tuned = unit * coning_drift<MultiSample<Wide, 4>>(cone, rate, step, kHalfMinute);
  std::printf(
      "[ FIGURE   ] cone of 1 deg at 10 Hz, 400 Hz: drift 4 tuned %.3g, exact 4, 6, 8: %.3g, %.3g, %.3g deg/h\n", tuned,
      four, six, eight);
  EXPECT_NEAR(four, 6.2e-4, 0.2e-4);
  EXPECT_NEAR(six, 1.07e-5, 0.03e-5);
  EXPECT_NEAR(eight, 1.9e-7, 0.1e-7);
  EXPECT_GT(tuned, six);
}

// The law of eq. (3)-(5): where rate and force are polynomials of degree N - 1, only rounding is left. Held against
// Runge-Kutta on the differential equations, up to two radians an update.
TEST(ExactSamples, IntegratePolynomialsToRounding) {
  constexpr int kN = 6;
  constexpr int kSteps = 6000;
  for (const Wide size : {0.01L, 0.3L, 2.0L}) {
    std::array<Vec3<Wide>, kN> w;
    std::array<Vec3<Wide>, kN> f;
    for (std::size_t k = 0; k < kN; ++k) {
      const auto x = static_cast<Wide>(k);
      w[k] = size * Vec3<Wide>(std::sin(1.0L + 3.0L * x), std::cos(2.0L * x), std::sin(0.5L - x)) / 2.0L;
      f[k] = Vec3<Wide>(std::cos(x), std::sin(2.0L + x), 1.0L);
    }
    const auto value = [](const std::array<Vec3<Wide>, kN>& c, Wide t) {
      Vec3<Wide> sum = c[kN - 1];
      for (std::size_t k = kN - 1; k-- > 0;) sum = c[k] + t * sum;
      return sum;
    };
    const auto integral = [](const std::array<Vec3<Wide>, kN>& c, Wide t) {
      Vec3<Wide> sum = c[kN - 1] / Wide(kN);
      for (std::size_t k = kN - 1; k-- > 0;) sum = c[k] / static_cast<Wide>(k + 1) + t * sum;
      return Vec3<Wide>(t * sum);
    };
    ExactSamples<double, kN> algorithm;
    const BodyMotion<double> motion = update(algorithm, 0, [&](long long i) {
      const Wide from = static_cast<Wide>(i) / kN;
      const Wide to = static_cast<Wide>(i + 1) / kN;
      return Increment<double>{(integral(w, to) - integral(w, from)).cast<double>(),
                               (integral(f, to) - integral(f, from)).cast<double>()};
    });
    using Eight = Eigen::Matrix<Wide, 8, 1>;
    const auto slope = [&](Wide t, const Eight& x) {
      const Quaternion<Wide> q(x(0), x(1), x(2), x(3));
      const Vec3<Wide> rate = value(w, t);
      const Quaternion<Wide> dq = q * Quaternion<Wide>(0.0L, rate.x() / 2.0L, rate.y() / 2.0L, rate.z() / 2.0L);
      const Vec3<Wide> dv = q * value(f, t);
      Eight d;
      d << dq.w(), dq.x(), dq.y(), dq.z(), dv, 0.0L;
      return d;
    };
    Eight x = Eight::Zero();
    x(0) = 1.0L;
    const Wide h = 1.0L / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const Wide t = h * i;
      const Eight k1 = slope(t, x);
      const Eight k2 = slope(t + h / 2.0L, x + h / 2.0L * k1);
      const Eight k3 = slope(t + h / 2.0L, x + h / 2.0L * k2);
      const Eight k4 = slope(t + h, x + h * k3);
      x += h / 6.0L * (k1 + 2.0L * k2 + 2.0L * k3 + k4);
    }
    EXPECT_LT((motion.rotation_v - x.segment<3>(1).cast<double>()).norm(), 2e-14) << size;
    EXPECT_NEAR(1.0 + motion.rotation_w, static_cast<double>(x(0)), 2e-14) << size;
    EXPECT_LT((motion.velocity - x.segment<3>(4).cast<double>()).norm(), 4e-14) << size;
  }
}

}  // namespace
}  // namespace trunnion
