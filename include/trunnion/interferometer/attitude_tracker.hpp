// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Epoch by epoch: single differences in, attitude with its status out, in the time and memory of a microcontroller.
///
///   fixed       the epoch's own phases decide its whole cycles
///   held        they do with the filter's prediction, x = C_hat b of covariance H P H^T + s^2 u u^T, in the place of a
///               code                                                                                      ... (1)
///   predicted   none do, and the filter goes on alone
///   float       no filter, and codes only
///   none        not even those
///
/// Cycle slips are no matter: every epoch finds its cycles anew. Half of one, where the receiver does not say so, is a
/// satellite that does not fit. A fix against the filter is refused; after kPatience of them the filter is wrong, and
/// starts again where they are: `restarts` counts. Without a filter, fixed and float are all there is.

#pragma once

#include "trunnion/attitude/multiplicative_ekf.hpp"
#include "trunnion/interferometer/attitude_from_baselines.hpp"

namespace trunnion {

enum class AttitudeStatus : std::uint8_t { kNone, kFloat, kPredicted, kHeld, kFixed };

/// What one epoch's phases and codes say, without a filter.
template <class T, int M>
struct EpochAttitude {
  AttitudeStatus status = AttitudeStatus::kNone;
  Status reason = Status::kOk;   ///< why it is not fixed: kNotObservable, kAmbiguous, kInconsistent, ...
  VectorObservation<T, M> seen;  ///< fixed or held; information of a slave that has no fix is zero
  AttitudeEstimate<T> attitude;  ///< of `seen`, or of the codes; not observable where those say too little
  int satellites = 0;            ///< of the fix, the most of a slave
  int excluded = 0;              ///< satellites left out
  T misfit = T(0);               ///< chi-square with `degrees`; of several baselines, the sum
  int degrees = 0;
  T gap = T(0);  ///< the least
  /// Lengths [m] of slaves whose phases fit without theirs, and not with it; 0: no such case.
  std::array<T, static_cast<std::size_t>(M)> other_length{};
};

namespace kernel {

/// The satellites that both have, in one order.
template <class T, int N>
void keep_common(SingleDifferences<T, N>& first, SingleDifferences<T, N>& second) {
  int count = 0;
  for (int i = 0; i < first.count; ++i) {
    for (int j = count; j < second.count; ++j) {
      if (second[j].satellite != first[i].satellite || second[j].group != first[i].group) continue;
      first[count] = first[i];
      std::swap(second[count], second[j]);
      ++count;
      break;
    }
  }
  first.count = second.count = count;
}

template <class T, int N>
bool same_satellites(const SingleDifferences<T, N>& first, const SingleDifferences<T, N>& second) {
  bool same = first.count == second.count;
  for (int i = 0; same && i < first.count; ++i)
    same = first[i].satellite == second[i].satellite && first[i].group == second[i].group;
  return same;
}

/// Code vectors as an attitude, where they say more than nothing.
template <class T, int M>
void take_float(const RigidVectors<T, M>& figure, EpochAttitude<T, M>& epoch) {
  constexpr double kMostSigma = 0.5;  // rad: beyond, no linear covariance is true
  const auto found = attitude_from_vectors(epoch.seen, figure);
  epoch.status = AttitudeStatus::kFloat;
  if (!found.ok()) return;
  if (!(found.value().covariance.trace() < T(kMostSigma * kMostSigma))) return;
  epoch.attitude = found.value();
}

template <class T, int M, int N>
void add_fix(int slave, const BaselineFix<T, N>& fix, EpochAttitude<T, M>& epoch) {
  epoch.seen.value.template segment<3>(3 * slave) = fix.seen.value;
  epoch.seen.information.template block<3, 3>(3 * slave, 3 * slave) = fix.seen.information;
  epoch.satellites = epoch.degrees == 0 || fix.satellites > epoch.satellites ? fix.satellites : epoch.satellites;
  epoch.excluded += fix.excluded >= 0 ? 1 : 0;
  epoch.gap = epoch.degrees == 0 || fix.gap < epoch.gap ? fix.gap : epoch.gap;
  epoch.misfit += fix.misfit;
  epoch.degrees += fix.degrees;
}

/// One slave alone: its two angles; they start where the body's z is as near to down as can be.
template <class T, int M>
Result<AttitudeEstimate<T>> attitude_of_slave(const VectorObservation<T, M>& seen, const RigidVectors<T, M>& figure,
                                              int slave) {
  VectorObservation<T, 1> one;
  one.value = seen.value.template segment<3>(3 * slave);
  one.information = seen.information.template block<3, 3>(3 * slave, 3 * slave);
  return attitude_from_vectors(one, RigidVectors<T, 1>(figure.b().col(slave), figure.sigma()));
}

/// Each slave by itself.
template <int M, class T, int N>
EpochAttitude<T, M> resolve_apart(const std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)>& sets,
                                  const RigidVectors<T, M>& figure, const FixOptions<T>& options,
                                  const std::array<VectorObservation<T, 1>, static_cast<std::size_t>(M)>* prior,
                                  AttitudeStatus fixed) {
  EpochAttitude<T, M> epoch;
  for (const auto& set : sets) epoch.satellites = set.count > epoch.satellites ? set.count : epoch.satellites;
  EpochAttitude<T, M> of_codes = epoch;
  std::array<bool, static_cast<std::size_t>(M)> has{};
  int fixes = 0;
  int codes = 0;
  epoch.reason = Status::kNotObservable;
  for (std::size_t k = 0; k < static_cast<std::size_t>(M); ++k) {
    const int slave = static_cast<int>(k);
    // the length is in the prior already
    const KnownLength<T> known{prior == nullptr ? T(figure.b().col(slave).norm()) : T(0), figure.sigma()};
    const auto found = resolve_baseline(sets[k], known, options, prior == nullptr ? nullptr : &(*prior)[k]);
    if (found.ok() && found.value().accepted) {
      add_fix(slave, found.value(), epoch);
      has[k] = true;
      ++fixes;
      continue;
    }
    if (found.ok() || epoch.reason == Status::kNotObservable)
      epoch.reason = found.ok() ? Status::kAmbiguous : found.status();
    if (found.status() == Status::kInconsistent && prior == nullptr) {
      FixOptions<T> whole = options;
      whole.exclude = false;
      const auto free = resolve_baseline(sets[k], KnownLength<T>(), whole);
      if (free.ok() && free.value().accepted) of_codes.other_length[k] = free.value().seen.value.norm();
    }
    if (found.status() == Status::kOutOfRange) continue;
    const FloatBaseline<T, N> real(sets[k]);
    if (real.status() != Status::kOk) continue;
    of_codes.seen.value.template segment<3>(3 * slave) = real.b();
    of_codes.seen.information.template block<3, 3>(3 * slave, 3 * slave) = real.code().information;
    ++codes;
  }
  epoch.other_length = of_codes.other_length;
  if (fixes > 0) {
    auto attitude = Result<AttitudeEstimate<T>>(Status::kNotObservable);
    if constexpr (M == 2) {
      if (fixes == 2) {
        VectorObservation<T, 1> one;
        VectorObservation<T, 1> two;
        one.value = epoch.seen.value.template head<3>();
        one.information = epoch.seen.information.template topLeftCorner<3, 3>();
        two.value = epoch.seen.value.template tail<3>();
        two.information = epoch.seen.information.template bottomRightCorner<3, 3>();
        // with other satellites than the other's, how much of the master's noise is in both is not told: as if none
        if (epoch.excluded == 0 && same_satellites(sets[0], sets[1])) epoch.seen = with_common_master(one, two);
        attitude = attitude_from_vectors(epoch.seen, figure);
        // the angle between them is known too
        if (!attitude.ok() || !(attitude.value().cost <= chi_square_quantile(T(3), options.misfit))) {
          epoch.reason = Status::kInconsistent;
          epoch.seen = {};
          return epoch;
        }
      }
    }
    if (fixes == 1 || !attitude.ok()) attitude = attitude_of_slave(epoch.seen, figure, has[0] ? 0 : 1);
    epoch.reason = attitude.status();
    if (!attitude.ok()) return epoch;
    epoch.status = fixed;
    epoch.attitude = attitude.value();
    epoch.seen.rank = 3 * fixes;
    return epoch;
  }
  if (codes < M) return epoch;
  of_codes.reason = epoch.reason;
  take_float(figure, of_codes);
  return of_codes;
}

}  // namespace kernel

