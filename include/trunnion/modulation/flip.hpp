// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Two-position modulation: a main unit on a turning platform with an index pulse, flipped by 90 deg across the axis
/// from time to time so that each of its axes is modulated, and an auxiliary unit on the base that bridges what the
/// main unit cannot see.
///
///        pulse              reverse()            pulse after the ramp
///   kSettling ---> kTurning -------> kReversing ----------------------> kTurning
///       ^             | switch leaves its position       | no pulse in time: kSettling, fault() == kNoPulse
///       |             v
///       +-------- kFlipping     longer than it may take: fault() == kFlipOverdue, bridged on
///       switch in a position
///
/// A main sample that is not finite is a lost one: the open turn is broken off and bridged. One fault is told at a
/// time, that of the mechanics first. In kTurning an interval goes out with every pulse: means of the turn in body
/// axes, across the axis free of bias (index_demodulator.hpp), along it corrected by what is known (turn_errors.hpp).
/// In every other state each sample of the auxiliary unit goes out, less the bias it showed against the main unit; when
/// it is silent too, the last interval is held and said to be. Intervals follow each other without a gap.
/// docs/theory/modulation.md.

#pragma once

#include <cmath>
#include <cstdint>

#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/modulation/turn_errors.hpp"

namespace trunnion {

enum class FlipState : std::uint8_t { kSettling, kTurning, kReversing, kFlipping };

enum class FlipFault : std::uint8_t {
  kNone,
  kNoPulse,          ///< the platform should turn, but no pulse came in time
  kFlipOverdue,      ///< the switch did not reach a position in time
  kAuxiliarySilent,  ///< no auxiliary samples while they are needed
  kMainSilent,       ///< samples of the main unit are not finite
  kSaturated,        ///< the axial gyro of the main unit is at its range
};

/// Where the flip stands, by its switches.
enum class FlipSwitch : std::uint8_t { kFirst, kSecond, kBetween };

template <class T>
struct FlipLimits {
  T flip;      ///< a flip takes no longer [s]
  T pulse;     ///< neither does a turn [s]
  T reversal;  ///< the platform has its new speed after so long [s]
};

enum class IntervalSource : std::uint8_t { kMain, kAuxiliary, kHeld };

/// Motion of the body over an interval; they follow each other without a gap.
template <class T>
struct ModulatedInterval {
  InertialSample<T> body;  ///< means
  T duration = T(0);       ///< s
  IntervalSource source = IntervalSource::kHeld;
  T along_sigma = T(0);  ///< 1 sigma of the bias left in body.w.z() [rad/s]; of kMain only
};

template <class T>
struct FlipSample {
  InertialSample<T> main;  ///< mean over the sample, in the unit's own axes
  InertialSample<T> auxiliary;
  bool has_auxiliary = true;
  bool has_pulse = false;
  T pulse_before = T(0);  ///< share of the sample that lies before the pulse
  FlipSwitch flip = FlipSwitch::kFirst;
};

template <class T>
class TwoPositionModulation {
 public:
  /// @param period of a sample [s]; @param axial_range of the gyros [rad/s], 0: unknown; @param index_angle as of
  /// IndexDemodulator; noise of the main unit's triads, the auxiliary one as reference
  TwoPositionModulation(const T& period, const T& axial_range, const T& index_angle, const FlipLimits<T>& limits,
                        const TurnErrorNoise<T>& gyro, const TurnErrorNoise<T>& accel)
      : period_(period),
        axial_range_(axial_range),
        limits_(limits),
        demodulator_(period, axial_range, index_angle),
        gyro_(gyro),
        accel_(accel) {}

  /// The platform was told to turn the other way, or at another speed: pulses count again after the ramp.
  void reverse() {
    ramp_left_ = limits_.reversal;
    if (state_ == FlipState::kTurning) leave(FlipState::kReversing);
  }

