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

constexpr double kMeets = 0.02;                 // s, within which receivers' epochs are one
constexpr std::int64_t kUnixToGps = 315964800;  // s, 1970 to 1980-01-06

std::string time_text(const GpsTime& time) {
  char text[64];
  std::snprintf(text, sizeof text, "week %d, %.3f s", time.week, time.seconds);
  return text;
}

}  // namespace

std::int64_t utime_of(const GpsTime& time) {
  return (kUnixToGps + static_cast<std::int64_t>(time.week) * 604800) * 1000000 + std::llround(time.seconds * 1e6);
}

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
      waiting_(antennas),
      has_(antennas, false) {
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
    strangers_.insert(raw->antenna);
    return true;
  }
  const GpsTime& time = raw->epoch.time;
  if (went_ && !(time - last_ > kMeets)) return true;  // too late
  if (any_ && time - time_ < -kMeets) return true;
  if (any_ && time - time_ > kMeets && !emit()) return false;
  if (!any_) {
    any_ = true;
    time_ = time;
    utime_ = raw->utime;
  }
  if (antenna == 0) utime_ = raw->utime;
  waiting_[antenna] = raw->epoch;
  has_[antenna] = true;
  return std::find(has_.begin(), has_.end(), false) == has_.end() ? emit() : true;
}

bool MessageReceivers::finish() { return any_ ? emit() : true; }

bool MessageReceivers::emit() {
  ArrayEpoch epoch;
  epoch.utime = utime_;
  epoch.time = has_[0] ? waiting_[0].time : time_;
  for (std::size_t i = 0; i < antennas_; ++i) {
    epoch.heard.push_back(has_[i]);
    epoch.antenna.push_back(has_[i] ? io::antenna_epoch(waiting_[i], signals_, orbits_, figures_.left_out)
                                    : AntennaEpoch<kMostSignals>());
    if (i > 0 && has_[0] && has_[i]) ++figures_.with_slave[i - 1];
  }
  has_.assign(antennas_, false);
  figures_.epochs += epoch.heard[0] ? 1 : 0;
  last_ = time_;
  went_ = true;
  any_ = false;
  return sink_(epoch);
}

}  // namespace trunnion::app
