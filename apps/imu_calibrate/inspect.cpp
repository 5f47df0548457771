// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "../terminal.hpp"
#include "channels.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "trunnion/calibration/compress.hpp"
#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string input;
  std::string format = "text";
  io::LogChannels channels;
  std::vector<std::string> lcm_types;
};

/// Stamps and ranges of one channel.
class ChannelStatistics {
 public:
  /// @return whether the stamp was the next one
  bool add(std::int64_t utime, std::initializer_list<double> values) {
    const ChannelClock::Verdict verdict = clock_.judge(utime);
    repeated_ = verdict == ChannelClock::Verdict::kDuplicate;
    switch (verdict) {
      case ChannelClock::Verdict::kDuplicate:
        ++duplicates_;
        return false;
      case ChannelClock::Verdict::kReset:
        if (!reset_) reset_at_ = utime;
        reset_ = true;
        ++stray_;
        return false;
      case ChannelClock::Verdict::kStray:
        ++stray_;
        return false;
      case ChannelClock::Verdict::kNextAndFirstWasStray:
        messages_ = 0;
        break;
      case ChannelClock::Verdict::kNext:
        break;
    }
    if (messages_ == 0) {
      first_ = utime;
      lowest_.assign(values);
      highest_.assign(values);
    } else {
      steps_.push_back(static_cast<float>(1e-6 * static_cast<double>(ChannelClock::difference(utime, last_))));
    }
    last_ = utime;
    ++messages_;
    std::size_t i = 0;
    for (const double value : values) {
      lowest_[i] = std::min(lowest_[i], value);
      highest_[i] = std::max(highest_[i], value);
      ++i;
    }
    return true;
  }

  /// Whether the last stamp was that of the sample before.
  [[nodiscard]] bool repeated() const { return repeated_; }
  [[nodiscard]] bool empty() const { return messages_ == 0; }

  [[nodiscard]] Json summary(const std::vector<const char*>& names, double in_unit, const char* unit) const {
    std::vector<float> sorted = steps_;
    std::sort(sorted.begin(), sorted.end());
    const double period = sorted.empty() ? 0.0 : static_cast<double>(sorted[sorted.size() / 2]);
    double jitter = 0.0;
    long long missing = 0;
    long long gaps = 0;
    double longest = 0.0;
    for (const float step_s : steps_) {
      const auto step = static_cast<double>(step_s);
      longest = std::max(longest, step);
      if (step > 1.5 * period) {
        ++gaps;
        missing += static_cast<long long>(std::lround(step / period)) - 1;
      } else {
        jitter += (step - period) * (step - period);
      }
    }
    const auto regular = static_cast<double>(static_cast<long long>(steps_.size()) - gaps);
    Json json = {{"messages", messages_},
                 {"rate_hz", period > 0.0 ? 1.0 / period : 0.0},
                 {"jitter_us", 1e6 * std::sqrt(jitter / std::max(1.0, regular))},
                 {"gaps", gaps},
                 {"missing", missing},
                 {"longest_gap_s", longest},
                 {"duplicates", duplicates_},
                 {"stray_stamps", stray_},
                 {"duration_s", 1e-6 * static_cast<double>(ChannelClock::difference(last_, first_))}};
    for (std::size_t i = 0; i < names.size() && i < lowest_.size(); ++i) {
      json["range"][names[i]] = {lowest_[i] * in_unit, highest_[i] * in_unit};
    }
    json["range_unit"] = unit;
    if (reset_) json["clock_reset_at_utime"] = reset_at_;
    return json;
  }

 private:
  ChannelClock clock_;
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  long long messages_ = 0;
  long long duplicates_ = 0;
  long long stray_ = 0;
  bool reset_ = false;
  bool repeated_ = false;
  std::int64_t reset_at_ = 0;
  std::vector<float> steps_;
  std::vector<double> lowest_;
  std::vector<double> highest_;
};

