// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From the files of a run to what the solver takes.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "trunnion/calibration/compress.hpp"
#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/error_model/stream_correction.hpp"
#include "trunnion/io/run_file.hpp"

namespace trunnion::app {

/// Digests and losses of a run's inputs.
struct RunInputs {
  std::vector<std::pair<std::string, std::string>> digests;  ///< path as in the run file's folder, SHA-256
  io::LogLosses losses;
};

/// Every file that a run names, itself included.
std::vector<std::string> files_of(const io::RunFile& run);

/// A recording that is named on the command line.
struct OneRecording {
  io::RunFile run;  ///< defaults where the input is no run file
  io::RecordingFiles files;
};

/// @param input LCM log, table, or a run file, of which @p of_run is the recording, from 1 (0: the only one).
/// @param channel of the log; empty: the default. @throws Error (usage, input)
OneRecording one_recording(const std::string& input, const std::string& channel, int of_run);

/// Of the name that is stated, else by the extension of the output. @throws Error (usage)
const io::LogFormat& format_to_write(const std::string& output, const std::string& stated);

/// On standard error: what was damaged, and what else was not read.
void say_losses(const io::LogLosses& losses);

/// How a recording of the run is compressed, whether it is read or comes live.
calibration::CompressOptions compress_options(const io::RunFile& run, const io::RecordingFiles& files);

/// Each sample as it is, and corrected; both with the same encoders.
class BeforeAndAfter final : public SampleSink {
 public:
  BeforeAndAfter(const calibration::CompressOptions& options, const InertialUnit<double>& unit)
      : before(options), after(options), correction_(unit) {}
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    before.imu(utime, sample);
    after.imu(utime, correction_.correct(1e-6 * static_cast<double>(utime), sample));
  }
  void temperature(double celsius) override {
    has_temperature_ = true;
    correction_.set_temperature(celsius);
  }
  /// On standard error, where @p unit has terms of temperature and nothing told one.
  void say_what_is_missing(const InertialUnit<double>& unit, const std::string& name) const;
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    before.encoder(utime, azimuth, pitch);
    after.encoder(utime, azimuth, pitch);
  }
  calibration::Compressor before;
  calibration::Compressor after;

 private:
  StreamCorrection<double> correction_;
  bool has_temperature_ = false;
};

/// Reads and compresses every recording, on as many threads as the machine has. @p mounts: names, in the rig's order
std::vector<calibration::TableRecording> read_table_recordings(const io::RunFile& run,
                                                               const std::vector<std::string>& mounts,
                                                               RunInputs& inputs);

/// Reads every recording by hand and takes it apart.
std::vector<calibration::HandRecording> read_hand_recordings(const io::RunFile& run, RunInputs& inputs);

}  // namespace trunnion::app
