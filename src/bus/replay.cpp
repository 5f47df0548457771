// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/bus/replay.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

namespace trunnion::bus {

ReplayFigures replay(io::LcmLogReader& log, Connection& connection, const ReplayOptions& options) {
  using Clock = std::chrono::steady_clock;
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
      const auto due = wall + std::chrono::duration_cast<Clock::duration>(
                                  std::chrono::duration<double>((t - began) / options.speed));
      const Clock::time_point now = Clock::now();
      if (due > now) {
        std::this_thread::sleep_until(due);
      } else {
        figures.latest = std::max(figures.latest, std::chrono::duration<double>(now - due).count());
      }
    }
    channel = event.channel;
    connection.publish(channel, event.data);
    ++figures.messages;
    figures.bytes += static_cast<long long>(event.data.size());
    figures.duration = std::max(figures.duration, t - began);
    if (options.published && !options.published(event)) break;
  }
  return figures;
}

}  // namespace trunnion::bus