  /// @return whether an interval is out: interval(). The one that an open turn leaves behind when it is broken off
  /// comes with the first sample after it.
  bool add(const FlipSample<T>& given) {
    FlipSample<T> sample = given;
    sample.has_auxiliary = given.has_auxiliary && finite(given.auxiliary);
    sample.has_pulse = given.has_pulse && given.pulse_before >= T(0) && given.pulse_before <= T(1);
    waited_ += period_;
    ramp_left_ -= period_;
    fault_ = FlipFault::kNone;
    if (state_ != FlipState::kFlipping && sample.flip != switch_of(position_)) leave(FlipState::kFlipping);
    if (state_ == FlipState::kFlipping && sample.flip != FlipSwitch::kBetween) {
      position_ = sample.flip == FlipSwitch::kFirst ? UnitPosition::kFirst : UnitPosition::kSecond;
      leave(FlipState::kSettling);
    }
    const T ramp = ramp_left_ > T(0) ? ramp_left_ : T(0);
    if (state_ == FlipState::kFlipping && waited_ > limits_.flip) fault_ = FlipFault::kFlipOverdue;
    if (state_ != FlipState::kFlipping && waited_ > limits_.pulse + limits_.reversal + ramp)
      fault_ = FlipFault::kNoPulse;
    if (!finite(sample.main)) {
      if (state_ == FlipState::kTurning) leave(FlipState::kSettling);
      if (fault_ == FlipFault::kNone) fault_ = FlipFault::kMainSilent;
      return bridge(sample, T(1));
    }
    const InertialSample<T> platform{in_platform(position_, sample.main.w), in_platform(position_, sample.main.f)};
    const T w = platform.w.z();
    if (fault_ == FlipFault::kNone && state_ != FlipState::kFlipping && axial_range_ > T(0) &&
        (w < T(0) ? -w : w) >= T(0.995) * axial_range_)
      fault_ = FlipFault::kSaturated;
    switch (state_) {
      case FlipState::kTurning:
        return turning(platform, sample);
      case FlipState::kReversing:
      case FlipState::kSettling:
        return settling(platform, sample);
      case FlipState::kFlipping:
        break;
    }
    return bridge(sample, T(1));
  }

  [[nodiscard]] const ModulatedInterval<T>& interval() const { return interval_; }
  [[nodiscard]] FlipState state() const { return state_; }
  [[nodiscard]] UnitPosition position() const { return position_; }
  /// What is wrong now.
  [[nodiscard]] FlipFault fault() const { return fault_; }
  /// The last whole turn, its means in p.
  [[nodiscard]] const TurnMean<T>& turn() const { return demodulator_.turn(); }
  [[nodiscard]] const TurnErrors<T>& gyro() const { return gyro_; }
  [[nodiscard]] const TurnErrors<T>& accel() const { return accel_; }

 private:
  static FlipSwitch switch_of(UnitPosition position) {
    return position == UnitPosition::kFirst ? FlipSwitch::kFirst : FlipSwitch::kSecond;
  }

  static bool finite(const InertialSample<T>& sample) {
    using std::isfinite;
    return isfinite(sample.w.sum()) && isfinite(sample.f.sum());
  }

  /// Breaks the open turn off: the auxiliary unit stands in for it.
  void leave(FlipState next) {
    state_ = next;
    waited_ = T(0);
    demodulator_.restart();
  }

  bool turning(const InertialSample<T>& platform, const FlipSample<T>& sample) {
    if (!sample.has_pulse || demodulator_.add_with_pulse(platform, sample.pulse_before) != Pulse::kTurn) {
      if (!sample.has_pulse) demodulator_.add(platform);
      carry(sample, T(1));
      if (waited_ > limits_.pulse) {
        leave(FlipState::kSettling);
        fault_ = FlipFault::kNoPulse;
      }
      return false;
    }
    carry(sample, sample.pulse_before);
    close_turn();
    carry(sample, T(1) - sample.pulse_before);
    waited_ = T(0);
    return true;
  }

  bool settling(const InertialSample<T>& platform, const FlipSample<T>& sample) {
    if (!sample.has_pulse || ramp_left_ > T(0)) return bridge(sample, T(1));
    demodulator_.restart();
    (void)demodulator_.add_with_pulse(platform, sample.pulse_before);
    const bool out = bridge(sample, sample.pulse_before);
    carry(sample, T(1) - sample.pulse_before);
    state_ = FlipState::kTurning;
    waited_ = T(0);
    return out;
  }

