// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a campaign over seeds says: means with Student's intervals, paired tests, homogeneity.
///
///   I_x(a, b)  the incomplete beta function, by its continued fraction                                    ... (1)
///   P(|T_n| > t) = I_(n/(n+t^2))(n/2, 1/2),   P(F_(m,n) > f) = I_(n/(n+mf))(n/2, m/2)                    ... (2)
///
/// Abramowitz & Stegun, Handbook of Mathematical Functions, 26.5.8, 26.6.2 and 26.7.1.

#pragma once

#include <vector>

namespace trunnion::comparison {

/// Eq. (1), to 1e-12. @param x in [0, 1]; a, b positive
double incomplete_beta(double a, double b, double x);

/// Probability that |T| with @p n degrees of freedom passes @p t.
double student_tail(double t, double n);

/// The t that |T| passes with probability @p p in (0, 1).
double student_quantile(double p, double n);

/// Probability that F with @p m and @p n degrees of freedom passes @p f.
double fisher_tail(double f, double m, double n);

struct Summary {
  int n = 0;
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation of one
  double low = 0.0;        ///< 95 % interval of the mean
  double high = 0.0;
};

/// @param values of independent seeds; two at least for an interval
Summary summarise(const std::vector<double>& values);

/// Two-sided probability that pairs of these differences, or larger ones, come of a mean difference of zero.
double paired_t_test(const std::vector<double>& a, const std::vector<double>& b);

/// One-way analysis of variance over @p groups equal groups in the order of the values: the probability of such
/// differences between groups of one population. Values that are left over are not used.
double homogeneity(const std::vector<double>& values, int groups);

}  // namespace trunnion::comparison