class InspectSink final : public SampleSink {
 public:
  InspectSink(const std::string& name, const calibration::SensorRange& range) : parts_(name), range_(range) {}
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    const bool next = imu_.add(utime, {s.w.x(), s.w.y(), s.w.z(), s.f.x(), s.f.y(), s.f.z()});
    if (next || imu_.repeated()) parts_.imu(utime, s);
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override { encoder_.add(utime, {azimuth, pitch}); }

  Json summary() {
    Json json = Json::object();
    if (!imu_.empty()) {
      json["imu"] = imu_.summary({"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"}, 1.0, "rad/s, m/s^2");
      try {
        add_parts(parts_.finish(range_), json);
      } catch (const Error& e) {
        json["refused"] = e.what();
      }
    }
    if (!encoder_.empty()) json["encoder"] = encoder_.summary({"azimuth", "pitch"}, 1.0 / kRadPerDeg, "deg");
    return json;
  }

 private:
  static void add_parts(const calibration::HandRecording& parts, Json& json) {
    double at_rest = 0.0;
    double force = 0.0;
    for (const calibration::Rest& rest : parts.rests) {
      at_rest += rest.end - rest.begin;
      force += rest.mean.f.norm() / static_cast<double>(parts.rests.size());
    }
    json["rests"] = {{"count", parts.rests.size()}, {"total_s", at_rest}};
    json["turns"] = {{"count", parts.turns.size()}};
    if (parts.rests.empty()) return;
    json["rests"]["specific_force_m_s2"] = force;
    json["noise_at_rest"] = {{"gyro_deg_per_h_per_rt_hz", parts.noise.gyro.density / kRadPerSPerDegPerH},
                             {"accel_ug_per_rt_hz", parts.noise.accel.density / kMetresPerS2PerMicroG}};
  }

  ChannelStatistics imu_;
  ChannelStatistics encoder_;
  calibration::RestsAndTurns parts_;
  calibration::SensorRange range_;
};

Json inspect_recording(const io::RunFile& run, const io::RecordingFiles& files, const io::LcmTypes& types) {
  Json json = {{"file", files.name()}};
  if (!files.mount.empty()) json["mount"] = files.mount;
  const io::LogFormat& format = io::format_of(files.name());
  json["format"] = format.name;
  if (!files.log.empty() && format.by_channel) look_at_channels(files.log, types, json);
  InspectSink sink(files.name(), {run.sheet.gyro_range, run.sheet.accel_range});
  std::vector<std::pair<std::string, std::string>> digests;
  try {
    const io::LogLosses losses = io::read_recording(run, files, sink, digests);
    if (!json.contains("lost")) json["lost"] = {{"records", losses.records}, {"bytes", losses.bytes}};
    if (!losses.note.empty()) json["note"] = losses.note;
  } catch (const Error& e) {
    if (!json.contains("channels")) throw;
    json["refused"] = e.what();  // the channels are what is there to see
  }
  json.update(sink.summary());
  return json;
}

void print_channel(const char* name, const Json& c) {
  std::printf(
      "  %-8s %10lld messages  %9.3f Hz  jitter %.1f us  %lld gaps (%lld missing, longest %.4f s)  %lld duplicates  "
      "%lld stray stamps  %.3f s\n",
      name, c["messages"].get<long long>(), c["rate_hz"].get<double>(), c["jitter_us"].get<double>(),
      c["gaps"].get<long long>(), c["missing"].get<long long>(), c["longest_gap_s"].get<double>(),
      c["duplicates"].get<long long>(), c["stray_stamps"].get<long long>(), c["duration_s"].get<double>());
  std::printf("           range:");
  for (const auto& [axis, range] : c["range"].items())
    std::printf(" %s %.4g..%.4g", axis.c_str(), range[0].get<double>(), range[1].get<double>());
  std::printf(" (%s)\n", c["range_unit"].get<std::string>().c_str());
  if (c.contains("clock_reset_at_utime")) {
    std::printf("           the clock was reset: stamps went to utime %lld and stayed there\n",
                c["clock_reset_at_utime"].get<long long>());
  }
}

