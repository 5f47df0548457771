// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The correction of an inertial unit in integers: raw counts in, corrected counts out, the same bits on every machine.
///
/// Readings y of B bits are moved up by s >= 2 bits; the matrices are in Q30, the sums on 64 bits:
///
///   out_i = floor((c_i + sum_j A_ij 2^s y_j) / 2^32),   A = (I + M)^-1 in Q30                      ... (1)
///
/// c holds the folded bias and zero and the half that makes floor a rounding. A count out is 2^(2-s) of a count in, and
/// 2^-fraction of one is what is stated: s = fraction + 2. Of the gyros a third sum takes H f away (H in Q32, f the
/// corrected specific force out); a nonlinearity is taken away in Triad's two steps. Against (5) of inertial_unit.hpp
/// in exact numbers, in counts out (docs/theory/calibration.md, eq. 28-32):
///
///   |error_i| <= 1/2 + sum_j 2^(B+s-34) + ...                                                      ... (2)
///
/// Of any 32-bit reading the sums stay within 64 bits: sum |A| < 2 is refused otherwise. A reading beyond B bits is
/// meaningless to correct() and the end of the range to correct_saturated().

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "trunnion/core/fixed.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

/// What (1) is made of: integers alone, for a flash block or a generated header.
struct CountCoefficients {
  using Row = std::array<std::int32_t, 3>;
  struct Axis {
    std::int64_t c;          ///< at T_0 [2^-32 counts out]
    std::int64_t c_1;        ///< by 1/256 K
    std::int64_t c_2;        ///< by (1/256 K)^2
    Row A;                   ///< Q30
    Row H;                   ///< of the gyros, Q32
    std::int32_t quadratic;  ///< of the nonlinearity, see bend()
    std::int32_t cubic;
  };
  std::array<Axis, 3> gyro;
  std::array<Axis, 3> accel;
  std::int32_t reference = 0;  ///< T_0 [1/256 degC]
  std::int16_t bits = 2;       ///< B: readings are within +-2^(B-1)
  std::int16_t shift = 2;      ///< s
  std::int32_t is_linear = 1;  ///< 1: no quadratic, no cubic
  std::int32_t reserved = 0;   ///< the size is a multiple of eight

  [[nodiscard]] constexpr bool linear() const { return is_linear == 1; }
  /// Whether (1) can be computed with them: of what comes from elsewhere.
  [[nodiscard]] constexpr bool is_usable() const {
    return bits >= 2 && shift >= 2 && bits + shift <= 32 && (is_linear == 0 || is_linear == 1);
  }
};

/// The coefficients, and how far (1) may be from exact arithmetic: worst case, in counts out, for readings of B bits.
struct CountCalibration {
  CountCoefficients coefficients{};
  UnitOutput<double> error_bound{};
};

namespace kernel {

/// Eq. (1) before the last shift.
TRUNNION_INLINE std::int64_t row_sum(std::int64_t c, const CountCoefficients::Row& A, std::int32_t x, std::int32_t y,
                                     std::int32_t z) {
  return c + static_cast<std::int64_t>(A[0]) * x + static_cast<std::int64_t>(A[1]) * y +
         static_cast<std::int64_t>(A[2]) * z;
}

/// Left by @p shift without the undefined behaviour of a negative number's.
TRUNNION_INLINE std::int32_t moved_up(std::int32_t value, int shift) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value) << static_cast<unsigned>(shift));
}

/// The same of what is beyond @p bits taken for the end of their range.
TRUNNION_INLINE std::int32_t limited(std::int32_t value, int bits, int shift) {
  const auto most = static_cast<std::int32_t>((std::uint32_t{1} << static_cast<unsigned>(bits - 1)) - 1U);
  return moved_up(value > most ? most : value < -most - 1 ? -most - 1 : value, shift);
}

/// Eq. (1) of one triad without the g-sensitivity: @p x, @p y, @p z moved up by s. @return counts out
TRUNNION_INLINE std::array<std::int32_t, 3> rows(const std::int64_t* c,
                                                 const std::array<CountCoefficients::Axis, 3>& axes, std::int32_t x,
                                                 std::int32_t y, std::int32_t z) {
  return {upper(row_sum(c[0], axes[0].A, x, y, z)), upper(row_sum(c[1], axes[1].A, x, y, z)),
          upper(row_sum(c[2], axes[2].A, x, y, z))};
}

}  // namespace kernel

/// @tparam Bends false: for units without nonlinearity, whose code is smaller
template <bool Bends>
class BasicCountCorrection {
 public:
  /// @p coefficients are not copied: they may stay in flash, and outlive this. Without Bends they must be linear().
  explicit BasicCountCorrection(const CountCoefficients& coefficients) : k_(&coefficients) {
    move(coefficients.reference);
  }

