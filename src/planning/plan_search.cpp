// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/planning/plan_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "trunnion/calibration/share_out.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/turntable/two_axis.hpp"

namespace trunnion::planning {
namespace {

using calibration::Parameter;
using calibration::PlannedMotion;
using calibration::Predictor;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPower = 8.0;      // of eq. (1)
constexpr double kRestTime = 10.0;  // s, of a block
constexpr double kTurnTime = 20.0;
constexpr double kSwingShare = 0.98;  // of the room that the joint leaves
constexpr double kForgotten = 4.0;    // correlation times
constexpr int kMostSweeps = 2;
constexpr int kMostLonger = 12;    // times that a transition is made longer
constexpr double kWorthIt = 1e-3;  // relative decrease of the cost

/// What a mount goes through for some seconds, beginning and ending at a stand.
struct Block {
  enum class Kind { kRest, kTurn, kSwing, kTurnAndSwing };
  Kind kind = Kind::kRest;
  double pitch = 0.0;      // rad
  double rate = 0.0;       // rad/s, of the azimuth, both ways
  double amplitude = 0.0;  // rad, of the pitch
  double frequency = 0.0;  // Hz
};

using Blocks = std::vector<Block>;

/// Everything that a block may be on this bench.
Blocks candidates(const Bench& bench) {
  const AxisLimits& pitch = bench.limits[kPitch];
  const double lowest = pitch.endless() ? -kPi : pitch.lowest;
  const double highest = pitch.endless() ? kPi : pitch.highest;
  const double middle = 0.5 * (lowest + highest);
  const double reach = 0.5 * (highest - lowest);
  Blocks all;
  const std::vector<double> shares = pitch.endless()
                                         ? std::vector<double>{-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0}
                                         : std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0};
  for (const double share : shares) all.push_back({Block::Kind::kRest, middle + share * reach, 0.0, 0.0, 0.0});
  const double amplitude = kSwingShare * std::min(reach, 0.5 * kPi);
  // the fastest swings of that amplitude that the joint takes, and slower ones
  const double fastest = std::min(pitch.rate / amplitude, std::sqrt(pitch.acceleration / amplitude)) / (2.0 * kPi);
  const double rated = bench.largest_rate / amplitude / (2.0 * kPi);
  const std::array<double, 2> frequency = {0.8 * std::min(fastest, 0.7 * rated), 0.3 * std::min(fastest, 0.7 * rated)};
  for (const double f : frequency) all.push_back({Block::Kind::kSwing, middle, 0.0, amplitude, f});
  for (const double share : {1.0, 0.6, 0.3}) {
    const double rate = share * std::min(bench.largest_rate, bench.limits[kAzimuth].rate);
    for (const double at : {-1.0, 0.0, 1.0})
      all.push_back({Block::Kind::kTurn, middle + (pitch.endless() ? 0.5 : 1.0) * at * reach, rate, 0.0, 0.0});
    // both axes together stay below what the unit takes
    const double together = 0.7 * rate;
    for (const double f : frequency) all.push_back({Block::Kind::kTurnAndSwing, middle, together, amplitude, f});
  }
  return all;
}

double seconds_of(const Block& block) { return block.kind == Block::Kind::kRest ? kRestTime : kTurnTime; }

std::string words(const Block& block) {
  char text[160];
  const double pitch = block.pitch / kRadPerDeg;
  const double rate = block.rate / kRadPerDeg;
  switch (block.kind) {
    case Block::Kind::kRest:
      std::snprintf(text, sizeof text, "a rest at a pitch of %.0f deg", pitch);
      break;
    case Block::Kind::kTurn:
      std::snprintf(text, sizeof text, "turns of the azimuth at %.0f deg/s, both ways, at a pitch of %.0f deg", rate,
                    pitch);
      break;
    case Block::Kind::kSwing:
      std::snprintf(text, sizeof text, "swings of the pitch by %.0f deg at %.2f Hz", block.amplitude / kRadPerDeg,
                    block.frequency);
      break;
    case Block::Kind::kTurnAndSwing:
      std::snprintf(text, sizeof text,
                    "turns of the azimuth at %.0f deg/s, both ways, with swings of the pitch by %.0f deg at %.2f Hz",
                    rate, block.amplitude / kRadPerDeg, block.frequency);
  }
  return text;
}

bool within(const simulation::AxisPeaks& peaks, const AxisLimits& limit) {
  return peaks.rate <= limit.rate && peaks.acceleration <= limit.acceleration;
}

/// Where the table stands.
using Stand = std::array<double, 2>;

/// Transitions as the joints allow; hundredths of seconds are enough for a controller.
void append(const Bench& bench, const Block& block, Stand& angle, TableSequence& moves) {
  const auto add = [&](double direction, double seconds) {
    TableMove move;
    const double rate = direction * block.rate;
    move.axis[kAzimuth] = {angle[kAzimuth], rate, 0.0, 0.0};
    move.axis[kPitch] = {block.pitch, 0.0, block.amplitude, block.frequency};
    const double swing_rate = block.amplitude * 2.0 * kPi * block.frequency;
    const double transition =
        std::max({simulation::transition_for(0.0, rate, bench.limits[kAzimuth]), block.amplitude > 0.0 ? 1.0 : 0.0,
                  simulation::transition_for(block.pitch - angle[kPitch], swing_rate, bench.limits[kPitch])});
    // a swing that fades in while the axis steps asks for more than each alone
    move.transition = transition;
    for (int longer = 0; longer < kMostLonger; ++longer) {
      move.transition = std::ceil(100.0 * move.transition) / 100.0;
      move.duration = std::max(seconds, 2.0 * move.transition + 1.0);
      TableMove stand{0.0, 1.0, {}};
      for (std::size_t a = 0; a < 2; ++a) stand.axis[a].angle = angle[a];
      const simulation::TableMotion motion = simulation::motion_of({stand, move}, bench.limits);
      if (within(simulation::peaks_of(motion.azimuth, 0.0, move), bench.limits[kAzimuth]) &&
          within(simulation::peaks_of(motion.pitch, 0.0, move), bench.limits[kPitch]))
        break;
      move.transition *= 1.25;
    }
    angle[kAzimuth] = std::remainder(angle[kAzimuth] + rate * (move.duration - move.transition), 2.0 * kPi);
    angle[kPitch] = block.pitch;
    moves.push_back(move);
  };
  if (block.rate > 0.0) {
    add(+1.0, 0.5 * seconds_of(block));
    add(-1.0, 0.5 * seconds_of(block));
  } else {
    add(0.0, seconds_of(block));
  }
}

TableSequence sequence_of(const Bench& bench, const Blocks& blocks) {
  Stand angle = {0.0, blocks.front().pitch};
  TableSequence moves = {
      {0.0, 1.0, {AxisCommand{angle[kAzimuth], 0.0, 0.0, 0.0}, AxisCommand{angle[kPitch], 0.0, 0.0, 0.0}}}};
  for (const Block& block : blocks) append(bench, block, angle, moves);
  return moves;
}

Stand end_of(const TableSequence& sequence) {
  const TableMove& last = sequence.back();
  Stand angle{};
  for (std::size_t a = 0; a < 2; ++a)
    angle[a] = last.axis[a].angle + last.axis[a].rate * std::max(0.0, last.duration - last.transition);
  return angle;
}

PlannedMotion motion_of(const TableSequence& sequence, const TableLimits& limits) {
  const simulation::TableMotion motion = simulation::motion_of(sequence, limits);
  return {[motion](double t) {
            return std::array<double, 2>{motion.azimuth.angle(t), motion.pitch.angle(t)};
          },
          motion.duration, 0.0};
}

/// What is left of a motion from @p from [s] on.
PlannedMotion after(const PlannedMotion& motion, double from) {
  return {[motion, from](double t) { return motion.angles(from + t); }, motion.duration - from, from};
}

double largest_rate_of(const TableSequence& sequence) {
  double largest = 1e-3;
  for (const TableMove& move : sequence) {
    double square = 0.0;
    for (const AxisCommand& axis : move.axis) {
      const double rate = std::abs(axis.rate) + axis.amplitude * 2.0 * kPi * axis.frequency;
      square += rate * rate;
    }
    largest = std::max(largest, std::sqrt(square));
  }
  return largest;
}

Predictor predictor_of(const Bench& bench, double largest_rate) {
  calibration::PredictionOptions options = bench.prediction;
  options.largest_rate = largest_rate;
  return Predictor(*bench.rig, bench.site, bench.mounts, options);
}

/// Wanted sigma of an entry in SI; infinite where none is asked.
double wanted_of(const Parameter& p, const WantedSigmas& wanted) {
  if (!calibration::has_verdict(p)) return kInfinity;
  return wanted[static_cast<std::size_t>(p.kind)] / p.in_unit;
}

double worst_of(const Eigen::VectorXd& sigma, const Eigen::VectorXd& wanted) {
  double worst = 0.0;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (std::isfinite(wanted(i))) worst = std::max(worst, sigma(i) / wanted(i));
  }
  return worst;
}