/// One epoch of a master and M = 1 or 2 slaves. @param sets single differences of each slave; @param prior of each
/// baseline, of a filter, or null
template <int M, class T, int N>
EpochAttitude<T, M> resolve_epoch(
    std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)> sets, const RigidVectors<T, M>& figure,
    const FixOptions<T>& options = {},
    const std::array<VectorObservation<T, 1>, static_cast<std::size_t>(M)>* prior = nullptr) {
  static_assert(M == 1 || M == 2, "one slave or two");
  EpochAttitude<T, M> epoch;
  const AttitudeStatus fixed = prior == nullptr ? AttitudeStatus::kFixed : AttitudeStatus::kHeld;
  if constexpr (M == 2) {
    if (prior == nullptr && figure.rank() == 3) {
      auto common = sets;
      kernel::keep_common(common[0], common[1]);
      const auto joint = resolve_array(common[0], common[1], figure, options);
      if (joint.ok() && joint.value().accepted) {
        const ArrayFix<T, N>& fix = joint.value();
        epoch.status = fixed;
        epoch.seen = fix.seen;
        epoch.attitude = fix.attitude;
        epoch.satellites = fix.satellites;
        epoch.misfit = fix.misfit;
        epoch.degrees = fix.degrees;
        epoch.gap = fix.gap;
        // one that does not fit well is asked for of each slave by itself, which leaves satellites out
        if (!(fix.misfit > chi_square_quantile(T(fix.degrees), T(kOneInSix)))) return epoch;
        const EpochAttitude<T, 2> apart = kernel::resolve_apart<2>(sets, figure, options, prior, fixed);
        const bool rival = apart.status == fixed && apart.excluded > 0 && apart.attitude.observable == 3;
        return rival && quaternion_log<T>(apart.attitude.q_nb.conjugate() * fix.attitude.q_nb).norm() > T(0.05) ? apart
                                                                                                                : epoch;
      }
    }
  }
  return kernel::resolve_apart<M>(sets, figure, options, prior, fixed);
}

