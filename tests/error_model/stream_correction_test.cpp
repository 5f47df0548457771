// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/error_model/stream_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "matchers/draw.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

InertialUnit<double> any_unit(Draw& draw) {
  InertialUnit<double> unit;
  unit.gyro.M = draw.matrix(0.02);
  unit.accel.M = draw.matrix(0.02);
  unit.gyro.bias = draw.vector(0.1);
  unit.accel.bias = draw.vector(0.5);
  unit.g_sensitivity = draw.matrix(1e-4);
  unit.gyro.asymmetry = draw.vector(1e-5);
  unit.accel.asymmetry = draw.vector(1e-5);
  unit.thermal.reference = 20.0;
  double power = 1.0;
  for (std::size_t k = 0; k < ThermalErrors<double>::kMostOrder; ++k) {
    power *= 40.0;
    unit.thermal.bias[k] = {draw.vector(1e-3 / power), draw.vector(1e-2 / power)};
    unit.thermal.scale[k] = {draw.vector(1e-3 / power), draw.vector(1e-3 / power)};
  }
  return unit;
}

// The polynomials term by term, not as Horner does.
TEST(ThermalErrors, AreTheSumOfTheirPowers) {
  Draw draw(1);
  for (int i = 0; i < 100; ++i) {
    const InertialUnit<double> unit = any_unit(draw);
    const double celsius = 20.0 + draw(40.0);
    InertialUnit<double> at = unit.at(celsius);
    for (std::size_t k = 0; k < ThermalErrors<double>::kMostOrder; ++k) {
      const double power = std::pow(celsius - 20.0, static_cast<double>(k + 1));
      at.gyro.bias -= power * unit.thermal.bias[k].w;
      at.accel.bias -= power * unit.thermal.bias[k].f;
      at.gyro.M.diagonal() -= power * unit.thermal.scale[k].w;
      at.accel.M.diagonal() -= power * unit.thermal.scale[k].f;
    }
    EXPECT_LT((at.gyro.bias - unit.gyro.bias).norm() + (at.accel.bias - unit.accel.bias).norm(), 1e-14);
    EXPECT_LT((at.gyro.M - unit.gyro.M).norm() + (at.accel.M - unit.accel.M).norm(), 1e-15);
    EXPECT_EQ(at.thermal.order(), 0);
  }
}

TEST(ThermalErrors, KnowTheirOrder) {
  ThermalErrors<double> thermal;
  EXPECT_EQ(thermal.order(), 0);
  EXPECT_TRUE(thermal.is_quadratic_bias());
  thermal.bias[1].f.y() = 1e-9;
  EXPECT_EQ(thermal.order(), 2);
  EXPECT_TRUE(thermal.is_quadratic_bias());
  thermal.scale[3].w.z() = 1e-12;
  EXPECT_EQ(thermal.order(), 4);
  EXPECT_FALSE(thermal.is_quadratic_bias());
}

// Beyond the range that was calibrated, its end: a polynomial of fifth order would run away.
TEST(ThermalErrors, StopAtTheEndsOfTheirRange) {
  Draw draw(2);
  InertialUnit<double> unit = any_unit(draw);
  unit.thermal.lowest = -20.0;
  unit.thermal.highest = 60.0;
  EXPECT_EQ(unit.at(200.0).gyro.bias, unit.at(60.0).gyro.bias);
  EXPECT_EQ(unit.at(-200.0).accel.M, unit.at(-20.0).accel.M);
  EXPECT_NE(unit.at(59.0).gyro.bias, unit.at(60.0).gyro.bias);
}

TEST(ThermalCorrection, UndoesWhatTheUnitDoesAtEveryTemperature) {
  Draw draw(3);
  for (int i = 0; i < 300; ++i) {
    const InertialUnit<double> unit = any_unit(draw);
    const UnitScale<double> counts{{938.7, 12.0}, {208.8, -7.0}};
    ThermalCorrection<double> correction(unit, counts);
    for (int k = 0; k < 3; ++k) {
      const double celsius = 20.0 + draw(40.0);
      const InertialSample<double> input{draw.vector(8.0), draw.vector(40.0)};
      const InertialSample<double> reading = unit.distort(input, celsius);
      const InertialSample<double> raw{reading.w * 938.7 + Vec3<double>::Constant(12.0),
                                       reading.f * 208.8 + Vec3<double>::Constant(-7.0)};
      correction.set_temperature(celsius);
      const InertialSample<double> found = correction.correct(raw);
      EXPECT_LT((found.w - input.w).norm() + (found.f - input.f).norm(), 1e-11 * 60.0);
      correction.set_temperature(kNaN);  // not measured: as before
      EXPECT_EQ(correction.correct(raw).w, found.w);
    }
  }
}