/// Eq. (1).
double cost_of(const Eigen::VectorXd& sigma, const Eigen::VectorXd& wanted) {
  // about the worst, so that no power leaves what a double holds
  const double worst = worst_of(sigma, wanted);
  if (!(worst > 0.0) || !std::isfinite(worst)) return worst;
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (!std::isfinite(wanted(i))) continue;
    sum += std::pow(sigma(i) / wanted(i) / worst, kPower);
    ++count;
  }
  return worst * std::pow(sum / count, 1.0 / kPower);
}

/// One change of the blocks of one recording.
struct Trial {
  Trial(std::size_t r, Blocks b) : recording(r), blocks(std::move(b)) {}
  std::size_t recording;
  Blocks blocks;
  double seconds = 0.0;  // of the recording then
  Eigen::MatrixXd information;
  double cost = kInfinity;
};

class Search {
 public:
  Search(const Bench& bench, const WantedSigmas& wanted)
      : bench_(bench), predictor_(predictor_of(bench, bench.largest_rate)), candidates_(candidates(bench)) {
    const std::vector<Parameter>& parameters = predictor_.parameters();
    wanted_.resize(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i)
      wanted_(static_cast<Eigen::Index>(i)) = wanted_of(parameters[i], wanted);
  }

  /// What every mount needs before any judgement: the ends of the pitch at rest, and a turn with swings.
  void begin() {
    const std::size_t recordings = bench_.mounts.size();
    blocks_.assign(recordings, Blocks());
    information_.assign(recordings, Eigen::MatrixXd());
    seconds_.assign(recordings, 0.0);
    Block highest = candidates_.front();
    for (const Block& block : candidates_) {
      if (block.kind == Block::Kind::kRest && block.pitch > highest.pitch) highest = block;
    }
    const auto turn = std::find_if(candidates_.begin(), candidates_.end(),
                                   [](const Block& block) { return block.kind == Block::Kind::kTurnAndSwing; });
    for (std::size_t r = 0; r < recordings; ++r) {
      Trial trial(r, {candidates_.front(), highest, *turn});
      evaluate(trial);
      take(trial);
    }
  }

