// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The receivers of an array as one stream of epochs: RINEX files side by side, or messages of a log or a bus.

#pragma once

#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine.hpp"
#include "trunnion/io/antenna_epoch.hpp"
#include "trunnion/io/gnss_messages.hpp"
#include "trunnion/io/lcm_log.hpp"

namespace trunnion::app {

struct ReceiverFigures {
  long long epochs = 0;               ///< of the master
  std::vector<long long> with_slave;  ///< of these, each slave was heard
  io::LeftOut left_out;
  std::vector<std::string> warnings;
  std::vector<std::string> digests;  ///< of the files read
};

/// Called with every epoch; false ends the reading.
using ArraySink = std::function<bool(const ArrayEpoch&)>;
using Fraction = std::function<void(double)>;

/// The signals that all files have, one band of each system: those of L1, E1, B1I.
/// @throws Error (input) when they have none in common
std::vector<io::SignalName> common_signals(const std::vector<std::string>& paths);

/// RINEX files, the master's first. @param orbits of --nav
/// @param raw when not null, takes what was read as gnss_raw_t of one receiver after the other
/// @throws Error (input) for a file that cannot be read, or when no epoch of a slave meets one of the master
ReceiverFigures read_rinex(const std::vector<std::string>& paths, const std::vector<io::SignalName>& signals,
                           const io::OrbitBook& orbits, const ArraySink& sink, const Fraction& progress,
                           const std::function<void(const io::GnssRaw&)>& raw = {});

/// Messages of several receivers to epochs, which the master's are: one goes out when all slaves have spoken of it, or
/// when a receiver speaks of a later one.
class MessageReceivers {
 public:
  /// @param antennas the master and its slaves
  MessageReceivers(std::size_t antennas, std::vector<io::SignalName> signals, io::OrbitBook orbits, ArraySink sink);

  /// gnss_raw_t. @return false when the sink wants no more
  bool raw(const io::LcmEvent& event);
  /// gnss_orbit_t.
  void orbit(const io::LcmEvent& event);
  /// What waits. Call after the last message. @return false when the sink wants no more
  bool finish();

  [[nodiscard]] const ReceiverFigures& figures() const { return figures_; }
  /// Messages that held none of the signals.
  [[nodiscard]] long long without_signal() const { return without_signal_; }
  /// Messages that were none of ours, or damaged.
  [[nodiscard]] long long damaged() const { return damaged_; }
  [[nodiscard]] const std::set<int>& strangers() const { return strangers_; }

 private:
  struct Waiting {
    std::int64_t utime;
    io::ObservationEpoch epoch;
  };
  /// What of the waiting epochs of the master is ripe. @return false when the sink wants no more
  bool emit(bool all_of_them);

  std::size_t antennas_;
  std::vector<io::SignalName> signals_;
  io::OrbitBook orbits_;
  ArraySink sink_;
  ReceiverFigures figures_;
  std::vector<std::deque<Waiting>> waiting_;  ///< of each antenna, in order of arrival
  GpsTime last_;                              ///< of the epoch that went out last
  bool went_ = false;
  long long damaged_ = 0;
  long long without_signal_ = 0;
  std::set<int> strangers_;
};

}  // namespace trunnion::app
