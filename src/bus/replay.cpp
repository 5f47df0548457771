// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/bus/replay.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

namespace trunnion::bus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestPause = 1e9;  // s: what a stray stamp can ask for stays within a clock's range
constexpr auto kSlice = std::chrono::milliseconds(100);

/// @return false when the replay is to end
bool pause_until(Clock::time_point due, const ReplayOptions& options) {
  for (Clock::time_point now = Clock::now(); now < due; now = Clock::now()) {
    std::this_thread::sleep_until(std::min(due, now + kSlice));
    if (options.goes_on && !options.goes_on()) return false;
  }
  return true;
}

}  // namespace

ReplayFigures replay(io::LcmLogReader& log, Connection& connection, const ReplayOptions& options) {
  ReplayFigures figures;
  io::LcmEvent event;
  bool has_first = false;
  std::int64_t first = 0;
  double began = 0.0;  // s of the log, of the first message played
  Clock::time_point wall;
  std::string channel;
  while (log.next(event)) {
    if (!has_first) first = event.timestamp;
    has_first = true;
    const double t = 1e-6 * (static_cast<double>(event.timestamp) - static_cast<double>(first));
    if (t < options.start || t > options.end) continue;
    if (options.chosen && !options.chosen(event.channel)) continue;
    if (figures.messages == 0) {
      began = t;
      wall = Clock::now();
    } else if (options.speed > 0.0) {
      const double pause = std::clamp((t - began) / options.speed, 0.0, kLongestPause);
      const auto due = wall + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
      figures.latest = std::max(figures.latest, std::chrono::duration<double>(Clock::now() - due).count());
      if (!pause_until(due, options)) break;
    }
    channel = event.channel;
    connection.publish(channel, event.data);
    ++figures.messages;
    figures.bytes += static_cast<long long>(event.data.size());
    figures.duration = std::max(figures.duration, t - began);
    if (options.published) options.published(event);
    if (options.goes_on && !options.goes_on()) break;
  }
  return figures;
}

}  // namespace trunnion::bus
