// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Schedules of rotation modulation as tables: quarter turns about an outer axis fixed in the body (its z) and an inner
/// one fixed in the unit (its x), and whether the unit rests after each.
///
///   C_bs = Rz(outer) Rx(inner)                                                                      ... (1)
///
/// What a schedule leaves of a unit's errors: modulation/residual.hpp. docs/theory/modulation.md, section 5.

#pragma once

#include <array>
#include <cstddef>

namespace trunnion {

enum class ModulationAxis : signed char { kOuter, kInner };

struct ScheduleStep {
  ModulationAxis axis = ModulationAxis::kOuter;
  int quarter_turns = 0;
  bool rests = true;
};

template <std::size_t N>
using Schedule = std::array<ScheduleStep, N>;

/// One axis, always turning.
inline constexpr Schedule<1> kContinuous = {{{ModulationAxis::kOuter, 4, false}}};

/// One axis, a turn forward and a turn back: the axial scale factor goes too.
inline constexpr Schedule<2> kReciprocating = {
    {{ModulationAxis::kOuter, 4, false}, {ModulationAxis::kOuter, -4, false}}};

/// One axis, start and stop in four positions, as much forward as back.
inline constexpr Schedule<4> kFourPosition = {{{ModulationAxis::kOuter, 2, true},
                                               {ModulationAxis::kOuter, 1, true},
                                               {ModulationAxis::kOuter, -2, true},
                                               {ModulationAxis::kOuter, -1, true}}};

namespace schedule_detail {

/// Eight half turns that visit each of four attitudes twice: a round and the same round begun with the other axis.
constexpr Schedule<8> eight(bool inner_first, int outer, int inner) {
  const ScheduleStep z{ModulationAxis::kOuter, 2 * outer, true};
  const ScheduleStep x{ModulationAxis::kInner, 2 * inner, true};
  const ScheduleStep z_back{ModulationAxis::kOuter, -2 * outer, true};
  const ScheduleStep x_back{ModulationAxis::kInner, -2 * inner, true};
  if (inner_first) return {{x, z, x_back, z_back, z, x, z_back, x_back}};
  return {{z, x, z_back, x_back, x, z, x_back, z_back}};
}

template <std::size_t N, std::size_t M>
constexpr Schedule<N + M> joined(const Schedule<N>& a, const Schedule<M>& b) {
  Schedule<N + M> both{};
  for (std::size_t i = 0; i < N; ++i) both[i] = a[i];
  for (std::size_t i = 0; i < M; ++i) both[N + i] = b[i];
  return both;
}

}  // namespace schedule_detail

/// Two axes, eight positions: each bias rests as often one way as the other.
inline constexpr Schedule<8> kEightPosition = schedule_detail::eight(false, 1, 1);

/// The eight, then the eight turned the other way round: what the moves themselves leave of a bias goes too.
inline constexpr Schedule<16> kSixteenPosition =
    schedule_detail::joined(schedule_detail::eight(false, 1, 1), schedule_detail::eight(false, -1, -1));

/// The sixteen with every combination of direction and order.
inline constexpr Schedule<64> kSixtyFourPosition = schedule_detail::joined(
    schedule_detail::joined(kSixteenPosition, schedule_detail::joined(schedule_detail::eight(false, 1, -1),
                                                                      schedule_detail::eight(false, -1, 1))),
    schedule_detail::joined(
        schedule_detail::joined(schedule_detail::eight(true, 1, 1), schedule_detail::eight(true, -1, -1)),
        schedule_detail::joined(schedule_detail::eight(true, 1, -1), schedule_detail::eight(true, -1, 1))));

}  // namespace trunnion
