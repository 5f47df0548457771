// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "receivers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "trunnion/core/error.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::app {
namespace {

constexpr double kBackwards = 10.0;       // s, and more ahead is no time to believe
constexpr std::size_t kMostWaiting = 16;  // epochs of an antenna
constexpr double kMeets = 0.005;          // s, within which receivers' epochs are one

std::string time_text(const GpsTime& time) {
  char text[64];
  std::snprintf(text, sizeof text, "week %d, %.3f s", time.week, time.seconds);
  return text;
}

}  // namespace

std::vector<io::SignalName> common_signals(const std::vector<std::string>& paths) {
  std::vector<std::vector<io::SignalName>> all;
  all.reserve(paths.size());
  for (const std::string& path : paths) all.push_back(io::ObservationReader(path).available());
  std::vector<io::SignalName> chosen;
  std::string seen;
  for (const io::SignalName& name : all.front()) {
    const bool first_band = name.code[0] == (name.system == SatelliteSystem::kBeidou ? '2' : '1');
    const bool known =
        std::any_of(chosen.begin(), chosen.end(), [&](const io::SignalName& c) { return c.system == name.system; });
    const bool everywhere = std::all_of(all.begin(), all.end(), [&](const std::vector<io::SignalName>& of) {
      return std::any_of(of.begin(), of.end(),
                         [&](const io::SignalName& o) { return o.system == name.system && o.code == name.code; });
    });
    seen += (seen.empty() ? "" : ", ") + name.text();
    if (first_band && !known && everywhere) chosen.push_back(name);
  }
  if (chosen.empty())
    throw io::input_error(paths.front(), 0, "",
                          "shares no signal of L1, E1 or B1I with the other files; it has " +
                              (seen.empty() ? "none" : seen) + " (--signals)");
  return chosen;
}

ReceiverFigures read_rinex(const std::vector<std::string>& paths, const std::vector<io::SignalName>& signals,
                           const io::OrbitBook& orbits, const ArraySink& sink, const Fraction& progress,
                           const std::function<void(const io::GnssRaw&)>& raw) {
  std::vector<io::ObservationReader> readers;
  readers.reserve(paths.size());
  for (const std::string& path : paths) {
    readers.emplace_back(path);
    readers.back().choose(signals);
  }
  ReceiverFigures figures;
  figures.with_slave.assign(paths.size() - 1, 0);
  for (const auto& reader : readers) figures.digests.push_back(reader.digest());
  std::vector<io::ObservationEpoch> next(paths.size());
  std::vector<bool> has(paths.size());
  std::vector<std::optional<GpsTime>> first(paths.size());
  const auto advance = [&](std::size_t i) {
    has[i] = readers[i].next(next[i]);
    if (has[i] && !first[i]) first[i] = next[i].time;
  };
  for (std::size_t i = 1; i < paths.size(); ++i) advance(i);
  std::int64_t sequence = 0;
  bool goes_on = true;
  for (advance(0); has[0] && goes_on; advance(0)) {
    ArrayEpoch epoch;
    epoch.time = next[0].time;
    epoch.utime = utime_of(epoch.time);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (i > 0) {
        while (has[i] && next[i].time - epoch.time < -kMeets) advance(i);
      }
      const bool meets = has[i] && std::abs(next[i].time - epoch.time) <= kMeets;
      epoch.heard.push_back(meets);
      epoch.antenna.push_back(meets ? io::antenna_epoch(next[i], signals, orbits, figures.left_out)
                                    : AntennaEpoch<kMostSignals>());
      if (meets && i > 0) ++figures.with_slave[i - 1];
      if (meets && raw) raw({epoch.utime, sequence, static_cast<int>(i), next[i]});
    }
    ++sequence;
    ++figures.epochs;
    goes_on = sink(epoch);
    progress(readers[0].fraction());
  }
  for (std::size_t i = 0; i < paths.size(); ++i) {
    readers[i].check();
    const io::RinexLosses& losses = readers[i].losses();
    if (!first[i])
      throw io::input_error(
          paths[i], 0, "",
          losses.first.empty() ? "holds no epoch" : "holds no epoch that can be read: " + losses.first);
    if (i > 0 && figures.with_slave[i - 1] == 0 && goes_on)
      throw io::input_error(paths[i], 0, "",
                            "has no epoch within " + std::to_string(static_cast<int>(1e3 * kMeets)) + " ms of one of " +
                                paths[0] + ": it begins at " + time_text(*first[i]) + ", the other at " +
                                time_text(*first[0]));
    if (losses.epochs + losses.satellites > 0)
      figures.warnings.push_back(std::to_string(losses.epochs) + " epochs and " + std::to_string(losses.satellites) +
                                 " satellites of " + paths[i] + " could not be read; first: " + losses.first);
  }
  return figures;
}

