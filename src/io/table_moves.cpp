// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/table_moves.hpp"

#include <charconv>
#include <cmath>

#include "trunnion/core/units.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr double kLongest = 1e6;  // s

void append(double value, char after, std::string& out) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  out.append(text.data(), result.ptr);
  out += after;
}

}  // namespace

TableMoves read_table_moves(const std::string& path, std::size_t recordings) {
  TableMoves moves;
  std::string digest;
  long long row = 1;  // the header
  const auto fail = [&](const char* field, const std::string& what) { throw input_error(path, row, field, what); };
  read_columns_csv(
      path,
      {"recording", "duration", "transition", "azimuth", "azimuth_rate", "azimuth_swing", "azimuth_frequency", "pitch",
       "pitch_rate", "pitch_swing", "pitch_frequency"},
      [&](const double* v) {
        ++row;
        const double number = v[0];
        if (!(number >= 1.0) ||
            (number != static_cast<double>(moves.size()) && number != static_cast<double>(moves.size() + 1)))
          fail("recording", "should go on from " + std::to_string(moves.size()) + " in steps of one");
        if (number > static_cast<double>(recordings))
          fail("recording", "the run has " + std::to_string(recordings) + " recordings");
        if (number == static_cast<double>(moves.size() + 1)) moves.emplace_back();
        if (!(v[1] >= 0.0 && v[1] <= kLongest)) fail("duration", "should be 0 to 1e6 s");
        if (v[1] == 0.0 && !moves.back().empty()) fail("duration", "is zero: only the first row says where it stands");
        TableMove move{v[1], v[2], {}};
        for (std::size_t a = 0; a < 2; ++a) {
          const double* axis = v + 3 + 4 * a;
          move.axis[a] = {axis[0], axis[1], axis[2], axis[3]};
          if (axis[2] != 0.0 && !(axis[3] > 0.0)) fail("frequency", "of a swing should be positive");
        }
        moves.back().push_back(move);
      },
      digest);
  if (moves.size() != recordings) {
    throw input_error(
        path, 0, "recording",
        "has moves for " + std::to_string(moves.size()) + " recordings, the run has " + std::to_string(recordings));
  }
  return moves;
}

std::string to_csv(const TableMoves& moves) {
  std::string out =
      "recording,duration_s,transition_s,azimuth_deg,azimuth_rate_deg_s,azimuth_swing_deg,azimuth_frequency_hz,"
      "pitch_deg,pitch_rate_deg_s,pitch_swing_deg,pitch_frequency_hz\n";
  // nine digits after the point of a degree are 20 prad
  const auto degrees = [](double radians) { return std::round(radians / kRadPerDeg * 1e9) / 1e9 + 0.0; };
  for (std::size_t r = 0; r < moves.size(); ++r) {
    for (const TableMove& move : moves[r]) {
      append(static_cast<double>(r + 1), ',', out);
      append(move.duration, ',', out);
      append(move.transition, ',', out);
      for (std::size_t a = 0; a < 2; ++a) {
        const AxisCommand& axis = move.axis[a];
        append(degrees(axis.angle), ',', out);
        append(degrees(axis.rate), ',', out);
        append(degrees(axis.amplitude), ',', out);
        append(axis.frequency, a == 1 ? '\n' : ',', out);
      }
    }
  }
  return out;
}

}  // namespace trunnion::io
