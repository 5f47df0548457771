// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Exact whitening of white noise plus Gauss-Markov wander: the innovations of a scalar Kalman filter.
///
///   P_(k|k-1) = phi^2 P + sigma^2 (1 - phi^2),  S = P + R,  e = (v - s) / sqrt(S),  s += P / S (v - s)     ... (1)
///
/// The gains depend on the noise alone, so the same linear map whitens the residual and every column of its Jacobian.
/// IEEE Std 952-1997, annex B; Gelb, Applied Optimal Estimation, ch. 4; docs/theory/calibration.md, eq. 19.

#pragma once

#include <cmath>

#include "trunnion/error_model/noise.hpp"

namespace trunnion::calibration {

/// @tparam Row a number, or a fixed-size vector: the residual and its derivatives side by side
template <class Row>
class Whitening {
 public:
  Whitening(const TriadNoise& noise, const Row& zero)
      : variance_(noise.wander * noise.wander),
        correlation_time_(noise.wander_correlation_time),
        P_(variance_),
        s_(zero) {}

  /// Variance of the next innovation at time @p t [s] for the measurement variance @p R.
  double predict(double t, double R) {
    if (variance_ > 0.0) {
      if (!first_) {
        const double dt = t - t_;
        if (dt != dt_) {
          dt_ = dt;
          phi_ = std::exp(-dt / correlation_time_);
        }
        P_ = phi_ * phi_ * P_ + variance_ * (1.0 - phi_ * phi_);
        s_ *= phi_;
      }
      first_ = false;
      t_ = t;
    }
    S_ = P_ + R;
    return S_;
  }

  /// Innovation of @p v, divided by its sigma; call after predict().
  Row innovate(const Row& v) {
    const Row difference = v - s_;
    if (variance_ > 0.0) {
      const double gain = P_ / S_;
      s_ += gain * difference;
      P_ *= 1.0 - gain;
    }
    return difference * (1.0 / std::sqrt(S_));
  }

 private:
  double variance_;
  double correlation_time_;
  double P_;
  Row s_;
  double S_ = 1.0;
  double t_ = 0.0;
  double dt_ = -1.0;
  double phi_ = 1.0;
  bool first_ = true;
};

}  // namespace trunnion::calibration