  /// The best block more that ends within @p room [s] of table time. @return whether there is one
  bool grow(double room) {
    std::vector<Trial> trials;
    for (std::size_t r = 0; r < blocks_.size(); ++r) {
      for (const Block& block : candidates_) {
        if (seconds_of(block) > room) continue;
        Trial trial(r, blocks_[r]);
        trial.blocks.push_back(block);
        trials.push_back(std::move(trial));
      }
    }
    evaluate(trials);
    const Trial* best = nullptr;
    double fastest = 0.0;
    const double now = cost();
    for (const Trial& trial : trials) {
      const double more = trial.seconds - seconds_[trial.recording];
      const double speed = std::log(now / trial.cost) / more;
      if (more > room || !(speed > fastest)) continue;
      fastest = speed;
      best = &trial;
    }
    if (best == nullptr) return false;
    take(*best);
    return true;
  }

  /// Each block for the best of all. @return whether any was
  bool exchange(double longest, const std::function<void()>& progress) {
    bool changed = false;
    for (std::size_t r = 0; r < blocks_.size(); ++r) {
      for (std::size_t b = 0; b < blocks_[r].size(); ++b) {
        std::vector<Trial> trials;
        for (const Block& block : candidates_) {
          Trial trial(r, blocks_[r]);
          trial.blocks[b] = block;
          trials.push_back(std::move(trial));
        }
        evaluate(trials);
        const Trial* best = nullptr;
        double least = cost() * (1.0 - kWorthIt);
        // a lower cost may have a higher worst: what is reached is not given up
        const double reached = std::max(1.0, worst());
        for (const Trial& trial : trials) {
          if (time() - seconds_[r] + trial.seconds > longest || !(trial.cost < least)) continue;
          if (worst_with(trial) > reached) continue;
          least = trial.cost;
          best = &trial;
        }
        if (best == nullptr) continue;
        take(*best);
        changed = true;
        if (progress) progress();
      }
    }
    return changed;
  }

