// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "engine.hpp"

#include <cmath>
#include <deque>
#include <optional>

#include "trunnion/attitude/fixed_interval_smoother.hpp"
#include "trunnion/attitude/quaternion_ekf.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::app {
namespace {

constexpr double kLongestGap = 3600.0;  // s between two epochs, beyond which a filter starts anew

template <int M>
class EngineOf : public Engine {
 public:
  using Sets = std::array<SingleDifferences<double, kMostSignals>, static_cast<std::size_t>(M)>;

  explicit EngineOf(const EngineOptions& options) : options_(options), figure_(figure(options)) {}

  Solution add(const ArrayEpoch& epoch) final {
    Solution solution;
    solution.utime = epoch.utime;
    solution.time = epoch.time;
    Sets sets;
    if (epoch.heard[0]) {
      const auto place = antenna_place(epoch.antenna[0], place_.r);
      if (place.ok()) {
        place_ = place.value();
        has_place_ = true;
      } else {
        place_.v.setZero();
      }
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(M); ++k) {
      solution.silent = solution.silent || !epoch.heard[0] || !epoch.heard[k + 1];
      if (!has_place_ || !epoch.heard[0] || !epoch.heard[k + 1]) continue;
      const auto set = single_differences<double>(epoch.antenna[0], epoch.antenna[k + 1], place_, options_.noise);
      if (set.ok()) sets[k] = set.value();
    }
    const double t = last_.week == 0 ? 0.0 : epoch.time - last_;
    last_ = epoch.time;
    const EpochAttitude<double, M> alone = resolve(t, sets, solution);
    solution.reason = alone.reason;
    solution.satellites = alone.satellites;
    solution.excluded = alone.excluded;
    solution.misfit = alone.misfit;
    solution.degrees = alone.degrees;
    solution.gap = alone.gap;
    if (alone.status >= AttitudeStatus::kHeld) {
      for (int k = 0; k < M; ++k) {
        if (!(alone.seen.information.template block<3, 3>(3 * k, 3 * k).trace() > 0.0)) continue;
        solution.has_baseline[static_cast<std::size_t>(k)] = true;
        solution.baseline.col(k) = alone.seen.value.template segment<3>(3 * k);
      }
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(M); ++k) solution.other_length[k] = alone.other_length[k];
    return solution;
  }

  void gyro(std::int64_t, double, const Vec3<double>&) override {}
  void smooth(std::vector<Solution>&) override { throw Error(ExitCode::kUsage, "only the mekf is smoothed"); }
  [[nodiscard]] int restarts() const override { return 0; }

 protected:
  static RigidVectors<double, M> figure(const EngineOptions& options) {
    Eigen::Matrix<double, 3, M> b;
    for (int k = 0; k < M; ++k) b.col(k) = options.slaves[static_cast<std::size_t>(k)];
    return RigidVectors<double, M>(b, options.figure_sigma);
  }
  /// The epoch @p t [s] after the last one; its status and attitude to @p solution.
  virtual EpochAttitude<double, M> resolve(double t, const Sets& sets, Solution& solution) = 0;

  EngineOptions options_;
  RigidVectors<double, M> figure_;
  AntennaPlace place_;
  bool has_place_ = false;
  GpsTime last_;
};

/// Each epoch by itself.
template <int M>
class UnfilteredEngine : public EngineOf<M> {
 public:
  explicit UnfilteredEngine(const EngineOptions& options)
      : EngineOf<M>(options), resolver_(this->figure_, options.tracker.fix) {}

 protected:
  EpochAttitude<double, M> resolve(double, const typename EngineOf<M>::Sets& sets, Solution& solution) override {
    EpochAttitude<double, M> alone = resolver_.resolve(sets);
    solution.status = alone.status;
    solution.attitude = alone.attitude;
    return alone;
  }

