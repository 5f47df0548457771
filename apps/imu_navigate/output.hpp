// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A track as a table, a log, a map and pictures.

#pragma once

#include <string>

#include "track.hpp"

namespace trunnion::app {

/// t_s,lat_deg,lon_deg,h_m,north_m_s,east_m_s,down_m_s,roll_deg,pitch_deg,yaw_deg
void write_csv(const std::string& path, const Track& track);
/// navigation_t on channel NAVIGATION.
void write_log(const std::string& path, const Track& track);
/// A line on a map.
void write_kml(const std::string& path, const Track& track);
/// Track, height, velocity and attitude as PNG files in a folder, by gnuplot.
/// @param truth a CSV to draw beside it; empty: none. @throws Error (input) when gnuplot is not there or fails
void write_plots(const std::string& folder, const std::string& table, const std::string& truth);

}  // namespace trunnion::app