/// resolve_epoch() with a memory of whether the figure is right.
///
/// An epoch whose phases fit but for one satellite, and one whose phases fit but for a length that is wrong, look
/// alike: leaving satellites out, one of them fits a wrong length. What tells them apart is the other epochs. A fix of
/// all satellites speaks for the figure with 4, one without a satellite with 1, phases that fit without the stated
/// length and not with it speak against it with 20. A fix without a satellite is taken from kTrusted on.
template <class T, int M, int N>
class ArrayResolver {
 public:
  static constexpr int kTrusted = 20;

  explicit ArrayResolver(const RigidVectors<T, M>& figure, const FixOptions<T>& options)
      : figure_(figure), options_(options) {}

  EpochAttitude<T, M> resolve(const std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)>& sets) {
    constexpr int kMost = 80;
    EpochAttitude<T, M> epoch = resolve_epoch<M>(sets, figure_, options_);
    bool against = false;
    for (const T& length : epoch.other_length) against = against || length > T(0);
    trust_ += against ? -20 : epoch.status != AttitudeStatus::kFixed ? 0 : epoch.excluded > 0 ? 1 : 4;
    trust_ = trust_ > kMost ? kMost : trust_ < -kMost ? -kMost : trust_;
    return epoch.excluded > 0 && trust_ < kTrusted ? without_exclusion(sets) : epoch;
  }

  /// With what a filter predicts of each baseline.
  EpochAttitude<T, M> resolve(const std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)>& sets,
                              const std::array<VectorObservation<T, 1>, static_cast<std::size_t>(M)>& prior) {
    FixOptions<T> options = options_;
    options.exclude = options.exclude && trust_ >= kTrusted;
    return resolve_epoch<M>(sets, figure_, options, &prior);
  }

 private:
  EpochAttitude<T, M> without_exclusion(
      const std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)>& sets) const {
    FixOptions<T> options = options_;
    options.exclude = false;
    EpochAttitude<T, M> epoch = resolve_epoch<M>(sets, figure_, options);
    // the fit that the one without a satellite contradicts is no better
    if (epoch.status == AttitudeStatus::kFixed) {
      epoch.status = AttitudeStatus::kNone;
      epoch.reason = Status::kInconsistent;
      epoch.attitude = {};
      epoch.seen = {};
    }
    return epoch;
  }

  RigidVectors<T, M> figure_;
  FixOptions<T> options_;
  int trust_ = 0;
};