  /// Moves the biases to @p temperature [1/256 degC] where it has changed. Within 128 K of T_0, else the nearer end.
  TRUNNION_INLINE void set_temperature(std::int32_t temperature) {
    if (temperature != temperature_) move(temperature);
  }

  /// Eq. (1) of readings within B bits.
  [[nodiscard]] UnitOutput<std::int32_t> correct(const UnitOutput<std::int32_t>& y) const {
    const int s = k_->shift;
    using kernel::moved_up;
    return corrected({moved_up(y[0], s), moved_up(y[1], s), moved_up(y[2], s), moved_up(y[3], s), moved_up(y[4], s),
                      moved_up(y[5], s)});
  }
  /// Eq. (1) of any readings: beyond B bits they are taken for the end of the range.
  [[nodiscard]] UnitOutput<std::int32_t> correct_saturated(const UnitOutput<std::int32_t>& y) const {
    const int b = k_->bits;
    const int s = k_->shift;
    using kernel::limited;
    return corrected({limited(y[0], b, s), limited(y[1], b, s), limited(y[2], b, s), limited(y[3], b, s),
                      limited(y[4], b, s), limited(y[5], b, s)});
  }
  [[nodiscard]] const CountCoefficients& coefficients() const { return *k_; }

 private:
  TRUNNION_COLD void move(std::int32_t temperature) {
    temperature_ = temperature;
    constexpr std::int64_t kMost = 128 * 256;
    const std::int64_t off = static_cast<std::int64_t>(temperature) - k_->reference;
    const std::int64_t t = off > kMost ? kMost : off < -kMost ? -kMost : off;
    const CountCoefficients::Axis* axis = k_->gyro.data();
    for (std::size_t i = 0; i < 6; ++i, ++axis) {
      if (i == 3) axis = k_->accel.data();
      c_[i] = axis->c + t * (axis->c_1 + t * axis->c_2);
    }
  }

  TRUNNION_INLINE UnitOutput<std::int32_t> corrected(const UnitOutput<std::int32_t>& y) const {
    using kernel::row_sum;
    using kernel::upper;
    const CountCoefficients& k = *k_;
    if constexpr (Bends) {
      if (!k.linear()) return straightened(y);
    }
    const std::int32_t fx = upper(row_sum(c_[3], k.accel[0].A, y[3], y[4], y[5]));
    TRUNNION_IN_ORDER;
    const std::int32_t fy = upper(row_sum(c_[4], k.accel[1].A, y[3], y[4], y[5]));
    TRUNNION_IN_ORDER;
    const std::int32_t fz = upper(row_sum(c_[5], k.accel[2].A, y[3], y[4], y[5]));
    TRUNNION_IN_ORDER;
    const std::int32_t wx = upper(row_sum(row_sum(c_[0], k.gyro[0].A, y[0], y[1], y[2]), k.gyro[0].H, fx, fy, fz));
    TRUNNION_IN_ORDER;
    const std::int32_t wy = upper(row_sum(row_sum(c_[1], k.gyro[1].A, y[0], y[1], y[2]), k.gyro[1].H, fx, fy, fz));
    TRUNNION_IN_ORDER;
    const std::int32_t wz = upper(row_sum(row_sum(c_[2], k.gyro[2].A, y[0], y[1], y[2]), k.gyro[2].H, fx, fy, fz));
    return {wx, wy, wz, fx, fy, fz};
  }
  TRUNNION_COLD UnitOutput<std::int32_t> straightened(const UnitOutput<std::int32_t>& y) const {
    using kernel::row_sum;
    using kernel::upper;
    const CountCoefficients& k = *k_;
    std::array<std::int64_t, 3> f{};
    for (std::size_t i = 0; i < 3; ++i) f[i] = row_sum(c_[i + 3], k.accel[i].A, y[3], y[4], y[5]);
    straighten(k.accel, f);
    std::array<std::int64_t, 3> w{};
    for (std::size_t i = 0; i < 3; ++i)
      w[i] = row_sum(row_sum(c_[i], k.gyro[i].A, y[0], y[1], y[2]), k.gyro[i].H, upper(f[0]), upper(f[1]), upper(f[2]));
    straighten(k.gyro, w);
    return {upper(w[0]), upper(w[1]), upper(w[2]), upper(f[0]), upper(f[1]), upper(f[2])};
  }

