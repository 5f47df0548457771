// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// MCAP, the container of ROS 2's recordings. Chunks hold records in turn, compressed. Read from front to back, without
// the indices, so a recording that was cut is read, too; one that was finished has counts that what was read is held
// to.

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "byte_stream.hpp"
#include "little_endian.hpp"
#include "log_formats.hpp"
#include "mcap_records.hpp"
#include "ros_message.hpp"

namespace trunnion::io {
namespace {

constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 28U;
constexpr std::uint64_t kLargestRecord = std::uint64_t{1} << 28U;  // of what is read
constexpr std::size_t kLongestName = 1024;                         // of a topic, a type or an encoding: ROS has 255
constexpr double kTolerableLoss = 0.01;                            // of the messages
constexpr std::uint64_t kJitter = 100000000;                       // ns, by which recorders mix up what comes at once

/// Members of a record, one after the other.
class Fields {
 public:
  explicit Fields(std::string_view record) : rest_(record) {}

  template <class T>
  T number() {
    if (rest_.size() < sizeof(T)) {
      whole_ = false;
      rest_ = {};
      return T{};
    }
    const T v = load_little<T>(rest_.data());
    rest_.remove_prefix(sizeof(T));
    return v;
  }
  std::string_view bytes(std::uint64_t length) {
    if (rest_.size() < length) {
      whole_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view found = rest_.substr(0, static_cast<std::size_t>(length));
    rest_.remove_prefix(static_cast<std::size_t>(length));
    return found;
  }
  std::string_view text() { return bytes(number<std::uint32_t>()); }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] bool whole() const { return whole_; }

 private:
  std::string_view rest_;
  bool whole_ = true;
};

/// A chunk's records as they were before they were compressed.
class Inflater {
 public:
  Inflater() : zstd_(ZSTD_createDCtx()) {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&lz4_, LZ4F_VERSION)) != 0U) lz4_ = nullptr;
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() {
    ZSTD_freeDCtx(zstd_);
    LZ4F_freeDecompressionContext(lz4_);
  }

  /// @return what is wrong, or empty
  std::string inflate(const std::string& compression, std::string_view from, std::size_t size, std::string_view& out) {
    if (compression.empty()) {
      out = from;
      return from.size() == size ? "" : "has another size than it says";
    }
    if (compression != "zstd" && compression != "lz4")
      return "is compressed with '" + printable(compression) + "': zstd and lz4 are read";
    // a size that no compression reaches is a lie, and is not made room for
    if (size / (compression == "zstd" ? kLargestRatioOfZstd : kLargestRatioOfLz4) > from.size())
      return "has another size than it says";
    if (buffer_.size() < size) buffer_.resize(size);
    const std::size_t made = compression == "zstd" ? zstd(from, size) : lz4(from, size);
    out = {buffer_.data(), made};
    return made == size ? "" : "cannot be decompressed";
  }

 private:
  static constexpr std::size_t kLargestRatioOfZstd = 40000;  // a block of 128 KiB of one byte
  static constexpr std::size_t kLargestRatioOfLz4 = 256;

  std::size_t zstd(std::string_view from, std::size_t size) {
    const std::size_t made = ZSTD_decompressDCtx(zstd_, buffer_.data(), size, from.data(), from.size());
    return ZSTD_isError(made) != 0U ? 0 : made;
  }

  std::size_t lz4(std::string_view from, std::size_t size) {
    LZ4F_resetDecompressionContext(lz4_);
    std::size_t made = 0;
    std::size_t hint = 1;  // zero at the end of the frame
    while (!from.empty() && hint != 0) {
      std::size_t room = size - made;
      std::size_t taken = from.size();
      hint = LZ4F_decompress(lz4_, buffer_.data() + made, &room, from.data(), &taken, nullptr);
      if (LZ4F_isError(hint) != 0U || (room == 0 && taken == 0)) return 0;
      made += room;
      from.remove_prefix(taken);
    }
    return hint == 0 && from.empty() ? made : 0;
  }

  ZSTD_DCtx* zstd_;
  LZ4F_dctx* lz4_ = nullptr;
  std::vector<char> buffer_;
};

/// "sensor_msgs/msg/Imu" of ROS 2 and "sensor_msgs/Imu" of ROS 1.
bool is_type(const std::string& schema, const std::string& package, const std::string& name) {
  return schema == package + "/msg/" + name || schema == package + "/" + name;
}

