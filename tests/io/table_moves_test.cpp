// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/table_moves.hpp"

#include <gtest/gtest.h>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

const std::string kHeader =
    "recording,duration_s,transition_s,azimuth_deg,azimuth_rate_deg_s,azimuth_swing_deg,azimuth_frequency_hz,"
    "pitch_deg,pitch_rate_deg_s,pitch_swing_deg,pitch_frequency_hz\n";

TableMoves read(const std::string& rows, std::size_t recordings) {
  const TemporaryFolder folder;
  const std::string path = folder / "moves.csv";
  write_whole(path, kHeader + rows);
  return read_table_moves(path, recordings);
}

TEST(TableMoves, ComeBackAsTheyWereWritten) {
  const TableMoves moves = {
      {{0.0, 1.0, {AxisCommand{0.1, 0, 0, 0}, AxisCommand{30.0 * kRadPerDeg, 0, 0, 0}}},
       {27.5, 2.25, {AxisCommand{0.1, -50.0 * kRadPerDeg, 0, 0}, AxisCommand{0.5, 0, 0.3, 0.16}}}},
      {{10.0, 3.0, {}}}};
  const TemporaryFolder folder;
  const std::string path = folder / "moves.csv";
  write_whole(path, to_csv(moves));
  const TableMoves again = read_table_moves(path, 2);
  ASSERT_EQ(again.size(), 2U);
  ASSERT_EQ(again[0].size(), 2U);
  for (std::size_t a = 0; a < 2; ++a) {
    const AxisCommand& was = moves[0][1].axis[a];
    const AxisCommand& is = again[0][1].axis[a];
    EXPECT_NEAR(is.angle, was.angle, 2e-11);
    EXPECT_NEAR(is.rate, was.rate, 2e-11);
    EXPECT_NEAR(is.amplitude, was.amplitude, 2e-11);
    EXPECT_EQ(is.frequency, was.frequency);
  }
  EXPECT_EQ(again[0][1].duration, 27.5);
  EXPECT_EQ(again[0][1].transition, 2.25);
  EXPECT_EQ(to_csv(again), to_csv(moves));
}

TEST(TableMoves, AreRefusedByLineAndColumn) {
  const auto refused = [](const std::string& rows, const char* words) {
    EXPECT_REFUSES(ExitCode::kInput, words, read(rows, 2));
  };
  refused("1,10,1,0,0,0,0,0,0,0,0\n3,10,1,0,0,0,0,0,0,0,0\n", "moves.csv:3: recording: should go on from 1");
  refused("1,10,1,0,0,0,0,0,0,0,0\n", "has moves for 1 recordings, the run has 2");
  refused("1,10,1,0,0,0,0,0,0,0,0\n2,1,1,0,0,0,0,0,0,0,0\n3,1,1,0,0,0,0,0,0,0,0\n", "the run has 2 recordings");
  refused("1,-1,1,0,0,0,0,0,0,0,0\n", "duration: should be 0 to 1e6 s");
  refused("1,10,1,0,0,0,0,0,0,0,0\n1,0,1,0,0,0,0,0,0,0,0\n", "only the first row says where it stands");
  refused("1,10,1,0,0,5,0,0,0,0,0\n", "frequency: of a swing should be positive");
  refused("1,10,1,0,0,nan,0,0,0,0,0\n", "azimuth_swing");
  refused("0,0,1,0,0,0,0,0,0,0,0\n", "moves.csv:2: recording: should go on from 0");
  refused("1,10,1,0,0,0\n", "row too short");
}

}  // namespace
}  // namespace trunnion::io
