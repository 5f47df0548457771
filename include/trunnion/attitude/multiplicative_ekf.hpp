// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The attitude filter: an error of three components in the body's axes, the quaternion never leaves the unit sphere.
///
///   C_nb = C_hat Exp(phi),   x = (phi, d_w | m),   w: the rate w_nb_b, or the bias of the gyros              ... (1)
///   q <- q Exp(w_nb_b t)                                                                                    ... (2)
///   phi <- Exp(-w t) phi +- Jr(w t) t d_w,   + for a rate, - for a bias                                     ... (3)
///   Q = [Jr q t^3/3 Jr^T, +- Jr q t^2/2; ., q t]  (+ n^2 t I for gyros of noise n)                          ... (4)
///   rate and bias: w' = -w / tau + noise of density q; a random walk for an infinite tau
///   m' = -m / tau_m + noise, in the steady state k^2 N^-1: errors of what is seen that stay for a while     ... (5)
///
/// An update minimises x^T P^-1 x + r(x)^T N r(x), iterated; H is (2) of vector_observation.hpp times Jr(phi):
///
///   x <- x + F (P H^T N r - x),   F = (I + P H^T N H)^-1                                                  ... (6)
///   P <- G F (P + P H^T N H P) F^T G^T,   G = Jr(phi),   NIS = r^T N r + x^T H^T N r                       ... (7)
///
/// N, the information of what was seen, may be singular: few satellites are not none; and so may P. What an iteration
/// adds is small against x and keeps its digits, in float too. NIS is of the last iterate: of the first, it takes the
/// curvature of a large correction for noise.
///
/// Lefferts, Markley & Shuster, J. Guidance 5 (1982), 417; Markley, J. Guidance 26 (2003), 311; Bell & Cathey, IEEE TAC
/// 38 (1993), 294 for the iteration; docs/theory/interferometer.md.

#pragma once

#include <limits>

#include "trunnion/attitude/vector_observation.hpp"
#include "trunnion/core/chi_square.hpp"

namespace trunnion {

/// How attitude and slow states wander.
template <class T>
struct AttitudeNoise {
  T walk = T(0);                                ///< of the rate [rad/s/sqrt(s)], or of the bias, sqrt(q)
  T time = std::numeric_limits<T>::infinity();  ///< tau [s]
  T gyro = T(0);                                ///< n [rad/s/sqrt(Hz)]
  T coloured = T(0);                            ///< k: standard deviation of m against that of the white noise
  T coloured_time = T(30);                      ///< tau_m [s]
};

/// The state and its covariance, and how they add: x = (phi, d_w | m).
template <class T, int M, bool Coloured>
struct AttitudeState {
  static constexpr int kStates = 6 + (Coloured ? 3 * M : 0);
  using Vector = Eigen::Matrix<T, kStates, 1>;
  using Square = Eigen::Matrix<T, kStates, kStates>;

  Quaternion<T> q_nb = Quaternion<T>::Identity();
  Vec3<T> w = Vec3<T>::Zero();                                        ///< rate, or bias of the gyros [rad/s]
  Eigen::Matrix<T, 3 * M, 1> m = Eigen::Matrix<T, 3 * M, 1>::Zero();  ///< n [m]
  Square P = Square::Zero();

  /// Moved by @p x; the covariance of x becomes that about the new state, eq. (7): G.
  void move(const Vector& x) {
    const Vec3<T> phi = x.template head<3>();
    q_nb = (q_nb * quaternion_exp(phi)).normalized();
    w += x.template segment<3>(3);
    if constexpr (Coloured) m += x.template tail<3 * M>();
    carry(right_jacobian(phi));
  }
  /// The x that leads to @p other.
  [[nodiscard]] Vector to(const AttitudeState& other) const {
    Vector x;
    x.template head<3>() = quaternion_log<T>(q_nb.conjugate() * other.q_nb);
    x.template segment<3>(3) = other.w - w;
    if constexpr (Coloured) x.template tail<3 * M>() = other.m - m;
    return x;
  }
  /// P of another measure of phi: G P G^T, symmetric again.
  void carry(const Mat3<T>& G) {
    Square whole = Square::Identity();
    whole.template topLeftCorner<3, 3>() = G;
    P = congruence(whole, P);
  }
};

/// Before and after an update, and the way from the last one: what a smoother needs.
template <class T, int M, bool Coloured>
struct AttitudeRecord {
  using State = AttitudeState<T, M, Coloured>;
  State before, after;
  typename State::Square Phi = State::Square::Identity();  ///< from the last `after` to this `before`
};

/// What an update found.
template <class T>
struct Innovation {
  T nis = T(0);   ///< chi-square of `rank` where the filter is right
  int rank = 0;   ///< of what was seen
  int steps = 0;  ///< of the iteration
};

/// @tparam M vectors seen; @tparam Coloured whether (5) is there: 3 M states more
template <class T, int M, bool Coloured = false>
class MultiplicativeEkf {
 public:
  using Record = AttitudeRecord<T, M, Coloured>;
  using State = typename Record::State;
  using Observation = VectorObservation<T, M>;
  static constexpr int kStates = State::kStates;

