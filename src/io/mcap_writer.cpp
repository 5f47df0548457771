// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <zstd.h>

#include <algorithm>
#include <array>
#include <limits>

#include "little_endian.hpp"
#include "mcap_records.hpp"
#include "ros_message.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
constexpr int kLevel = 1;  // of zstd

void add_text(std::string& out, std::string_view text) {
  append_little(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

void add_record(std::string& out, McapKind kind, std::string_view content) {
  out += static_cast<char>(kind);
  append_little(out, static_cast<std::uint64_t>(content.size()));
  out.append(content);
}

class McapWriter final : public LogWriter {
 public:
  explicit McapWriter(const std::string& path) : path_(path), file_(path) {
    write(kMcapMagic);
    std::string header;
    add_text(header, "ros2");
    add_text(header, "trunnion");
    write_record(McapKind::kHeader, header);
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      std::string schema;
      append_little(schema, id_of(i));
      add_text(schema, topics_[i].type);
      add_text(schema, "ros2msg");
      add_text(schema, topics_[i].definition);
      add_record(definitions_, McapKind::kSchema, schema);
      std::string channel;
      append_little(channel, id_of(i));
      append_little(channel, id_of(i));
      add_text(channel, topics_[i].name);
      add_text(channel, "cdr");
      append_little(channel, std::uint32_t{0});  // no metadata
      add_record(definitions_, McapKind::kChannel, channel);
    }
    write(definitions_);
  }

  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    check(utime);
    encode_ros_imu(utime, sample, message_);
    add(0, utime);
  }
  [[nodiscard]] bool holds_temperature() const override { return false; }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    check(utime);
    encode_ros_joints(utime, joints_, {azimuth, pitch}, message_);
    add(1, utime);
  }
  void commit() override {
    flush();
    write_record(McapKind::kDataEnd, std::string(4, '\0'));  // no checksum
    const std::uint64_t summary = offset_;
    write(definitions_);
    write(chunk_indices_);
    write_statistics();
    std::string footer;
    append_little(footer, summary);
    footer.append(12, '\0');  // no offsets within the summary, no checksum
    write_record(McapKind::kFooter, footer);
    write(kMcapMagic);
    file_.commit();
  }
  [[nodiscard]] std::vector<std::string> files() const override { return {path_}; }

 private:
  struct Topic {
    const char* name;
    const char* type;
    const char* definition;
    std::uint64_t messages = 0;
    std::string index;  // of the chunk: stamp and place of each message
  };
  struct Span {
    std::uint64_t first = std::numeric_limits<std::uint64_t>::max();  // ns
    std::uint64_t last = 0;
    void add(std::uint64_t at) {
      first = std::min(first, at);
      last = std::max(last, at);
    }
  };

  static std::uint16_t id_of(std::size_t topic) { return static_cast<std::uint16_t>(topic + 1); }

  void write(std::string_view bytes) {
    file_.write(bytes);
    offset_ += bytes.size();
  }
  void write_record(McapKind kind, std::string_view content) {
    record_.clear();
    add_record(record_, kind, content);
    write(record_);
  }
  void check(std::int64_t utime) const {
    if (utime < 0 || utime / 1000000 > std::numeric_limits<std::int32_t>::max())
      throw input_error(path_, 0, "", "a stamp of " + std::to_string(utime) + " us: ROS holds 0 to 2147483647 s");
  }
  void add(std::size_t topic, std::int64_t utime) {
    const auto log_time = static_cast<std::uint64_t>(1000 * utime);
    append_little(topics_[topic].index, log_time);
    append_little(topics_[topic].index, static_cast<std::uint64_t>(chunk_.size()));
    record_.clear();
    append_little(record_, id_of(topic));
    append_little(record_, static_cast<std::uint32_t>(topics_[topic].messages++));
    append_little(record_, log_time);
    append_little(record_, log_time);
    record_.append(message_);
    add_record(chunk_, McapKind::kMessage, record_);
    span_.add(log_time);
    if (chunk_.size() >= kChunkBytes) flush();
  }

  /// The chunk, the index of its messages by topic, and what the summary says of it.
  void flush() {
    if (chunk_.empty()) return;
    packed_.resize(ZSTD_compressBound(chunk_.size()));
    const std::size_t size = ZSTD_compress(packed_.data(), packed_.size(), chunk_.data(), chunk_.size(), kLevel);
    if (ZSTD_isError(size) != 0U) throw input_error(path_, 0, "", std::string("zstd: ") + ZSTD_getErrorName(size));
    std::string chunk;
    append_little(chunk, span_.first);
    append_little(chunk, span_.last);
    append_little(chunk, static_cast<std::uint64_t>(chunk_.size()));
    append_little(chunk, mcap_crc(chunk_));
    add_text(chunk, "zstd");
    append_little(chunk, static_cast<std::uint64_t>(size));
    chunk.append(packed_.data(), size);
    const std::uint64_t start = offset_;
    write_record(McapKind::kChunk, chunk);
    const std::uint64_t end = offset_;
    std::string places;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].index.empty()) continue;
      append_little(places, id_of(i));
      append_little(places, offset_);
      std::string index;
      append_little(index, id_of(i));
      add_text(index, topics_[i].index);
      write_record(McapKind::kMessageIndex, index);
      topics_[i].index.clear();
    }
    std::string in_summary;
    append_little(in_summary, span_.first);
    append_little(in_summary, span_.last);
    append_little(in_summary, start);
    append_little(in_summary, end - start);
    add_text(in_summary, places);
    append_little(in_summary, offset_ - end);
    add_text(in_summary, "zstd");
    append_little(in_summary, static_cast<std::uint64_t>(size));
    append_little(in_summary, static_cast<std::uint64_t>(chunk_.size()));
    add_record(chunk_indices_, McapKind::kChunkIndex, in_summary);
    ++chunks_;
    whole_.add(span_.first);
    whole_.add(span_.last);
    span_ = {};
    chunk_.clear();
  }

  void write_statistics() {
    std::string counts;
    std::uint64_t messages = 0;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].messages == 0) continue;
      messages += topics_[i].messages;
      append_little(counts, id_of(i));
      append_little(counts, topics_[i].messages);
    }
    std::string statistics;
    append_little(statistics, messages);
    append_little(statistics, static_cast<std::uint16_t>(topics_.size()));
    append_little(statistics, static_cast<std::uint32_t>(topics_.size()));
    append_little(statistics, std::uint32_t{0});  // attachments
    append_little(statistics, std::uint32_t{0});  // metadata
    append_little(statistics, chunks_);
    append_little(statistics, messages > 0 ? whole_.first : 0);
    append_little(statistics, whole_.last);
    add_text(statistics, counts);
    write_record(McapKind::kStatistics, statistics);
  }

  std::string path_;
  std::array<std::string, 2> joints_ = LogRequest().joints;
  WholeFile file_;
  std::uint64_t offset_ = 0;
  std::array<Topic, 2> topics_{{{"/imu/data", "sensor_msgs/msg/Imu", kRosImuDefinition, 0, {}},
                                {"/joint_states", "sensor_msgs/msg/JointState", kRosJointStateDefinition, 0, {}}}};
  std::string definitions_;  // schemas and channels, as records
  std::string chunk_indices_;
  std::uint32_t chunks_ = 0;
  Span span_;   // of the chunk
  Span whole_;  // of the recording
  std::string message_;
  std::string record_;
  std::string chunk_;
  std::string packed_;
};

}  // namespace

std::unique_ptr<LogWriter> write_mcap(const std::string& path) { return std::make_unique<McapWriter>(path); }

}  // namespace trunnion::io
