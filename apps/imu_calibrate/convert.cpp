// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string input;
  std::string output;
  std::string format;
  std::string channel;
  std::string encoder_channel;
  int of_run = 0;
};

struct Reading {
  std::int64_t utime;
  double azimuth;
  double pitch;
};

class Readings final : public SampleSink {
 public:
  void imu(std::int64_t, const InertialSample<double>&) override {}
  void encoder(std::int64_t utime, double azimuth, double pitch) override { all.push_back({utime, azimuth, pitch}); }
  std::vector<Reading> all;
};

/// Passes on to a writer; readings that come from a file of their own are put among the samples by their stamps.
class Converted final : public SampleSink {
 public:
  Converted(io::LogWriter& writer, std::vector<Reading> apart) : writer_(writer), apart_(std::move(apart)) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    while (next_ < apart_.size() && apart_[next_].utime <= utime) pass_reading();
    writer_.imu(utime, sample);
    ++samples;
    if (samples > 1 && utime < last_ && ++steps_back == 1) first_back = samples;
    if (samples > 1 && utime == last_) ++repeats;
    last_ = utime;
  }
  void temperature(double celsius) override {
    writer_.temperature(celsius);
    has_temperature = true;
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    writer_.encoder(utime, azimuth, pitch);
    ++readings;
  }
  void finish() {
    while (next_ < apart_.size()) pass_reading();
  }

  long long samples = 0;
  long long readings = 0;
  long long steps_back = 0;  // of the stamps
  long long first_back = 0;  // at this sample
  long long repeats = 0;     // of the stamp before
  bool has_temperature = false;

 private:
  void pass_reading() {
    const Reading& r = apart_[next_++];
    encoder(r.utime, r.azimuth, r.pitch);
  }

  io::LogWriter& writer_;
  std::vector<Reading> apart_;
  std::size_t next_ = 0;
  std::int64_t last_ = 0;
};

void convert(const Options& o) {
  const io::LogFormat& format = format_to_write(o.output, o.format);
  auto [run, files] = one_recording(o.input, o.channel, o.of_run);
  if (!o.encoder_channel.empty()) {
    if (io::is_run_file(o.input)) throw Error(ExitCode::kUsage, "--encoder-channel: the run file names its channels");
    run.channels.encoder.name = o.encoder_channel;
  }
  std::vector<std::string> sources = files_of(run);
  sources.insert(sources.end(), {o.input});
  const std::string encoder_file = format.encoder_file == nullptr ? "" : format.encoder_file(o.output);
  check_outputs({o.output, encoder_file}, sources);
  Readings apart;
  io::LogLosses lost;
  if (!files.encoder.empty()) {
    io::LogRequest request = io::log_request(run, files.encoder);
    request.need_imu = false;
    request.need_encoder = true;
    lost = io::read_log(request, apart);
    files.encoder.clear();
  }
  const std::unique_ptr<io::LogWriter> writer = format.write(o.output);
  Converted sink(*writer, std::move(apart.all));
  std::vector<std::pair<std::string, std::string>> digests;
  ProgressLine progress;
  const io::LogLosses losses = io::read_recording(run, files, sink, digests, [&](double fraction) {
    progress.show("converting " + std::to_string(static_cast<int>(100.0 * fraction)) + " %");
  });
  sink.finish();
  writer->commit();
  std::string made;
  for (const std::string& file : writer->files()) made += (made.empty() ? "" : ", ") + file;
  std::printf("%s: %lld samples", made.c_str(), sink.samples);
  if (sink.readings > 0) std::printf(", %lld encoder readings", sink.readings);
  std::printf("\n");
  if (sink.has_temperature && !writer->holds_temperature())
    std::fprintf(stderr, "%s: the temperature is left out: this format has no place for it\n", o.output.c_str());
  if (sink.steps_back > 0)
    std::fprintf(stderr, "%s: stamps go back %lld times, first at sample %lld: kept as they are\n", o.input.c_str(),
                 sink.steps_back, sink.first_back);
  if (sink.repeats > 0)
    std::fprintf(stderr, "%s: %lld stamps are those of the sample before: kept as they are\n", o.input.c_str(),
                 sink.repeats);
  if (!encoder_file.empty() && writer->files().size() == 1 && std::filesystem::exists(encoder_file))
    std::fprintf(stderr, "%s: is not of this recording, which has no readings of encoders\n", encoder_file.c_str());
  say_losses(losses);
  say_losses(lost);
}

}  // namespace

void add_convert(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("convert", "Write a recording in another format, in SI units");
  auto o = std::make_shared<Options>();
  std::vector<std::string> names;
  std::string readable;
  for (const io::LogFormat& format : io::log_formats()) {
    readable += std::string(readable.empty() ? "" : ", ") + format.title;
    if (format.write != nullptr) names.emplace_back(format.name);
  }
  command
      ->add_option("input", o->input,
                   "A log, told by what is in it: " + readable +
                       "; or the run file of a recording (channels, columns, "
                       "raw counts), with --of-run")
      ->required();
  command
      ->add_option("-o,--output", o->output,
                   "File to write; as a table the encoders' readings go beside it, to NAME_encoder.csv")
      ->required();
  command->add_option("--format", o->format, "To write; default by the output's extension")
      ->check(CLI::IsMember(names));
  command->add_option(
      "--channel", o->channel,
      "Channel or topic of the unit; default IMU in an LCM log; else the only one, in a ULog sensor_combined");
  command->add_option("--encoder-channel", o->encoder_channel,
                      "... of the encoders; default ENCODER in an LCM log, else the only one");
  command->add_option("--of-run", o->of_run, "Of a run file with several: the recording to convert, from 1")
      ->check(CLI::Range(1, 1000));
  command->footer("Example:\n  imu_calibrate convert recording.mcap -o recording.lcm");
  command->callback([o, &exit_code] {
    convert(*o);
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
