// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Two slaves and a master, jointly: whole cycles of both baselines that are the same rigid figure, turned.
///
///   noise of the pair, undifferenced sigma s:  s^2 R,   R = [2 1; 1 2]                                    ... (1)
///   minimise E(a_1, a_2) + (x - C b)^T (R^-1 x N) (x - C b)  over a_1, a_2 and C on SO(3)                 ... (2)
///   E = sum of r^T R^-1 r / s^2 over the satellites, r = (r_1, r_2) the misfits at x                      ... (3)
///
/// x: both baselines, each from its phases and codes; N: the information of one, for the variance of one receiver.
/// The candidates are pairs of the K best of either baseline by its length. (2) is never below two thirds of what the
/// baselines cost apart: pairs beyond the K count as seconds of that cost. Most pairs are left out by the angle between
/// them. What a figure of
/// three antennas knows: two lengths, an angle, and that the master's noise is in both. Teunissen, Giorgi & Buist, GPS
/// Solutions 15 (2011), 15 (MC-LAMBDA) solves (2) without the cut to K.

#pragma once

#include "trunnion/attitude/wahba.hpp"
#include "trunnion/interferometer/baseline.hpp"

namespace trunnion {

/// Both baselines as one observation, eq. (1). The satellites of both must be the same.
template <class T>
VectorObservation<T, 2> with_common_master(const VectorObservation<T, 1>& first,
                                           const VectorObservation<T, 1>& second) {
  VectorObservation<T, 2> both;
  both.value << first.value, second.value;
  const Mat3<T> N = first.information + second.information;  // each for 2 s^2: their sum for s^2
  both.information << T(2.0 / 3.0) * N, T(-1.0 / 3.0) * N, T(-1.0 / 3.0) * N, T(2.0 / 3.0) * N;
  return both;
}

/// The figure's attitude, its whole cycles, and what speaks for them.
template <class T, int N>
struct ArrayFix {
  VectorObservation<T, 2> seen;
  AttitudeEstimate<T> attitude;
  std::array<std::array<T, static_cast<std::size_t>(N)>, 2> cycles{};
  T misfit = T(0);  ///< of (2), chi-square with `degrees`
  int degrees = 0;
  T gap = T(0);  ///< to the second best; where none is within reach, what it is at least
  int satellites = 0;
  long nodes = 0;
  long pairs = 0;         ///< whose attitude was computed
  bool accepted = false;  ///< as a BaselineFix is
};

namespace kernel {

/// One baseline's candidate: its vector, and its misfits over s, code and phase.
template <class T, int N>
struct ArrayCandidate {
  std::array<T, static_cast<std::size_t>(N)> cycles{};
  Vec3<T> b = Vec3<T>::Zero();
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 2 * N, 1> r;
};

/// Misfits of the centred observations at @p b, over the sigmas of one receiver.
template <class T, int N, class Observed, class Sigma>
void misfits(const SingleDifferences<T, N>& set, const Observed& observed, const Sigma& sigma, const Vec3<T>& b, T* r) {
  for (int g = 0; g < kGroups; ++g) {
    T weights = T(0);
    T mean = T(0);
    for (int i = 0; i < set.count; ++i) {
      if (set[i].group != g) continue;
      const T w = T(1) / (sigma(i) * sigma(i));
      weights += w;
      r[i] = observed(i) + set[i].e.dot(b);
      mean += w * r[i];
    }
    for (int i = 0; i < set.count; ++i) {
      if (set[i].group == g) r[i] = (r[i] - mean / weights) / sigma(i);
    }
  }
}

/// Sum of r^T R^-1 r, eq. (3).
template <class V>
typename V::Scalar joint_square(const V& first, const V& second) {
  using T = typename V::Scalar;
  return T(2.0 / 3.0) * (first.squaredNorm() + second.squaredNorm() - first.dot(second));
}

}  // namespace kernel

/// Eq. (2).
/// @param first the master to slave 1
/// @param second the master to slave 2, the same satellites in the same order
/// @param figure of the slaves from the master; its sigma is that of both lengths and the angle
/// @tparam K candidates of either baseline
/// @return as resolve_baseline(); kNotObservable too for slaves in one line with the master
template <int K = 24, class T, int N>
Result<ArrayFix<T, N>> resolve_array(const SingleDifferences<T, N>& first, const SingleDifferences<T, N>& second,
                                     const RigidVectors<T, 2>& figure, const FixOptions<T>& options = {}) {
  using Candidate = kernel::ArrayCandidate<T, N>;
  if (!figure.valid() || first.count != second.count || first.count < 0 || first.count > N) return Status::kOutOfRange;
  for (int i = 0; i < first.count; ++i) {
    if (first[i].satellite != second[i].satellite || first[i].group != second[i].group) return Status::kOutOfRange;
  }
  if (figure.rank() < 3) return Status::kNotObservable;
  const std::array<const SingleDifferences<T, N>*, 2> sets = {&first, &second};
  std::array<std::array<Candidate, static_cast<std::size_t>(K)>, 2> candidates;
  std::array<int, 2> count{};
  std::array<T, 2> first_cost{};
  std::array<T, 2> last_cost{};  // of a list that was cut; infinite for a whole one
  std::array<VectorObservation<T, 1>, 2> seen;
  std::array<Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 2 * N, 1>, 2> code_misfit;
  ArrayFix<T, N> fix;
  fix.satellites = first.count;
  bool complete = true;
  for (std::size_t s = 0; s < 2; ++s) {
    const SingleDifferences<T, N>& set = *sets[s];
    const FloatBaseline<T, N> real(set);
    if (real.status() != Status::kOk) return real.status();
    const KnownLength<T> known{figure.b().col(static_cast<int>(s)).norm(), figure.sigma()};
    const int n = real.pairs().count();
    fix.degrees = 2 * n + 3;
    IntegerCandidates<T, N, K> found;
    // the misfit that counts is that of both: here, wide
    const T farthest = chi_square_quantile(T(n + 1), T(kOneInMillion));
    for (T radius = T(n + 1);; radius *= T(3)) {
      const bool last = radius >= farthest;
      real.search(known, last ? farthest : radius, farthest, options.limits, found);
      if (found.count == K || last || !found.complete) break;
    }
    fix.nodes += found.nodes;
    complete = complete && found.complete;
    if (found.count == 0) return found.complete ? Status::kInconsistent : Status::kTimeOut;
    count[s] = found.count;
    first_cost[s] = found.at[0].cost;
    last_cost[s] = found.count == K ? found.at[K - 1].cost : std::numeric_limits<T>::infinity();
    const auto code = [&](int i) { return set[i].code; };
    const auto code_sigma = [&](int i) { return set[i].code_sigma; };
    code_misfit[s].resize(2 * set.count);
    code_misfit[s].setZero();
    kernel::misfits(set, code, code_sigma, real.b(), code_misfit[s].data());
    for (int c = 0; c < found.count; ++c) {
      Candidate& candidate = candidates[s][static_cast<std::size_t>(c)];
      const BoundedVector<T, N> a = real.cycles(found.at[static_cast<std::size_t>(c)].z);
      for (int k = 0; k < n; ++k) candidate.cycles[static_cast<std::size_t>(real.pairs().satellite(k))] = a(k);
      const BaselineSum<T> sum = fixed_sum(set, candidate.cycles, real.code());
      candidate.b = sum.information.ldlt().solve(sum.moment);
      seen[s].information = sum.information;
      candidate.r.resize(2 * set.count);
      kernel::misfits(set, code, code_sigma, candidate.b, candidate.r.data());
      kernel::misfits(
          set,
          [&](int i) { return set[i].wavelength * (set[i].phase - candidate.cycles[static_cast<std::size_t>(i)]); },
          [&](int i) { return set[i].phase_sigma; }, candidate.b, candidate.r.data() + set.count);
    }
  }
  // what the codes alone do not meet is in every pair, and no matter of the cycles
  const T of_codes = kernel::joint_square(code_misfit[0], code_misfit[1]);
  const T degrees = T(fix.degrees);
  const T farthest = chi_square_quantile(degrees, options.misfit);
  const T dot = figure.b().col(0).dot(figure.b().col(1));
  const Mat3<T> Q = T(2) * (seen[0].information + seen[1].information).inverse();
  T best = std::numeric_limits<T>::infinity();
  T second_best = best;
  std::array<std::size_t, 2> chosen{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count[0]); ++i) {
    const Candidate& c1 = candidates[0][i];
    for (std::size_t j = 0; j < static_cast<std::size_t>(count[1]); ++j) {
      const Candidate& c2 = candidates[1][j];
      const T reach =
          best < farthest ? (options.gap * (best > degrees ? best / degrees : T(1)) + best) : farthest + options.gap;
      const T apart = kernel::joint_square(c1.r, c2.r) - of_codes;
      const T off = c1.b.dot(c2.b) - dot;
      const T variance = c1.b.dot(Q * c1.b) + c2.b.dot(Q * c2.b) + c1.b.dot(Q * c2.b) +
                         T(2) * figure.sigma() * figure.sigma() * (c1.b.squaredNorm() + c2.b.squaredNorm());
      // the bound is half of what the angle costs to first order: it is not exact far off
      if (apart + T(0.5) * off * off / variance > reach) continue;
      seen[0].value = c1.b;
      seen[1].value = c2.b;
      const VectorObservation<T, 2> both = with_common_master(seen[0], seen[1]);
      const auto attitude = attitude_from_vectors(both, figure);
      ++fix.pairs;
      if (!attitude.ok()) continue;
      const T F = apart + attitude.value().cost;
      if (F < best) {
        second_best = best;
        best = F;
        chosen = {i, j};
        fix.seen = both;
        fix.attitude = attitude.value();
      } else if (F < second_best) {
        second_best = F;
      }
    }
  }
  if (!(best <= farthest)) return Status::kInconsistent;
  const T asked = options.gap * (best > degrees ? best / degrees : T(1));
  // what pairs of a candidate beyond the K cost at least: (3) is no less than two thirds of what they cost apart
  const T cut =
      T(2.0 / 3.0) * (first_cost[0] + last_cost[1] < first_cost[1] + last_cost[0] ? first_cost[0] + last_cost[1]
                                                                                  : first_cost[1] + last_cost[0]) -
      (code_misfit[0] - code_misfit[1]).squaredNorm() / T(3);
  const T runner_up = second_best < cut ? second_best : cut;
  fix.misfit = best;
  fix.gap = runner_up - best < asked * T(2) ? runner_up - best : asked * T(2);
  fix.accepted = complete && fix.gap > asked;
  for (std::size_t s = 0; s < 2; ++s) fix.cycles[s] = candidates[s][chosen[s]].cycles;
  return fix;
}

}  // namespace trunnion
