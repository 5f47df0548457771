// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Coning and sculling: from the increments of one update to the motion of the case.
///
/// With theta = sum theta_i, v = sum v_i over the samples 1..N of an update, and eta = phi / |phi|:
///
///   phi = theta + sum_i k_i theta_i x theta_N                                                    ... (1)  coning
///   dv  = v + (1 - cos|phi|)/|phi|^2 phi x v + (|phi| - sin|phi|)/|phi|^3 phi x (phi x v)
///         + sum_i k_i (theta_i x v_N + v_i x theta_N)                                            ... (2)  sculling
///
/// | algorithm      | k_i                              | coning drift, cone a, rate W, sample h: a^2 W times |
/// |----------------|----------------------------------|-----------------------------------------------------|
/// | PreviousSample | 1/12, with the sample before     | (W h)^4 / 60                                        |
/// | MultiSample<2> | 2/3                              | (W h)^4 / 60                                        |
/// | MultiSample<3> | 9/20, 27/20                      | (W h)^6 / 280                                       |
/// | MultiSample<4> | 54/105, 92/105, 214/105          | (W h)^8 / 1260                                      |
///
/// Miller, J. Guidance 6 (1983), 287; Ignagni, J. Guidance 19 (1996), 424; Savage, J. Guidance 21 (1998), 19 and 208.
/// The second term of (2) in full, not 1/2 phi x v: what the half leaves along gravity, g |phi|^2 / 6, outgrows all
/// else. (1) drops the third term of the Bortz equation, of order a^3. ExactSamples drops nothing:
///
///   w(t), f(t) = the polynomials of degree N - 1 whose integrals over the samples are the increments   ... (3)
///   q' = 1/2 q w,  y' = f - w x y  from the middle of the update, by their power series                ... (4)
///   dv = C_start_end y(end) - y(start)                                                                 ... (5)
///
/// The series is as long as the angle asks for: it stops where a bound on its terms passes the scalar's rounding. This
/// is the limit of the functional iterations of Wu, arXiv:1905.11615.

#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "trunnion/core/linear.hpp"
#include "trunnion/core/triple.hpp"
#include "trunnion/strapdown/increment.hpp"

namespace trunnion {

namespace kernel {

/// Of a rotation vector: quaternion (minus identity) and the two factors of eq. (2).
template <class T>
struct RotationFactors {
  T w;       // cos(t/2) - 1
  T v;       // sin(t/2) / t
  T first;   // (1 - cos t) / t^2
  T second;  // (t - sin t) / t^3

  /// Up to half a radian, with what float can tell: what is left out is below 6e-8 of the rotation, and below 1e-15 of
  /// one of 20 mrad.
  static TRUNNION_INLINE RotationFactors short_series(const T& t2) {
    RotationFactors short_one;
    const T x2 = T(0.25) * t2;
    short_one.w = x2 * (T(-0.5) + x2 * (T(1.0 / 24.0) - x2 * T(1.0 / 720.0)));
    short_one.v = T(0.5) - x2 * (T(1.0 / 12.0) - x2 * T(1.0 / 240.0));
    short_one.first = T(2) * short_one.v * short_one.v;
    short_one.second = T(1.0 / 6.0) - t2 * (T(1.0 / 120.0) - t2 * T(1.0 / 5040.0));
    return short_one;
  }

  explicit RotationFactors(const T& t2) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    if (t2 < T(0.02)) {  // what the series leave out is below 1e-16 of the rotation
      const T x2 = T(0.25) * t2;
      w = T(-0.5) * x2 * (T(1) - x2 * (T(1.0 / 12.0) - x2 * (T(1.0 / 360.0) - x2 * T(1.0 / 20160.0))));
      v = T(0.5) - x2 * (T(1.0 / 12.0) - x2 * (T(1.0 / 240.0) - x2 * (T(1.0 / 10080.0) - x2 * T(1.0 / 725760.0))));
      second = T(1.0 / 6.0) - t2 * (T(1.0 / 120.0) - t2 * (T(1.0 / 5040.0) - t2 * T(1.0 / 362880.0)));
    } else {
      const T t = sqrt(t2);
      w = cos(t / T(2)) - T(1);
      v = sin(t / T(2)) / t;
      second = (t - sin(t)) / (t2 * t);
    }
    first = T(2) * v * v;
  }

 private:
  RotationFactors() = default;
};

/// Eq. (1), (2) once phi and the sculling sum are known.
template <class T>
inline BodyMotion<T> body_motion(const Triple<T>& phi, const Triple<T>& v, const Triple<T>& sculling) {
  const RotationFactors<T> factor(dot(phi, phi));
  const Triple<T> turned = cross(phi, v);
  return {factor.w, vector(factor.v * phi),
          vector(v + (factor.first * turned + factor.second * cross(phi, turned) + sculling))};
}

/// Eq. (3) over tau in [-1, 1]: even and odd coefficients apart, from sums and differences of mirrored samples.
template <std::size_t N>
struct PolynomialFit {
  static constexpr std::size_t kEven = (N + 1) / 2;
  static constexpr std::size_t kOdd = N / 2;
  template <std::size_t M>
  using Square = std::array<std::array<double, M>, M>;
  Square<kEven> even;  // rows w_0, w_2, ...; columns theta_i + theta_(N-1-i)
  Square<kOdd> odd;    // rows w_1, w_3, ...; columns theta_i - theta_(N-1-i)

