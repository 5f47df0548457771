// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A track against the truth.

#pragma once

#include <optional>
#include <string>

#include "track.hpp"

namespace trunnion::app {

struct Comparison {
  double time = 0.0;                // s, compared
  double distance = 0.0;            // m, of the truth
  bool moving = false;              // the truth has a course somewhere
  double largest_horizontal = 0.0;  // m
  double end_horizontal = 0.0;      // m
  double largest_vertical = 0.0;    // m
  double heading_rms = 0.0;         // rad, against the course where the truth moves faster than 1 m/s
  double heading_end = 0.0;         // rad, mean of the last two seconds of that
};

class Truth {
 public:
  /// CSV with t_s, lat_deg, lon_deg and h_m. @param offset added to stamps of the track to get the truth's [s]
  /// @throws Error (input)
  Truth(const std::string& path, double offset);

  /// Where and when it starts.
  [[nodiscard]] double latitude() const { return point_.front().latitude; }
  [[nodiscard]] double longitude() const { return point_.front().longitude; }
  [[nodiscard]] double height() const { return point_.front().height; }

  /// What is to be added to the heading of the track [rad] so that over the first @p seconds of motion its mean is the
  /// course of the truth. @throws Error (input) when nothing moves
  [[nodiscard]] double heading_offset(const Track& track, double seconds) const;

  /// @throws Error (input) when they have no time in common
  [[nodiscard]] Comparison compare(const Track& track) const;

 private:
  struct Point {
    double t, latitude, longitude, height;
    double north, east;    // m from the first
    double speed, course;  // m/s, rad
  };
  template <class Visit>
  void along(const Track& track, Visit visit) const;

  std::vector<Point> point_;
  double offset_;
};

/// The track turned about its start, of a wheel whose heading was found afterwards.
void turn_track(Track& track, double angle);

}  // namespace trunnion::app
