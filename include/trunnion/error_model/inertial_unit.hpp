// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Deterministic errors of an inertial unit: a gyro triad that feels specific force, and an accelerometer triad.
///
///   y_g = (I + M_g(T)) w + b_g(T) + n_g(w) + G f                           ... (1)
///   y_a = (I + M_a(T)) f + b_a(T) + n_a(f) + e                             ... (2)
///   b(T) = b + sum b_k t^k,  M(T) = M + diag(sum s_k t^k),  t = T - T_0    ... (3)
///   correction: f from (2) first, then w from y_g - G f                    ... (4)
///   e_i = K_i (w' x d_i + w x (w x d_i)),  K_i: row i of I + M_a           ... (6)
///
/// w = w_ib_b [rad/s], f = f_b [m/s^2], n: nonlinearity (triad.hpp), G: g-sensitivity of the gyros
/// [(rad/s)/(m/s^2)], T: temperature [degC], e: size effect of accelerometers that sit at d_i [m] about the sensing
/// point, w': angular acceleration. IEEE Std 1554-2005; docs/theory/calibration.md, eq. 1-5, 35-37.

#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "trunnion/core/status.hpp"
#include "trunnion/core/triple.hpp"
#include "trunnion/error_model/triad.hpp"

namespace trunnion {

/// A pair of three-axis readings or inputs: angular rate [rad/s] and specific force [m/s^2].
template <class T>
struct InertialSample {
  Vec3<T> w = Vec3<T>::Zero();
  Vec3<T> f = Vec3<T>::Zero();
};

/// The outputs of a unit as they come: x y z of the gyros, then x y z of the accelerometers.
template <class C>
using UnitOutput = std::array<C, 6>;

/// b_k and s_k of eq. (3): zero where a unit is not calibrated over temperature.
template <class T>
struct ThermalErrors {
  static constexpr int kMostOrder = 5;
  using Orders = std::array<InertialSample<T>, kMostOrder>;

  T reference = T(0);  ///< T_0 [degC]
  /// Of the calibration [degC]; beyond it the nearer end is taken: a polynomial runs away there.
  T lowest = -std::numeric_limits<T>::infinity();
  T highest = std::numeric_limits<T>::infinity();
  Orders bias;   ///< b_1, b_2, ... [unit of the sensor / K^k]
  Orders scale;  ///< s_1, s_2, ... [1 / K^k]

  /// The highest power with a coefficient that is not zero.
  [[nodiscard]] int order() const {
    for (std::size_t k = kMostOrder; k > 0; --k) {
      if (!is_zero(bias[k - 1]) || !is_zero(scale[k - 1])) return static_cast<int>(k);
    }
    return 0;
  }
  /// Whether there is no more than b_1 and b_2: what UnitCorrection and the integers carry.
  [[nodiscard]] bool is_quadratic_bias() const {
    for (std::size_t k = 0; k < kMostOrder; ++k) {
      if (!is_zero(scale[k]) || (k >= 2 && !is_zero(bias[k]))) return false;
    }
    return true;
  }
  /// sum c_k t^k of @p orders at @p temperature [degC].
  [[nodiscard]] InertialSample<T> at(const T& temperature, const Orders& orders) const {
    const T t = std::min(std::max(temperature, lowest), highest) - reference;
    InertialSample<T> sum;
    for (std::size_t k = kMostOrder; k > 0; --k) sum = {t * (orders[k - 1].w + sum.w), t * (orders[k - 1].f + sum.f)};
    return sum;
  }

 private:
  static bool is_zero(const InertialSample<T>& c) { return c.w.isZero(T(0)) && c.f.isZero(T(0)); }
};

template <class T>
struct InertialUnit {
  Triad<T> gyro;
  Triad<T> accel;
  Mat3<T> g_sensitivity = Mat3<T>::Zero();
  ThermalErrors<T> thermal;
  Mat3<T> accel_place = Mat3<T>::Zero();  ///< d_x d_y d_z, a column each [m]; d_x is zero: x is the sensing point