  /// Leaves out what is not needed for a cost at which the worst is within @p most.
  void prune(double most) {
    for (;;) {
      std::vector<Trial> trials;
      for (std::size_t r = 0; r < blocks_.size(); ++r) {
        for (std::size_t b = 0; b < blocks_[r].size() && blocks_[r].size() > 3; ++b) {
          Trial trial(r, blocks_[r]);
          trial.blocks.erase(trial.blocks.begin() + static_cast<std::ptrdiff_t>(b));
          trials.push_back(std::move(trial));
        }
      }
      evaluate(trials);
      const Trial* best = nullptr;
      double most_saved = 0.0;
      for (const Trial& trial : trials) {
        const double saved = seconds_[trial.recording] - trial.seconds;
        if (worst_with(trial) <= most && saved > most_saved) {
          most_saved = saved;
          best = &trial;
        }
      }
      if (best == nullptr) return;
      take(*best);
    }
  }

  [[nodiscard]] double time() const { return std::accumulate(seconds_.begin(), seconds_.end(), 0.0); }
  [[nodiscard]] double cost() const { return cost_of(predictor_.sigmas(total()), wanted_); }
  [[nodiscard]] double worst() const { return worst_of(predictor_.sigmas(total()), wanted_); }
  [[nodiscard]] std::vector<TableSequence> sequences() const {
    std::vector<TableSequence> all;
    for (const Blocks& blocks : blocks_) all.push_back(sequence_of(bench_, blocks));
    return all;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd total() const {
    Eigen::MatrixXd sum = information_.front();
    for (std::size_t r = 1; r < information_.size(); ++r) sum += information_[r];
    return sum;
  }
  [[nodiscard]] Eigen::VectorXd sigmas_with(const Trial& trial) const {
    Eigen::MatrixXd sum = trial.information;
    for (std::size_t r = 0; r < information_.size(); ++r) {
      if (r != trial.recording && information_[r].size() > 0) sum += information_[r];
    }
    return predictor_.sigmas(sum);
  }
  [[nodiscard]] double worst_with(const Trial& trial) const { return worst_of(sigmas_with(trial), wanted_); }

  void evaluate(Trial& trial) const {
    const PlannedMotion motion = motion_of(sequence_of(bench_, trial.blocks), bench_.limits);
    trial.seconds = motion.duration;
    trial.information = predictor_.information(trial.recording, motion);
    trial.cost = cost_of(sigmas_with(trial), wanted_);
  }
  void evaluate(std::vector<Trial>& trials) const {
    calibration::share_out(trials.size(), [&](std::size_t i) { evaluate(trials[i]); });
  }
  void take(const Trial& trial) {
    blocks_[trial.recording] = trial.blocks;
    information_[trial.recording] = trial.information;
    seconds_[trial.recording] = trial.seconds;
  }

  const Bench& bench_;
  Predictor predictor_;
  Blocks candidates_;
  Eigen::VectorXd wanted_;
  std::vector<Blocks> blocks_;
  std::vector<Eigen::MatrixXd> information_;
  std::vector<double> seconds_;
};

}  // namespace

WantedSigmas nothing_wanted() {
  WantedSigmas wanted;
  wanted.fill(kInfinity);
  return wanted;
}

double Plan::duration() const {
  double sum = 0.0;
  for (const TableSequence& sequence : recordings) sum += simulation::duration_of(sequence);
  return sum;
}

double Plan::worst(const WantedSigmas& wanted) const {
  double worst = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double asked = wanted_of(parameters[i], wanted);
    const auto at = static_cast<Eigen::Index>(i);
    if (std::isfinite(asked)) worst = std::max(worst, std::sqrt(predicted.covariance(at, at)) / asked);
  }
  return worst;
}

Plan predict(const Bench& bench, const std::vector<TableSequence>& recordings) {
  double largest_rate = 0.0;
  for (const TableSequence& sequence : recordings) largest_rate = std::max(largest_rate, largest_rate_of(sequence));
  const Predictor predictor = predictor_of(bench, largest_rate);
  const auto n = static_cast<Eigen::Index>(predictor.parameters().size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t r = 0; r < recordings.size(); ++r)
    information += predictor.information(r, motion_of(recordings[r], bench.limits));
  return {recordings, predictor.parameters(), predictor.conclude(information), information};
}

double largest_rate_of(const Plan& plan) {
  double largest = 0.0;
  for (const TableSequence& sequence : plan.recordings) largest = std::max(largest, largest_rate_of(sequence));
  return largest;
}

