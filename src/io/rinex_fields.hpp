// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// RINEX's lines: fields at fixed columns.

#pragma once

#include <optional>
#include <string_view>

#include "trunnion/io/rinex_names.hpp"

namespace trunnion::io::rinex {

inline constexpr std::string_view kLetters = "GEJC";  ///< in the order of SatelliteSystem
inline constexpr double kBeidouBehind = 14.0;         ///< s, of its time against GPS time
inline constexpr std::size_t kLabel = 60;             ///< column of a header line's label

/// The file's next line from @p next on, without its end. @return false at the end of @p text
bool take_line(std::string_view text, std::size_t& next, std::string_view& line);

/// Columns that a short line has not are empty.
std::string_view part(std::string_view text, std::size_t from, std::size_t count);
std::string_view trimmed(std::string_view text);

/// The whole of a field as a number; D for E as Fortran writes it. Nothing for blanks and for anything else.
std::optional<double> number(std::string_view field);
std::optional<int> integer(std::string_view field);

bool has_band(SatelliteSystem system, char band);

/// "G05", " 5" of GPS. Nothing for another system.
std::optional<SatelliteName> satellite_name(std::string_view field);

}  // namespace trunnion::io::rinex
