// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The vector between two antennas from one epoch: codes, whole cycles, and the length that a ruler has measured.
///
///   b_float = N_c^-1 sum w (e - e_g) ...,   of the codes, and of a prior where there is one               ... (1)
///   a_float = DD_phi + (e^i - e^r) . b_float / lambda,   Q_a = (Q_phi + G Q_b G^T) / (lambda lambda^T)     ... (2)
///   b(a) = b_float - Q_b G^T / lambda Q_a^-1 (a_float - a)                                                ... (3)
///   F(a) = E(a) + H(b(a)),   H = (|b| - L)^2 / (s_L^2 + u^T Q_b(a) u),   u = b / |b|                      ... (4)
///   accepted: F_1 < chi^2(n + 1) and F_2 - F_1 > gap max(1, F_1 / (n + 1))                                ... (5)
///
/// E is that of integer_least_squares.hpp. The length is an observation: it bends no codes, and 10 mm off it costs four
/// in F where s_L is 5 mm, not the fix. (5): the whole fit, against n + 1 degrees of freedom, and e^(-gap/2) for the
/// odds of the second candidate, in noise as large as that of the fit. The ratio of E_2 to E_1 is not
/// used: with few satellites wrong fixes pass it. Teunissen, J. Geodesy 84
/// (2010), 413 (C-LAMBDA).

#pragma once

#include "trunnion/core/chi_square.hpp"
#include "trunnion/interferometer/double_difference.hpp"

namespace trunnion {

/// What is known beforehand of |b|.
template <class T>
struct KnownLength {
  T length = T(0);     ///< m; 0: nothing
  T sigma = T(0.005);  ///< m; 5 to 10 mm, or what the ruler is worth
};

template <class T>
struct FixOptions {
  T gap = T(16);                 ///< eq. (5)
  T misfit = T(kOneInThousand);  ///< normal quantile of the chi^2 of eq. (5)
  SearchLimits limits;
  bool exclude = true;  ///< whether one satellite may be left out where all do not fit
};

/// Eq. (1)-(3), all but the search.
template <class T, int N>
class FloatBaseline {
 public:
  /// @param prior of b, where there is one: a filter's. Without: only the codes
  explicit FloatBaseline(const SingleDifferences<T, N>& set, const VectorObservation<T, 1>* prior = nullptr)
      : pairs_(set), decorrelation_(BoundedMatrix<T, N>(0, 0)) {
    const int n = pairs_.count();
    for (int i = 0; i < set.count; ++i) {
      const SingleDifference<T>& s = set[i];
      using std::abs;
      const T largest = T(0.25) / std::numeric_limits<T>::epsilon();
      if (!s.e.allFinite() || !(s.wavelength > T(0)) || !(abs(s.code) < largest) || !(abs(s.phase) < largest) ||
          !(s.code_sigma > T(0)) || !(s.phase_sigma > T(0)) || s.group < 0 || s.group >= kGroups) {
        status_ = Status::kOutOfRange;
        return;
      }
    }
    if (n < 3) return;
    BaselineSum<T> codes;
    add_centred(
        set, [&](int i) { return set[i].code; }, [&](int i) { return T(2) * set[i].code_sigma * set[i].code_sigma; },
        codes);
    code_ = codes;
    if (prior != nullptr) {
      codes.information += prior->information;
      codes.moment += prior->information * prior->value;
    }
    const Eigen::SelfAdjointEigenSolver<Mat3<T>> parts(codes.information);
    if (!(parts.eigenvalues()(0) > T(100) * std::numeric_limits<T>::epsilon() * parts.eigenvalues()(2))) return;
    const Mat3<T> root = parts.eigenvectors() * parts.eigenvalues().cwiseInverse().cwiseSqrt().asDiagonal();
    Q_b_ = root * root.transpose();
    b_ = Q_b_ * codes.moment;
    Eigen::Matrix<T, Eigen::Dynamic, 3, 0, N, 3> G(n, 3);  // over lambda
    BoundedVector<T, N> a(n);
    BoundedMatrix<T, N> Q = pairs_.covariance([&](int i) { return set[i].phase_sigma; });
    for (int k = 0; k < n; ++k) {
      const SingleDifference<T>& s = set[pairs_.satellite(k)];
      const SingleDifference<T>& r = set[pairs_.reference(k)];
      G.row(k) = (s.e - r.e).transpose() / s.wavelength;
      a(k) = s.phase - r.phase + G.row(k) * b_;
      Q.row(k) /= s.wavelength;
      Q.col(k) /= s.wavelength;
    }
    whole_ = a.array().round();
    const Eigen::Matrix<T, Eigen::Dynamic, 3, 0, N, 3> U = G * root;  // U U^T = G Q_b G^T
    decorrelation_ = Decorrelation<T, N>(Q, U);
    status_ = decorrelation_.status();
    if (status_ != Status::kOk) return;
    z_ = decorrelation_.forth() * (a - whole_);
    // Q_b G^T Z (L^T D L)^-1
    sensitivity_ = Q_b_ * G.transpose() * decorrelation_.forth().transpose();
    const auto& L = decorrelation_.lower();
    for (int k = n - 1; k >= 0; --k) {  // X L = S
      for (int i = k + 1; i < n; ++i) sensitivity_.col(k) -= L(i, k) * sensitivity_.col(i);
    }
    for (int k = 0; k < n; ++k) sensitivity_.col(k) /= decorrelation_.variances()(k);
    for (int k = 0; k < n; ++k) {  // Y L^T = X
      for (int i = 0; i < k; ++i) sensitivity_.col(k) -= L(k, i) * sensitivity_.col(i);
    }
    BaselineSum<T> all = codes;
    add_centred(
        set, [](int) { return T(0); }, [&](int i) { return T(2) * set[i].phase_sigma * set[i].phase_sigma; }, all);
    Q_fixed_ = all.information.inverse();
  }

