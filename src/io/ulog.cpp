// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// PX4's ULog. A header of 16 bytes, then messages: length (16 bits, without these three bytes), kind, content; numbers
// are little-endian. F defines a format, A gives a number to a topic that has it, D is data of such a number.

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "byte_stream.hpp"
#include "little_endian.hpp"
#include "log_formats.hpp"

namespace trunnion::io {
namespace {

constexpr std::string_view kMagic("ULog\x01\x12\x35", 7);
constexpr std::size_t kFileHeader = 16;
constexpr std::size_t kMessageHeader = 3;
constexpr std::string_view kKinds = "ABCDFILMOPQRS";  // of messages
constexpr int kSureAfter = 4;                         // messages in a row, that bytes are no damage
constexpr std::size_t kFlagBytes = 16;                // of a B message, before the offsets of what was appended
constexpr std::size_t kMostAppended = 3;
constexpr std::size_t kMostFormats = 4096;
constexpr std::size_t kMostTopics = 1000;  // that are named
constexpr int kMostNesting = 8;
constexpr int kMostFields = 10000;  // of a topic with those nested in it
constexpr std::size_t kLongestMessage = 65535;
constexpr std::int64_t kLongestTail = kMessageHeader + kLongestMessage;  // of a log that was cut
constexpr int kMostElements = 10000;
constexpr std::int32_t kNotRelative = std::numeric_limits<std::int32_t>::max();
constexpr const char* kCombined = "sensor_combined";
constexpr const char* kIntegrals = "vehicle_imu";

std::size_t size_of(std::string_view type) {
  if (type == "int8_t" || type == "uint8_t" || type == "bool" || type == "char") return 1;
  if (type == "int16_t" || type == "uint16_t") return 2;
  if (type == "int32_t" || type == "uint32_t" || type == "float") return 4;
  if (type == "int64_t" || type == "uint64_t" || type == "double") return 8;
  return 0;
}

/// Definitions of topics, as the log states them: "uint64_t timestamp;float[3] gyro_rad;...".
class Formats {
 public:
  /// @return false for what is no definition
  bool add(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || fields_.size() >= kMostFormats) return false;
    fields_[std::string(text.substr(0, colon))] = std::string(text.substr(colon + 1));
    return true;
  }

  struct Place {
    std::size_t offset = 0;
    std::string type;  // of an element
    int elements = 1;
  };

  /// Where a field is in the data of a topic; nothing when it has none of that name.
  [[nodiscard]] std::optional<Place> find(const std::string& topic, std::string_view name) const {
    std::optional<Place> found;
    int fields = 0;
    size(topic, name, found, 0, fields);
    return found;
  }

 private:
  /// Of a topic's data, the padding at its end left out as the logger does; nothing for an unknown or endless type.
  std::optional<std::size_t> size(const std::string& topic, std::string_view wanted, std::optional<Place>& found,
                                  int depth, int& fields) const {
    const auto format = fields_.find(topic);
    if (format == fields_.end() || depth > kMostNesting) return std::nullopt;
    std::size_t offset = 0;
    std::string_view rest = format->second;
    while (!rest.empty()) {
      const std::string_view field = rest.substr(0, rest.find(';'));
      rest.remove_prefix(std::min(rest.size(), field.size() + 1));
      if (field.empty()) continue;
      const std::size_t blank = field.find(' ');
      if (blank == std::string_view::npos || ++fields > kMostFields) return std::nullopt;
      std::string_view type = field.substr(0, blank);
      int elements = 1;
      const std::size_t bracket = type.find('[');
      if (bracket != std::string_view::npos) {
        elements = 0;
        for (std::size_t i = bracket + 1; i < type.size() && type[i] != ']'; ++i) {
          if (type[i] < '0' || type[i] > '9' || elements > kMostElements) return std::nullopt;
          elements = 10 * elements + (type[i] - '0');
        }
        type = type.substr(0, bracket);
      }
      if (depth == 0 && field.substr(blank + 1) == wanted) found = Place{offset, std::string(type), elements};
      std::size_t one = size_of(type);
      if (one == 0) {
        std::optional<Place> ignored;
        const std::optional<std::size_t> nested = size(std::string(type), {}, ignored, depth + 1, fields);
        if (!nested) return std::nullopt;
        one = *nested;
      }
      offset += one * static_cast<std::size_t>(elements);
      if (offset > kLongestMessage) return std::nullopt;
    }
    return offset;
  }

