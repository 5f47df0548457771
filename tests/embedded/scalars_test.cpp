// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Every scalar that rungs 0 and 1 promise, by name: a template is tested for what it is instantiated with.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <type_traits>

#include "trunnion/model.hpp"

namespace trunnion {

using Jet = ceres::Jet<double, 4>;

template struct Triad<float>;
template struct Triad<double>;
template struct Triad<long double>;
template struct Triad<Jet>;
template struct InertialUnit<float>;
template struct InertialUnit<double>;
template struct InertialUnit<long double>;
template struct InertialUnit<Jet>;
template class UnitCorrection<float>;
template class UnitCorrection<double>;
template class UnitCorrection<long double>;
template class UnitCorrection<Jet>;
template class ThermalCorrection<float>;
template class ThermalCorrection<double>;
template class SizeEffect<float>;
template class StreamCorrection<float>;
template class StreamCorrection<double>;
template struct EncoderEccentricity<float>;
template struct EncoderEccentricity<double>;
template struct EncoderEccentricity<long double>;
template struct EncoderEccentricity<Jet>;
template class TwoAxisTable<float>;
template class TwoAxisTable<double>;
template class TwoAxisTable<long double>;
template class TwoAxisTable<Jet>;
template Quaternion<float> quaternion_exp<float>(const Vec3<float>&);
template Quaternion<Jet> quaternion_exp<Jet>(const Vec3<Jet>&);
template Vec3<float> quaternion_log<float>(const Quaternion<float>&);
template Vec3<Jet> quaternion_log<Jet>(const Quaternion<Jet>&);

static_assert(std::is_trivially_destructible_v<UnitCorrection<float>>);
static_assert(sizeof(InertialUnit<float>) == 123 * sizeof(float));

namespace {

// The derivative through zero is exactly one half: what the series is for.
TEST(QuaternionExp, HasItsDerivativeAtZero) {
  Vec3<Jet> phi;
  for (int i = 0; i < 3; ++i) phi(i) = Jet(0.0, i);
  const Quaternion<Jet> q = quaternion_exp<Jet>(phi);
  EXPECT_EQ(q.x().v(0), 0.5);
  EXPECT_EQ(q.y().v(1), 0.5);
  EXPECT_EQ(q.z().v(2), 0.5);
  EXPECT_EQ(q.w().v(0), 0.0);
}

/// One input to the table as a function of nonorthogonality, tilt, eccentricity and heading.
template <class T>
InertialSample<T> table_input(const std::array<T, 4>& p) {
  TwoAxisErrors<T> errors;
  errors.nonorthogonality = p[0];
  errors.tilt_x = p[1];
  errors.eccentricity[1].cosine = p[2];
  errors.heading = p[3];
  const TwoAxisTable<T> table(TwoAxisGeometry{}, errors, 0.7, T(9.8));
  return table.input({T(0.5), T(0.8), T(0.1)}, {T(0.3), T(-0.4), T(0.2)}, Vec3<T>(T(0.01), T(0.02), T(0.03)));
}

// Jets against central differences, step 1e-6: truncation 1e-12, rounding 1e-9.
TEST(TwoAxisTable, JetsAgreeWithDifferences) {
  const std::array<double, 4> at = {1e-3, 2e-3, 1e-4, 0.6};
  std::array<Jet, 4> jets;
  for (int i = 0; i < 4; ++i) jets[static_cast<std::size_t>(i)] = Jet(at[static_cast<std::size_t>(i)], i);
  const InertialSample<Jet> derived = table_input(jets);
  for (int i = 0; i < 4; ++i) {
    std::array<double, 4> ahead = at;
    std::array<double, 4> behind = at;
    ahead[static_cast<std::size_t>(i)] += 1e-6;
    behind[static_cast<std::size_t>(i)] -= 1e-6;
    const InertialSample<double> plus = table_input(ahead);
    const InertialSample<double> minus = table_input(behind);
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(derived.w(row).v(i), (plus.w(row) - minus.w(row)) / 2e-6, 1e-8) << i;
      EXPECT_NEAR(derived.f(row).v(i), (plus.f(row) - minus.f(row)) / 2e-6, 1e-7) << i;
    }
  }
}

// Single precision follows double to some epsilon of its largest intermediate.
TEST(TwoAxisTable, FloatFollowsDouble) {
  const InertialSample<float> f = table_input(std::array<float, 4>{1e-3F, 2e-3F, 1e-4F, 0.6F});
  const InertialSample<double> d = table_input(std::array<double, 4>{1e-3, 2e-3, 1e-4, 0.6});
  EXPECT_LT((f.w.cast<double>() - d.w).norm(), 8 * 1.2e-7);
  EXPECT_LT((f.f.cast<double>() - d.f).norm(), 8 * 1.2e-7 * 10.0);
}

}  // namespace
}  // namespace trunnion
