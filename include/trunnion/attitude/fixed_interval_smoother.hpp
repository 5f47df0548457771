// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fixed-interval smoothing of a log: what the epochs to come say of this one.
///
///   A = P_k Phi^T (P-_k+1)^-1,   x = A (xs_k+1 [-] x-_k+1)                                               ... (1)
///   xs_k = x_k [+] x,   Ps_k = G (P_k + A (Ps_k+1 - P-_k+1) A^T) G^T,   G = Jr(phi of x)                 ... (2)
///
/// [+], [-]: AttitudeState::move() and to(). Ps_k+1 is taken about x-_k+1 in (2). Rauch, Tung & Striebel, AIAA J. 3
/// (1965), 1445.

#pragma once

#include <Eigen/Cholesky>

#include "trunnion/attitude/multiplicative_ekf.hpp"

namespace trunnion {

/// One step back. @param next the record after @p record, whose `after` is smoothed already
/// @return the smoothed state at @p record; kNotObservable where the prediction's covariance is singular
template <class T, int M, bool Coloured>
Result<AttitudeState<T, M, Coloured>> smooth(const AttitudeRecord<T, M, Coloured>& record,
                                             const AttitudeRecord<T, M, Coloured>& next) {
  using State = AttitudeState<T, M, Coloured>;
  using Square = typename State::Square;
  const Eigen::LLT<Square> predicted(next.before.P);
  if (predicted.info() != Eigen::Success) return Status::kNotObservable;
  const Square A = predicted.solve(product(next.Phi, record.after.P)).transpose();
  const typename State::Vector x = next.before.to(next.after);
  State future = next.after;
  future.carry(right_jacobian(Vec3<T>(x.template head<3>())).inverse());
  State state = record.after;
  state.P += congruence(A, Square(future.P - next.before.P));
  state.move(A * x);
  return state;
}

/// The whole interval, in place: every record's `after` becomes the smoothed state. @param records in order of time
template <class T, int M, bool Coloured>
Status smooth(AttitudeRecord<T, M, Coloured>* records, long count) {
  for (long k = count - 2; k >= 0; --k) {
    const auto state = smooth(records[k], records[k + 1]);
    if (!state.ok()) return state.status();
    records[k].after = state.value();
  }
  return Status::kOk;
}

}  // namespace trunnion