  std::map<std::string, std::string, std::less<>> fields_;
};

/// Where the fields of the topic are that is read.
struct Layout {
  std::size_t stamp = 0;
  std::size_t rate = 0;
  std::size_t force = 0;
  std::optional<std::size_t> relative;     // of sensor_combined: age of the accelerometers' sample
  std::optional<std::size_t> rate_period;  // of vehicle_imu: us that its increments are of
  std::optional<std::size_t> force_period;
  bool wide_period = false;  // of 32 bits, else 16
  std::size_t bytes = 0;     // that a message has at least
};

class UlogReader {
 public:
  UlogReader(const LogRequest& request, SampleSink& sink)
      : request_(request), stream_(request.path, request.digest), intake_(sink) {
    const std::string& name = request.channels.imu.name;
    const std::size_t hash = name.find('#');
    topic_ = name.substr(0, hash);
    if (hash == std::string::npos) return;
    instance_ = name.substr(hash + 1);
    if (instance_.empty() || instance_.size() > 3 || instance_.find_first_not_of("0123456789") != std::string::npos)
      throw input_error(request.path, 0, "", "'" + printable(name) + "' is no topic: name it topic or topic#instance");
  }

  LogLosses read() {
    stream_.have(kFileHeader);
    stream_.skip(std::min(kFileHeader, stream_.available()));
    ByteProgress progress(request_.progress);
    std::int64_t cut = 0;
    while (stream_.have(kMessageHeader)) {
      const std::size_t length = length_at(0);
      if (length == 0) {
        const std::int64_t from = stream_.offset();
        const bool goes_on = resume();
        const std::int64_t lost = (goes_on ? stream_.offset() : stream_.size()) - from;
        if (!goes_on && lost <= kLongestTail)
          cut = lost;
        else
          intake_.lose(lost, AtByte(request_.path, from)("message", "is none"));
        continue;
      }
      message(stream_.data()[2], {stream_.data() + kMessageHeader, length - kMessageHeader});
      stream_.skip(length);
      progress.show(stream_);
    }
    cut += static_cast<std::int64_t>(stream_.available());  // less than a header
    NameList topics;
    for (const bool readable : {true, false}) {
      for (const std::string& name : topics_) {
        if (readable == is_readable(name)) topics.add(name);
      }
    }
    require(request_, intake_, stream_.size(),
            topics.empty() ? "" : "topics " + topics.text() + "; sensor_combined or vehicle_imu is read");
    std::string note;
    for (const NameList* own : {&rotations_, &offsets_}) {
      if (!own->empty()) note += (note.empty() ? "the vehicle's own " : ", ") + own->text();
    }
    if (!note.empty()) note += " are in its units' readings";
    if (without_force_ > 0)
      note += (note.empty() ? "" : "; ") + std::to_string(without_force_) +
              " samples of the gyros without one of the accelerometers are passed over";
    if (dropouts_ > 0)
      note += (note.empty() ? "" : "; ") + std::to_string(dropouts_) + " dropouts of the logger, " +
              std::to_string(dropped_ms_) + " ms in all";
    return losses_of(intake_, cut, note);
  }

 private:
  static bool is_readable(const std::string& topic) {
    const std::string name = topic.substr(0, topic.find('#'));
    return name == kCombined || name == kIntegrals;
  }

  /// Of the message @p at bytes from here, with its header; zero where there is none, or not all of it.
  std::size_t length_at(std::size_t at) {
    if (!stream_.have(at + kMessageHeader)) return 0;
    const char* const p = stream_.data() + at;
    const std::size_t length = kMessageHeader + load_little<std::uint16_t>(p);
    if (length == kMessageHeader || kKinds.find(p[2]) == std::string_view::npos || !stream_.have(at + length)) return 0;
    return ends_before_appended(at + length) ? length : 0;
  }

  /// What was appended after a crash begins where the flags say, whatever was being written when it happened.
  [[nodiscard]] bool ends_before_appended(std::size_t end) const {
    const auto to = stream_.offset() + static_cast<std::int64_t>(end);
    return std::none_of(appended_.begin(), appended_.end(),
                        [&](std::int64_t begins) { return begins > stream_.offset() && begins < to; });
  }
  /// On to where messages follow each other again, or what was appended begins. @return false where the log ends first
  bool resume() {
    const auto is_message = [&] {
      std::size_t at = 0;
      for (int k = 0; k < kSureAfter; ++k) {
        if (k > 0 && stream_.offset() + static_cast<std::int64_t>(at) == stream_.size()) return true;
        const std::size_t length = length_at(at);
        if (length == 0) return false;
        at += length;
      }
      return true;
    };
    const auto is_appended = [&] {
      return std::find(appended_.begin(), appended_.end(), stream_.offset()) != appended_.end();
    };
    do stream_.skip(1);
    while (stream_.have(kMessageHeader) && !is_appended() && !is_message());
    return stream_.have(kMessageHeader);
  }

