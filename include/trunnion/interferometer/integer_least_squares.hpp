// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Integer least squares: LAMBDA. Which whole numbers fit real ones of covariance Q best, and what else they must fit.
///
///   Q = L^T D L,   z = Z^T a,   a = Z^-T z,   det Z = +-1, Z of whole numbers that make L and D even     ... (1)
///   E(a) = (a_float - a)^T Q^-1 (a_float - a) = sum_k (z_k - zeta_k)^2 / D_k                             ... (2)
///   zeta_k = z_float,k + sum_{i > k} (z_i - zeta_i) L_ik
///   P(bootstrapped) = prod_k erf(1 / sqrt(8 D_k))                                                        ... (3)
///   minimise F(a) = E(a) + H(a),  H >= 0                                                                 ... (4)
///
/// H is whatever else is known of the answer: a baseline's length. As H is never negative, the search of (2) may leave
/// out what lies beyond the best F so far, and is exact. It walks each z_k outwards from zeta_k in zigzag.
///
/// Teunissen, J. Geodesy 70 (1995), 65; de Jonge & Tiberius, LGR 12 (1996); Chang, Yang, Zhou, J. Geodesy 79 (2005),
/// 552, whose order of reduction and search this is; Schnorr & Euchner, Math. Programming 66 (1994), 181. A covariance
/// of 1e14 between its largest and smallest number is double's limit, 1e5 float's.

#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>

#include "trunnion/core/status.hpp"

namespace trunnion {

/// As many numbers as there happen to be, N at most; never from the heap.
template <class T, int N>
using BoundedVector = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, N, 1>;
template <class T, int N>
using BoundedMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, N, N>;

/// Eq. (1). @tparam N most numbers
template <class T, int N>
class Decorrelation {
 public:
  /// @param Q covariance, symmetric; only its lower half is read
  explicit Decorrelation(const BoundedMatrix<T, N>& Q) : L_(Q), D_(Q.rows()) {
    if (factor()) reduce();
  }

  /// Of Q + U U^T, Q well conditioned and U large: phases, and the codes' vector in them. The factors of Q are updated
  /// column by column, which loses no digits where factoring the sum would lose all of float's (Gill, Golub, Murray &
  /// Saunders, Math. Comp. 28 (1974), 505, method C1).
  template <int Columns>
  Decorrelation(const BoundedMatrix<T, N>& Q, const Eigen::Matrix<T, Eigen::Dynamic, Columns, 0, N, Columns>& U)
      : L_(Q), D_(Q.rows()) {
    if (!factor()) return;
    for (int column = 0; column < Columns; ++column) {
      BoundedVector<T, N> u = U.col(column);
      T weight = T(1);
      for (int i = size() - 1; i >= 0; --i) {
        const T p = u(i);
        const T d = D_(i) + weight * p * p;
        const T share = weight * p / d;
        weight *= D_(i) / d;
        D_(i) = d;
        for (int r = 0; r < i; ++r) {
          u(r) -= p * L_(i, r);
          L_(i, r) += share * u(r);
        }
      }
    }
    if (!L_.allFinite() || !D_.allFinite())
      status_ = Status::kOutOfRange;
    else
      reduce();
  }

  /// kOk; kOutOfRange where Q is not positive definite, or not finite.
  [[nodiscard]] Status status() const { return status_; }
  [[nodiscard]] int size() const { return static_cast<int>(D_.size()); }
  [[nodiscard]] const BoundedMatrix<T, N>& lower() const { return L_; }
  /// Conditional variances, eq. (2).
  [[nodiscard]] const BoundedVector<T, N>& variances() const { return D_; }
  /// Z^-T: whole numbers.
  [[nodiscard]] const BoundedMatrix<T, N>& back() const { return A_; }
  /// Z^T a, by the whole numbers of Z^-T: exact for whole a that fit the mantissa.
  [[nodiscard]] const BoundedMatrix<T, N>& forth() const { return Zt_; }

  /// Eq. (3).
  [[nodiscard]] T bootstrapped_success() const {
    using std::erf;
    using std::sqrt;
    T product = T(1);
    for (int k = 0; k < size(); ++k) product *= erf(T(1) / sqrt(T(8) * D_(k)));
    return product;
  }

