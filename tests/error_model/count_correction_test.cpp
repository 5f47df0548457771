// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/error_model/count_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "matchers/draw.hpp"

namespace trunnion {
namespace {

using Wide = long double;

constexpr double kGyroRange = 35.0;    // rad/s
constexpr double kAccelRange = 160.0;  // m/s^2

/// As far from perfect as a MEMS unit is before its calibration.
InertialUnit<double> any_unit(Draw& draw, bool bends) {
  InertialUnit<double> unit;
  unit.gyro.bias = draw.vector(0.1);
  unit.accel.bias = draw.vector(0.5);
  unit.gyro.M = draw.matrix(draw(1.0) > 0.5 ? 0.2 : 0.05);  // up to what the factory refuses
  unit.accel.M = draw.matrix(draw(1.0) > 0.5 ? 0.2 : 0.05);
  unit.g_sensitivity = draw.matrix(1e-4);
  unit.thermal.reference = 25.0 + draw(10.0);
  unit.thermal.bias[0] = {draw.vector(1e-3), draw.vector(1e-3)};
  unit.thermal.bias[1] = {draw.vector(1e-6), draw.vector(1e-5)};
  if (bends) {
    const double size = draw(1.0) > 0.5 ? 1.9e-3 : 1e-3;  // of full scale
    unit.gyro.cubic = draw.vector(size / (kGyroRange * kGyroRange));
    unit.gyro.quadratic = draw.vector(2e-5 / kGyroRange);
    unit.accel.quadratic = draw.vector(size / kAccelRange);
  }
  return unit;
}

template <class T>
InertialUnit<T> widened(const InertialUnit<double>& unit) {
  const auto triad = [](const Triad<double>& t) {
    return Triad<T>{t.bias.cast<T>(), t.M.cast<T>(), t.asymmetry.cast<T>(), t.quadratic.cast<T>(), t.cubic.cast<T>()};
  };
  const auto sample = [](const InertialSample<double>& s) { return InertialSample<T>{s.w.cast<T>(), s.f.cast<T>()}; };
  InertialUnit<T> wide;
  wide.gyro = triad(unit.gyro);
  wide.accel = triad(unit.accel);
  wide.g_sensitivity = unit.g_sensitivity.cast<T>();
  wide.thermal.reference = static_cast<T>(unit.thermal.reference);
  for (std::size_t k = 0; k < 2; ++k) wide.thermal.bias[k] = sample(unit.thermal.bias[k]);
  return wide;
}

/// Eq. (2) and (4) of inertial_unit.hpp in long double, its nonlinearity iterated until it stands.
UnitOutput<Wide> exactly(const InertialUnit<double>& of, const UnitScale<double>& scale,
                         const UnitOutput<std::int32_t>& y, double temperature, int fraction) {
  const InertialUnit<Wide> unit = widened<Wide>(of);
  const Wide t = static_cast<Wide>(temperature) - unit.thermal.reference;
  const auto reading = [&](std::size_t at, const NominalScale<double>& counts) {
    Vec3<Wide> r;
    for (std::size_t i = 0; i < 3; ++i)
      r(static_cast<int>(i)) =
          (static_cast<Wide>(y[at + i]) - static_cast<Wide>(counts.zero)) / static_cast<Wide>(counts.scale);
    return r;
  };
  const auto corrected = [&](const Triad<Wide>& triad, const Vec3<Wide>& unbiased) {
    const Mat3<Wide> A = triad.matrix().inverse();
    Vec3<Wide> u = A * unbiased;
    for (int i = 0; i < 30; ++i) u = A * (unbiased - triad.nonlinearity(u));
    return u;
  };
  const auto& linear = unit.thermal.bias[0];
  const auto& quadratic = unit.thermal.bias[1];
  const Vec3<Wide> f =
      corrected(unit.accel, reading(3, scale.accel) - unit.accel.bias - t * (linear.f + t * quadratic.f));
  const Vec3<Wide> w = corrected(
      unit.gyro, reading(0, scale.gyro) - unit.gyro.bias - t * (linear.w + t * quadratic.w) - unit.g_sensitivity * f);
  UnitOutput<Wide> out;
  const Wide one = std::ldexp(1.0L, fraction);
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = w(static_cast<int>(i)) * static_cast<Wide>(scale.gyro.scale) * one;
    out[i + 3] = f(static_cast<int>(i)) * static_cast<Wide>(scale.accel.scale) * one;
  }
  return out;
}

struct Format {
  int bits;
  int fraction;
};

/// All 64 corners of the readings' range, and 100 readings within: the largest error over the bound stated.
double worst_share_of_bound(bool bends, unsigned seed) {
  Draw draw(seed);
  double worst = 0.0;
  int accepted = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Format format = std::array<Format, 6>{
        {{16, 6}, {16, 14}, {20, 6}, {24, 4}, {8, 3}, {4, 20}}}[static_cast<std::size_t>(trial % 6)];
    const double most = std::ldexp(1.0, format.bits - 1);
    const InertialUnit<double> unit = any_unit(draw, bends);
    const UnitScale<double> scale{{most / kGyroRange, 0.2}, {most / kAccelRange, -0.3 * most}};
    const auto made = count_calibration(unit, scale, format.bits, format.fraction);
    if (!made.ok()) continue;
    ++accepted;
    CountCorrection correction(made.value().coefficients);
    const int t = static_cast<int>(25 * 256 + draw(90.0 * 256));
    correction.set_temperature(t);
    for (int i = 0; i < 164; ++i) {
      UnitOutput<std::int32_t> y;
      for (std::size_t k = 0; k < 6; ++k) {
        y[k] = i >= 64 ? static_cast<std::int32_t>(draw(most - 1.0))
                       : static_cast<std::int32_t>((static_cast<unsigned>(i) >> k & 1U) != 0U ? most - 1.0 : -most);
      }
      const UnitOutput<std::int32_t> out = correction.correct(y);
      EXPECT_EQ(out, correction.correct_saturated(y));
      const UnitOutput<Wide> exact = exactly(unit, scale, y, t / 256.0, format.fraction);
      for (std::size_t k = 0; k < 6; ++k) {
        const double error = std::abs(static_cast<double>(static_cast<Wide>(out[k]) - exact[k]));
        worst = std::max(worst, error / made.value().error_bound[k]);
      }
    }
  }
  EXPECT_GT(accepted, 1000);
  return worst;
}

