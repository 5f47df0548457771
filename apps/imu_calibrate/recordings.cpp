// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "recordings.hpp"

#include <algorithm>
#include <filesystem>
#include <mutex>

#include "../terminal.hpp"
#include "trunnion/calibration/share_out.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::app {
namespace {

/// Progress of several files as one line.
class ReadProgress {
 public:
  explicit ReadProgress(std::size_t files) : fraction_(files, 0.0) {}
  io::Progress of(std::size_t file) {
    return [this, file](double fraction) {
      const std::lock_guard<std::mutex> lock(mutex_);
      fraction_[file] = fraction;
      double sum = 0.0;
      for (const double f : fraction_) sum += f;
      line_.show("reading " + std::to_string(static_cast<int>(100.0 * sum / static_cast<double>(fraction_.size()))) +
                 " %");
    };
  }

 private:
  std::mutex mutex_;
  std::vector<double> fraction_;
  ProgressLine line_;
};

/// @throws Error (input) when two recordings are the same file by content
void collect(RunInputs& inputs, std::vector<RunInputs>& each) {
  for (std::size_t i = 0; i < each.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (each[i].digests.front().second == each[k].digests.front().second) {
        throw Error(ExitCode::kInput,
                    each[i].digests.front().first + ": is the same recording as " + each[k].digests.front().first);
      }
    }
  }
  for (RunInputs& one : each) {
    inputs.losses.records += one.losses.records;
    inputs.losses.bytes += one.losses.bytes;
    inputs.losses.samples += one.losses.samples;
    if (!one.losses.note.empty()) inputs.losses.note += (inputs.losses.note.empty() ? "" : "; ") + one.losses.note;
    for (auto& digest : one.digests) inputs.digests.push_back(std::move(digest));
  }
}

}  // namespace

std::vector<std::string> files_of(const io::RunFile& run) {
  std::vector<std::string> files = {run.path, run.rig, run.sheet_path, run.moves};
  for (const io::RecordingFiles& recording : run.recordings)
    files.insert(files.end(), {recording.log, recording.imu, recording.encoder, recording.gyro, recording.accel});
  return files;
}

OneRecording one_recording(const std::string& input, const std::string& channel, int of_run) {
  OneRecording one;
  if (io::is_run_file(input)) {
    one.run = io::read_run_file(input);
    const int recordings = static_cast<int>(one.run.recordings.size());
    if (of_run > recordings || (of_run == 0 && recordings > 1))
      throw Error(ExitCode::kUsage, input + ": has " + std::to_string(recordings) +
                                        " recordings: choose one with --of-run 1" +
                                        (recordings > 1 ? " to " + std::to_string(recordings) : ""));
    if (!channel.empty()) throw Error(ExitCode::kUsage, "--channel: the run file names its channels");
    one.files = one.run.recordings[static_cast<std::size_t>(std::max(1, of_run) - 1)];
  } else {
    if (of_run > 0) throw Error(ExitCode::kUsage, "--of-run: " + input + " is no run file");
    if (!channel.empty()) one.run.channels.imu.name = channel;
    one.files.log = input;
  }
  return one;
}

const io::LogFormat& format_to_write(const std::string& output, const std::string& stated) {
  if (!stated.empty()) return io::format_by_name(stated);
  std::string writable;
  for (const io::LogFormat& format : io::log_formats()) {
    if (format.write == nullptr) continue;
    if (std::filesystem::path(output).extension() == format.extension) return format;
    writable += std::string(writable.empty() ? "" : ", ") + format.extension;
  }
  throw Error(ExitCode::kUsage, output + ": no format that is written has this extension (" + writable + ")");
}

void say_losses(const io::LogLosses& losses) {
  if (losses.samples > 0)
    std::fprintf(stderr, "%lld samples are missing, as sequence numbers or the recorder's own count say\n",
                 losses.samples);
  if (losses.records > 0)
    std::fprintf(stderr, "%lld damaged records, %lld bytes passed over\n", losses.records, losses.bytes);
  if (!losses.note.empty()) std::fprintf(stderr, "note: %s\n", losses.note.c_str());
}

void BeforeAndAfter::say_what_is_missing(const InertialUnit<double>& unit, const std::string& name) const {
  if (unit.thermal.order() > 0 && !has_temperature_)
    std::fprintf(stderr, "%s: states no temperature, and the calibration has terms of it: corrected at %s degC\n",
                 name.c_str(), figure(unit.thermal.reference, 4).c_str());
}

calibration::CompressOptions compress_options(const io::RunFile& run, const io::RecordingFiles& files) {
  calibration::CompressOptions options;
  options.name = files.name();
  options.period = run.sheet.rate_hz > 0.0 ? 1.0 / run.sheet.rate_hz : 0.0;
  options.range = {run.sheet.gyro_range, run.sheet.accel_range};
  return options;
}

std::vector<calibration::TableRecording> read_table_recordings(const io::RunFile& run,
                                                               const std::vector<std::string>& mounts,
                                                               RunInputs& inputs) {
  std::vector<calibration::TableRecording> recordings(run.recordings.size());
  std::vector<RunInputs> each(run.recordings.size());
  ReadProgress progress(run.recordings.size());
  calibration::share_out(run.recordings.size(), [&](std::size_t i) {
    const io::RecordingFiles& files = run.recordings[i];
    calibration::Compressor compressor(compress_options(run, files));
    each[i].losses = io::read_recording(run, files, compressor, each[i].digests, progress.of(i));
    recordings[i].data = compressor.finish();
    recordings[i].mount = static_cast<int>(std::find(mounts.begin(), mounts.end(), files.mount) - mounts.begin());
  });
  collect(inputs, each);
  return recordings;
}

std::vector<calibration::HandRecording> read_hand_recordings(const io::RunFile& run, RunInputs& inputs) {
  std::vector<calibration::HandRecording> recordings(run.recordings.size());
  std::vector<RunInputs> each(run.recordings.size());
  ReadProgress progress(run.recordings.size());
  calibration::share_out(run.recordings.size(), [&](std::size_t i) {
    calibration::RestsAndTurns parts(run.recordings[i].name());
    each[i].losses = io::read_recording(run, run.recordings[i], parts, each[i].digests, progress.of(i));
    recordings[i] = parts.finish({run.sheet.gyro_range, run.sheet.accel_range});
  });
  collect(inputs, each);
  return recordings;
}

}  // namespace trunnion::app