  /// The unit as it is at @p temperature [degC], without terms of temperature, eq. (3).
  [[nodiscard]] InertialUnit at(const T& temperature) const {
    InertialUnit unit = *this;
    unit.thermal = {};
    const InertialSample<T> bias_change = thermal.at(temperature, thermal.bias);
    const InertialSample<T> scale_change = thermal.at(temperature, thermal.scale);
    unit.gyro.bias += bias_change.w;
    unit.accel.bias += bias_change.f;
    unit.gyro.M.diagonal() += scale_change.w;
    unit.accel.M.diagonal() += scale_change.f;
    return unit;
  }

  /// e of eq. (6) for the angular rate @p w [rad/s] and acceleration @p w_dot [rad/s^2]: what distort() leaves out.
  [[nodiscard]] Vec3<T> size_effect(const Vec3<T>& w, const Vec3<T>& w_dot) const {
    Vec3<T> e;
    for (int i = 0; i < 3; ++i) {
      const Vec3<T> d = accel_place.col(i);
      e(i) = accel.matrix().row(i).dot(w_dot.cross(d) + w.cross(w.cross(d)));
    }
    return e;
  }

  /// What the unit reads for the true input at T_0, eq. (1) and (2), without the size effect.
  [[nodiscard]] InertialSample<T> distort(const InertialSample<T>& input) const {
    return {gyro.distort(input.w) + g_sensitivity * input.f, accel.distort(input.f)};
  }
  /// The same at @p temperature [degC].
  [[nodiscard]] InertialSample<T> distort(const InertialSample<T>& input, const T& temperature) const {
    return at(temperature).distort(input);
  }
};

/// What a raw count means: reading = (count - zero) / scale.
template <class T>
struct NominalScale {
  T scale = T(1);  ///< counts per SI unit; not zero
  T zero = T(0);   ///< counts at zero input
};

/// Of both triads. The default is a unit that reads in SI.
template <class T>
struct UnitScale {
  NominalScale<T> gyro;
  NominalScale<T> accel;
};

/// Undoes an InertialUnit: readings in SI, or raw counts. Inverses, scales and biases are folded, so that a sample
/// costs no division, and of a linear unit no more than two matrices and the g-sensitivity:
///
///   f = A_a y_a + c_a(T) - A_a' n_a(f),   w = A_g y_g + c_g(T) - H f - A_g' n_g(w)       ... (5)
///
/// A' = (I + M)^-1, A = A' / scale, c = -A' b - A zero, H = A_g' G, n: the nonlinearity, by Triad's two steps. Of the
/// terms of temperature it takes b_1 and b_2; ThermalCorrection takes all. The size effect is not its affair.
template <class T>
class UnitCorrection {
 public:
  struct Axes {
    kernel::Matrix<T> A;
    kernel::Triple<T> c, c_1, c_2;  // over temperature
  };
  /// Of one triad's nonlinearity.
  struct Bend {
    kernel::Matrix<T> A;
    kernel::Triple<T> half_asymmetry, quadratic, cubic;
  };
  /// Plain numbers, as a flash block or a generated header holds them.
  struct Coefficients {
    Axes accel, gyro;
    kernel::Matrix<T> H;
    Bend accel_bend, gyro_bend;
    T reference;  // T_0
    T is_linear;  // 1: both bends are zero
  };

  constexpr explicit UnitCorrection(const Coefficients& coefficients) : k_(coefficients) {}

  /// @p unit, and what its counts mean, in a scalar as wide as T or wider: folded there, then rounded once.
  template <class U>
  explicit UnitCorrection(const InertialUnit<U>& unit, const UnitScale<U>& counts = UnitScale<U>()) {
    const Mat3<U> accel = unit.accel.matrix().inverse();
    const Mat3<U> gyro = unit.gyro.matrix().inverse();
    k_.accel = axes<U>(accel, unit.accel.bias, unit.thermal.bias[0].f, unit.thermal.bias[1].f, counts.accel);
    k_.gyro = axes<U>(gyro, unit.gyro.bias, unit.thermal.bias[0].w, unit.thermal.bias[1].w, counts.gyro);
    k_.H = kernel::matrix<T>((gyro * unit.g_sensitivity).template cast<T>());
    k_.accel_bend = bend<U>(accel, unit.accel);
    k_.gyro_bend = bend<U>(gyro, unit.gyro);
    k_.reference = static_cast<T>(unit.thermal.reference);
    k_.is_linear = unit.accel.is_linear() && unit.gyro.is_linear() ? T(1) : T(0);
  }