class McapReader {
 public:
  McapReader(const LogRequest& request, SampleSink& sink)
      : request_(request), stream_(request.path, request.digest), intake_(sink) {}

  LogLosses read() {
    stream_.skip(stream_.have(kMcapMagic.size()) ? kMcapMagic.size() : stream_.available());
    bool data_ended = false;
    ByteProgress progress(request_.progress);
    while (left() > kMcapMagic.size() && stream_.have(kMcapRecordHeader)) {
      byte_ = stream_.offset();
      const auto kind = static_cast<McapKind>(stream_.data()[0]);
      const auto length = load_little<std::uint64_t>(stream_.data() + 1);
      const bool wanted = (kind >= McapKind::kSchema && kind <= McapKind::kChunk) || kind == McapKind::kStatistics;
      if (kind == McapKind{} || length > left() - kMcapRecordHeader || (wanted && length > kLargestRecord)) break;
      if (wanted) {
        if (!stream_.have(kMcapRecordHeader + static_cast<std::size_t>(length))) break;
        take(kind, {stream_.data() + kMcapRecordHeader, static_cast<std::size_t>(length)});
      }
      stream_.pass(kMcapRecordHeader + length);
      data_ended = data_ended || (kind == McapKind::kDataEnd && length == kMcapDataEnd);
      progress.show(stream_);
    }
    const auto unread = static_cast<std::int64_t>(left());
    const bool closed = is_closed();
    const std::int64_t cut = closed || data_ended ? 0 : std::max<std::int64_t>(unread, 1);
    if (closed && unread > static_cast<std::int64_t>(kMcapMagic.size()))
      intake_.lose(unread, AtByte(request_.path, byte_)("record", "has a kind or a length that cannot be"));
    finish(cut);
    std::string note = intake_.first_loss();
    const auto add = [&](const std::string& words) { note += (note.empty() ? "" : "; ") + words; };
    if (other_joints_ > 0)
      add(std::to_string(other_joints_) + " joint states passed over; the first " + other_joint_ +
          " (axes: of a run file names them)");
    const long long readings = missing(Role::kEncoder);
    if (readings > 0)
      add(std::to_string(readings) + " readings of the encoders are missing, as the recorder's own count says");
    if (cut > 0) add("the recording was not ended");
    LogLosses losses = losses_of(intake_, cut, note);
    losses.samples = missing(Role::kImu);
    return losses;
  }

 private:
  enum class Role { kOther, kImu, kEncoder };
  struct Channel {
    std::string topic;
    std::string type;
    std::string shown;  // for people
    RosEncoding encoding = RosEncoding::kCdr;
    Role role = Role::kOther;
    std::int64_t chunk = 0;   // where the last one with its messages is
    std::uint64_t first = 0;  // ns, of its messages there
    std::uint64_t last = 0;
    std::uint64_t messages = 0;  // seen
    std::uint64_t counted = 0;   // by the recorder
    [[nodiscard]] std::uint64_t missing() const { return counted > messages ? counted - messages : 0; }
  };

  [[nodiscard]] std::uint64_t left() const { return static_cast<std::uint64_t>(stream_.size() - stream_.offset()); }

  /// Goes on to the end, for the digest is of all. @return whether it ends as a recording that was finished
  bool is_closed() {
    while (stream_.have(kMcapMagic.size() + 1)) stream_.skip(stream_.available() - kMcapMagic.size());
    return std::string_view(stream_.data(), stream_.available()) == kMcapMagic;
  }

