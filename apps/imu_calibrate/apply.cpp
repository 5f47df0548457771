// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <memory>

#include "../imu_correct/corrector.hpp"
#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "recordings.hpp"
#include "trunnion/error_model/stream_correction.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string calibration;
  std::string input;
  std::string output;
  std::string channel;
  int recording = 0;
  int of_run = 0;
};

/// Corrects samples and passes them on, with all else that is told.
class Corrected final : public SampleSink {
 public:
  Corrected(const InertialUnit<double>& unit, const std::string& source, SampleSink& to)
      : unit_(unit), source_(source), correction_(unit), to_(to) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    ++samples_;
    const InertialSample<double> corrected = correction_.correct(1e-6 * static_cast<double>(utime), sample);
    if (!can_be_undone(unit_, corrected))
      throw io::input_error(source_, 0, "sample " + std::to_string(samples_), kNotUndone);
    to_.imu(utime, corrected);
  }
  void temperature(double celsius) override {
    has_temperature_ = true;
    correction_.set_temperature(celsius);
    to_.temperature(celsius);
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override { to_.encoder(utime, azimuth, pitch); }
  [[nodiscard]] long long samples() const { return samples_; }
  [[nodiscard]] bool has_temperature() const { return has_temperature_; }

 private:
  const InertialUnit<double>& unit_;
  const std::string& source_;
  StreamCorrection<double> correction_;
  SampleSink& to_;
  bool has_temperature_ = false;
  long long samples_ = 0;
};

/// Message by message as imu_correct does live; other channels are copied.
long long apply_to_log(const io::RecordingFiles& files, const io::LogChannels& channels, const std::string& output,
                       Corrector corrector) {
  io::LcmLogReader log(files.log);
  io::LcmLogWriter out(output);
  CorrectedMessages messages(files.log, channels);
  io::LcmEvent event;
  std::string fault;
  while (log.next(event)) {
    if (event.channel != channels.imu_channel()) {
      out.write(event.timestamp, event.channel, event.data);
      continue;
    }
    const std::string* const corrected = messages.correct(event, corrector);
    if (corrected != nullptr) out.write(event.timestamp, event.channel, *corrected);
    if (!messages.why().empty() && fault.empty()) fault = messages.why();
  }
  messages.finish();
  if (messages.samples() == 0) {
    throw io::input_error(
        files.log, 0, "",
        "no usable message on the IMU channel '" + channels.imu_channel() + "'" + (fault.empty() ? "" : ": " + fault));
  }
  out.commit();
  if (corrector.without_temperature() > 0)
    std::fprintf(
        stderr,
        "%lld samples state no temperature, and the calibration has terms of it: corrected at the last one, or "
        "at its reference\n",
        corrector.without_temperature());
  const long long records = log.lost_records() + messages.damaged();
  if (records > 0)
    std::fprintf(stderr, "%lld damaged records, %lld bytes passed over\n", records,
                 log.lost_bytes() + messages.damaged_bytes());
  return messages.samples();
}

/// Through the same reader as solve: columns and raw counts as the run file says.
long long apply_to_recording(const Options& o, const io::LogFormat& format, const io::RunFile& run,
                             const io::RecordingFiles& files, const InertialUnit<double>& unit) {
  const std::unique_ptr<io::LogWriter> out = format.write(o.output);
  Corrected sink(unit, o.input, *out);
  std::vector<std::pair<std::string, std::string>> digests;
  const io::LogLosses losses = io::read_recording(run, files, sink, digests);
  if (sink.samples() == 0) throw io::input_error(o.input, 0, "", "has no samples");
  if (unit.thermal.order() > 0 && !sink.has_temperature())
    std::fprintf(stderr, "%s: has terms of temperature, and no sample states one: at %s degC\n", o.calibration.c_str(),
                 figure(unit.thermal.reference, 4).c_str());
  out->commit();
  say_losses(losses);
  return sink.samples();
}

void apply(const Options& o) {
  auto [run, files] = one_recording(o.input, o.channel, o.of_run);
  files.encoder.clear();
  std::vector<std::string> sources = files_of(run);
  sources.insert(sources.end(), {o.input, o.calibration});
  const io::LogFormat& format = format_to_write(o.output, "");
  check_outputs({o.output, format.encoder_file == nullptr ? "" : format.encoder_file(o.output)}, sources);
  // from log to log of a bus the other channels go along
  const bool is_log = !files.log.empty() && format.by_channel && io::format_of(files.name()).by_channel;
  long long samples = 0;
  if (!is_log) {
    const InertialUnit<double> unit = io::unit_of(io::read_calibration_file(o.calibration), o.calibration, o.recording);
    samples = apply_to_recording(o, format, run, files, unit);
  } else {
    CorrectorOptions options;
    options.calibration = o.calibration;
    if (run.sheet.counts.gyro.scale != 1.0 && run.sheet.counts.accel.scale != 1.0) options.sheet = run.sheet_path;
    options.recording = o.recording;
    options.in_floating_point = true;
    samples = apply_to_log(files, run.channels, o.output, Corrector(options));
  }
  std::printf("%s: %lld samples corrected\n", o.output.c_str(), samples);
}

}  // namespace

void add_apply(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("apply", "Write a corrected log, in the format of its extension");
  auto o = std::make_shared<Options>();
  command->add_option("calibration", o->calibration, "Calibration file")->required();
  command
      ->add_option("input", o->input,
                   "A log of any format that is read (imu_calibrate convert --help); or the run file of a recording "
                   "(columns, raw counts), with --of-run")
      ->required();
  command
      ->add_option("-o,--output", o->output,
                   "Corrected file to write, .csv, .lcm or .mcap; from an LCM log to another the other channels go "
                   "along, beside a table the encoders go to NAME_encoder.csv")
      ->required();
  command->add_option("--channel", o->channel,
                      "Channel or topic of the unit; default IMU in an LCM log; else the only one");
  command->add_option("--of-run", o->of_run, "Of a run file with several: the recording to correct, from 1")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--recording", o->recording,
                   "Use the turn-on bias of this recording of the calibration, from 1; default the mean over them")
      ->check(CLI::Range(1, 1000));
  command->footer("Example:\n  imu_calibrate apply calibration.yaml flight.lcm -o corrected.lcm");
  command->callback([o, &exit_code] {
    apply(*o);
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