template <class T>
struct TrackerOptions {
  FixOptions<T> fix;
  AttitudeNoise<T> noise{T(0.02)};  ///< of the filter; walk [rad/s/sqrt(s)]
  T slow_sigma = T(0.35);           ///< of the rate, or of the gyros' bias, at the start [rad/s]
  T free_sigma = T(1);              ///< about an axis that no antenna shows [rad]
  T gate = T(kOneInMillion);        ///< of the filter, normal quantile
  T held_sigma = T(0.1);            ///< rad: a filter less sure than that predicts no cycles
  T lost_sigma = T(0.5);            ///< rad: and less sure than that, nothing
  T longest = T(30);                ///< s that the filter goes on alone
};

/// What comes out at an epoch.
template <class T, int M>
struct TrackedAttitude {
  AttitudeStatus status = AttitudeStatus::kNone;
  AttitudeEstimate<T> attitude;    ///< the filter's, or of the codes; observable 0: none
  Vec3<T> slow = Vec3<T>::Zero();  ///< rate, or bias of the gyros [rad/s]
  EpochAttitude<T, M> epoch;       ///< this epoch alone
  Innovation<T> innovation;
  bool refused = false;  ///< a fix that the filter did not believe
  bool started = false;  ///< the filter started here, the first time or again
};

template <class T, int M, int N, bool Coloured = false>
class AttitudeTracker {
 public:
  using Filter = MultiplicativeEkf<T, M, Coloured>;
  using Sets = std::array<SingleDifferences<T, N>, static_cast<std::size_t>(M)>;
  static constexpr int kPatience = 3;

  AttitudeTracker(const RigidVectors<T, M>& figure, const TrackerOptions<T>& options)
      : figure_(figure),
        options_(options),
        resolver_(figure, options.fix),
        filter_(AttitudeEstimate<T>(), T(0), T(0), options.noise) {}

  /// Gyros, the mean over @p t [s]: then the time of add() is that which is left. @param w_in_n as of the filter
  Status turn(const T& t, const Vec3<T>& w_ib_b, const Vec3<T>& w_in_n) {
    driven_ = true;
    if (!live_) return Status::kOk;
    last_w_ = w_ib_b;
    last_w_in_ = w_in_n;
    const Status status = filter_.predict(t, w_ib_b, w_in_n);
    if (status == Status::kOk) alone_ += t;
    return status;
  }

  /// An epoch, @p t [s] after the last epoch or, with gyros, the last turn(): over that time their last rate stays.
  TrackedAttitude<T, M> add(const T& t, const Sets& sets) {
    TrackedAttitude<T, M> out;
    if (live_ && (driven_ ? filter_.predict(t, last_w_, last_w_in_) : filter_.predict(t)) != Status::kOk) live_ = false;
    alone_ += t;
    out.epoch = resolver_.resolve(sets);
    if (out.epoch.status != AttitudeStatus::kFixed && live_ && slaves_within(options_.held_sigma) == M) {
      const auto led = resolver_.resolve(sets, predicted());
      if (led.status == AttitudeStatus::kHeld) out.epoch = led;
    }
    const bool has = out.epoch.status == AttitudeStatus::kFixed || out.epoch.status == AttitudeStatus::kHeld;
    if (has && live_) {
      out.refused = filter_.update(out.epoch.seen, figure_, options_.gate, &out.innovation) != Status::kOk;
      refusals_ = out.refused ? refusals_ + 1 : 0;
    }
    if (live_ && (!has || out.refused)) {
      VectorObservation<T, M> nothing;
      nothing.rank = 0;
      (void)filter_.update(nothing, figure_);  // a record all the same
    }
    if (has && out.epoch.attitude.observable >= 2 && out.epoch.status == AttitudeStatus::kFixed &&
        (!Coloured || out.epoch.seen.rank == 3 * M) && (!live_ || refusals_ >= kPatience)) {
      restarts_ += live_ ? 1 : 0;
      filter_ =
          Filter(out.epoch.attitude, options_.free_sigma, options_.slow_sigma, options_.noise, out.epoch.seen, figure_);
      live_ = out.started = true;
      out.refused = false;
      refusals_ = 0;
    }
    if (live_ && has && out.epoch.attitude.observable == 2)
      filter_.tether(out.epoch.attitude.free_axis, options_.free_sigma, options_.slow_sigma);
    if (has && !out.refused) alone_ = T(0);
    if (live_ && !(alone_ <= options_.longest && slaves_within(options_.lost_sigma) > 0)) live_ = false;
    if (!live_) {
      out.status = out.epoch.status;
      out.attitude = out.epoch.attitude;
      return out;
    }
    out.status = has && !out.refused ? out.epoch.status : AttitudeStatus::kPredicted;
    out.attitude = estimate();
    out.slow = filter_.state().w;
    return out;
  }

