// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <lz4frame.h>
#include <zstd.h>

#include <cstring>

#include "io/format_bytes.hpp"
#include "io/log_reading.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

using testing::ElementsAre;

using McapRecordings = LogReading;

TEST_F(McapRecordings, HoldsStampsOfRosOnly) {
  const std::unique_ptr<LogWriter> writer = format_by_name("mcap").write(folder_ / "x.mcap");
  EXPECT_REFUSES(ExitCode::kInput, "ROS holds", writer->imu(-1, kSample));
  EXPECT_REFUSES(ExitCode::kInput, "ROS holds", writer->encoder(2147483648000000, 0.0, 0.0));
}

TEST_F(McapRecordings, OfRos1AndRos2) {
  const std::string imu = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr") +
                          mcap_message(1, cdr_imu(12, 345678900, kSample));
  read(mcap_head() + imu + mcap_end());
  EXPECT_THAT(collect_->stamps, ElementsAre(12345679));
  EXPECT_EQ(collect_->samples[0].w, kSample.w);
  EXPECT_EQ(collect_->samples[0].f, kSample.f);
  read(mcap_head() + mcap_schema(1, "sensor_msgs/Imu") + mcap_channel(3, 1, "/imu", "ros1") +
       mcap_message(3, ros1_imu(12, 345678000, kSample)) + mcap_end());
  EXPECT_THAT(collect_->stamps, ElementsAre(12345678));
  EXPECT_EQ(collect_->samples[0].f, kSample.f);
}

std::string compressed(const std::string& how, const std::string& records) {
  std::string out(ZSTD_compressBound(records.size()) + LZ4F_compressFrameBound(records.size(), nullptr), '\0');
  out.resize(how == "zstd" ? ZSTD_compress(out.data(), out.size(), records.data(), records.size(), 3)
                           : LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr));
  return out;
}

TEST_F(McapRecordings, InCompressedChunks) {
  const std::string channel = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  std::string records = channel;
  for (std::uint32_t k = 1; k <= 500; ++k) records += mcap_message(1, cdr_imu(k, 0, kSample));
  const std::uint32_t crc = crc_of(records);
  for (const char* how : {"zstd", "lz4"}) {
    SCOPED_TRACE(how);
    const std::string packed = compressed(how, records);
    EXPECT_LT(packed.size(), records.size() / 4);
    EXPECT_EQ(read(mcap_head() + mcap_chunk(how, packed, records.size(), crc) + mcap_end()).bytes, 0);
    EXPECT_EQ(collect_->samples.size(), 500U);
    for (const auto& [wrong, what] :
         {std::pair{mcap_chunk(how, packed, records.size(), crc ^ 1U), "checksum"},
          std::pair{mcap_chunk(how, packed, records.size() + 1, crc), "decompressed"},
          std::pair{mcap_chunk(how, packed, records.size() - 1, crc), "decompressed"},
          std::pair{mcap_chunk(how, packed, std::uint64_t{1} << 27U, 0), "another size"},
          std::pair{mcap_chunk(how, packed, std::uint64_t{1} << 29U, 0), "larger than 256 MiB"},
          std::pair{mcap_chunk(how, std::string(2000, 'n'), records.size(), 0), "decompressed"}}) {
      const auto& text = wrong;
      EXPECT_REFUSES(ExitCode::kInput, what, read(mcap_head() + text + mcap_end()));
    }
    // what is damaged is passed over where there is a hundred times as much else
    const std::string whole = mcap_chunk(how, packed, records.size(), crc);
    const std::string wrong = mcap_chunk(how, packed, records.size(), crc ^ 1U);
    std::string hundred;
    for (int k = 0; k < 110; ++k) hundred += whole;
    const LogLosses lost = read(mcap_head() + hundred + wrong + mcap_end());
    EXPECT_EQ(lost.records, 1);
    EXPECT_THAT(lost.note, testing::HasSubstr("chunk: does not have its checksum"));
    EXPECT_EQ(collect_->samples.size(), 110U * 500U);
    EXPECT_REFUSES(ExitCode::kInput, "bytes cannot be read", read(mcap_head() + whole + wrong + mcap_end()));
  }
  EXPECT_REFUSES(ExitCode::kInput, "zstd and lz4 are read",
                 read(mcap_head() + mcap_chunk("brotli", records, records.size(), crc) + mcap_end()));
}