  /// Four times the nonlinearity at @p out, in counts out: full scale is 2^(B+s-3) of them, so x is Q29 of it.
  static std::int32_t bend(const CountCoefficients::Axis& axis, std::int32_t out, int to_q29) {
    using kernel::upper;
    const std::int32_t x = kernel::moved_up(out, to_q29);
    const std::int32_t x2 = upper(x, x);  // Q26
    return upper(axis.quadratic, x2) + upper(axis.cubic, upper(x2, x));
  }
  void straighten(const std::array<CountCoefficients::Axis, 3>& axis, std::array<std::int64_t, 3>& sum) const {
    const int to_q29 = 32 - k_->bits - k_->shift;
    const std::array<std::int64_t, 3> linear = sum;
    for (int step = 0; step < Triad<double>::kCorrectionSteps; ++step) {
      std::array<std::int32_t, 3> n;
      for (std::size_t i = 0; i < 3; ++i) n[i] = -bend(axis[i], kernel::upper(sum[i]), to_q29);
      for (std::size_t i = 0; i < 3; ++i) sum[i] = kernel::row_sum(linear[i], axis[i].A, n[0], n[1], n[2]);
    }
  }

  const CountCoefficients* k_;
  std::int32_t temperature_ = 0;
  std::array<std::int64_t, 6> c_;
};

using CountCorrection = BasicCountCorrection<true>;
using LinearCountCorrection = BasicCountCorrection<false>;