  constexpr PolynomialFit() : even(inverse<kEven>(0)), odd(inverse<kOdd>(1)) {}

 private:
  static constexpr double power(double x, std::size_t n) {
    double p = 1.0;
    for (std::size_t i = 0; i < n; ++i) p *= x;
    return p;
  }
  static constexpr double magnitude(double x) { return x < 0.0 ? -x : x; }

  /// Gauss-Jordan of: pair i = sum over k of w_(2k + parity) times twice the integral of tau^(2k + parity) over i.
  template <std::size_t M>
  static constexpr Square<M> inverse(std::size_t parity) {
    Square<M> a{};
    Square<M> inverse{};
    for (std::size_t i = 0; i < M; ++i) {
      const double from = 2.0 * static_cast<double>(i) / static_cast<double>(N) - 1.0;
      const double to = 2.0 * static_cast<double>(i + 1) / static_cast<double>(N) - 1.0;
      const double samples = N % 2 == 1 && i == kOdd ? 1.0 : 2.0;  // the middle one is its own mirror
      for (std::size_t k = 0; k < M; ++k) {
        const std::size_t n = 2 * k + parity + 1;
        a[i][k] = samples * (power(to, n) - power(from, n)) / static_cast<double>(n);
      }
      inverse[i][i] = 1.0;
    }
    for (std::size_t c = 0; c < M; ++c) {
      std::size_t pivot = c;
      for (std::size_t r = c + 1; r < M; ++r) {
        if (magnitude(a[r][c]) > magnitude(a[pivot][c])) pivot = r;
      }
      for (std::size_t k = 0; k < M; ++k) {
        const double of_a = a[c][k];
        a[c][k] = a[pivot][k];
        a[pivot][k] = of_a;
        const double of_inverse = inverse[c][k];
        inverse[c][k] = inverse[pivot][k];
        inverse[pivot][k] = of_inverse;
      }
      const double scale = 1.0 / a[c][c];
      for (std::size_t k = 0; k < M; ++k) {
        a[c][k] *= scale;
        inverse[c][k] *= scale;
      }
      for (std::size_t r = 0; r < M; ++r) {
        const double share = a[r][c];
        for (std::size_t k = 0; r != c && k < M; ++k) {
          a[r][k] -= share * a[c][k];
          inverse[r][k] -= share * inverse[c][k];
        }
      }
    }
    return inverse;
  }
};

}  // namespace kernel

/// One sample an update, corrected with the one before: output at the full rate.
template <class T>
class PreviousSample {
 public:
  using Scalar = T;
  static constexpr int kSamples = 1;

  BodyMotion<T> operator()(const std::array<Increment<T>, 1>& sample) {
    using namespace kernel;
    constexpr double kTwelfth = 1.0 / 12.0;
    const Triple<T> theta = triple(sample[0].angle);
    const Triple<T> v = triple(sample[0].velocity);
    const Triple<T> theta_before = T(kTwelfth) * triple(previous_.angle);
    const Triple<T> v_before = T(kTwelfth) * triple(previous_.velocity);
    previous_ = sample[0];
    return body_motion(theta + cross(theta_before, theta), v, cross(theta_before, v) + cross(v_before, theta));
  }

 private:
  Increment<T> previous_;
};

/// N = 1 (no correction), 2, 3 or 4 samples an update, tuned to pure coning. Of smooth motion ExactSamples makes more.
template <class T, int N>
class MultiSample {
  static_assert(N >= 1 && N <= 4, "Miller's coefficients are here for one to four samples");

 public:
  using Scalar = T;
  static constexpr int kSamples = N;

  BodyMotion<T> operator()(const std::array<Increment<T>, static_cast<std::size_t>(N)>& sample) {
    constexpr std::array<std::array<double, 3>, 4> kFactors = {
        {{}, {2.0 / 3.0}, {9.0 / 20.0, 27.0 / 20.0}, {54.0 / 105.0, 92.0 / 105.0, 214.0 / 105.0}}};
    constexpr std::array<double, 3> kFactor = kFactors[static_cast<std::size_t>(N - 1)];
    using namespace kernel;
    const Triple<T> last_theta = triple(sample.back().angle);
    const Triple<T> last_v = triple(sample.back().velocity);
    Triple<T> theta = last_theta;
    Triple<T> v = last_v;
    Triple<T> theta_k{T(0), T(0), T(0)};
    Triple<T> v_k = theta_k;
    for (std::size_t i = 0; i + 1 < sample.size(); ++i) {
      theta = theta + triple(sample[i].angle);
      v = v + triple(sample[i].velocity);
      theta_k = theta_k + T(kFactor[i]) * triple(sample[i].angle);
      v_k = v_k + T(kFactor[i]) * triple(sample[i].velocity);
    }
    return body_motion(theta + cross(theta_k, last_theta), v, cross(theta_k, last_v) + cross(v_k, last_theta));
  }
};

