// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "../imu_calibrate/result.hpp"
#include "../terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::app {
namespace {

constexpr std::size_t kPlotted = 600;  // points, of half a second
constexpr double kPlotStep = 0.5;      // s
constexpr std::size_t kNotices = 200;
constexpr double kMisfit = 5.0;  // reduced chi-square of the last seconds
constexpr int kMisfits = 3;      // linearisations in a row

std::string angle_text(double radians) { return figure(radians / kRadPerDeg, 3); }

std::string text_of(const PlanStep& step) {
  if (step.kind == PlanStep::Kind::kRest)
    return "rest with the pitch between " + angle_text(step.pitch_from) + " and " + angle_text(step.pitch_to) + " deg";
  return "turn the azimuth at " + std::string(step.rate > 0.0 ? "+" : "") + angle_text(step.rate) +
         " deg/s, swinging the pitch";
}

}  // namespace

void add_notice(SharedState& state, const std::string& text) {
  static const auto kStart = std::chrono::steady_clock::now();
  state.change([&](LiveState& s) {
    const double t = std::chrono::duration<double>(std::chrono::steady_clock::now() - kStart).count();
    s.notices.push_back({t, s.notices.empty() ? 1 : s.notices.back().serial + 1, text});
    if (s.notices.size() > kNotices) s.notices.pop_front();
  });
}

std::vector<LiveState::Entry> entries_of(const io::RunFile& run, const std::vector<calibration::Parameter>& parameters,
                                         const Eigen::VectorXd& x, const Eigen::VectorXd& sigma) {
  std::vector<LiveState::Entry> entries;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const calibration::Parameter& p = parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double stated = run.limits[static_cast<std::size_t>(p.kind)].sigma;
    const bool judged = stated >= 0.0 && calibration::has_verdict(p);
    const double limit = judged ? stated : p.refuse_above * p.in_unit;
    entries.push_back({p.name, p.unit, x(at) * p.in_unit, sigma(at) * p.in_unit, limit});
  }
  return entries;
}

int count_within(const std::vector<LiveState::Entry>& entries) {
  return static_cast<int>(std::count_if(entries.begin(), entries.end(),
                                        [](const LiveState::Entry& entry) { return entry.sigma <= entry.limit; }));
}

Estimator::Estimator(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& mounts,
                     SharedState& state)
    : run_(run),
      rig_(rig),
      mounts_(mounts),
      state_(state),
      solve_(rig.rig, run.site, table_options(run, mounts)),
      thread_([this] { work(); }) {}

Estimator::~Estimator() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Estimator::push(Job job) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

void Estimator::begin(int recording, int mount) { push({Job::Kind::kBegin, recording, mount, {}}); }
void Estimator::add(calibration::CompressedRecording part) { push({Job::Kind::kAdd, 0, 0, std::move(part)}); }
void Estimator::abandon() { push({Job::Kind::kAbandon, 0, 0, {}}); }

bool Estimator::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return working_ || !jobs_.empty();
}

void Estimator::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return end_ || !jobs_.empty(); });
    if (end_) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    working_ = true;
    lock.unlock();
    try {
      if (!failed_) take(job);
    } catch (const std::exception& e) {  // the estimate leads, it decides nothing: the recording goes on without it
      failed_ = true;
      notice(std::string("no more estimates: ") + e.what());
    }
    lock.lock();
    working_ = false;
    changed_.notify_all();
  }
}

void Estimator::take(Job& job) {
  if (job.kind != Job::Kind::kAdd) {
    if (job.kind == Job::Kind::kBegin) {
      recording_ = job.recording;
      mount_ = job.mount;
      solve_.begin(mount_);
    } else {
      solve_.abandon();
      solve_.begin(mount_);
    }
    const AxisLimits& pitch = rig_.limits[kPitch];
    plan_ = pitch.endless() ? TablePlan(run_.plan, 0.0, 0.0) : TablePlan(run_.plan, pitch.lowest, pitch.highest);
    watch_.emplace(rig_.rig, run_.site, mount_);
    ahead_.clear();
    said_mount_ = said_moved_ = false;
    misfits_ = 0;
    state_.change([](LiveState& s) { s.plot.clear(); });
    show_plan();
    return;
  }
  follow(job.part);
  try {
    solve_.update(std::move(job.part));
    said_.clear();
    show_estimate();
  } catch (const Error& e) {
    // what the data cannot be yet or ever: it is said once, and looked at again with more of them
    if (said_ != e.what()) notice(e.what());
    said_ = e.what();
  }
  show_plan();
}

void Estimator::notice(const std::string& text) { add_notice(state_, text); }