  /// kNotObservable with fewer than three double differences, or a sky that leaves a direction open; kOutOfRange.
  [[nodiscard]] Status status() const { return status_; }
  [[nodiscard]] const DoubleDifferences<T, N>& pairs() const { return pairs_; }
  /// Eq. (1) and its covariance.
  [[nodiscard]] const Vec3<T>& b() const { return b_; }
  [[nodiscard]] const Mat3<T>& b_covariance() const { return Q_b_; }
  /// Of the codes alone.
  [[nodiscard]] const BaselineSum<T>& code() const { return code_; }
  [[nodiscard]] const Decorrelation<T, N>& decorrelation() const { return decorrelation_; }

  /// Eq. (3) of decorrelated candidates.
  [[nodiscard]] Vec3<T> b_of(const BoundedVector<T, N>& z) const { return b_ - sensitivity_ * (z_ - z); }

  /// H of eq. (4).
  [[nodiscard]] T off_length(const Vec3<T>& b, const KnownLength<T>& known) const {
    const T length = b.norm();
    if (!(length > T(0))) return known.length * known.length / (known.sigma * known.sigma + Q_fixed_.trace());
    const Vec3<T> u = b / length;
    const T off = length - known.length;
    return off * off / (known.sigma * known.sigma + u.dot(Q_fixed_ * u));
  }

  /// The best K of eq. (4) with F up to @p radius; none worse than the best by more than @p gap.
  template <int K>
  void search(const KnownLength<T>& known, const T& radius, const T& gap, const SearchLimits& limits,
              IntegerCandidates<T, N, K>& found) const {
    integer_search(
        decorrelation_, z_, radius, gap, limits,
        [&](const BoundedVector<T, N>& z) { return known.length > T(0) ? off_length(b_of(z), known) : T(0); }, found);
  }

  /// The whole numbers of the double differences.
  [[nodiscard]] BoundedVector<T, N> cycles(const BoundedVector<T, N>& z) const {
    return whole_ + decorrelation_.back() * z;
  }