 private:
  /// L_ holds Q, then its factor.
  bool factor() {
    const int n = size();
    for (int i = n - 1; i >= 0; --i) {
      D_(i) = L_(i, i);
      // a variance that rounding has eaten is none
      if (!(D_(i) > T(0)) || !(D_(i) <= std::numeric_limits<T>::max())) {
        status_ = Status::kOutOfRange;
        return false;
      }
      for (int j = 0; j <= i; ++j) L_(i, j) /= D_(i);
      for (int j = 0; j < i; ++j) {
        for (int k = 0; k <= j; ++k) L_(j, k) -= D_(i) * L_(i, j) * L_(i, k);
      }
      for (int j = i + 1; j < n; ++j) L_(i, j) = T(0);
    }
    return true;
  }

  void reduce() {
    const int n = size();
    A_.setIdentity(n, n);
    Zt_.setIdentity(n, n);
    int k = n - 2;
    int untouched = n - 2;
    while (k >= 0) {
      if (k <= untouched) {
        for (int i = k + 1; i < n; ++i) subtract(i, k);
      }
      const T swapped = D_(k) + L_(k + 1, k) * L_(k + 1, k) * D_(k + 1);
      // the margin ends the rounds that rounding could keep up for ever
      if (swapped < D_(k + 1) * (T(1) - T(64) * std::numeric_limits<T>::epsilon())) {
        exchange(k, swapped);
        untouched = k;
        k = n - 2;
      } else {
        --k;
      }
    }
  }

  /// Column j less a whole multiple of column i, which leaves |L_ij| <= 1/2.
  void subtract(int i, int j) {
    using std::round;
    const T mu = round(L_(i, j));
    if (mu == T(0)) return;
    const int n = size();
    for (int r = i; r < n; ++r) L_(r, j) -= mu * L_(r, i);
    Zt_.row(j) -= mu * Zt_.row(i);
    A_.col(i) += mu * A_.col(j);
  }

  /// Numbers k and k + 1 change places, after which D_(k + 1) is @p swapped.
  void exchange(int k, const T& swapped) {
    const T eta = D_(k) / swapped;
    const T lambda = D_(k + 1) * L_(k + 1, k) / swapped;
    D_(k) = eta * D_(k + 1);
    D_(k + 1) = swapped;
    for (int j = 0; j < k; ++j) {
      const T upper = L_(k, j);
      const T lower = L_(k + 1, j);
      L_(k, j) = lower - L_(k + 1, k) * upper;
      L_(k + 1, j) = eta * upper + lambda * lower;
    }
    L_(k + 1, k) = lambda;
    for (int i = k + 2; i < size(); ++i) std::swap(L_(i, k), L_(i, k + 1));
    Zt_.row(k).swap(Zt_.row(k + 1));
    A_.col(k).swap(A_.col(k + 1));
  }