WantedSigmas sigmas_of(const Plan& plan) {
  WantedSigmas largest = nothing_wanted();
  for (std::size_t i = 0; i < plan.parameters.size(); ++i) {
    const Parameter& p = plan.parameters[i];
    if (!calibration::has_verdict(p)) continue;
    const auto at = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(plan.predicted.covariance(at, at)) * p.in_unit;
    double& entry = largest[static_cast<std::size_t>(p.kind)];
    entry = std::isfinite(entry) ? std::max(entry, sigma) : sigma;
  }
  return largest;
}

Plan search(const Bench& bench, const WantedSigmas& wanted, double time, double longest,
            const SearchProgress& progress) {
  Search search(bench, wanted);
  search.begin();
  const auto say = [&] {
    if (progress) progress(search.time(), search.worst());
  };
  say();
  const double most = time > 0.0 ? time : longest;
  if (search.time() > most)
    throw Error(ExitCode::kUsage, "no plan for these mounts is shorter than " +
                                      std::to_string(static_cast<int>(std::ceil(search.time()))) + " s");
  while ((time > 0.0 || search.worst() > 1.0) && search.grow(most - search.time())) say();
  for (int sweep = 0; sweep < kMostSweeps && search.exchange(time > 0.0 ? time : search.time(), say); ++sweep) {
  }
  if (time <= 0.0 && search.worst() <= 1.0) search.prune(1.0);
  say();
  return predict(bench, search.sequences());
}

Addition cheapest_addition(const Bench& bench, const Plan& plan, const WantedSigmas& wanted) {
  const double largest_rate = largest_rate_of(plan);
  const Predictor predictor = predictor_of(bench, largest_rate);
  const auto n = static_cast<Eigen::Index>(plan.parameters.size());
  Eigen::VectorXd asked(n);
  for (Eigen::Index i = 0; i < n; ++i) asked(i) = wanted_of(plan.parameters[static_cast<std::size_t>(i)], wanted);
  if (!asked.array().isFinite().any()) {
    // nothing is wanted: every entry of the unit a little better
    for (Eigen::Index i = 0; i < n; ++i) {
      const Parameter& p = plan.parameters[static_cast<std::size_t>(i)];
      asked(i) = is_of_unit(p.kind) ? std::sqrt(plan.predicted.covariance(i, i)) : kInfinity;
    }
  }
  Addition best;
  best.cost_before = cost_of(predictor.sigmas(plan.information), asked);
  std::vector<Addition> additions;
  std::vector<TableSequence> longer;
  for (std::size_t r = 0; r < plan.recordings.size(); ++r) {
    for (const Block& block : candidates(bench)) {
      if (largest_rate_of(sequence_of(bench, {block})) > 1.01 * largest_rate) continue;  // the nonlinearity's scale
      longer.push_back(plan.recordings[r]);
      Stand angle = end_of(longer.back());
      append(bench, block, angle, longer.back());
      additions.push_back({words(block), r,
                           simulation::duration_of(longer.back()) - simulation::duration_of(plan.recordings[r]),
                           best.cost_before, kInfinity});
    }
  }
  // the wander carries over from what was before, but not from long before: the end of a recording stands for it
  const UnitNoise& noise = bench.prediction.solve.noise;
  const double memory = kForgotten * std::max(noise.gyro.wander_correlation_time, noise.accel.wander_correlation_time);
  std::vector<Eigen::MatrixXd> end(plan.recordings.size());
  const auto end_from = [&](std::size_t r) {
    return std::max(0.0, simulation::duration_of(plan.recordings[r]) - memory);
  };
  calibration::share_out(end.size(), [&](std::size_t r) {
    end[r] = predictor.information(r, after(motion_of(plan.recordings[r], bench.limits), end_from(r)));
  });
  calibration::share_out(additions.size(), [&](std::size_t i) {
    const std::size_t r = additions[i].recording;
    const Eigen::MatrixXd with = predictor.information(r, after(motion_of(longer[i], bench.limits), end_from(r)));
    additions[i].cost_after = cost_of(predictor.sigmas(plan.information + with - end[r]), asked);
  });
  double fastest = 0.0;
  for (const Addition& addition : additions) {
    const double speed = std::log(addition.cost_before / addition.cost_after) / addition.seconds;
    if (!(speed > fastest)) continue;
    fastest = speed;
    best = addition;
  }
  return best;
}

}  // namespace trunnion::planning