  void message(char kind, std::string_view content) {
    if (kind == 'D') {
      if (content.size() > 2 && number_ && load_little<std::uint16_t>(content.data()) == *number_)
        data(content.substr(2));
    } else if (kind == 'F') {
      formats_.add(content);
    } else if (kind == 'P') {
      parameter(content);
    } else if (kind == 'O' && content.size() >= 2) {
      ++dropouts_;
      dropped_ms_ += load_little<std::uint16_t>(content.data());
    } else if (kind == 'R' && content.size() >= 2) {
      if (number_ == load_little<std::uint16_t>(content.data())) number_.reset();
    } else if (kind == 'B') {
      flags(content);
    } else if (kind == 'A' && content.size() > 3) {
      subscribe(std::to_string(static_cast<std::uint8_t>(content[0])), load_little<std::uint16_t>(content.data() + 1),
                std::string(content.substr(3)));
    }
  }

  /// Of eight bytes that one may pass over, eight that one must understand, and three offsets of what was appended.
  void flags(std::string_view content) {
    constexpr std::size_t kMust = 8;
    constexpr unsigned kAppends = 1;
    for (std::size_t i = kMust; i < std::min(kFlagBytes, content.size()); ++i) {
      if ((static_cast<unsigned char>(content[i]) & ~(i == kMust ? kAppends : 0U)) != 0)
        throw input_error(request_.path, 0, "", "is a ULog of a newer kind: its flags are not known");
    }
    for (std::size_t i = kFlagBytes; i + 8 <= content.size() && appended_.size() < kMostAppended; i += 8) {
      const auto begins = load_little<std::uint64_t>(content.data() + i);
      if (begins > 0 && begins < static_cast<std::uint64_t>(stream_.size()))
        appended_.push_back(static_cast<std::int64_t>(begins));
    }
  }

  /// What the vehicle does to readings before it logs them: "float CAL_ACC0_XOFF", and its value.
  void parameter(std::string_view content) {
    const std::size_t length = content.empty() ? 0 : static_cast<unsigned char>(content[0]);
    if (content.size() != 1 + length + 4) return;
    const std::string_view key = content.substr(1, length);
    const char* const value = content.data() + 1 + length;
    const std::size_t blank = key.find(' ');
    const std::string name(key.substr(std::min(blank, key.size() - 1) + 1));
    const auto ends = [&](std::string_view end) {
      return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    };
    const bool is_float = key.substr(0, blank) == "float";
    const double number = is_float ? static_cast<double>(load_little<float>(value))
                                   : static_cast<double>(load_little<std::int32_t>(value));
    const bool calibrates = name.rfind("CAL_ACC", 0) == 0 || name.rfind("CAL_GYRO", 0) == 0;
    const bool turns = (calibrates && ends("_ROT") && number > 0.0) || (name == "SENS_BOARD_ROT" && number != 0.0);
    const bool moves = (calibrates && is_float && ends("OFF") && number != 0.0) ||
                       (calibrates && is_float && ends("SCALE") && number != 1.0);
    if (!turns && !moves) return;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", number);
    (turns ? rotations_ : offsets_).add(name + " = " + text.data());
  }

  void subscribe(const std::string& instance, std::uint16_t number, const std::string& topic) {
    if (topics_.size() < kMostTopics) topics_.insert(topic + (instance == "0" ? "" : "#" + instance));
    if (number_ == number && topic != chosen_) number_.reset();  // given to another topic
    const bool wanted = topic_.empty() ? (topic == kCombined || topic == kIntegrals) : topic == topic_;
    if (!wanted || instance != instance_) return;
    // sensor_combined where there is one: vehicle_imu is often logged at a part of its rate
    const bool better = topic_.empty() && topic == kCombined && chosen_ == kIntegrals;
    if ((number_ && !better) || (intake_.samples() > 0 && !better && topic != chosen_)) return;
    if (better && intake_.samples() > 0)
      throw input_error_at_byte(request_.path, stream_.offset(), "",
                                "begins sensor_combined where vehicle_imu has samples already: name one of them under "
                                "channels: {imu: ...}, or with --channel");
    layout_ = layout_of(topic);
    number_ = number;
    chosen_ = topic;
  }

