// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What two antennas tell of the vector between them: single and double differences, slave less master.
///
///   D_phi^i lambda = -e^i . b + lambda N^i + clock + noise,   D_P^i = -e^i . b + clock' + noise          ... (1)
///   DD^ir = D^i - D^r:   lambda DD_phi = -(e^i - e^r) . b + lambda N^ir,   covariance 2 s^2 (I + 1 1^T)     ... (2)
///   sum over groups g of sum_i w_i (e^i - e_g)(e^i - e_g)^T,   e_g = sum w_i e^i / sum w_i,  w = 1 / (2 s^2) ... (3)
///
/// e: from the receiver to the satellite, in n. (3) is the information of all double differences with the whole of
/// their covariance, whichever satellite is the reference: to difference is to estimate a clock. A group is what shares
/// one: the satellites of one system on one signal. (2) is written out for the integers only. Teunissen & Kleusberg,
/// GPS for Geodesy, 2nd ed., ch. 5; Jwo, CMC 66 (2021), 2105, eq. (4), where the sign of D is the other.

#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "trunnion/attitude/vector_observation.hpp"
#include "trunnion/interferometer/integer_least_squares.hpp"

namespace trunnion {

/// One satellite's signal at both antennas, less what a baseline of length zero would give.
template <class T>
struct SingleDifference {
  Vec3<T> e = Vec3<T>::Zero();  ///< from the receiver to the satellite, in n, of length one
  T wavelength = T(0);          ///< m
  T code = T(0);                ///< m
  T phase = T(0);               ///< cycles; whole ones may be left out
  T code_sigma = T(0);          ///< of one receiver's code [m]
  T phase_sigma = T(0);         ///< of one receiver's phase [m]
  int group = 0;                ///< 0 ... kGroups - 1
  int satellite = 0;            ///< whatever the caller calls it
};

inline constexpr int kGroups = 8;

/// Those of an epoch, N at most.
template <class T, int N>
struct SingleDifferences {
  std::array<SingleDifference<T>, static_cast<std::size_t>(N)> at{};
  int count = 0;

  [[nodiscard]] const SingleDifference<T>& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
  SingleDifference<T>& operator[](int i) { return at[static_cast<std::size_t>(i)]; }
  [[nodiscard]] SingleDifferences without(int omitted) const {
    SingleDifferences rest = *this;
    for (int i = omitted; i + 1 < count; ++i) rest[i] = rest[i + 1];
    --rest.count;
    return rest;
  }
};

/// Normal equations of b, eq. (3), and how well they are met.
template <class T>
struct BaselineSum {
  Mat3<T> information = Mat3<T>::Zero();  ///< 1/m^2
  Vec3<T> moment = Vec3<T>::Zero();       ///< information times b [1/m]
  T square = T(0);                        ///< of the observations
};

/// Adds observations of e . b with the variances @p variance, clocks eliminated.
/// @param observed called with i [m], of -e . b
template <class T, int N, class Observed, class Variance>
void add_centred(const SingleDifferences<T, N>& set, const Observed& observed, const Variance& variance,
                 BaselineSum<T>& sum) {
  for (int g = 0; g < kGroups; ++g) {
    T weights = T(0);
    T mean = T(0);
    Vec3<T> e_g = Vec3<T>::Zero();
    for (int i = 0; i < set.count; ++i) {
      if (set[i].group != g) continue;
      const T w = T(1) / variance(i);
      weights += w;
      mean += w * observed(i);
      e_g += w * set[i].e;
    }
    if (!(weights > T(0))) continue;
    mean /= weights;
    e_g /= weights;
    for (int i = 0; i < set.count; ++i) {
      if (set[i].group != g) continue;
      const T w = T(1) / variance(i);
      const Vec3<T> e = set[i].e - e_g;
      const T y = mean - observed(i);
      sum.information += w * e * e.transpose();
      sum.moment += w * y * e;
      sum.square += w * y * y;
    }
  }
}

/// The double differences written out, eq. (2): each group's reference is its quietest satellite.
template <class T, int N>
class DoubleDifferences {
 public:
  explicit DoubleDifferences(const SingleDifferences<T, N>& set) {
    std::array<int, kGroups> reference{};
    reference.fill(-1);
    const auto grouped = [&](int i) { return set[i].group >= 0 && set[i].group < kGroups; };
    for (int i = 0; i < set.count; ++i) {
      if (!grouped(i)) continue;
      int& r = reference[static_cast<std::size_t>(set[i].group)];
      if (r < 0 || set[i].phase_sigma < set[r].phase_sigma) r = i;
    }
    for (int i = 0; i < set.count; ++i) {
      if (!grouped(i)) continue;
      const int r = reference[static_cast<std::size_t>(set[i].group)];
      if (i == r) continue;
      satellite_[static_cast<std::size_t>(count_)] = i;
      reference_[static_cast<std::size_t>(count_++)] = r;
    }
  }

  [[nodiscard]] int count() const { return count_; }
  /// Index into the single differences.
  [[nodiscard]] int satellite(int k) const { return satellite_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] int reference(int k) const { return reference_[static_cast<std::size_t>(k)]; }

  /// 2 (D diag(s^2) D^T), for the sigmas of one receiver.
  template <class Sigma>
  [[nodiscard]] BoundedMatrix<T, N> covariance(const Sigma& sigma) const {
    BoundedMatrix<T, N> Q(count_, count_);
    for (int j = 0; j < count_; ++j) {
      for (int k = 0; k < count_; ++k) {
        const T shared = reference(j) == reference(k) ? T(2) * sigma(reference(j)) * sigma(reference(j)) : T(0);
        Q(j, k) = shared + (j == k ? T(2) * sigma(satellite(j)) * sigma(satellite(j)) : T(0));
      }
    }
    return Q;
  }

 private:
  int count_ = 0;
  std::array<int, static_cast<std::size_t>(N)> satellite_{};
  std::array<int, static_cast<std::size_t>(N)> reference_{};
};

}  // namespace trunnion
