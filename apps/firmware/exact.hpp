// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One digest of everything that the core computes in integers, and one in float, over a stream and over extremes. The
/// same function runs on the host and on every board: the digests must be equal.

#pragma once

#include "golden.hpp"
#include "trunnion/modulation/angle_bins.hpp"
#include "trunnion/strapdown/attitude.hpp"

namespace firmware {

struct Exact {
  std::uint64_t integers;
  std::uint64_t floats;
  std::uint32_t refused;
};

namespace exact_detail {

/// A unit whose sensors bend, so that the other half of the correction runs too.
inline const trunnion::CountCoefficients& bent_counts() {
  static const trunnion::CountCoefficients kBent = [] {
    trunnion::CountCoefficients k = golden::kCounts;
    k.is_linear = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      k.gyro[i].cubic = static_cast<std::int32_t>(i + 1) * 40000000;
      k.accel[i].quadratic = static_cast<std::int32_t>(i + 1) * -3000000;
    }
    return k;
  }();
  return kBent;
}
inline trunnion::UnitCorrection<float>::Coefficients bent_unit() {
  trunnion::UnitCorrection<float>::Coefficients k = golden::kUnit;
  k.is_linear = 0.0F;
  k.gyro_bend.cubic = {1e-6F, -2e-6F, 3e-6F};
  k.accel_bend.quadratic = {1e-5F, 2e-5F, -1e-5F};
  return k;
}

/// As a unit's registers of 16 bits hold it.
inline Sample from_registers(Sample s) {
  for (std::int32_t& count : s.counts) count = static_cast<std::int16_t>(count);
  return s;
}

class Integers {
 public:
  void add(const Sample& s, Digest& digest) {
    Corrected c;
    digest.add(static_cast<std::int32_t>(front_.add(from_registers(s), c)));
    for (std::int32_t x : c.counts) digest.add(x);
    digest.add(c.phasor.sine.raw);
    digest.add(c.phasor.cosine.raw);
    for (std::int32_t x : bent_.correct_saturated(s.counts)) digest.add(x);
    sum(c, digest);
    if (c.step.pulse.before < 0) {
      (void)bins_.add(c.counts, c.step.middle);
    } else if (bins_.add_with_pulse(c.counts, c.step.middle, c.step.pulse)) {
      firmware::add(digest, bins_.turn().record());
      firmware::add(digest, bins_.turn().split());
      firmware::add(digest, front_.modulation().record());
      firmware::add(digest, front_.modulation().split());
    }
    digest.add(static_cast<std::int32_t>(axial_.middle(c.counts[2])));
    if (c.step.pulse.before >= 0) {
      const trunnion::IndexPulse pulse = axial_.pulse(c.step.pulse.before, c.counts[2]);
      digest.add(pulse.ahead);
      digest.add(pulse.turns);
    }
    const trunnion::Wide<62> wide = c.phasor.sine * c.phasor.cosine;
    digest.add(trunnion::rounded<31>(wide).raw);
    digest.add(trunnion::saturated<10>(wide).raw);
  }

 private:
  void sum(const Corrected& c, Digest& digest) {
    if (c.step.pulse.before < 0) {
      digest.add(static_cast<std::int32_t>(average_.add(c.counts)));
      return;
    }
    digest.add(static_cast<std::int32_t>(average_.add_with_pulse(c.counts, c.step.pulse.before)));
    for (std::int64_t x : average_.turn().sum) digest.add(x);
    for (std::size_t i = 0; i < 6; ++i) digest.add(average_.turn().mean(i));
  }

  FrontEnd front_{golden::kCounts, kStartAngle};
  trunnion::CountCorrection bent_{bent_counts()};
  trunnion::AngleBins<kBits, kMostSamples> bins_;
  trunnion::RevolutionAverage<std::int32_t> average_{2, kFullTurn, kRange << 6};
  trunnion::AxialPhase axial_{kFullTurn};
};

class Floats {
 public:
  void add(const Sample& s, Digest& digest, std::uint32_t& refused) {
    const trunnion::InertialSample<float> reading{
        trunnion::Vec3<float>(static_cast<float>(s.counts[0]), static_cast<float>(s.counts[1]),
                              static_cast<float>(s.counts[2])),
        trunnion::Vec3<float>(static_cast<float>(s.counts[3]), static_cast<float>(s.counts[4]),
                              static_cast<float>(s.counts[5]))};
    const trunnion::InertialSample<float> input =
        unit_.correct(reading, static_cast<float>(s.temperature) * (1.0F / 256.0F));
    add(digest, input);
    const auto bent = bent_.checked(reading);
    refused += bent.ok() ? 0U : 1U;
    add(digest, bent.value());
    trunnion::Increment<float> increment = trunnion::increment_of(input, static_cast<float>(kPeriod));
    if ((s.angle & 0xfffU) == 0x123U) increment.velocity.x() = increment.velocity.x() / 0.0F;  // what no unit may send
    refused += chain_.add(from_registers(s)) == trunnion::Status::kOk ? 0U : 1U;
    refused += navigator_.add(increment) == trunnion::Status::kOk ? 0U : 1U;
    refused += attitude_.add(before_, increment.angle) == trunnion::Status::kOk ? 0U : 1U;
    before_ = increment.angle;
    firmware::add(digest, chain_.navigator());
    if ((count_++ & 63U) == 0U) firmware::add(digest, chain_.front().modulation().split_as<float>());
    firmware::add(digest, navigator_);
    for (int i = 0; i < 4; ++i) digest.add(attitude_.q().coeffs()(i));
  }

 private:
  static void add(Digest& digest, const trunnion::InertialSample<float>& x) {
    for (int i = 0; i < 3; ++i) {
      digest.add(x.w(i));
      digest.add(x.f(i));
    }
  }
  static trunnion::WanderState<float> start() { return golden_chain().navigator().wander_state(); }

  trunnion::UnitCorrection<float> unit_{golden::kUnit};
  trunnion::UnitCorrection<float> bent_{bent_unit()};
  GoldenChain chain_ = golden_chain();
  trunnion::TwoSpeedNavigator<float> navigator_{start(), static_cast<float>(kPeriod), 20};
  trunnion::Attitude<float> attitude_{trunnion::Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F)};
  std::uint32_t count_ = 0;
  trunnion::Vec3<float> before_ = trunnion::Vec3<float>::Zero();
};

}  // namespace exact_detail

/// @p Source Turning or Extremes
template <class Source>
Exact exact(std::uint32_t samples) {
  Digest integer_digest;
  Digest float_digest;
  Exact result{};
  static exact_detail::Integers integers;  // too large for a small stack
  static exact_detail::Floats floats;
  integers = exact_detail::Integers();
  floats = exact_detail::Floats();
  Source source;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const Sample s = source.next();
    integers.add(s, integer_digest);
    floats.add(s, float_digest, result.refused);
  }
  result.integers = integer_digest.value();
  result.floats = float_digest.value();
  return result;
}

}  // namespace firmware
