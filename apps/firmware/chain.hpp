// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From raw counts to a position, as a firmware would have it: watch, correct in integers, modulate in integers,
/// navigate in float. FrontEnd alone is what a processor without a floating-point unit takes.

#pragma once

#include "stream.hpp"
#include "trunnion/error_model/channel_watch.hpp"
#include "trunnion/error_model/count_correction.hpp"
#include "trunnion/modulation/count_demodulator.hpp"
#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/strapdown/two_speed_navigator.hpp"

namespace firmware {

constexpr int kBits = 23;           // of a corrected count: 16, 6 behind the point, and one for scale and bias
constexpr int kMostSamples = 4096;  // of a turn, or without an index
constexpr std::int32_t kRange = 32760;
constexpr double kPeriod = 1.0 / 400.0;

using Modulation = trunnion::CountDemodulator<kBits, kMostSamples>;

/// Counts corrected, and where the platform was.
struct Corrected {
  trunnion::UnitOutput<std::int32_t> counts;  ///< of what a register of 16 bits holds
  trunnion::EncoderPhase::Step step;
  trunnion::SinCos phasor;
  bool turn;  ///< one is complete: it stands in the modulation's record
};

class FrontEnd {
 public:
  /// @param counts stay where they are, in flash; @param angle of the platform at the start
  FrontEnd(const trunnion::CountCoefficients& counts, trunnion::BinaryAngle angle)
      : watch_(kRange, kRange, 400), correction_(counts), encoder_(angle) {}

  /// @return what the watch says, or kTimeOut; the sample is taken in any case
  TRUNNION_INLINE trunnion::Status add(const Sample& sample, Corrected& out) {
    using trunnion::Status;
    correction_.set_temperature(sample.temperature);
    const Status seen = watch_.look(sample.counts);
    if (seen == Status::kSaturated) modulation_.mark_saturated();
    out.counts = correction_.correct(sample.counts);
    out.step = encoder_.add(sample.angle);
    out.phasor = trunnion::sin_cos(out.step.middle);
    out.turn = false;
    Status status = Status::kOk;
    if (out.step.pulse.before < 0) {
      status = modulation_.add(out.counts, out.phasor);
    } else {
      out.turn = modulation_.add_with_pulse(out.counts, out.phasor, out.step.pulse);
      if (seen == Status::kSaturated) modulation_.mark_saturated();  // the turn that begins has its share of it
    }
    return seen != Status::kOk ? seen : status;
  }
  [[nodiscard]] const Modulation& modulation() const { return modulation_; }

 private:
  trunnion::ChannelWatch watch_;
  trunnion::LinearCountCorrection correction_;
  trunnion::EncoderPhase encoder_;
  Modulation modulation_;
};

/// @tparam Unit has the calibration: kCounts, kGyroScale and kAccelScale, constants in flash
template <class Unit>
class Chain {
 public:
  Chain(trunnion::BinaryAngle angle, const trunnion::WanderState<float>& start)
      : front_(Unit::kCounts, angle), navigator_(start, static_cast<float>(kPeriod), 20) {}

  /// @return kOutOfRange of the navigator, or what the watch says, or kTimeOut
  /// @param turned whether a turn is complete: it stands in front().modulation().record()
  trunnion::Status add(const Sample& sample, bool& turned) {
    Corrected c;
    const trunnion::Status seen = front_.add(sample, c);
    turned = c.turn;
    constexpr auto kTurn = static_cast<float>(2.0 * trunnion::kPi / 4294967296.0);
    constexpr auto kAngle = static_cast<float>(kPeriod / Unit::kGyroScale);
    constexpr auto kVelocity = static_cast<float>(kPeriod / Unit::kAccelScale);
    const float moved = kTurn * static_cast<float>(c.step.moved);
    // back to the body's axes; what the mean of a turning vector lost
    const float k = trunnion::sinc_correction(moved) * (1.0F / 2147483648.0F);
    const float sine = k * static_cast<float>(c.phasor.sine.raw);
    const float cosine = k * static_cast<float>(c.phasor.cosine.raw);
    const auto turn = [&](const std::int32_t* counts, float scale, trunnion::Vec3<float>& to) {
      const float x = scale * static_cast<float>(counts[0]);
      const float y = scale * static_cast<float>(counts[1]);
      to.coeffRef(0) = cosine * x - sine * y;
      to.coeffRef(1) = sine * x + cosine * y;
      to.coeffRef(2) = scale * static_cast<float>(counts[2]);
    };
    trunnion::Increment<float>& increment = navigator_.next();
    turn(c.counts.data(), kAngle, increment.angle);
    turn(c.counts.data() + 3, kVelocity, increment.velocity);
    increment.angle.coeffRef(2) -= moved;
    const trunnion::Status moved_on = navigator_.take();
    return moved_on != trunnion::Status::kOk ? moved_on : seen;
  }
  trunnion::Status add(const Sample& sample) {
    bool turned = false;
    return add(sample, turned);
  }
  [[nodiscard]] const FrontEnd& front() const { return front_; }
  [[nodiscard]] const trunnion::TwoSpeedNavigator<float>& navigator() const { return navigator_; }

 private:
  FrontEnd front_;
  trunnion::TwoSpeedNavigator<float> navigator_;
};

}  // namespace firmware