TEST(CountCorrection, StaysWithinItsBound) {
  const double linear = worst_share_of_bound(false, 1);
  const double bent = worst_share_of_bound(true, 2);
  std::printf("[ FIGURE   ] integer correction: largest error %.2f of its bound; with nonlinearity %.2f\n", linear,
              bent);
  EXPECT_LT(linear, 1.0);
  EXPECT_LT(bent, 1.0);
  EXPECT_GT(linear, 0.5);  // a bound that is far off says nothing
}

// At the very end of what the factory takes: rows of 1.98, a bias near full scale, 1/512 of nonlinearity, 30 bits out.
// No sum overflows (UBSan sees to it), and the bound holds.
TEST(CountCorrection, StaysWithinItsBoundAtTheEndOfWhatFits) {
  for (const double sign : {-1.0, 1.0}) {
    InertialUnit<double> unit;
    unit.gyro.M = (1.0 / 1.9 - 1.0) * Mat3<double>::Identity();
    unit.accel.M = unit.gyro.M;
    unit.gyro.cubic.setConstant(sign * 0.99 / 512.0 / (kGyroRange * kGyroRange));
    unit.accel.quadratic.setConstant(sign * 0.99 / 512.0 / kAccelRange);
    unit.gyro.bias.setConstant(-0.5 * kGyroRange);
    unit.accel.bias.setConstant(-0.5 * kAccelRange);
    unit.g_sensitivity(0, 0) = 0.12 / 1.9 * kGyroRange / kAccelRange;
    const UnitScale<double> scale{{32768.0 / kGyroRange, 0.0}, {32768.0 / kAccelRange, 0.0}};
    const auto made = count_calibration(unit, scale, 16, 14);
    ASSERT_TRUE(made.ok());
    const CountCorrection correction(made.value().coefficients);
    for (int i = 0; i < 64; ++i) {
      UnitOutput<std::int32_t> y;
      for (std::size_t k = 0; k < 6; ++k) y[k] = (static_cast<unsigned>(i) >> k & 1U) != 0U ? 32767 : -32768;
      const UnitOutput<std::int32_t> out = correction.correct_saturated(y);
      const UnitOutput<Wide> exact = exactly(unit, scale, y, 0.0, 14);
      for (std::size_t k = 0; k < 6; ++k)
        EXPECT_LT(std::abs(static_cast<double>(static_cast<Wide>(out[k]) - exact[k])), made.value().error_bound[k]);
    }
  }
}