  BoundedMatrix<T, N> L_;
  BoundedVector<T, N> D_;
  BoundedMatrix<T, N> A_;
  BoundedMatrix<T, N> Zt_;
  Status status_ = Status::kOk;
};

template <class T, int N>
struct IntegerCandidate {
  BoundedVector<T, N> z;  ///< decorrelated, less the whole numbers nearest to the float ones
  T cost = T(0);          ///< F, eq. (4)
};

/// The best K, in the order of their cost.
template <class T, int N, int K>
struct IntegerCandidates {
  std::array<IntegerCandidate<T, N>, static_cast<std::size_t>(K)> at;
  int count = 0;
  long nodes = 0;        ///< of the tree, looked at
  bool complete = true;  ///< false: the limit of nodes ended the search, and a better one may be left
};

struct SearchLimits {
  long nodes = 100000;
};

/// Eq. (4) over all z with F <= @p radius, of these the best K, and none that is worse than the best by more than
/// @p gap.
///
/// @param z_float less whole numbers: around zero
/// @param H called with z, after E(z) has been found small enough; what it returns is never negative
template <int K, class T, int N, class Further>
void integer_search(const Decorrelation<T, N>& of, const BoundedVector<T, N>& z_float, T radius, const T& gap,
                    const SearchLimits& limits, const Further& H, IntegerCandidates<T, N, K>& found) {
  using std::round;
  const int n = of.size();
  const auto& L = of.lower();
  const auto& D = of.variances();
  found.count = 0;
  BoundedVector<T, N> z(n);
  BoundedVector<T, N> zeta(n);
  BoundedVector<T, N> step(n);
  BoundedVector<T, N> before(n);  // E of the numbers above
  const auto centre = [&](int k) {
    T sum = z_float(k);
    for (int i = k + 1; i < n; ++i) sum += (z(i) - zeta(i)) * L(i, k);
    zeta(k) = sum;
    z(k) = round(sum);
    step(k) = z(k) <= sum ? T(1) : T(-1);
  };
  const auto next = [&](int k) {  // outwards, the nearer side first
    z(k) += step(k);
    step(k) = step(k) > T(0) ? -step(k) - T(1) : -step(k) + T(1);
  };
  int k = n - 1;
  before(k) = T(0);
  centre(k);
  for (;;) {
    if (++found.nodes > limits.nodes) {
      found.complete = false;
      return;
    }
    const T off = z(k) - zeta(k);
    const T E = before(k) + off * off / D(k);
    if (!(E <= radius)) {
      if (++k == n) return;
      next(k);
      continue;
    }
    if (k > 0) {
      before(--k) = E;
      centre(k);
      continue;
    }
    const T F = E + H(z);
    if (F <= radius) {
      int place = found.count < K ? found.count++ : K - 1;
      for (; place > 0 && found.at[static_cast<std::size_t>(place - 1)].cost > F; --place)
        found.at[static_cast<std::size_t>(place)] = found.at[static_cast<std::size_t>(place - 1)];
      found.at[static_cast<std::size_t>(place)] = {z, F};
      if (found.count == K && found.at[K - 1].cost < radius) radius = found.at[K - 1].cost;
      if (found.at[0].cost + gap < radius) radius = found.at[0].cost + gap;
      while (found.count > 1 && found.at[static_cast<std::size_t>(found.count - 1)].cost > radius) --found.count;
    }
    next(0);
  }
}

/// What lambda() finds: the two best vectors of whole numbers and E of each.
template <class T, int N>
struct IntegerFix {
  BoundedVector<T, N> best;
  BoundedVector<T, N> second;
  T best_norm = T(0);
  T second_norm = T(0);
  T bootstrapped_success = T(0);
};

/// Plain integer least squares, H = 0.
///
/// @param a_float real numbers; @param Q their covariance
/// @return kOutOfRange for numbers that are not finite or too large to be told from their neighbours, a Q that is not
/// positive definite, or no numbers; kTimeOut when the limit of nodes ended the search
template <class T, int N>
Result<IntegerFix<T, N>> lambda(const BoundedVector<T, N>& a_float, const BoundedMatrix<T, N>& Q,
                                const SearchLimits& limits = {}) {
  using std::abs;
  using std::round;
  if (a_float.size() == 0 || Q.rows() != a_float.size() || Q.cols() != a_float.size()) return Status::kOutOfRange;
  const T largest = T(0.25) / std::numeric_limits<T>::epsilon();
  for (int i = 0; i < a_float.size(); ++i) {
    if (!(abs(a_float(i)) < largest)) return Status::kOutOfRange;
  }
  const Decorrelation<T, N> of(Q);
  if (of.status() != Status::kOk) return of.status();
  const BoundedVector<T, N> whole = a_float.array().round();
  const BoundedVector<T, N> z_float = of.forth() * (a_float - whole);
  IntegerCandidates<T, N, 2> found;
  integer_search(
      of, z_float, std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), limits,
      [](const BoundedVector<T, N>&) { return T(0); }, found);
  if (!found.complete) return Status::kTimeOut;
  if (found.count < 2) return Status::kOutOfRange;  // variances so small that nothing is finite
  IntegerFix<T, N> fix;
  fix.best = whole + of.back() * found.at[0].z;
  fix.second = whole + of.back() * found.at[1].z;
  fix.best_norm = found.at[0].cost;
  fix.second_norm = found.at[1].cost;
  fix.bootstrapped_success = of.bootstrapped_success();
  return fix;
}

}  // namespace trunnion