MessageReceivers::MessageReceivers(std::size_t antennas, std::vector<io::SignalName> signals, io::OrbitBook orbits,
                                   ArraySink sink)
    : antennas_(antennas),
      signals_(std::move(signals)),
      orbits_(std::move(orbits)),
      sink_(std::move(sink)),
      waiting_(antennas) {
  figures_.with_slave.assign(antennas - 1, 0);
}

void MessageReceivers::orbit(const io::LcmEvent& event) {
  if (const auto orbit = io::decode_gnss_orbit(event.data))
    orbits_.add(*orbit);
  else
    ++damaged_;
}

bool MessageReceivers::raw(const io::LcmEvent& event) {
  const auto raw = io::decode_gnss_raw(event.data, signals_);
  if (!raw) {
    ++damaged_;
    return true;
  }
  const auto antenna = static_cast<std::size_t>(raw->antenna);
  if (antenna >= antennas_) {
    if (strangers_.size() < kMostWaiting) strangers_.insert(raw->antenna);
    return true;
  }
  without_signal_ += raw->epoch.at.empty() ? 1 : 0;
  std::deque<Waiting>& queue = waiting_[antenna];
  if (antenna == 0 && (went_ || !queue.empty())) {
    const double step = raw->epoch.time - (queue.empty() ? last_ : queue.back().epoch.time);
    if (step < -kBackwards) {
      figures_.warnings.push_back("the master's time steps back by " + std::to_string(static_cast<long long>(-step)) +
                                  " s: begun anew there");
      for (auto& of : waiting_) of.clear();
      went_ = false;
    } else if (!(step > 0.0)) {
      return true;  // twice the same
    }
  }
  queue.push_back({raw->utime, raw->epoch});
  if (queue.size() > kMostWaiting) queue.pop_front();
  return emit(false);
}

bool MessageReceivers::finish() { return emit(true); }

bool MessageReceivers::emit(bool all_of_them) {
  while (!waiting_[0].empty()) {
    const Waiting& master = waiting_[0].front();
    const GpsTime& time = master.epoch.time;
    ArrayEpoch epoch;
    epoch.utime = master.utime;
    epoch.time = time;
    epoch.heard.assign(antennas_, false);
    epoch.heard[0] = true;
    epoch.antenna.assign(antennas_, {});
    bool later = waiting_[0].size() > 1;
    bool missing = false;
    std::vector<const Waiting*> chosen(antennas_, nullptr);
    for (std::size_t i = 1; i < antennas_; ++i) {
      for (const Waiting& slave : waiting_[i]) {
        const double after = slave.epoch.time - time;
        if (std::abs(after) <= kMeets) chosen[i] = &slave;
        // a clock that is far ahead is no later epoch
        later = later || (after > kMeets && after < kBackwards);
      }
      missing = missing || chosen[i] == nullptr;
    }
    if (missing && !later && !all_of_them) return true;
    epoch.antenna[0] = io::antenna_epoch(master.epoch, signals_, orbits_, figures_.left_out);
    for (std::size_t i = 1; i < antennas_; ++i) {
      if (chosen[i] == nullptr) continue;
      epoch.heard[i] = true;
      epoch.antenna[i] = io::antenna_epoch(chosen[i]->epoch, signals_, orbits_, figures_.left_out);
      ++figures_.with_slave[i - 1];
    }
    ++figures_.epochs;
    last_ = time;
    went_ = true;
    for (std::size_t i = 1; i < antennas_; ++i) {
      std::deque<Waiting>& queue = waiting_[i];
      while (!queue.empty() && queue.front().epoch.time - last_ <= kMeets) queue.pop_front();
    }
    waiting_[0].pop_front();
    if (!sink_(epoch)) return false;
  }
  return true;
}

}  // namespace trunnion::app