  void take(McapKind kind, std::string_view record) {
    if (kind == McapKind::kMessage) return message(record);
    if (kind == McapKind::kChunk) return chunk(record);
    if (kind == McapKind::kStatistics) return statistics(record);
    Fields fields(record);
    const auto id = fields.number<std::uint16_t>();
    if (kind == McapKind::kSchema) {
      const std::string_view name = fields.text();
      if (!fields.whole() || name.size() > kLongestName) return damage(record.size(), "schema", "has no name");
      schemas_[id] = name;
      return;
    }
    const auto schema = fields.number<std::uint16_t>();
    const std::string topic(fields.text().substr(0, kLongestName));
    const std::string_view encoding = fields.text().substr(0, kLongestName);
    if (!fields.whole()) return damage(record.size(), "channel", "is shorter than its members");
    if (channels_.count(id) != 0) return;
    Channel channel;
    channel.topic = topic;
    channel.type = schemas_[schema];
    if (encoding == "ros1") channel.encoding = RosEncoding::kRos1;
    const bool known = encoding == "cdr" || encoding == "ros1";
    channel.shown = channel.topic + (channel.type.empty() ? "" : " (" + channel.type + ")") +
                    (known ? "" : " in " + std::string(encoding));
    const std::string& imu = request_.channels.imu.name;
    const std::string& encoder = request_.channels.encoder.name;
    const bool is_imu = known && is_type(channel.type, "sensor_msgs", "Imu");
    const bool is_joints = known && is_type(channel.type, "sensor_msgs", "JointState");
    const bool named_imu = !imu.empty() && topic == imu;
    if (named_imu || (!encoder.empty() && topic == encoder)) {
      if (named_imu ? !is_imu : !is_joints)
        throw input_error(request_.path, 0, printable(topic),
                          "is of type " + printable(channel.type) + " in " + printable(std::string(encoding)) +
                              ", not " + (named_imu ? "sensor_msgs/msg/Imu" : "sensor_msgs/msg/JointState"));
    }
    if (is_imu && (imu.empty() || topic == imu)) channel.role = Role::kImu;
    if (is_joints && (encoder.empty() || topic == encoder)) channel.role = Role::kEncoder;
    channels_[id] = channel;
  }

  /// One topic is read: where there are two, the user says which.
  void claim(std::string& claimed, const std::string& topic, const char* key) const {
    if (!claimed.empty() && claimed != topic)
      throw input_error(request_.path, 0, "",
                        "has more than one: " + printable(claimed) + " and " + printable(topic) +
                            "; name one under channels: {" + key + ": ...}, or with " +
                            (std::string(key) == "imu" ? "--channel" : "--encoder-channel"));
    claimed = topic;
  }

  void message(std::string_view record) {
    Fields fields(record);
    const auto channel = channels_.find(fields.number<std::uint16_t>());
    fields.number<std::uint32_t>();  // its number: zero where the recorder has none
    const auto log_time = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    if (!fields.whole()) return damage(record.size(), "message", "is shorter than its members");
    if (channel == channels_.end()) return damage(record.size(), "message", "is of a channel that nothing describes");
    if (channel->second.role == Role::kOther) return;
    Channel& of = channel->second;
    ++of.messages;
    follow(of, log_time);
    std::string wrong;
    if (of.role == Role::kImu) {
      claim(imu_topic_, of.topic, "imu");
      const auto imu = decode_ros_imu(fields.rest(), of.encoding, wrong);
      if (imu && (imu->utime != 0 || intake_.samples() == 0))  // simulated time begins at zero
        return intake_.imu(imu->utime, imu->sample, record.size(), AtByte(request_.path, byte_));
    } else {
      if (const auto at = decode_ros_joints(fields.rest(), of.encoding, request_.joints, wrong)) {
        claim(encoder_topic_, of.topic, "encoder");
        return intake_.encoder(at->utime, at->angle, record.size(), AtByte(request_.path, byte_));
      }
      if (!request_.need_encoder) {  // the joints of something else
        if (other_joints_++ == 0) other_joint_ = wrong;
        return;
      }
    }
    if (wrong.empty())
      wrong = "has no stamp: its header's is zero, and when it was recorded says nothing of when it was measured";
    damage(record.size(), of.topic, wrong);
  }

  /// Chunks that overlap in time, as recordings that were merged have them, are not put in order here.
  void follow(Channel& of, std::uint64_t log_time) const {
    if (of.chunk != byte_) {
      if (log_time >= of.first && log_time + kJitter < of.last)
        throw input_error_at_byte(request_.path, byte_, printable(of.topic),
                                  "goes back within the time of the chunk before: sort the recording (mcap sort)");
      of.chunk = byte_;
      of.first = log_time;
    }
    of.last = log_time;
  }

