// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The chain with the golden calibration: scales and a start, without a trigonometric function.

#pragma once

#include "chain.hpp"
#include "golden_calibration.hpp"
#include "trunnion/core/units.hpp"

namespace firmware {

/// What the axial counts out of a turn sum to.
constexpr auto kFullTurn = static_cast<std::int64_t>(2.0 * trunnion::kPi * golden::kGyroScale * 400.0);

static_assert(golden::kCounts.linear(), "the chain corrects linear units");

struct Golden {
  static constexpr const trunnion::CountCoefficients& kCounts = golden::kCounts;
  static constexpr double kGyroScale = golden::kGyroScale;
  static constexpr double kAccelScale = golden::kAccelScale;
};
using GoldenChain = Chain<Golden>;
constexpr trunnion::BinaryAngle kStartAngle = 0x12345000U;

inline GoldenChain golden_chain() {
  // latitude 0.76, longitude 2.19 rad, level
  const trunnion::WanderState<float> start = {
      trunnion::Quaternion<float>(0.180646511F, 0.816876561F, -0.420919715F, 0.350579685F),
      trunnion::Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F), trunnion::Vec3<float>(0.0F, 0.0F, 0.0F), 220.0F};
  return {kStartAngle, start};
}

/// Everything that the chain says.
inline void add(Digest& digest, const trunnion::TurnRecord& r) {
  for (std::int64_t x : r.sums.a) digest.add(x);
  for (std::int64_t x : r.sums.b) digest.add(x);
  for (std::int64_t x : r.sums.e) digest.add(x);
  digest.add(r.samples);
  digest.add(r.ahead);
  digest.add(static_cast<std::int32_t>(r.turns) * 4 + (r.saturated ? 1 : 0) + (r.reversed ? 2 : 0));
}
template <class T>
void add(Digest& digest, const trunnion::TurnSplit<T>& turn) {
  for (T x : turn.body) digest.add(x);
  for (T x : turn.unit) digest.add(x);
  digest.add(static_cast<std::int32_t>(turn.valid));
}
inline void add(Digest& digest, const trunnion::TwoSpeedNavigator<float>& navigator) {
  const trunnion::WanderState<float> state = navigator.wander_state();
  for (int i = 0; i < 4; ++i) {
    digest.add(state.q_nb.coeffs()(i));
    digest.add(state.q_en.coeffs()(i));
  }
  for (int i = 0; i < 3; ++i) digest.add(navigator.velocity()(i));
  digest.add(state.height);
}

}  // namespace firmware