  Layout layout_of(const std::string& topic) const {
    Layout layout;
    const auto place = [&](const char* name, const char* type, int elements) {
      const std::optional<Formats::Place> found = formats_.find(topic, name);
      if (!found || found->type != type || found->elements != elements)
        throw input_error(request_.path, 0, topic + "." + name,
                          std::string("is no ") + type + (elements > 1 ? "[" + std::to_string(elements) + "]" : "") +
                              ": topics sensor_combined and vehicle_imu can be read");
      return found->offset;
    };
    const auto end_at = [&](std::size_t end) { layout.bytes = std::max(layout.bytes, end); };
    if (formats_.find(topic, "delta_angle")) {
      layout.stamp = place("timestamp_sample", "uint64_t", 1);
      layout.rate = place("delta_angle", "float", 3);
      layout.force = place("delta_velocity", "float", 3);
      const auto period = [&](const char* name) {
        const std::optional<Formats::Place> found = formats_.find(topic, name);
        layout.wide_period = found && found->type == "uint32_t";
        return place(name, layout.wide_period ? "uint32_t" : "uint16_t", 1);
      };
      layout.rate_period = period("delta_angle_dt");
      layout.force_period = period("delta_velocity_dt");
      end_at(*layout.rate_period + (layout.wide_period ? 4 : 2));
      end_at(*layout.force_period + (layout.wide_period ? 4 : 2));
    } else {
      layout.stamp = place("timestamp", "uint64_t", 1);
      layout.rate = place("gyro_rad", "float", 3);
      layout.force = place("accelerometer_m_s2", "float", 3);
      if (formats_.find(topic, "accelerometer_timestamp_relative")) {
        layout.relative = place("accelerometer_timestamp_relative", "int32_t", 1);
        end_at(*layout.relative + 4);
      }
    }
    end_at(layout.stamp + 8);
    end_at(layout.rate + 12);
    end_at(layout.force + 12);
    return layout;
  }

  static Vec3<double> vector_at(const char* p) {
    return {static_cast<double>(load_little<float>(p)), static_cast<double>(load_little<float>(p + 4)),
            static_cast<double>(load_little<float>(p + 8))};
  }

  void data(std::string_view content) {
    const AtByte fault(request_.path, stream_.offset());
    if (content.size() < layout_.bytes)
      return intake_.damage(content.size(), fault("data", "is shorter than its format"));
    const char* const p = content.data();
    InertialSample<double> sample{vector_at(p + layout_.rate), vector_at(p + layout_.force)};
    if (layout_.rate_period) {
      const auto microseconds = [&](std::size_t at) {
        return layout_.wide_period ? static_cast<double>(load_little<std::uint32_t>(p + at))
                                   : static_cast<double>(load_little<std::uint16_t>(p + at));
      };
      const double rate_period = 1e-6 * microseconds(*layout_.rate_period);
      const double force_period = 1e-6 * microseconds(*layout_.force_period);
      if (rate_period == 0.0 || force_period == 0.0)
        return intake_.damage(content.size(), fault("delta_angle_dt", "is zero"));
      sample = {sample.w / rate_period, sample.f / force_period};
    } else if (layout_.relative && load_little<std::int32_t>(p + *layout_.relative) == kNotRelative) {
      ++without_force_;
      return;
    }
    const auto stamp = load_little<std::uint64_t>(p + layout_.stamp);
    if (stamp > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      return intake_.damage(content.size(), fault("timestamp", "is beyond any clock"));
    intake_.imu(static_cast<std::int64_t>(stamp), sample, content.size(), fault);
  }

  const LogRequest& request_;
  ByteStream stream_;
  SampleIntake intake_;
  std::string topic_;
  std::string instance_ = "0";
  Formats formats_;
  std::set<std::string> topics_;
  std::vector<std::int64_t> appended_;   // offsets in the file
  std::optional<std::uint16_t> number_;  // of the topic that is read
  std::string chosen_;
  long long without_force_ = 0;  // samples of the gyros alone
  long long dropouts_ = 0;
  long long dropped_ms_ = 0;
  NameList rotations_;
  NameList offsets_;
  Layout layout_;
};

bool is_ulog(std::string_view head) { return head.substr(0, kMagic.size()) == kMagic; }

LogLosses read_ulog(const LogRequest& request, SampleSink& sink) { return UlogReader(request, sink).read(); }

}  // namespace

const LogFormat kUlogFormat = {"ulog", "PX4 ULog", ".ulg", is_ulog, read_ulog, nullptr};

}  // namespace trunnion::io