 private:
  ArrayResolver<double, M, kMostSignals> resolver_;
};

template <int M, bool Coloured>
class TrackedEngine final : public EngineOf<M> {
 public:
  using Tracker = AttitudeTracker<double, M, kMostSignals, Coloured>;
  using Base = EngineOf<M>;
  explicit TrackedEngine(const EngineOptions& options)
      : Base(options), tracker_(this->figure_, options.tracker), keeps_(options.keep_records) {}

  void gyro(std::int64_t utime, double t, const Vec3<double>& w_ib_b) override {
    constexpr std::size_t kMostWaiting = 1000000;
    if (waiting_.size() < kMostWaiting) waiting_.push_back({utime, t, w_ib_b});
  }

  void smooth(std::vector<Solution>& solutions) override {
    for (std::size_t from = 0; from < solutions.size();) {
      std::size_t to = from + 1;
      if (!live_[from]) {
        ++from;
        continue;
      }
      while (to < solutions.size() && live_[to] && !solutions[to].started) ++to;
      if (trunnion::smooth(&records_[from], static_cast<long>(to - from)) != Status::kOk)
        throw Error(ExitCode::kNumerics, "the smoother found a singular covariance");
      for (std::size_t i = from; i < to; ++i) {
        const auto& state = records_[i].after;
        solutions[i].attitude.q_nb = state.q_nb;
        solutions[i].attitude.covariance = state.P.template topLeftCorner<3, 3>();
        solutions[i].attitude.information = solutions[i].attitude.covariance.inverse();
        if (solutions[i].has_rate) solutions[i].rate = state.w;
      }
      from = to;
    }
  }

  [[nodiscard]] int restarts() const override { return tracker_.restarts(); }

 private:
  EpochAttitude<double, M> resolve(double t, const typename Base::Sets& sets, Solution& solution) override {
    if (this->options_.driven) turn(solution.utime, t);
    const auto out = tracker_.add(this->options_.driven ? 0.0 : std::min(t, kLongestGap), sets);
    solution.status = out.status;
    solution.attitude = out.attitude;
    solution.rate = out.slow;
    solution.has_rate = !this->options_.driven && tracker_.live() && !out.started;
    solution.started = out.started;
    solution.refused = out.refused;
    if (keeps_) {
      records_.push_back(tracker_.filter().record());
      live_.push_back(tracker_.live());
    }
    return out.epoch;
  }

  /// By the gyros up to @p utime, @p t [s] after the last epoch; of a sample that reaches beyond, its share.
  void turn(std::int64_t utime, double t) {
    constexpr double kMostMissing = 0.5;  // s of an epoch that no gyro saw
    const Vec3<double> earth = this->has_place_
                                   ? Vec3<double>(north_from_earth(this->place_.r) * Vec3<double>(0.0, 0.0, kEarthRate))
                                   : Vec3<double>(Vec3<double>::Zero());
    double seen = 0.0;
    while (!waiting_.empty()) {
      Sample& sample = waiting_.front();
      const double beyond = 1e-6 * static_cast<double>(sample.utime - utime);
      const double share = std::min(sample.t, sample.t - beyond);
      if (share <= 0.0) break;
      (void)tracker_.turn(share, sample.w, earth);
      seen += share;
      last_rate_ = sample.w;
      if (beyond > 0.0) {
        sample.t -= share;
        break;
      }
      waiting_.pop_front();
    }
    const double missing = t - seen;
    if (missing > kMostMissing)
      tracker_.lose();
    else if (missing > 0.0)
      (void)tracker_.turn(missing, last_rate_, earth);
  }

  struct Sample {
    std::int64_t utime;
    double t;
    Vec3<double> w;
  };

  Tracker tracker_;
  bool keeps_;
  std::deque<Sample> waiting_;
  Vec3<double> last_rate_ = Vec3<double>::Zero();
  std::vector<typename Tracker::Filter::Record> records_;
  std::vector<bool> live_;
};

/// The paper's filter on the quaternion of its equation (6); where an epoch is not fixed it predicts.
class PaperEngine final : public UnfilteredEngine<2> {
 public:
  using UnfilteredEngine<2>::UnfilteredEngine;