TEST_F(McapRecordings, AreHeldToTheirOwnCounts) {
  const std::unique_ptr<LogWriter> writer = format_by_name("mcap").write(folder_ / "x.mcap");
  for (int k = 1; k <= 60000; ++k) writer->imu(10000LL * k, kSample);
  writer->commit();
  const std::string whole = read_whole(folder_ / "x.mcap");
  std::vector<std::size_t> chunks;  // where they begin
  for (std::size_t at = 8; at + 9 < whole.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, whole.data() + at + 1, 8);
    if (whole[at] == 6) chunks.push_back(at);
    at += 9 + length;
  }
  ASSERT_GT(chunks.size(), 2U);
  EXPECT_EQ(read(whole).samples, 0);
  for (const int kind : {2, 4, 7, 14, 15, 22, 38, 70, 134}) {  // a bit of the kind, and the end of the data
    std::string damaged = whole;
    damaged[chunks[1]] = static_cast<char>(kind);
    EXPECT_REFUSES(ExitCode::kInput, "of 60000 that the recorder counted", read(damaged));
  }
  for (const char* wrong : {"kind", "length"}) {
    std::string damaged = whole;
    damaged.replace(chunks[1] + (wrong[0] == 'k' ? 0 : 7), 1, 1, wrong[0] == 'k' ? '\0' : '\x7f');
    EXPECT_REFUSES(ExitCode::kInput, "has a kind or a length that cannot be", read(damaged));
    EXPECT_THAT(read(damaged.substr(0, damaged.size() - 1)).note, testing::HasSubstr("was not ended"));
  }
}

TEST_F(McapRecordings, SayWhichMessagesAreMissing) {
  const std::string schema = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  std::string messages;
  for (std::uint32_t k = 1; k <= 199; ++k) messages += mcap_message(1, cdr_imu(k, 0, kSample));
  const auto counted = [](char count) {
    std::string totals(42, '\0');
    const std::string of_channel{'\x0a', '\0', '\0', '\0', '\x01', '\0', count,
                                 '\0',   '\0', '\0', '\0', '\0',   '\0', '\0'};
    return mcap_record(11, totals + of_channel);
  };
  EXPECT_EQ(read(mcap_head() + schema + messages + counted('\xc7') + mcap_end()).samples, 0);
  EXPECT_EQ(read(mcap_head() + schema + messages + counted('\xc8') + mcap_end()).samples, 1);
  EXPECT_REFUSES(ExitCode::kInput, "/imu: has 199 messages, of 202",
                 read(mcap_head() + schema + messages + counted('\xca') + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "is of a channel that nothing describes",
                 read(mcap_head() + mcap_message(2, cdr_imu(1, 0, kSample)) + schema + messages + mcap_end()));
}

TEST_F(McapRecordings, ThatWasCut) {
  std::string log = mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  for (std::uint32_t k = 0; k < 50; ++k) log += mcap_message(1, cdr_imu(k, 0, kSample));
  const LogLosses lost = read(log.substr(0, log.size() - 7));
  EXPECT_EQ(collect_->samples.size(), 49U);
  EXPECT_EQ(lost.records, 1);
  EXPECT_EQ(read(log).records, 1) << "a recording that was not ended";
  EXPECT_REFUSES(ExitCode::kInput, "it has no topics, and was cut there", read(mcap_head()));
}

TEST_F(McapRecordings, OfAnotherEncodingAreNamedWithIt) {
  EXPECT_REFUSES(ExitCode::kInput, "it has topics /imu (sensor_msgs/msg/Imu) in json",
                 read(mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "json") +
                      mcap_message(1, "{}") + mcap_end()));
}