  [[nodiscard]] constexpr const Coefficients& coefficients() const { return k_; }

  /// The true input for a reading at T_0, eq. (5).
  [[nodiscard]] InertialSample<T> correct(const InertialSample<T>& reading) const {
    return corrected(reading, k_.accel.c, k_.gyro.c);
  }
  /// The same at @p temperature [degC].
  [[nodiscard]] InertialSample<T> correct(const InertialSample<T>& reading, const T& temperature) const {
    const T t = temperature - k_.reference;
    return corrected(reading, k_.accel.c + t * (k_.accel.c_1 + t * k_.accel.c_2),
                     k_.gyro.c + t * (k_.gyro.c_1 + t * k_.gyro.c_2));
  }
  /// For readings that may be damaged. @return kOutOfRange when one is not finite, or so large that a sum is not
  [[nodiscard]] Result<InertialSample<T>> checked(const InertialSample<T>& reading) const {
    return finite(correct(reading));
  }
  [[nodiscard]] Result<InertialSample<T>> checked(const InertialSample<T>& reading, const T& temperature) const {
    return finite(correct(reading, temperature));
  }

 private:
  using Triple = kernel::Triple<T>;

  static Result<InertialSample<T>> finite(const InertialSample<T>& input) {
    if (!kernel::is_finite(kernel::triple(input.w)) || !kernel::is_finite(kernel::triple(input.f)))
      return Status::kOutOfRange;
    return input;
  }

  template <class U>
  static Axes axes(const Mat3<U>& A, const Vec3<U>& bias, const Vec3<U>& linear, const Vec3<U>& quadratic,
                   const NominalScale<U>& counts) {
    const auto folded = [&A](const Vec3<U>& b) { return kernel::triple<T>((A * (-b)).template cast<T>()); };
    return {kernel::matrix<T>((A / counts.scale).template cast<T>()),
            folded(bias + Vec3<U>::Constant(counts.zero / counts.scale)), folded(linear), folded(quadratic)};
  }
  template <class U>
  static Bend bend(const Mat3<U>& A, const Triad<U>& triad) {
    return {kernel::matrix<T>(A.template cast<T>()), kernel::triple<T>((U(0.5) * triad.asymmetry).template cast<T>()),
            kernel::triple<T>(triad.quadratic.template cast<T>()), kernel::triple<T>(triad.cubic.template cast<T>())};
  }

  TRUNNION_INLINE InertialSample<T> corrected(const InertialSample<T>& reading, const Triple& c_a,
                                              const Triple& c_g) const {
    const Triple f_linear = c_a + k_.accel.A * kernel::triple(reading.f);
    const Triple w_linear = c_g + k_.gyro.A * kernel::triple(reading.w);
    if (k_.is_linear == T(1)) return {kernel::vector(w_linear - k_.H * f_linear), kernel::vector(f_linear)};
    const Triple f = straightened(f_linear, k_.accel_bend);
    return {kernel::vector(straightened(w_linear - k_.H * f, k_.gyro_bend)), kernel::vector(f)};
  }
  static Triple straightened(const Triple& linear, const Bend& bend) {
    Triple u = linear;
    for (int step = 0; step < Triad<T>::kCorrectionSteps; ++step) {
      const auto n_of = [](const T& x, const T& half_asymmetry, const T& quadratic, const T& cubic) {
        return (x < T(0) ? -x : x) * half_asymmetry + x * x * (quadratic + cubic * x);
      };
      const Triple n = {n_of(u.x, bend.half_asymmetry.x, bend.quadratic.x, bend.cubic.x),
                        n_of(u.y, bend.half_asymmetry.y, bend.quadratic.y, bend.cubic.y),
                        n_of(u.z, bend.half_asymmetry.z, bend.quadratic.z, bend.cubic.z)};
      u = linear - bend.A * n;
    }
    return u;
  }

  Coefficients k_;
};

}  // namespace trunnion