void print_text(const Json& all) {
  for (const Json& one : all["recordings"]) {
    std::printf("%s%s%s\n", one["file"].get<std::string>().c_str(),
                one.contains("mount") ? (", " + one["mount"].get<std::string>()).c_str() : "",
                one.contains("channels") ? "" : (", " + one["format"].get<std::string>()).c_str());
    if (one.contains("channels")) print_channels(one);
    if (one.contains("imu")) print_channel("IMU", one["imu"]);
    if (one.contains("encoder")) print_channel("encoder", one["encoder"]);
    if (!one.contains("channels") && one.contains("lost") && one["lost"]["bytes"].get<long long>() > 0)
      std::printf("  lost to damage: %lld records, %lld bytes\n", one["lost"]["records"].get<long long>(),
                  one["lost"]["bytes"].get<long long>());
    if (one.contains("note")) std::printf("  note: %s\n", one["note"].get<std::string>().c_str());
    if (one.contains("refused"))
      std::printf("  solve would refuse it: %s\n", one["refused"].get<std::string>().c_str());
    if (one.contains("rests")) {
      std::printf("  %lld rests, %.1f s in all; %lld turns between them\n", one["rests"]["count"].get<long long>(),
                  one["rests"]["total_s"].get<double>(), one["turns"]["count"].get<long long>());
      const double force = one["rests"].value("specific_force_m_s2", kStandardGravity);
      if (std::abs(force / kStandardGravity - 1.0) > 0.1)
        std::printf("  specific force at rest: %.4g m/s^2: no gravity; another unit?\n", force);
    }
    if (one.contains("noise_at_rest")) {
      std::printf("  white noise at rest: %.3g deg/h/rtHz, %.3g ug/rtHz\n",
                  one["noise_at_rest"]["gyro_deg_per_h_per_rt_hz"].get<double>(),
                  one["noise_at_rest"]["accel_ug_per_rt_hz"].get<double>());
    }
  }
}

ExitCode inspect(const Options& o) {
  io::RunFile run;
  if (io::is_run_file(o.input)) {
    run = io::read_run_file(o.input);
  } else {
    run.channels = o.channels;
    io::RecordingFiles files;
    files.log = o.input;
    run.recordings.push_back(files);
  }
  io::LcmTypes types = *io::known_types();
  for (const std::string& path : run.lcm_types) types.add(path);
  for (const std::string& path : o.lcm_types) types.add(path);
  ProgressLine progress;
  Json all = {{"schema", "trunnion/inspect/1"}};
  for (const io::RecordingFiles& files : run.recordings) {
    progress.show("reading " + files.name());
    all["recordings"].push_back(inspect_recording(run, files, types));
  }
  if (o.format == "json") {
    std::printf("%s\n", all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  } else {
    print_text(all);
  }
  const bool refused = std::any_of(all["recordings"].begin(), all["recordings"].end(),
                                   [](const Json& one) { return one.contains("refused") && !one.contains("imu"); });
  return refused ? ExitCode::kInput : ExitCode::kDone;
}

}  // namespace

void add_inspect(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command =
      app.add_subcommand("inspect", "What a recording holds: rates, jitter, gaps, ranges, rests and turns");
  auto o = std::make_shared<Options>();
  command->add_option("input", o->input, "Run file, or a log of any format that is read (imu_calibrate convert --help)")
      ->required();
  command->add_option("--format", o->format, "Of the result")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("--imu-channel,--channel", o->channels.imu.name,
                      "Of a log: channel or topic; default IMU in an LCM log, else the only one");
  command->add_option("--encoder-channel", o->channels.encoder.name,
                      "Of a log: channel or topic; default ENCODER in an LCM log, else the only one");
  command->add_option("--lcm-types", o->lcm_types, "Definitions to know types by: a .lcm file, or a folder of them");
  command->footer("Example:\n  imu_calibrate inspect run.yaml");
  command->callback([o, &exit_code] { exit_code = inspect(*o); });
}

}  // namespace trunnion::app