/// N samples an update as polynomials, integrated to the scalar's rounding, eq. (3)-(5).
template <class T, int N>
class ExactSamples {
  static_assert(N >= 2 && N <= 8,
                "of one sample MultiSample is exact; a polynomial through more samples amplifies their noise");
  static constexpr auto kCount = static_cast<std::size_t>(N);

 public:
  using Scalar = T;
  static constexpr int kSamples = N;
  static constexpr std::size_t kMostTerms = 40;  ///< enough for eight radians an update

  BodyMotion<T> operator()(const std::array<Increment<T>, kCount>& sample) {
    using namespace kernel;
    std::array<Triple, kCount> w;
    std::array<Triple, kCount> f;
    fit(sample, w, f);
    std::array<T, kCount> w_size;
    for (std::size_t j = 0; j < w.size(); ++j) w_size[j] = size(w[j]);

    constexpr Triple kZero{T(0), T(0), T(0)};
    std::array<Quad<T>, kMostTerms + 1> q;
    std::array<Triple, kMostTerms + 1> y;
    std::array<T, kMostTerms + 1> bound;  // of the terms of exp(integral of |w|), which bound those of q and y
    q[0] = {T(1), kZero};
    y[0] = kZero;
    bound[0] = T(1);
    Quad<T> even{T(0), kZero};
    Quad<T> odd = even;
    Triple even_y = kZero;
    Triple odd_y = kZero;
    for (std::size_t k = 0; k < kMostTerms; ++k) {
      Quad<T> s{T(0), kZero};
      Triple s_y = k < f.size() ? f[k] : kZero;
      T s_b(0);
      for (std::size_t j = 0; j < w.size() && j <= k; ++j) {
        const Triple wj = w[j];
        const Quad<T> a = q[k - j];
        s.w -= dot(a.v, wj);
        s.v = s.v + a.w * wj + cross(a.v, wj);
        s_y = s_y + cross(y[k - j], wj);
        s_b += w_size[j] * bound[k - j];
      }
      const T share = T(1) / T(k + 1);
      q[k + 1] = (T(0.5) * share) * s;
      y[k + 1] = share * s_y;
      bound[k + 1] = share * s_b;
      if (k % 2 == 0) {
        odd = odd + q[k + 1];
        odd_y = odd_y + y[k + 1];
      } else {
        even = even + q[k + 1];
        even_y = even_y + y[k + 1];
      }
      if (k + 1 >= w.size() && bound[k + 1] < std::numeric_limits<T>::epsilon() / T(8)) break;
    }
    // q(-1)^* q(1) with q(+-1) = 1 + even +- odd
    const Quad<T> end = even + odd;
    const Quad<T> start{even.w - odd.w, odd.v - even.v};  // conjugate
    Quad<T> turn = product(start, end);
    turn.w += T(2) * even.w;
    turn.v = turn.v + T(2) * odd.v;
    const Triple y_end = even_y + odd_y;
    const Triple turned = T(2) * cross(turn.v, y_end);
    return {turn.w, vector(turn.v), vector(T(2) * odd_y + ((T(1) + turn.w) * turned + cross(turn.v, turned)))};
  }

 private:
  using Triple = kernel::Triple<T>;

  static T size(const Triple& a) {
    using std::abs;
    return abs(a.x) + abs(a.y) + abs(a.z);
  }

  static void fit(const std::array<Increment<T>, kCount>& sample, std::array<Triple, kCount>& w,
                  std::array<Triple, kCount>& f) {
    using kernel::triple;
    static constexpr kernel::PolynomialFit<kCount> kFit;
    constexpr std::size_t kHalf = kCount / 2;
    constexpr std::size_t kEven = (kCount + 1) / 2;
    for (std::size_t k = 0; k < w.size(); ++k) w[k] = f[k] = {T(0), T(0), T(0)};
    for (std::size_t i = 0; i < kEven; ++i) {
      const bool middle = i >= kHalf;  // its own mirror
      const Triple theta = triple(sample[i].angle);
      const Triple v = triple(sample[i].velocity);
      const Triple theta_mirror = middle ? Triple{T(0), T(0), T(0)} : triple(sample[kCount - 1 - i].angle);
      const Triple v_mirror = middle ? Triple{T(0), T(0), T(0)} : triple(sample[kCount - 1 - i].velocity);
      for (std::size_t k = 0; k < kEven; ++k) {
        w[2 * k] = w[2 * k] + T(kFit.even[k][i]) * (theta + theta_mirror);
        f[2 * k] = f[2 * k] + T(kFit.even[k][i]) * (v + v_mirror);
      }
      for (std::size_t k = 0; k < kHalf && !middle; ++k) {
        w[2 * k + 1] = w[2 * k + 1] + T(kFit.odd[k][i]) * (theta - theta_mirror);
        f[2 * k + 1] = f[2 * k + 1] + T(kFit.odd[k][i]) * (v - v_mirror);
      }
    }
  }
};

}  // namespace trunnion
