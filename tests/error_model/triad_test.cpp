// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/error_model/triad.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "matchers/draw.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {
namespace {

TEST(Triad, ZeroParametersAreThePerfectInstrument) {
  const Vec3<double> u(0.3, -1.2, 4.0);
  const Triad<double> perfect;
  EXPECT_EQ(perfect.distort(u), u);
  EXPECT_EQ(perfect.correct(u, perfect.matrix().inverse()), u);
}

// Without nonlinearity the inverse is exact: rounding only, a few epsilon of the largest component.
TEST(Triad, CorrectUndoesALinearDistortion) {
  Draw draw(1);
  for (int i = 0; i < 1000; ++i) {
    Triad<double> triad;
    triad.bias = draw.vector(0.5);
    triad.M = draw.matrix(0.1);
    const Vec3<double> u = draw.vector(10.0);
    EXPECT_LT((triad.correct(triad.distort(u), triad.matrix().inverse()) - u).norm(), 1e-14 * 30.0);
  }
}

// Two steps leave less than 1e-9 of full scale where the nonlinearity is 100 ppm of it: the header's promise.
TEST(Triad, CorrectUndoesANonlinearDistortionToItsPromise) {
  Draw draw(2);
  constexpr double kFullScale = 8.7;
  for (int i = 0; i < 1000; ++i) {
    Triad<double> triad;
    triad.M = draw.matrix(0.01);
    triad.cubic = draw.vector(100e-6 / (kFullScale * kFullScale));
    triad.quadratic = draw.vector(100e-6 / kFullScale);
    triad.asymmetry = draw.vector(100e-6);
    const Vec3<double> u = draw.vector(kFullScale);
    EXPECT_LT((triad.correct(triad.distort(u), triad.matrix().inverse()) - u).norm(), 1e-9 * kFullScale);
  }
}

TEST(Triad, ConvergesAtWhatCorrectUndoes) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Draw draw(21);
  for (int i = 0; i < 1000; ++i) {
    Triad<double> triad;
    for (Vec3<double>* of : {&triad.asymmetry, &triad.quadratic, &triad.cubic}) *of = draw.vector(0.02);
    const Vec3<double> u = draw.vector(10.0);
    if (!triad.converges_at(u)) continue;
    Vec3<double> x = triad.distort(u);
    for (int step = 0; step < 100; ++step) x = triad.distort(u) - triad.nonlinearity(x);
    EXPECT_LT((x - u).norm(), 1e-12 * (1.0 + u.norm())) << "the fixed point is not the input";
  }
  Triad<double> triad;
  EXPECT_TRUE(triad.converges_at({1e300, -1e300, 0.0}));
  EXPECT_FALSE(triad.converges_at({0.0, kNone, 0.0}));
  EXPECT_FALSE(triad.converges_at({0.0, 0.0, -kInfinite}));
  triad.cubic.x() = 0.01;
  EXPECT_TRUE(triad.converges_at({4.0, 100.0, 100.0}));
  EXPECT_FALSE(triad.converges_at({-4.1, 0.0, 0.0}));
}

TEST(Triad, GeometryMultipliesBackToTheMatrix) {
  Draw draw(3);
  for (int i = 0; i < 1000; ++i) {
    Triad<double> triad;
    triad.M = draw.matrix(0.05);
    const TriadGeometry<double> parts = triad.geometry();
    const Mat3<double> S = (Vec3<double>::Ones() + parts.scale).asDiagonal();
    const Mat3<double> T = Mat3<double>::Identity() + parts.nonorthogonality;
    EXPECT_LT((S * T * rotation_exp<double>(parts.installation) - triad.matrix()).norm(), 1e-13);
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(T.row(row).norm(), 1.0, 1e-14);
      for (int column = row + 1; column < 3; ++column) EXPECT_NEAR(T(row, column), 0.0, 1e-14);
    }
  }
}

TEST(InertialUnit, CorrectTakesGSensitivityOutWithTheCorrectedForce) {
  Draw draw(4);
  for (int i = 0; i < 1000; ++i) {
    InertialUnit<double> unit;
    unit.gyro.bias = draw.vector(0.1);
    unit.gyro.M = draw.matrix(0.02);
    unit.accel.bias = draw.vector(0.5);
    unit.accel.M = draw.matrix(0.02);
    unit.g_sensitivity = draw.matrix(1e-3);
    const InertialSample<double> input{draw.vector(5.0), draw.vector(20.0)};
    const InertialSample<double> output = UnitCorrection<double>(unit).correct(unit.distort(input));
    EXPECT_LT((output.w - input.w).norm(), 1e-13);
    EXPECT_LT((output.f - input.f).norm(), 1e-13);
  }
}

// Readings in SI and raw counts, float and double, at a temperature: one law, what distort() did is undone.
TEST(UnitCorrection, UndoesCountsAndTemperature) {
  Draw draw(7);
  for (int i = 0; i < 300; ++i) {
    InertialUnit<double> unit;
    unit.gyro.M = draw.matrix(0.02);
    unit.accel.M = draw.matrix(0.02);
    unit.gyro.bias = draw.vector(0.1);
    unit.accel.bias = draw.vector(0.5);
    unit.g_sensitivity = draw.matrix(1e-4);
    if (i % 2 == 1) unit.gyro.cubic = draw.vector(1e-7);
    unit.thermal.reference = 20.0;
    unit.thermal.bias[0] = {draw.vector(1e-4), draw.vector(1e-3)};
    unit.thermal.bias[1] = {draw.vector(1e-6), draw.vector(1e-5)};
    const UnitScale<double> counts{{938.7, 12.0}, {208.8, -7.0}};
    const double temperature = 20.0 + draw(50.0);
    const InertialSample<double> input{draw.vector(8.0), draw.vector(40.0)};
    const InertialSample<double> reading = unit.distort(input, temperature);
    const InertialSample<double> raw{reading.w * 938.7 + Vec3<double>::Constant(12.0),
                                     reading.f * 208.8 + Vec3<double>::Constant(-7.0)};
    const InertialSample<double> found = UnitCorrection<double>(unit, counts).correct(raw, temperature);
    EXPECT_LT((found.w - input.w).norm() + (found.f - input.f).norm(), 1e-12 * 60.0);
    const InertialSample<float> in_float =
        UnitCorrection<float>(unit, counts)
            .correct({raw.w.cast<float>(), raw.f.cast<float>()}, static_cast<float>(temperature));
    EXPECT_LT((in_float.w.cast<double>() - input.w).norm(), 1e-6 * 8.0);
    EXPECT_LT((in_float.f.cast<double>() - input.f).norm(), 1e-6 * 40.0);
  }
}

TEST(UnitCorrection, SaysThatAReadingIsNotFinite) {
  const UnitCorrection<float> correction{InertialUnit<float>()};
  for (int i = 0; i < 6; ++i) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
      InertialSample<float> reading;
      (i < 3 ? reading.w(i) : reading.f(i - 3)) = bad;
      EXPECT_EQ(correction.checked(reading).status(), Status::kOutOfRange);
    }
  }
  EXPECT_TRUE(correction.checked({Vec3<float>(1, 2, 3), Vec3<float>(4, 5, 6)}).ok());
  EXPECT_TRUE(correction.checked({Vec3<float>(1, 2, 3), Vec3<float>(4, 5, 6)}, 20.0F).ok());
  EXPECT_FALSE(correction.checked({}, std::numeric_limits<float>::quiet_NaN()).ok());
}

}  // namespace
}  // namespace trunnion