/// Plan, mount and plot.
void Estimator::follow(const calibration::CompressedRecording& part) {
  ahead_.insert(ahead_.end(), part.windows.begin(), part.windows.end());
  std::vector<LiveState::Point> points;
  std::size_t done = 0;
  double last_point = -1.0;
  state_.change([&](LiveState& s) { last_point = s.plot.empty() ? -1.0 : s.plot.back().t; });
  for (; done < ahead_.size(); ++done) {
    const ObservationWindow& window = ahead_[done];
    if (window.t + window.half_width > part.course.end()) break;
    if (!part.course.covers(window.t - window.half_width, window.t + window.half_width)) continue;
    const auto reading = part.course.at(window.t);
    plan_.see(2.0 * window.half_width, reading[0].rate, reading[1].angle, reading[1].rate);
    watch_->see(window, reading);
    if (window.t < last_point + kPlotStep) continue;
    last_point = window.t;
    LiveState::Point point;
    point.t = window.t;
    point.azimuth_rate = reading[0].rate / kRadPerDeg;
    point.pitch = reading[1].angle / kRadPerDeg;
    for (int i = 0; i < 3; ++i) point.gyro[i] = window.mean.w(i) / kRadPerDeg;
    points.push_back(point);
  }
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(done));
  state_.change([&](LiveState& s) {
    s.plot.insert(s.plot.end(), points.begin(), points.end());
    while (s.plot.size() > kPlotted) s.plot.pop_front();
  });
  if (said_mount_) return;
  const std::string& mount = mounts_[static_cast<std::size_t>(mount_)];
  if (watch_->verdict() == calibration::MountWatch::Verdict::kOther) {
    notice("wrong mount: the unit feels as in " + mounts_[static_cast<std::size_t>(watch_->best())] + ", not as in " +
           mount);
    said_mount_ = true;
  } else if (watch_->verdict() == calibration::MountWatch::Verdict::kNone) {
    notice("the unit feels as in no mount of the rig: look at " + mount +
           " in the drawing, the axes of the unit, the zeros, signs and units of the encoders");
    said_mount_ = true;
  }
}

void Estimator::show_estimate() {
  const calibration::RunningEstimate& estimate = solve_.estimate();
  if (estimate.parameters.empty()) return;
  std::vector<LiveState::Entry> entries = entries_of(run_, estimate.parameters, estimate.x, estimate.sigma);
  const int within = count_within(entries);
  state_.change([&](LiveState& s) {
    s.entries = std::move(entries);
    s.within = within;
    s.chi_square = estimate.chi_square;
  });
  // one misfit is news; one that stays after the estimate has learnt from it is a fault
  if (estimate.linearisations != linearisations_) misfits_ = estimate.chi_square > kMisfit ? misfits_ + 1 : 0;
  linearisations_ = estimate.linearisations;
  if (said_moved_ || misfits_ < kMisfits) return;
  said_moved_ = true;
  notice("the last seconds do not fit what was before (reduced chi-square " + figure(estimate.chi_square, 2) +
         "): was the unit moved in " + mounts_[static_cast<std::size_t>(mount_)] +
         ", the table pushed, or is a channel wrong?");
}

void Estimator::show_plan() {
  const int next = plan_.next();
  state_.change([&](LiveState& s) {
    s.steps.clear();
    for (int i = 0; i < plan_.size(); ++i) s.steps.push_back({text_of(plan_[i]), plan_[i].seen, plan_[i].seconds});
    if (s.recording != recording_) return;  // the operator is on already
    // sigmas can be enough when every mount is in them
    const bool stated = std::any_of(run_.limits.begin(), run_.limits.end(),
                                    [](const io::EntryVerdict& limit) { return limit.sigma >= 0.0; });
    const bool certain = stated && !s.entries.empty() && s.within == static_cast<int>(s.entries.size()) &&
                         solve_.estimate().recordings == static_cast<std::size_t>(s.recordings);
    const bool last = s.recording == s.recordings;
    s.enough = certain || (next < 0 && !(stated && last));
    if (s.phase != Phase::kRecording) return;
    if (s.enough) {
      s.guidance = "enough of " + s.mount + (s.unattended ? "" : ": press Enter to end it");
    } else if (next < 0) {
      s.guidance = "the plan is done, and " + std::to_string(static_cast<int>(s.entries.size()) - s.within) +
                   " sigmas are above their limits: go on turning, or press Enter";
    } else {
      const PlanStep& step = plan_[next];
      s.guidance = text_of(step) + ": " + figure(std::floor(step.seen), 4) + " of " + figure(step.seconds, 4) + " s";
    }
  });
}

}  // namespace trunnion::app