 private:
  EpochAttitude<double, 2> resolve(double t, const Sets& sets, Solution& solution) override {
    EpochAttitude<double, 2> alone = UnfilteredEngine<2>::resolve(t, sets, solution);
    if (filter_ && filter_->predict(std::min(t, kLongestGap)) != Status::kOk) filter_.reset();
    const bool whole = alone.status == AttitudeStatus::kFixed && alone.attitude.observable == 3;
    if (whole) {
      const auto C =
          attitude_by_equation_six<double>(alone.seen.value.head<3>(), alone.seen.value.tail<3>(), figure_.b());
      const Quaternion<double> computed = Quaternion<double>(C.value()).normalized();
      // r: a quaternion's element is half an angle
      const double r = 0.25 * alone.attitude.covariance.trace() / 3.0;
      if (!filter_) {
        filter_.emplace(computed, 0.0, options_.tracker.noise.walk, r, options_.tracker.slow_sigma);
        solution.started = true;
      } else {
        (void)filter_->update(computed);
      }
      alone_for_ = 0.0;
    } else {
      alone_for_ += t;
    }
    if (filter_ && alone_for_ > options_.tracker.longest) filter_.reset();
    if (!filter_) return alone;
    solution.status = whole ? AttitudeStatus::kFixed : AttitudeStatus::kPredicted;
    const Quaternion<double> q = filter_->q_nb();
    solution.attitude.q_nb = q;
    Eigen::Matrix<double, 4, 3> Xi;
    Xi << -q.x(), -q.y(), -q.z(), q.w(), -q.z(), q.y(), q.z(), q.w(), -q.x(), -q.y(), q.x(), q.w();
    solution.attitude.covariance = 4.0 * Xi.transpose() * filter_->covariance().topLeftCorner<4, 4>() * Xi;
    solution.attitude.information = solution.attitude.covariance.inverse();
    solution.attitude.observable = 3;
    solution.rate = filter_->rate();
    solution.has_rate = true;
    return alone;
  }

  std::optional<QuaternionEkf<double>> filter_;
  double alone_for_ = 0.0;
};

template <int M>
std::unique_ptr<Engine> make_of(const EngineOptions& options) {
  if (options.filter == AttitudeFilter::kNone) return std::make_unique<UnfilteredEngine<M>>(options);
  if (options.tracker.noise.coloured > 0.0) return std::make_unique<TrackedEngine<M, true>>(options);
  return std::make_unique<TrackedEngine<M, false>>(options);
}

}  // namespace

std::unique_ptr<Engine> Engine::make(const EngineOptions& options) {
  if (options.slaves.empty() || options.slaves.size() > 2)
    throw Error(ExitCode::kUsage, "a master and one or two slaves make an array, not " +
                                      std::to_string(options.slaves.size()) + " slaves");
  for (const Vec3<double>& slave : options.slaves) {
    if (!slave.allFinite() || !(slave.norm() > 0.01) || !(slave.norm() <= 1000.0))
      throw Error(ExitCode::kUsage, "an antenna is 1 cm to 1 km from the master");
  }
  if (options.slaves.size() == 1) {
    if (options.filter == AttitudeFilter::kPaper)
      throw Error(ExitCode::kUsage, "the paper's filter needs a whole quaternion: three antennas");
    return make_of<1>(options);
  }
  if (options.filter == AttitudeFilter::kPaper) {
    if (options.slaves[0].cross(options.slaves[1]).norm() < 1e-3 * options.slaves[0].norm() * options.slaves[1].norm())
      throw Error(ExitCode::kUsage, "the paper's filter needs three antennas that are not in one line");
    return std::make_unique<PaperEngine>(options);
  }
  return make_of<2>(options);
}

}  // namespace trunnion::app
