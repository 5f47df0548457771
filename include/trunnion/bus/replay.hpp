// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A log played back onto a bus, at the pace at which it was recorded or another.
///
///   t_wall(i) = t_wall(0) + (t_log(i) - t_log(0)) / speed                                          ... (1)
///
/// against a clock that nobody sets, from the start: a late message does not make those after it late.

#pragma once

#include <functional>
#include <limits>
#include <string_view>

#include "trunnion/bus/connection.hpp"
#include "trunnion/io/lcm_log.hpp"

namespace trunnion::bus {

struct ReplayOptions {
  double speed = 1.0;  ///< zero or less: without pauses
  double start = 0.0;  ///< s after the first event of the log
  double end = std::numeric_limits<double>::infinity();
  std::function<bool(std::string_view channel)> chosen;  ///< empty: all
  /// Called after each message. On memq: where the subscribers are served.
  std::function<void(const io::LcmEvent&)> published;
  /// Asked after each message and every 0.1 s of a pause; false ends the replay.
  std::function<bool()> goes_on;
};

struct ReplayFigures {
  long long messages = 0;
  long long bytes = 0;
  double duration = 0.0;  ///< s, of the log from first to last message played
  double latest = 0.0;    ///< s, by which the worst message was late
};

/// @throws Error (transport) when a message cannot be sent
ReplayFigures replay(io::LcmLogReader& log, Connection& connection, const ReplayOptions& options);

}  // namespace trunnion::bus