TEST_F(McapRecordings, WithSeveralTopics) {
  const std::string types = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_schema(2, "sensor_msgs/msg/JointState") +
                            mcap_schema(3, "sensor_msgs/msg/Image");
  const std::string log =
      mcap_head() + types + mcap_channel(1, 1, "/imu/a", "cdr") + mcap_channel(2, 2, "/joint_states", "cdr") +
      mcap_channel(3, 3, "/camera", "cdr") + mcap_message(1, cdr_imu(1, 0, kSample)) +
      mcap_message(2, cdr_joints(2, {"wheel", "pitch", "azimuth"}, {9.0, 0.5, 0.25})) + mcap_message(3, "an image");
  LogRequest both;
  both.need_encoder = true;
  read(log + mcap_end(), both);
  EXPECT_THAT(collect_->angles, ElementsAre(std::array<double, 2>{0.25, 0.5}));
  both.joints = {"pan", "tilt"};
  EXPECT_REFUSES(ExitCode::kInput, "no position of a joint 'pan'", read(log + mcap_end(), both));
  EXPECT_EQ(read(log + mcap_end()).note, "") << "joints that are there and were not asked for";
  LogRequest pan;
  pan.joints = {"pan", "tilt"};
  EXPECT_EQ(read(log + mcap_end(), pan).note,
            "1 joint states passed over; the first has no position of a joint 'pan', but of wheel, pitch, azimuth "
            "(axes: of a run file names them)");
  const std::string again =
      mcap_channel(9, 2, "/other", "cdr") + mcap_message(9, cdr_joints(3, {"pitch", "azimuth"}, {0.1, 0.2}));
  EXPECT_REFUSES(ExitCode::kInput, "more than one: /joint_states and /other", read(log + again + mcap_end()));
  read(log + mcap_channel(8, 1, "/imu/idle", "cdr") + mcap_end());
  EXPECT_EQ(collect_->samples.size(), 1U) << "a topic without a message is no other";
  read(log + mcap_channel(7, 3, "", "cdr") + mcap_end());
  EXPECT_EQ(collect_->samples.size(), 1U) << "nor is a topic without a name";

  const std::string two = log + mcap_channel(4, 1, "/imu/b", "cdr") + mcap_message(4, cdr_imu(3, 0, kSample));
  EXPECT_REFUSES(ExitCode::kInput, "more than one: /imu/a and /imu/b", read(two + mcap_end()));
  LogRequest b;
  b.channels.imu.name = "/imu/b";
  read(two + mcap_end(), b);
  EXPECT_THAT(collect_->stamps, ElementsAre(3000000));
  b.channels.imu.name = "/camera";
  EXPECT_REFUSES(ExitCode::kInput, "is of type sensor_msgs/msg/Image in cdr, not sensor_msgs/msg/Imu", read(log, b));
  b.channels.imu.name = "/none";
  EXPECT_REFUSES(ExitCode::kInput,
                 "no samples of an IMU on '/none'; it has topics /imu/a (sensor_msgs/msg/Imu), /joint_states "
                 "(sensor_msgs/msg/JointState), /camera",
                 read(log + mcap_end(), b));
}

TEST_F(McapRecordings, WhoseChunksOverlapIsToBeSorted) {
  const std::string channel = mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  const auto chunk = [&](std::uint32_t from, std::uint32_t step) {
    std::string records = channel;
    for (std::uint32_t k = 0; k < 50; ++k) {
      const std::uint32_t at = from + step * k;
      records += mcap_message(1, cdr_imu(at, 0, kSample), 1000000000ULL * at);
    }
    return mcap_chunk("", records, records.size(), 0);
  };
  EXPECT_REFUSES(ExitCode::kInput, "/imu: goes back within the time of the chunk before: sort",
                 read(mcap_head() + chunk(100, 2) + chunk(101, 2) + mcap_end()));
  read(mcap_head() + chunk(100, 1) + chunk(150, 1) + chunk(1, 1) + mcap_end());  // a clock that was reset
  EXPECT_EQ(collect_->samples.size(), 150U);
}

// Texts are let in before anything is known of them: a chunk of 17 KB can hold a name of 256 MiB.
TEST_F(McapRecordings, NamesAreOfALengthThatNamesHave) {
  EXPECT_REFUSES(ExitCode::kInput, "schema: has no name",
                 read(mcap_head() + mcap_schema(1, std::string(2000, 'n')) + mcap_end()));
}

TEST_F(McapRecordings, MessagesThatAreNone) {
  const std::string head = mcap_head() + mcap_schema(1, "sensor_msgs/msg/Imu") + mcap_channel(1, 1, "/imu", "cdr");
  const std::string whole = cdr_imu(1, 0, kSample);
  EXPECT_REFUSES(ExitCode::kInput, "shorter than its type",
                 read(head + mcap_message(1, whole.substr(0, whole.size() - 1)) + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "shorter than its type", read(head + mcap_message(1, "") + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "no linear acceleration",
                 read(head + mcap_message(1, cdr_imu(1, 0, kSample, 0.0, -1.0)) + mcap_end()));
  EXPECT_REFUSES(ExitCode::kInput, "no angular velocity",
                 read(head + mcap_message(1, cdr_imu(1, 0, kSample, -1.0, 0.0)) + mcap_end()));
  InertialSample<double> none = kSample;
  none.f.y() = std::nan("");
  EXPECT_REFUSES(ExitCode::kInput, "specific_force[1]: is not finite",
                 read(head + mcap_message(1, cdr_imu(1, 0, none)) + mcap_end()));
  std::string other_order = whole;
  other_order[1] = 0;  // big-endian: the same bytes are other numbers, or no message
  EXPECT_REFUSES(ExitCode::kInput, "", read(head + mcap_message(1, other_order) + mcap_end()));
}

}  // namespace
}  // namespace trunnion::io