  /// What is predicted is worth nothing, gyros were silent: the next fix starts anew.
  void lose() { live_ = false; }

  [[nodiscard]] bool live() const { return live_; }
  [[nodiscard]] const Filter& filter() const { return filter_; }
  [[nodiscard]] int restarts() const { return restarts_; }

 private:
  /// Slaves whose direction is predicted to @p sigma [rad].
  [[nodiscard]] int slaves_within(const T& sigma) const {
    const auto& state = filter_.state();
    const Mat3<T> P = state.P.template topLeftCorner<3, 3>();
    int count = 0;
    for (int k = 0; k < M; ++k) {
      const Mat3<T> H = skew<T>(figure_.b().col(k)) / figure_.b().col(k).norm();
      count += congruence(H, P).trace() < sigma * sigma ? 1 : 0;
    }
    return count;
  }

  /// Eq. (1).
  [[nodiscard]] std::array<VectorObservation<T, 1>, static_cast<std::size_t>(M)> predicted() const {
    std::array<VectorObservation<T, 1>, static_cast<std::size_t>(M)> prior;
    const auto& state = filter_.state();
    const Mat3<T> C = state.q_nb.toRotationMatrix();
    const Mat3<T> P = state.P.template topLeftCorner<3, 3>();
    for (std::size_t k = 0; k < static_cast<std::size_t>(M); ++k) {
      const Vec3<T> b = figure_.b().col(static_cast<int>(k));
      const Mat3<T> H = -C * skew(b);
      const Vec3<T> u = C * b.normalized();
      // a length that is certain still has a figure: a tenth of a millimetre
      const T s = figure_.sigma() > T(1e-4) ? figure_.sigma() : T(1e-4);
      Mat3<T> Q = H * P * H.transpose() + s * s * u * u.transpose();
      if constexpr (Coloured) {
        const int at = 6 + 3 * static_cast<int>(k);
        const Mat3<T> cross = H * state.P.template block<3, 3>(0, at);
        Q += cross + cross.transpose() + state.P.template block<3, 3>(at, at);
      }
      prior[k].value = C * b + state.m.template segment<3>(3 * static_cast<int>(k));
      prior[k].information = Q.inverse();
    }
    return prior;
  }

  /// The filter's; an axis that is less sure than lost_sigma is free.
  [[nodiscard]] AttitudeEstimate<T> estimate() const {
    AttitudeEstimate<T> estimate;
    estimate.q_nb = filter_.state().q_nb;
    estimate.covariance = filter_.state().P.template topLeftCorner<3, 3>();
    estimate.information = estimate.covariance.inverse();
    const Eigen::SelfAdjointEigenSolver<Mat3<T>> parts(estimate.covariance);
    // without gyros, what the smoothness of the rates tells of the open axis is not worth a claim
    const bool free =
        (figure_.rank() < 3 && !driven_) || !(parts.eigenvalues()(2) < options_.lost_sigma * options_.lost_sigma);
    estimate.observable = free ? 2 : 3;
    if (free)
      estimate.free_axis =
          figure_.rank() < 3 ? Vec3<T>(figure_.b().col(0).normalized()) : Vec3<T>(parts.eigenvectors().col(2));
    return estimate;
  }

  RigidVectors<T, M> figure_;
  TrackerOptions<T> options_;
  ArrayResolver<T, M, N> resolver_;
  Filter filter_;
  bool live_ = false;
  int refusals_ = 0;
  int restarts_ = 0;
  T alone_ = T(0);
  bool driven_ = false;
  Vec3<T> last_w_ = Vec3<T>::Zero();
  Vec3<T> last_w_in_ = Vec3<T>::Zero();
};

}  // namespace trunnion