  /// Sums of the auxiliary unit since the last interval.
  void carry(const FlipSample<T>& sample, const T& share) {
    const T time = share * period_;
    open_time_ += time;
    if (!sample.has_auxiliary) return;
    heard_ += time;
    sum_.w += time * sample.auxiliary.w;
    sum_.f += time * sample.auxiliary.f;
  }

  bool bridge(const FlipSample<T>& sample, const T& share) {
    carry(sample, share);
    if (!(open_time_ > T(0))) return false;
    interval_.duration = open_time_;
    gyro_.propagate(open_time_);
    accel_.propagate(open_time_);
    if (heard_ > T(0)) {
      interval_.source = IntervalSource::kAuxiliary;
      interval_.body.w = sum_.w / heard_ - bias_.w;
      interval_.body.f = sum_.f / heard_ - bias_.f;
    } else {
      interval_.source = IntervalSource::kHeld;
      if (fault_ == FlipFault::kNone) fault_ = FlipFault::kAuxiliarySilent;
    }
    forget();
    return true;
  }

  void close_turn() {
    const TurnMean<T>& turn = demodulator_.turn();
    gyro_.propagate(turn.period);
    accel_.propagate(turn.period);
    const T r = turn.rate * turn.rate;
    const bool heard = heard_ > T(0.5) * open_time_;
    const InertialSample<T> auxiliary = heard ? InertialSample<T>{sum_.w / heard_, sum_.f / heard_} : sum_;
    interval_.body = turn.body;
    if (!turn.saturated && !turn.unsteady) {
      gyro_.add_across(position_, turn.unit.w, turn.rate, turn.period);
      accel_.add_across(position_, turn.unit.f, r, turn.period);
      if (heard) {
        gyro_.add_along(position_, turn.body.w.z(), turn.rate, auxiliary.w.z(), turn.period);
        accel_.add_along(position_, turn.body.f.z(), T(0), auxiliary.f.z(), turn.period);
      }
      interval_.body.w.z() = gyro_.along(position_, turn.body.w.z(), turn.rate);
    } else if (turn.saturated && heard) {
      interval_.body.w.z() = auxiliary.w.z() - bias_.w.z();
    }
    interval_.body.f.z() = accel_.along(position_, turn.body.f.z(), T(0));
    interval_.along_sigma = gyro_.along_sigma(position_, turn.rate);
    interval_.duration = turn.period;
    interval_.source = IntervalSource::kMain;
    if (heard && !turn.unsteady) learn(auxiliary, turn);
    forget();
  }

  /// The auxiliary unit's bias: across the axis an average that forgets over eight turns, along it what turn_errors.hpp
  /// calls c.
  void learn(const InertialSample<T>& auxiliary, const TurnMean<T>& turn) {
    turns_learnt_ += turns_learnt_ < 8 ? 1 : 0;
    const T share = T(1) / T(turns_learnt_);
    bias_.w += share * (auxiliary.w - turn.body.w - bias_.w);
    bias_.f += share * (auxiliary.f - turn.body.f - bias_.f);
    bias_.w.z() = gyro_.state()(TurnErrors<T>::kReference);
    bias_.f.z() = accel_.state()(TurnErrors<T>::kReference);
  }

  void forget() {
    sum_ = InertialSample<T>{};
    open_time_ = heard_ = T(0);
  }

  T period_;
  T axial_range_;
  FlipLimits<T> limits_;
  IndexDemodulator<T> demodulator_;
  TurnErrors<T> gyro_;
  TurnErrors<T> accel_;
  FlipState state_ = FlipState::kSettling;
  FlipFault fault_ = FlipFault::kNone;
  UnitPosition position_ = UnitPosition::kFirst;
  T waited_ = T(0);     // since the state began, or the last pulse
  T ramp_left_ = T(0);  // until the platform has its new speed
  T open_time_ = T(0);
  T heard_ = T(0);
  InertialSample<T> sum_;
  InertialSample<T> bias_;
  int turns_learnt_ = 0;
  ModulatedInterval<T> interval_;
};

}  // namespace trunnion