  /// @param start from attitude_from_vectors(); @param free_sigma about its free axis, where it has one [rad]
  /// @param slow_sigma of each rate or bias, which start at zero [rad/s]
  MultiplicativeEkf(const AttitudeEstimate<T>& start, const T& free_sigma, const T& slow_sigma,
                    const AttitudeNoise<T>& noise)
      : noise_(noise) {
    State& state = record_.after;
    state.q_nb = start.q_nb.normalized();
    state.P.template topLeftCorner<3, 3>() =
        start.covariance + free_sigma * free_sigma * start.free_axis * start.free_axis.transpose();
    state.P.template block<3, 3>(3, 3).diagonal().setConstant(slow_sigma * slow_sigma);
    record_.before = state;
  }

  /// The same at an observation that starts a filter of coloured errors, which are in the start already: with
  /// phi = -A (m + v), A = (H^T N H)^-1 H^T N, the start's covariance is 1 + k^2 times the white one, and that of phi
  /// and m is -A k^2 N^-1.
  MultiplicativeEkf(const AttitudeEstimate<T>& start, const T& free_sigma, const T& slow_sigma,
                    const AttitudeNoise<T>& noise, const Observation& seen, const RigidVectors<T, M>& vectors)
      : MultiplicativeEkf(start, free_sigma, slow_sigma, noise) {
    if constexpr (Coloured) {
      if (seen.rank < 3 * M) return;
      State& state = record_.after;
      const T k2 = noise.coloured * noise.coloured;
      steady_ = k2 * seen.information.inverse();
      state.P.template topLeftCorner<3, 3>() += k2 * start.covariance;
      const Eigen::Matrix<T, 3 * M, 3> H = vectors.turned_by(state.q_nb.toRotationMatrix());
      const Eigen::Matrix<T, 3, 3 * M> cross = -k2 * start.covariance * H.transpose();
      state.P.template block<3, 3 * M>(0, 6) = cross;
      state.P.template block<3 * M, 3>(6, 0) = cross.transpose();
      state.P.template bottomRightCorner<3 * M, 3 * M>() = steady_;
      record_.before = state;
      started_ = true;
    }
  }

  [[nodiscard]] const State& state() const { return record_.after; }
  /// Of the last update(), or of the start.
  [[nodiscard]] const Record& record() const { return record_; }

  /// Without gyros, over @p t [s]. @return kOutOfRange, and nothing changed, for a time that is not finite or negative
  Status predict(const T& t) {
    using std::exp;
    if (!(t >= T(0) && t <= std::numeric_limits<T>::max())) return Status::kOutOfRange;
    // what a rate that dies away turns by
    const bool walks = !(noise_.time <= std::numeric_limits<T>::max());
    const T effective = walks ? t : noise_.time * (T(1) - exp(-t / noise_.time));
    propagate(record_.after.w * effective, effective, t);
    return Status::kOk;
  }

  /// With gyros. @param w_ib_b measured, mean over the @p t [s] since the last; @param w_in_n of the Earth, and of the
  /// way over it [rad/s]
  Status predict(const T& t, const Vec3<T>& w_ib_b, const Vec3<T>& w_in_n) {
    if (!(t >= T(0) && t <= std::numeric_limits<T>::max()) || !w_ib_b.allFinite() || !w_in_n.allFinite())
      return Status::kOutOfRange;
    const Vec3<T> w_nb_b = w_ib_b - record_.after.w - record_.after.q_nb.conjugate() * w_in_n;
    propagate(w_nb_b * t, -t, t);
    return Status::kOk;
  }