TEST(CountCorrection, OfAPerfectUnitIsTheScale) {
  const auto made = count_calibration(InertialUnit<double>(), {{1000.0, 0.0}, {200.0, 0.0}}, 16, 6);
  ASSERT_TRUE(made.ok());
  const CountCorrection correction(made.value().coefficients);
  const LinearCountCorrection linear(made.value().coefficients);
  EXPECT_EQ(correction.correct({1, -2, 3, 32767, -32768, 0}),
            (UnitOutput<std::int32_t>{64, -128, 192, 32767 * 64, -32768 * 64, 0}));
  EXPECT_EQ(linear.correct({1, -2, 3, 32767, -32768, 0}), correction.correct({1, -2, 3, 32767, -32768, 0}));
}

// Whatever the register holds: the end of the range, no overflow (UBSan sees to it).
TEST(CountCorrection, TakesAnyReadingForTheEndOfTheRange) {
  Draw draw(3);
  for (const bool bends : {false, true}) {
    const auto made =
        count_calibration(any_unit(draw, bends), {{32768.0 / kGyroRange, 0.0}, {32768.0 / kAccelRange, 0.0}}, 16, 14);
    ASSERT_TRUE(made.ok());
    const CountCorrection correction(made.value().coefficients);
    for (const std::int32_t beyond : {32768, 1 << 20, std::numeric_limits<std::int32_t>::max()}) {
      for (std::size_t k = 0; k < 6; ++k) {
        UnitOutput<std::int32_t> y{};
        UnitOutput<std::int32_t> end{};
        y[k] = beyond;
        end[k] = 32767;
        EXPECT_EQ(correction.correct_saturated(y), correction.correct(end));
        y[k] = -beyond - 1;
        end[k] = -32768;
        EXPECT_EQ(correction.correct_saturated(y), correction.correct(end));
        (void)correction.correct(y);
      }
    }
  }
}

TEST(CountCorrection, KeepsToTheEndOfItsTemperatures) {
  Draw draw(4);
  const auto made = count_calibration(any_unit(draw, false), {{1000.0, 0.0}, {200.0, 0.0}}, 16, 6);
  ASSERT_TRUE(made.ok());
  CountCorrection far(made.value().coefficients);
  CountCorrection end(made.value().coefficients);
  far.set_temperature(std::numeric_limits<std::int32_t>::max());
  end.set_temperature(made.value().coefficients.reference + 128 * 256);
  EXPECT_EQ(far.correct({1, 2, 3, 4, 5, 6}), end.correct({1, 2, 3, 4, 5, 6}));
  far.set_temperature(std::numeric_limits<std::int32_t>::min());
  end.set_temperature(made.value().coefficients.reference - 128 * 256);
  EXPECT_EQ(far.correct({1, 2, 3, 4, 5, 6}), end.correct({1, 2, 3, 4, 5, 6}));
}

TEST(CountCorrection, RefusesWhatDoesNotFit) {
  const UnitScale<double> scale{{1000.0, 0.0}, {200.0, 0.0}};
  const auto status = [&](const InertialUnit<double>& unit, const UnitScale<double>& s, int bits, int fraction) {
    return count_calibration(unit, s, bits, fraction).status();
  };
  InertialUnit<double> unit;
  EXPECT_EQ(status(unit, scale, 16, 14), Status::kOk);
  EXPECT_EQ(status(unit, scale, 16, 15), Status::kOutOfRange);
  EXPECT_EQ(status(unit, scale, 1, 6), Status::kOutOfRange);
  EXPECT_EQ(status(unit, scale, 16, -1), Status::kOutOfRange);
  EXPECT_EQ(status(unit, {{0.0, 0.0}, {200.0, 0.0}}, 16, 6), Status::kOutOfRange);
  EXPECT_EQ(status(unit, {{1000.0, 40000.0}, {200.0, 0.0}}, 16, 6), Status::kOutOfRange);
  unit.gyro.M(0, 1) = 1.0;
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.gyro.M = -Mat3<double>::Identity();
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.accel.bias.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.gyro.cubic.z() = 1e-5;  // 1 % of 32.8 rad/s
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.g_sensitivity(2, 0) = 0.06;
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.thermal.reference = std::numeric_limits<double>::infinity();
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  // what the integers do not carry is not left out in silence
  unit = {};
  unit.accel.asymmetry.y() = 1e-6;
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.thermal.scale[0].w.x() = 1e-9;
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
  unit = {};
  unit.thermal.bias[2].f.z() = 1e-9;
  EXPECT_EQ(status(unit, scale, 16, 6), Status::kOutOfRange);
}

}  // namespace
}  // namespace trunnion
