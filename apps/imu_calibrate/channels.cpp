// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "channels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include "trunnion/core/error.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/io/message_map.hpp"
#include "trunnion/positions/sequence_watch.hpp"

namespace trunnion::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostChannels = 1000;

/// What a channel's messages have been so far.
class ChannelLook {
 public:
  void add(const io::LcmEvent& event, const io::LcmTypes& types) {
    const std::uint64_t fingerprint = io::fingerprint_of(event.data);
    if (messages_ == 0) {
      first_ = event.timestamp;
      recognise(fingerprint, types);
    } else if (event.timestamp < last_) {
      ++backward_;
    } else {
      steps_.push_back(static_cast<float>(1e-6 * static_cast<double>(event.timestamp - last_)));
    }
    other_ += fingerprint != fingerprint_ ? 1 : 0;
    last_ = event.timestamp;
    ++messages_;
    bytes_ += static_cast<long long>(event.data.size());
    if (!reader_) return;
    if (!reader_->read(event.data)) {
      ++undecodable_;
    } else if (has_sequence_ && !reader_->integers(0).empty()) {
      const auto n = static_cast<std::int64_t>(reader_->integers(0).size());
      if (n > 1 || !has_count_) {
        for (const std::int64_t number : reader_->integers(0)) sequence_.add(number);
      } else {
        sequence_.add(reader_->integers(0)[0], reader_->integers(1).empty() ? 1 : reader_->integers(1)[0]);
      }
    }
  }

  [[nodiscard]] Json summary() const {
    std::vector<float> sorted = steps_;
    std::sort(sorted.begin(), sorted.end());
    const double step = sorted.empty() ? 0.0 : static_cast<double>(sorted[sorted.size() / 2]);
    double squares = 0.0;
    for (const float s : steps_) squares += (static_cast<double>(s) - step) * (static_cast<double>(s) - step);
    const double duration = 1e-6 * static_cast<double>(last_ - first_);
    Json json = {{"messages", messages_},
                 {"types", types_},
                 {"fingerprint", io::hexadecimal(fingerprint_)},
                 {"rate_hz", duration > 0.0 ? static_cast<double>(messages_ - 1) / duration : 0.0},
                 {"period_ms", 1e3 * step},
                 {"jitter_ms", steps_.empty() ? 0.0 : 1e3 * std::sqrt(squares / static_cast<double>(steps_.size()))},
                 {"kilobytes_per_s", duration > 0.0 ? 1e-3 * static_cast<double>(bytes_) / duration : 0.0},
                 {"undecodable", undecodable_},
                 {"other_types", other_},
                 {"backward", backward_}};
    if (has_sequence_ && sequence_.numbered()) {
      json["lost"] = sequence_.lost();
      json["repeated"] = sequence_.late();
      json["restarts"] = sequence_.restarts();
      json["two_publishers"] = sequence_.two_publishers();
    }
    if (!preset_.empty()) json["preset"] = preset_;
    return json;
  }

 private:
  void recognise(std::uint64_t fingerprint, const io::LcmTypes& types) {
    fingerprint_ = fingerprint;
    types_ = types.with_fingerprint(fingerprint);
    if (types_.empty()) return;
    const std::string& type = types_.front();
    reader_.emplace(types, type, std::vector<std::string>{});
    for (const io::MessagePreset& preset : io::message_presets()) {
      if (std::find(types_.begin(), types_.end(), preset.name) != types_.end()) preset_ = preset.name;
    }
    for (const char* path :
         {"sequence", "seq", "header.seq", "sequence_number", "raw_imu.packet_count", "packet_count"}) {
      for (const bool count : {true, false}) {
        try {
          io::LcmFieldReader reader(
              types, type, count ? std::vector<std::string>{path, "num_samples"} : std::vector<std::string>{path});
          if (reader.kind(0) != io::LcmFieldReader::Kind::kInteger) continue;
          reader_ = std::move(reader);
          has_sequence_ = true;
          has_count_ = count;
          return;
        } catch (const Error&) {
          continue;  // this type has no such field
        }
      }
    }
  }

  std::uint64_t fingerprint_ = 0;
  std::vector<std::string> types_;
  std::string preset_;
  std::optional<io::LcmFieldReader> reader_;
  bool has_sequence_ = false;
  bool has_count_ = false;
  SequenceWatch sequence_;
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  long long messages_ = 0;
  long long bytes_ = 0;
  long long undecodable_ = 0;
  long long other_ = 0;
  long long backward_ = 0;
  std::vector<float> steps_;
};

}  // namespace

void look_at_channels(const std::string& path, const io::LcmTypes& types, Json& json) {
  io::LcmLogReader log(path);
  io::LcmEvent event;
  std::map<std::string, ChannelLook, std::less<>> channels;
  while (log.next(event)) {
    auto found = channels.find(event.channel);
    if (found == channels.end()) {
      if (channels.size() == kMostChannels) continue;
      found = channels.emplace(event.channel, ChannelLook()).first;
    }
    found->second.add(event, types);
  }
  json["channels"] = Json::object();
  for (const auto& [channel, look] : channels) json["channels"][channel] = look.summary();
  json["lost"] = {{"records", log.lost_records()}, {"bytes", log.lost_bytes()}};
}

void print_channels(const Json& json) {
  std::printf("  %-20s %-28s %9s %9s %9s %9s %9s %8s %7s %7s %7s\n", "channel", "type", "messages", "Hz", "1/Hz ms",
              "jitter ms", "kB/s", "undecod.", "lost", "repeat", "backw.");
  for (const auto& item : json["channels"].items()) {
    const std::string& name = item.key();
    const Json& c = item.value();
    const std::string type =
        c["types"].empty() ? c["fingerprint"].get<std::string>() : c["types"][0].get<std::string>();
    const auto number = [&](const char* key) {
      return c.contains(key) ? std::to_string(c[key].get<long long>()) : std::string("-");
    };
    std::printf("  %-20s %-28s %9lld %9.2f %9.3f %9.3f %9.1f %8s %7s %7s %7s\n", io::printable(name).c_str(),
                type.c_str(), c["messages"].get<long long>(), c["rate_hz"].get<double>(), c["period_ms"].get<double>(),
                c["jitter_ms"].get<double>(), c["kilobytes_per_s"].get<double>(),
                c["types"].empty() ? "?" : number("undecodable").c_str(), number("lost").c_str(),
                number("repeated").c_str(), number("backward").c_str());
    for (std::size_t i = 1; i < c["types"].size(); ++i)
      std::printf("  %-20s or %s, of the same fingerprint\n", "", c["types"][i].get<std::string>().c_str());
    if (c["other_types"].get<long long>() > 0)
      std::printf("  %-20s %lld messages are of another type\n", "", c["other_types"].get<long long>());
    if (c.contains("restarts") && c["restarts"].get<long long>() > 0)
      std::printf("  %-20s its publisher began again %lld times\n", "", c["restarts"].get<long long>());
    if (c.contains("two_publishers") && c["two_publishers"].get<bool>()) std::printf("  %-20s two publishers\n", "");
    if (c.contains("preset"))
      std::printf("  %-20s in a run file: {channel: %s, preset: %s}\n", "", io::printable(name).c_str(),
                  c["preset"].get<std::string>().c_str());
  }
  if (json["lost"]["bytes"].get<long long>() > 0)
    std::printf("  lost to damage: %lld records, %lld bytes\n", json["lost"]["records"].get<long long>(),
                json["lost"]["bytes"].get<long long>());
}

}  // namespace trunnion::app