TEST(ThermalCorrection, RefusesWhatNoUnitReads) {
  Draw draw(5);
  const InertialUnit<double> unit = any_unit(draw);
  ThermalCorrection<double> correction(unit);
  correction.set_temperature(45.0);
  const InertialSample<double> reading = unit.distort({draw.vector(2.0), draw.vector(10.0)}, 45.0);
  const auto found = correction.checked(reading);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found.value().w, correction.correct(reading).w);
  EXPECT_EQ(found.value().f, correction.correct(reading).f);
  for (int i = 0; i < 6; ++i) {
    InertialSample<double> bad = reading;
    (i < 3 ? bad.w(i) : bad.f(i - 3)) = kNaN;
    EXPECT_EQ(correction.checked(bad).status(), Status::kOutOfRange) << i;
  }
}

// Eq. (6) against what accelerometers at their own places feel: second differences of their positions.
TEST(SizeEffect, IsTheAccelerationOfThePlaces) {
  Draw draw(4);
  for (int i = 0; i < 50; ++i) {
    InertialUnit<double> unit = any_unit(draw);
    unit.accel_place.col(1) = draw.vector(0.05);
    unit.accel_place.col(2) = draw.vector(0.05);
    const Vec3<double> w = draw.vector(5.0);
    const Vec3<double> w_dot = draw.vector(20.0);
    // C(t) = Exp(w t + w' t^2 / 2 + w x w' t^3 / 12): rate w and acceleration w' at t = 0, in body axes
    const auto place = [&](double t, int axis) -> Vec3<double> {
      const Vec3<double> turned = w * t + 0.5 * t * t * w_dot + t * t * t / 12.0 * w.cross(w_dot);
      return rotation_exp<double>(turned) * unit.accel_place.col(axis);
    };
    constexpr double kStep = 1e-3;
    const Vec3<double> e = unit.size_effect(w, w_dot);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3<double> acceleration =
          (place(kStep, axis) - 2.0 * place(0.0, axis) + place(-kStep, axis)) / (kStep * kStep);
      EXPECT_NEAR(e(axis), unit.accel.matrix().row(axis).dot(acceleration), 1e-3 * (1.0 + acceleration.norm()) * 0.05);
    }
    EXPECT_EQ(e(0), 0.0);
  }
}

// Along a swing: exact but for the lag of the angular acceleration, half of 20 to 40 ms.
TEST(StreamCorrection, UndoesTheSizeEffectAlongAMotion) {
  InertialUnit<double> unit;
  unit.accel.M.diagonal().setConstant(0.01);
  unit.accel_place.col(1) = Vec3<double>(0.02, -0.01, 0.03);
  unit.accel_place.col(2) = Vec3<double>(-0.02, 0.02, 0.01);
  StreamCorrection<double> correction(unit);
  constexpr double kRate = 2.0 * kPi * 0.2;  // rad/s
  const Vec3<double> axis = Vec3<double>(1.0, -2.0, 0.5).normalized();
  const Vec3<double> f(0.3, -0.2, 9.8);
  double worst = 0.0;
  double largest = 0.0;
  double jerk = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double t = 0.0025 * k;
    const Vec3<double> w = 3.0 * std::sin(kRate * t) * axis;
    const Vec3<double> w_dot = 3.0 * kRate * std::cos(kRate * t) * axis;
    const Vec3<double> e = unit.size_effect(w, w_dot);
    InertialSample<double> reading = unit.distort({w, f});
    reading.f += e;
    const InertialSample<double> found = correction.correct(t, reading);
    EXPECT_LT((found.w - w).norm(), 1e-12);
    if (t < 0.05) continue;
    worst = std::max(worst, (found.f - f).norm());
    largest = std::max(largest, e.norm());
    jerk = std::max(jerk, 3.0 * kRate * kRate);
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(worst, 0.5 * 0.04 * jerk * 0.05);  // lag times jerk times the places
  // a turn that stands has no acceleration: exact
  for (int k = 0; k < 100; ++k) {
    const double t = 20.0 + 0.0025 * k;
    const Vec3<double> w = 3.0 * axis;
    InertialSample<double> reading = unit.distort({w, f});
    reading.f += unit.size_effect(w, Vec3<double>::Zero());
    EXPECT_LT((correction.correct(t, reading).f - f).norm(), 1e-12);
  }
}

TEST(StreamCorrection, IsTheThermalOneWhereTheAccelerometersAreInOnePlace) {
  Draw draw(6);
  const InertialUnit<double> unit = any_unit(draw);
  StreamCorrection<double> stream(unit);
  ThermalCorrection<double> thermal(unit);
  for (int k = 0; k < 50; ++k) {
    const double celsius = 20.0 + draw(40.0);
    stream.set_temperature(celsius);
    thermal.set_temperature(celsius);
    const InertialSample<double> reading{draw.vector(2.0), draw.vector(10.0)};
    const InertialSample<double> found = stream.correct(0.01 * k, reading);
    EXPECT_EQ(found.w, thermal.correct(reading).w);
    EXPECT_EQ(found.f, thermal.correct(reading).f);
  }
}

}  // namespace
}  // namespace trunnion
