// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// RINEX 2.1x and 3 observation files as receivers' programs write them, epoch by epoch.
///
/// Systems other than GPS, Galileo, QZSS and BeiDou are passed over. Version 2's C1, P1, L1, ... take the names that
/// stand for them (C1 and L1: G1C). Times are GPS time.
/// RINEX 2.11 (Gurtner & Estey, 2007); RINEX 3.04 (IGS & RTCM, 2018), tables 5-13 and A2-A4.

#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trunnion/interferometer/broadcast_orbit.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/rinex_names.hpp"

namespace trunnion::io {

/// One signal of one satellite; what was not measured is not a number.
struct SignalObservation {
  SatelliteName satellite;
  int signal = 0;                                             ///< index into the names that the reader was given
  double code = std::numeric_limits<double>::quiet_NaN();     ///< m
  double phase = std::numeric_limits<double>::quiet_NaN();    ///< cycles
  double doppler = std::numeric_limits<double>::quiet_NaN();  ///< Hz
  bool half_cycle = false;  ///< the receiver says that the phase may be half a cycle off
};

struct ObservationEpoch {
  GpsTime time;
  std::vector<SignalObservation> at;
};

/// An observation file, epoch by epoch.
class ObservationReader {
 public:
  /// @throws Error (input) for a file that is missing, is no observation file, or is of a version or time that is not
  /// known
  explicit ObservationReader(std::string path);

  /// What next() is to read. @throws Error (input) when the file has none of it; what it has is listed then
  void choose(const std::vector<SignalName>& signals);

  /// Signals of the four systems whose code and phase the file has, in its order.
  [[nodiscard]] std::vector<SignalName> available() const;

  /// The next epoch that can be read. @return false at the end
  /// @throws Error (input) at the end when more than one line in ten could not be read
  bool next(ObservationEpoch& epoch);

  /// The same for a file that is not read to its end.
  void check() const;

  [[nodiscard]] const RinexLosses& losses() const { return losses_; }
  /// Of the header, Earth-fixed [m]; zero where it is not stated.
  [[nodiscard]] const Vec3<double>& approximate_position() const { return position_; }
  [[nodiscard]] const std::string& digest() const { return digest_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// How much of the file has been read, 0 to 1.
  [[nodiscard]] double fraction() const;

 private:
  struct Column {
    int signal = -1;  // -1: passed over
    char kind = ' ';  // C, L, D
  };
  bool line(std::string_view& text);
  void read_header();
  void types_of_version_2(std::string_view text);
  void types_of_version_3(std::string_view text);
  bool read_2(std::string_view head, ObservationEpoch& epoch);
  bool read_3(std::string_view head, ObservationEpoch& epoch);
  bool time_of(std::string_view head, bool version_2, ObservationEpoch& epoch, int& flag, int& count);
  void new_header_line(std::string_view text, bool first);
  bool next_epoch_line(std::string_view& text);
  bool take(std::string_view field, const Column& column, std::vector<SignalObservation>& found);
  void keep(const SatelliteName& satellite, std::vector<SignalObservation>& found, ObservationEpoch& epoch);
  void lose(bool whole_epoch, const std::string& field, const std::string& what);

  std::string path_;
  std::string text_;
  std::string digest_;
  std::size_t next_ = 0;
  long long line_ = 0;
  long long read_ = 0;
  int version_ = 0;
  std::vector<SignalName> signals_;
  std::map<char, std::vector<std::string>> types_;
  std::map<char, std::vector<Column>> columns_;
  bool renewed_ = false;
  char listed_ = ' ';  // the system whose types go on in the next line
  bool seconds_of_beidou_ = false;
  bool started_ = false;
  GpsTime last_;
  Vec3<double> position_ = Vec3<double>::Zero();
  RinexLosses losses_;
};

}  // namespace trunnion::io
