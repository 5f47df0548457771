// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Samples in text tables: columns found by a header name with the unit in it, or mapped by name or index with a unit.
///
/// One table of unit, encoders or both is read as any log is (log_format.hpp).
/// Names understood without a map: t_s, t_ms, t_us, t_ns, utime; gyro_x_rad_s, gyro_x_deg_s, gyro_x_deg_h;
/// accel_x_m_s2, accel_x_g, accel_x_mg; azimuth_rad, azimuth_deg, pitch_rad, pitch_deg. Separators: comma, semicolon,
/// tab or blanks. Numbers are read in the C locale.

#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trunnion/io/digest.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/positions/sample_sink.hpp"

namespace trunnion::io {

/// Where a quantity stands: by header name or, when that is empty, by index from zero.
struct ColumnChoice {
  std::string name;
  int index = -1;
  std::string unit;
};

/// Quantity (t, gyro_x ... accel_z, azimuth, pitch) to column.
using ColumnMap = std::map<std::string, ColumnChoice>;

/// Whether @p unit can measure @p quantity: for messages about a wrong unit, @p expected takes the list.
bool unit_fits(const std::string& quantity, const std::string& unit, std::string& expected);

/// One @p unit of @p quantity in SI; zero for a unit that does not measure it, and for counts.
double unit_in_si(const std::string& quantity, const std::string& unit);

/// Samples from two files with equal stamps, gyro and accelerometers apart; in both the map's indices count from the
/// file's own first column, and without a map columns 0 to 3 are t [s], x, y, z in counts.
void read_split_csv(const std::string& gyro_path, const std::string& accel_path, const ColumnMap& columns,
                    const SensorSheet& sheet, SampleSink& sink, std::string& gyro_digest, std::string& accel_digest);

/// Any columns by their header names with the unit in them: "t", "angle", "lat", "lon" (_rad, _deg), "h" (_m), ... in
/// SI.
/// @param row called with the values of each row, in the order of @p quantities
/// @throws Error (input) naming file, line and column
void read_columns_csv(const std::string& path, const std::vector<std::string>& quantities,
                      const std::function<void(const double*)>& row, std::string& digest);

/// Where the encoders' readings go when a log is written as a table at @p path: NAME_encoder.csv beside it.
std::string encoder_table_of(const std::string& path);

}  // namespace trunnion::io