 private:
  DoubleDifferences<T, N> pairs_;
  Decorrelation<T, N> decorrelation_;
  Status status_ = Status::kNotObservable;
  BaselineSum<T> code_;
  Vec3<T> b_ = Vec3<T>::Zero();
  Mat3<T> Q_b_ = Mat3<T>::Zero();
  Mat3<T> Q_fixed_ = Mat3<T>::Zero();
  BoundedVector<T, N> whole_;
  BoundedVector<T, N> z_;
  Eigen::Matrix<T, 3, Eigen::Dynamic, 0, 3, N> sensitivity_;
};

/// The baseline of an epoch, its whole cycles, and what speaks for them.
template <class T, int N>
struct BaselineFix {
  VectorObservation<T, 1> seen;  ///< b [m] of phases and codes, and its information; of a prior, none of it
  Vec3<T> float_b = Vec3<T>::Zero();
  Mat3<T> float_covariance = Mat3<T>::Zero();
  std::array<T, static_cast<std::size_t>(N)> cycles{};  ///< of each single difference; the references have 0
  T misfit = T(0);                                      ///< F_1 of eq. (4): chi-square with `degrees`
  int degrees = 0;
  T gap = T(0);  ///< F_2 - F_1; where there was no second within reach, what it is at least
  T bootstrapped_success = T(0);
  int satellites = 0;
  int excluded = -1;  ///< the satellite left out, by its index; -1: none
  long nodes = 0;
  bool accepted = false;  ///< eq. (5), and the search was complete
};

/// b of phases, less their cycles, and codes: sum (3) of double_difference.hpp.
template <class T, int N>
BaselineSum<T> fixed_sum(const SingleDifferences<T, N>& set, const std::array<T, static_cast<std::size_t>(N)>& cycles,
                         const BaselineSum<T>& code) {
  BaselineSum<T> sum = code;
  add_centred(
      set, [&](int i) { return set[i].wavelength * (set[i].phase - cycles[static_cast<std::size_t>(i)]); },
      [&](int i) { return T(2) * set[i].phase_sigma * set[i].phase_sigma; }, sum);
  return sum;
}

namespace kernel {

template <class T, int N>
Result<BaselineFix<T, N>> resolve_all(const SingleDifferences<T, N>& set, const KnownLength<T>& known,
                                      const FixOptions<T>& options, const VectorObservation<T, 1>* prior) {
  const FloatBaseline<T, N> real(set, prior);
  BaselineFix<T, N> fix;
  if (real.status() != Status::kOk) return real.status();
  fix.satellites = set.count;
  fix.float_b = real.b();
  fix.float_covariance = real.b_covariance();
  fix.degrees = real.pairs().count() + (known.length > T(0) ? 1 : 0);
  fix.bootstrapped_success = real.decorrelation().bootstrapped_success();
  const T degrees = T(fix.degrees);
  const T farthest = chi_square_quantile(degrees, options.misfit);
  IntegerCandidates<T, N, 2> found;
  // a small ellipsoid first: most of the time it holds the answer
  for (T radius = degrees; found.complete; radius *= T(3)) {
    const bool last = radius >= farthest;
    real.search(known, last ? farthest : radius, options.gap, options.limits, found);
    if (found.count > 0 || last) break;
  }
  fix.nodes = found.nodes;
  if (found.count == 0) return found.complete ? Status::kInconsistent : Status::kTimeOut;
  fix.misfit = found.at[0].cost;
  // how far the second must be, in noise as large as that of the fit
  const T asked = options.gap * (fix.misfit > degrees ? fix.misfit / degrees : T(1));
  if (found.complete) {
    const BoundedVector<T, N> best = found.at[0].z;
    real.search(known, fix.misfit + asked * T(1.001), asked * T(1.001), options.limits, found);
    fix.nodes = found.nodes;
    if (found.count == 0) {  // rounding: the best is at the rim
      found.count = 1;
      found.at[0] = {best, fix.misfit};
    }
  }
  fix.misfit = found.at[0].cost;
  fix.gap = found.count > 1 ? found.at[1].cost - fix.misfit : asked * T(1.001);
  fix.accepted = found.complete && fix.gap > asked;
  const BoundedVector<T, N> a = real.cycles(found.at[0].z);
  for (int k = 0; k < real.pairs().count(); ++k) fix.cycles[static_cast<std::size_t>(real.pairs().satellite(k))] = a(k);
  const BaselineSum<T> sum = fixed_sum(set, fix.cycles, real.code());
  fix.seen.information = sum.information;
  fix.seen.value = sum.information.ldlt().solve(sum.moment);
  return fix;
}

}  // namespace kernel

/// The baseline of greatest likelihood, eq. (1)-(5).
///
/// Where no whole numbers fit, or those that fit best do not fit well, there being seven satellites or more, each is
/// left out in turn: one with half a cycle bends the whole numbers of the others until they fit, in a way. A fit
/// without one costs kExclusion more, and the best of all must be ahead of every other answer. Where nothing fits but
/// what leaves the length out, the length is wrong, and no satellite is blamed for it.
/// @param prior of b, of a filter: a fix that leans on it is held, not found
/// @return kNotObservable with fewer than three double differences or a sky that leaves a direction open; kInconsistent
/// when nothing fits: a wrong length, half cycles, an antenna that is not where it should be; kTimeOut when the limit
/// of nodes came before any candidate; kOutOfRange. A fix that is not `accepted` is none to be used
template <class T, int N>
Result<BaselineFix<T, N>> resolve_baseline(const SingleDifferences<T, N>& set, const KnownLength<T>& known,
                                           const FixOptions<T>& options = {},
                                           const VectorObservation<T, 1>* prior = nullptr) {
  constexpr double kExclusion = 12.0;  // -2 ln of how often a satellite is half a cycle off: one in 400
  if (set.count < 0 || set.count > N || !(known.length >= T(0)) || !(known.sigma >= T(0))) return Status::kOutOfRange;
  Result<BaselineFix<T, N>> whole = kernel::resolve_all(set, known, options, prior);
  if (!options.exclude || set.count < 7) return whole;
  const bool misfits = whole.status() == Status::kInconsistent;
  const bool doubtful =
      whole.ok() && whole.value().misfit > chi_square_quantile(T(whole.value().degrees), T(kOneInSix));
  if (!misfits && !doubtful) return whole;
  if (misfits && known.length > T(0)) {  // does all fit, but for the length?
    const Result<BaselineFix<T, N>> free = kernel::resolve_all(set, KnownLength<T>(), options, prior);
    if (free.ok() && free.value().accepted) return whole;
  }
  // candidates: all satellites, and all but each; what they cost, and how far the best is from others than itself
  T wavelength = set[0].wavelength;
  for (int i = 1; i < set.count; ++i) wavelength = set[i].wavelength < wavelength ? set[i].wavelength : wavelength;
  const auto other = [&](const BaselineFix<T, N>& a, const BaselineFix<T, N>& b) {
    return (a.seen.value - b.seen.value).norm() > T(0.25) * wavelength;
  };
  FixOptions<T> strict = options;
  strict.misfit = T(kOneInHundred);
  Result<BaselineFix<T, N>> best = whole;
  T cost = whole.ok() ? whole.value().misfit : std::numeric_limits<T>::infinity();
  T rival = std::numeric_limits<T>::infinity();
  for (int i = 0; i < set.count; ++i) {
    const Result<BaselineFix<T, N>> rest = kernel::resolve_all(set.without(i), known, strict, prior);
    if (!rest.ok()) continue;
    const T price = rest.value().misfit + T(kExclusion);
    if (best.ok() && !other(best.value(), rest.value()) && cost <= price) continue;  // the same answer
    if (price >= cost) {
      rival = price < rival ? price : rival;
      continue;
    }
    if (best.ok() && other(best.value(), rest.value())) rival = cost < rival ? cost : rival;
    BaselineFix<T, N> fix = rest.value();
    for (int k = set.count - 1; k > i; --k)
      fix.cycles[static_cast<std::size_t>(k)] = fix.cycles[static_cast<std::size_t>(k - 1)];
    fix.cycles[static_cast<std::size_t>(i)] = T(0);
    fix.excluded = i;
    best = fix;
    cost = price;
  }
  if (!best.ok()) return best;
  BaselineFix<T, N> fix = best.value();
  fix.gap = rival - cost < fix.gap ? rival - cost : fix.gap;
  fix.accepted = fix.accepted && fix.gap > options.gap;
  return fix;
}

}  // namespace trunnion