  /// Eq. (6), (7). @param gate normal quantile beyond whose chi_square_quantile() a NIS refuses the observation; 0:
  /// none
  /// @return kOutOfRange for what is not finite, kInconsistent for what was refused and for what does not settle;
  /// nothing is changed then
  Status update(const Observation& seen, const RigidVectors<T, M>& vectors, const T& gate = T(0),
                Innovation<T>* innovation = nullptr) {
    using Vector = typename State::Vector;
    using Square = typename State::Square;
    using Stack = Eigen::Matrix<T, 3 * M, 1>;
    using Wide = Eigen::Matrix<T, 3 * M, 3 * M>;
    constexpr int kMostSteps = 12;
    constexpr T kSettled = T(2e-6);  // rad
    if (!vectors.valid() || !seen.value.allFinite() || !seen.information.allFinite()) return Status::kOutOfRange;
    State before = record_.after;
    if constexpr (Coloured) {
      // where not everything was seen, it is that of the last time
      if (seen.rank == 3 * M) steady_ = noise_.coloured * noise_.coloured * seen.information.inverse();
      if (!started_) before.P.template bottomRightCorner<3 * M, 3 * M>() = steady_;
    }
    Eigen::Matrix<T, 3 * M, kStates> H = Eigen::Matrix<T, 3 * M, kStates>::Zero();
    if constexpr (Coloured) H.template rightCols<3 * M>().setIdentity();
    Vector x = Vector::Zero();
    for (int step = 1; step <= kMostSteps; ++step) {
      const Vec3<T> phi = x.template head<3>();
      const Mat3<T> C = (before.q_nb * quaternion_exp(phi)).toRotationMatrix();
      const Wide N = vectors.loosened(seen.information, C);
      H.template leftCols<3>() = vectors.turned_by(C) * right_jacobian(phi);
      Stack r = seen.value - vectors.seen_from(C) - before.m;
      if constexpr (Coloured) r -= x.template tail<3 * M>();
      const Eigen::Matrix<T, kStates, 3 * M> Ht = H.transpose();
      const Square Lambda = congruence(Ht, N);
      const Vector pull = Ht * (N * r);
      const Eigen::PartialPivLU<Square> step_of(Square::Identity() + product(before.P, Lambda));
      const Vector moved = step_of.solve(before.P * pull - x);
      x += moved;
      if (!x.allFinite()) return Status::kInconsistent;
      if (moved.template head<3>().norm() > kSettled) continue;
      const T nis = r.dot(N * r) + x.dot(pull);
      if (innovation != nullptr) *innovation = {nis, seen.rank, step};
      if (gate > T(0) && !(nis <= chi_square_quantile(T(seen.rank), gate))) return Status::kInconsistent;
      State after = before;
      after.P = congruence(Square(step_of.inverse()), Square(before.P + congruence(before.P, Lambda)));
      after.move(x);
      record_ = {before, after, Phi_};
      Phi_.setIdentity();
      started_ = started_ || seen.rank == 3 * M;
      return Status::kOk;
    }
    return Status::kInconsistent;
  }

  /// About an axis of the body that nothing shows, angle and rate are kept from being less sure than that: without it
  /// they wander off, and the iteration with them. The state stays, and what is surer stays as sure.
  void tether(const Vec3<T>& axis, const T& angle_sigma, const T& slow_sigma) {
    typename State::Square& P = record_.after.P;
    for (const int block : {0, 3}) {
      const T most = block == 0 ? angle_sigma * angle_sigma : slow_sigma * slow_sigma;
      const typename State::Vector Pa = P.template middleCols<3>(block) * axis;
      const T variance = axis.dot(Pa.template segment<3>(block));
      if (variance > most) P -= (T(1) - most / variance) / variance * Pa * Pa.transpose();
    }
  }

 private:
  /// Eq. (2)-(5). @param sensitivity of the angle to the slow state [s]
  void propagate(const Vec3<T>& angle, const T& sensitivity, const T& t) {
    using std::exp;
    State& state = record_.after;
    const Mat3<T> J = right_jacobian(angle);
    const T kept = exp(-t / noise_.time);
    const T q = noise_.walk * noise_.walk;
    typename State::Square Phi = State::Square::Identity();
    Phi.template topLeftCorner<3, 3>() = rotation_exp<T>(-angle);
    Phi.template block<3, 3>(0, 3) = sensitivity * J;
    Phi.template block<3, 3>(3, 3) *= kept;
    state.P = congruence(Phi, state.P);
    state.P.template topLeftCorner<3, 3>() +=
        q * t * t * t / T(3) * J * J.transpose() + noise_.gyro * noise_.gyro * t * Mat3<T>::Identity();
    const Mat3<T> cross = (sensitivity < T(0) ? T(-0.5) : T(0.5)) * q * t * t * J;
    state.P.template block<3, 3>(0, 3) += cross;
    state.P.template block<3, 3>(3, 0) += cross.transpose();
    state.P.template block<3, 3>(3, 3).diagonal().array() += q * t;
    if constexpr (Coloured) {
      const T fades = exp(-t / noise_.coloured_time);
      Phi.template bottomRightCorner<3 * M, 3 * M>() *= fades;
      state.P.template rightCols<3 * M>() *= fades;
      state.P.template bottomRows<3 * M>() *= fades;
      state.P.template bottomRightCorner<3 * M, 3 * M>() += (T(1) - fades * fades) * steady_;
      state.m *= fades;
    }
    state.q_nb = (state.q_nb * quaternion_exp(angle)).normalized();
    state.w *= kept;
    Phi_ = product(Phi, Phi_);
  }

  AttitudeNoise<T> noise_;
  Record record_;
  typename State::Square Phi_ = State::Square::Identity();
  Eigen::Matrix<T, 3 * M, 3 * M> steady_ = Eigen::Matrix<T, 3 * M, 3 * M>::Zero();
  bool started_ = false;
};

}  // namespace trunnion