  void chunk(std::string_view record) {
    Fields fields(record);
    fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string compression(fields.text().substr(0, kLongestName));
    const std::string_view packed = fields.bytes(fields.number<std::uint64_t>());
    std::string wrong = !fields.whole()        ? "is shorter than its members"
                        : size > kLargestChunk ? "is larger than 256 MiB"
                                               : "";
    std::string_view records;
    if (wrong.empty()) wrong = inflater_.inflate(compression, packed, static_cast<std::size_t>(size), records);
    if (wrong.empty() && crc != 0 && mcap_crc(records) != crc) wrong = "does not have its checksum";
    if (!wrong.empty())
      return intake_.lose(static_cast<std::int64_t>(record.size()), AtByte(request_.path, byte_)("chunk", wrong));
    while (records.size() >= kMcapRecordHeader) {
      const auto kind = static_cast<McapKind>(records[0]);
      const auto length = load_little<std::uint64_t>(records.data() + 1);
      if (length > records.size() - kMcapRecordHeader) break;
      if (kind >= McapKind::kSchema && kind <= McapKind::kMessage)
        take(kind, records.substr(kMcapRecordHeader, static_cast<std::size_t>(length)));
      records.remove_prefix(kMcapRecordHeader + static_cast<std::size_t>(length));
    }
    if (!records.empty()) damage(records.size(), "chunk", "ends within a record");
  }

  /// How many messages the recorder wrote, by channel.
  void statistics(std::string_view record) {
    Fields fields(record);
    fields.bytes(kMcapTotals);
    Fields counts(fields.text());
    if (!fields.whole()) return;
    while (!counts.rest().empty()) {
      const auto id = counts.number<std::uint16_t>();
      const auto count = counts.number<std::uint64_t>();
      const auto channel = channels_.find(id);
      if (counts.whole() && channel != channels_.end()) channel->second.counted = count;
    }
  }

  /// Messages that the recorder counted and that were not found.
  [[nodiscard]] long long missing(Role role) const {
    std::uint64_t sum = 0;
    for (const auto& [id, channel] : channels_) {
      if (channel.role == role) sum += channel.missing();
    }
    return static_cast<long long>(sum);
  }

  void damage(std::size_t bytes, const std::string& field, const std::string& what) {
    intake_.damage(bytes, AtByte(request_.path, byte_)(printable(field), what));
  }

  void finish(std::int64_t cut) const {
    std::set<std::string> readable;
    std::set<std::string> other;
    for (const auto& [id, channel] : channels_)
      (is_type(channel.type, "sensor_msgs", "Imu") || is_type(channel.type, "sensor_msgs", "JointState") ? readable
                                                                                                         : other)
          .insert(channel.shown);
    NameList topics;
    for (const auto* names : {&readable, &other}) {
      for (const std::string& name : *names) topics.add(name);
    }
    std::string holds = topics.empty() ? "no topics" : "topics " + topics.text();
    const bool empty = intake_.samples() + intake_.encoders() == 0;
    if (empty && cut > 0) holds += ", and was cut there";
    if (empty && !intake_.first_loss().empty()) throw Error(ExitCode::kInput, intake_.first_loss());
    require(request_, intake_, stream_.size(), holds);
    for (const auto& [id, channel] : channels_) {
      const bool read = channel.role == Role::kImu || (channel.role == Role::kEncoder && request_.need_encoder);
      if (read && static_cast<double>(channel.missing()) > kTolerableLoss * static_cast<double>(channel.counted))
        throw input_error(request_.path, 0, printable(channel.topic),
                          "has " + std::to_string(channel.messages) + " messages, of " +
                              std::to_string(channel.counted) + " that the recorder counted: the file is damaged");
    }
  }

  const LogRequest& request_;
  ByteStream stream_;
  SampleIntake intake_;
  Inflater inflater_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::string imu_topic_;
  std::string encoder_topic_;
  std::int64_t byte_ = 0;  // of the record in the file
  long long other_joints_ = 0;
  std::string other_joint_;  // what is wrong with the first
};

bool is_mcap(std::string_view head) { return head.substr(0, kMcapMagic.size()) == kMcapMagic; }

LogLosses read_mcap(const LogRequest& request, SampleSink& sink) { return McapReader(request, sink).read(); }

}  // namespace

const LogFormat kMcapFormat = {"mcap", "MCAP recording", ".mcap", is_mcap, read_mcap, write_mcap};

}  // namespace trunnion::io