/// The factory, for a host: integer coefficients of @p unit, whose readings are raw counts of @p bits that mean what
/// @p scale says, and the bound on what they cost. Counts out are 2^-fraction of counts in.
///
/// @param bits B in 2..30; @param fraction in 0..28, bits + fraction <= 30
/// @return kOutOfRange for an argument outside that or not finite, a matrix without an inverse or with a row whose
/// sizes sum to 1.99 or more, a g-sensitivity of an eighth of a gyro count by a count of force, a bias with its zero
/// beyond the range of the counts, a nonlinearity above 1/512 of full scale, an asymmetry, or terms of temperature
/// other than the biases' first and second order
inline Result<CountCalibration> count_calibration(const InertialUnit<double>& unit, const UnitScale<double>& scale,
                                                  int bits, int fraction) {
  if (bits < 2 || fraction < 0 || bits + fraction > 30) return Status::kOutOfRange;
  constexpr double kMostRow = 1.99;
  constexpr double kMostForce = 0.125;
  constexpr double kMostBend = (1.0 - 1e-6) / 512.0;
  constexpr double kMostReach = 3.9;  // full scales: four are the end of 64 bits
  const double out_per_in = std::ldexp(1.0, fraction);
  const double full_scale = std::ldexp(1.0, bits - 1);  // counts in
  CountCalibration made;
  CountCoefficients& k = made.coefficients;
  k.bits = static_cast<std::int16_t>(bits);
  k.shift = static_cast<std::int16_t>(fraction + 2);
  const auto q = [](double value, int point) {
    return static_cast<std::int32_t>(std::lround(std::ldexp(value, point)));
  };
  bool fits = std::abs(unit.thermal.reference) <= 1000.0 && unit.thermal.is_quadratic_bias() &&
              unit.gyro.asymmetry.isZero(0.0) && unit.accel.asymmetry.isZero(0.0);
  if (!fits) return Status::kOutOfRange;
  k.reference = q(unit.thermal.reference, 8);
  k.is_linear = unit.gyro.is_linear() && unit.accel.is_linear() ? 1 : 0;

  // how far an output goes, in full scales, and what the force's error adds to a rate
  std::array<double, 3> h_row{};
  const Mat3<double> H = unit.gyro.matrix().inverse() * unit.g_sensitivity * (scale.gyro.scale / scale.accel.scale);
  for (std::size_t i = 0; i < 3; ++i) {
    h_row[i] = H.row(static_cast<int>(i)).cwiseAbs().sum();
    fits = fits && h_row[i] < kMostForce;
    for (std::size_t j = 0; fits && j < 3; ++j) k.gyro[i].H[j] = q(-H(static_cast<int>(i), static_cast<int>(j)), 32);
  }
  if (!fits) return Status::kOutOfRange;

  // one triad; force: an addition to each output, in full scales, and force_error in counts out
  const auto fold = [&](const Triad<double>& triad, const NominalScale<double>& counts, const Vec3<double>& thermal_1,
                        const Vec3<double>& thermal_2, const std::array<double, 3>& force,
                        const std::array<double, 3>& force_error, std::array<CountCoefficients::Axis, 3>& axes,
                        double& reach) {
    std::array<double, 3> bound{};
    const Mat3<double> A = triad.matrix().inverse();
    const auto in_counts = [&](const Vec3<double>& b) -> Vec3<double> {
      return -(A * (counts.scale * b)) * out_per_in;
    };
    const Vec3<double> c_2 = in_counts(thermal_2) / 65536.0;
    const Vec3<double> at_exact_t0 = in_counts(triad.bias + Vec3<double>::Constant(counts.zero / counts.scale));
    // T_0 is held in 1/256 K; off it by e, c(t - e) in powers of t
    const double e = unit.thermal.reference * 256.0 - static_cast<double>(k.reference);
    const Vec3<double> slope_at_t0 = in_counts(thermal_1) / 256.0;
    const Vec3<double> c = at_exact_t0 - e * slope_at_t0 + e * e * c_2;
    const Vec3<double> c_1 = slope_at_t0 - 2.0 * e * c_2;
    const double range = full_scale / counts.scale;  // in SI
    const double full_out = full_scale * out_per_in;
    double bend = 0.0;   // the largest nonlinearity within reach, in full scales
    double slope = 0.0;  // and its slope
    double largest_row = 0.0;
    reach = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double row = A.row(i).cwiseAbs().sum();
      const double drift = 32768.0 * (std::abs(c_1(i)) + 32768.0 * std::abs(c_2(i)));
      fits = fits && row < kMostRow && std::abs(c(i)) + drift < full_out;
      if (!fits) return bound;
      reach = std::max(reach, row + (std::abs(c(i)) + drift) / full_out + force[static_cast<std::size_t>(i)]);
      largest_row = std::max(largest_row, row);
      CountCoefficients::Axis& axis = axes[static_cast<std::size_t>(i)];
      axis.c = std::llround(std::ldexp(c(i), 32)) + (std::int64_t{1} << 31);
      axis.c_1 = std::llround(std::ldexp(c_1(i), 32));
      axis.c_2 = std::llround(std::ldexp(c_2(i), 32));
      for (int j = 0; j < 3; ++j) axis.A[static_cast<std::size_t>(j)] = q(A(i, j), 30);
      // the last rounding, A's roundings on full readings, those of c, and of its slopes over 128 K
      double& b = bound[static_cast<std::size_t>(i)];
      b = 0.5 + 3.0 * std::ldexp(1.0, bits + k.shift - 34) + std::ldexp(0.5, -32) +
          force_error[static_cast<std::size_t>(i)];
      if (drift > 0.0) b += std::ldexp(0.5 * 32768.0 * (1.0 + 32768.0), -32);
    }
    // the nonlinearity reaches farther than the linear part, and then is larger: eight rounds leave 1e-6 of it
    const double linear_reach = reach;
    for (int round = 0; round < 8; ++round) {
      double most = 0.0;
      for (int j = 0; j < 3; ++j)
        most = std::max(
            most,
            reach * reach * (std::abs(triad.quadratic(j) * range) + reach * std::abs(triad.cubic(j) * range * range)));
      reach = linear_reach + 1.0001 * largest_row * most;
      fits = fits && reach < kMostReach;
      if (!fits) return bound;
    }
    for (int j = 0; j < 3; ++j) {
      const double quadratic = triad.quadratic(j) * range;
      const double cubic = triad.cubic(j) * range * range;
      fits = fits && std::abs(quadratic) + std::abs(cubic) < kMostBend;
      if (!fits) return bound;
      bend = std::max(bend, reach * reach * (std::abs(quadratic) + reach * std::abs(cubic)));
      slope = std::max(slope, largest_row * reach * (2.0 * std::abs(quadratic) + 3.0 * reach * std::abs(cubic)));
      axes[static_cast<std::size_t>(j)].quadratic = q(quadratic, bits + k.shift + 5);
      axes[static_cast<std::size_t>(j)].cubic = q(cubic, bits + k.shift + 8);
    }
    if (k.linear()) return bound;
    // what two steps leave, bend()'s roundings (three quarters of a count) through a row, and all errors seen once more
    // by the bend
    for (double& b : bound)
      b = (b + largest_row * 0.75) / (1.0 - slope) + slope * slope * largest_row * bend * full_out;
    return bound;
  };
  double reach = 0.0;
  const std::array<double, 3> accel =
      fold(unit.accel, scale.accel, unit.thermal.bias[0].f, unit.thermal.bias[1].f, {}, {}, k.accel, reach);
  if (!fits) return Status::kOutOfRange;
  std::array<double, 3> force{};
  std::array<double, 3> force_error{};
  for (std::size_t i = 0; i < 3; ++i) {
    force[i] = h_row[i] * reach;
    for (std::size_t j = 0; j < 3; ++j)  // of the force's own error, and H's rounding on it
      force_error[i] += std::abs(H(static_cast<int>(i), static_cast<int>(j))) * accel[j] +
                        reach * std::ldexp(1.0, bits + k.shift - 36);
  }
  const std::array<double, 3> gyro =
      fold(unit.gyro, scale.gyro, unit.thermal.bias[0].w, unit.thermal.bias[1].w, force, force_error, k.gyro, reach);
  if (!fits) return Status::kOutOfRange;
  for (std::size_t i = 0; i < 3; ++i) {
    made.error_bound[i] = gyro[i];
    made.error_bound[i + 3] = accel[i];
  }
  return made;
}

}  // namespace trunnion
