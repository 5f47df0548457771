// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A live calibration from the first message to the recordings that are solved: mount after mount, each journalled as
/// it comes, so that a session which was cut short goes on where it was.

#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../imu_calibrate/recordings.hpp"
#include "estimator.hpp"
#include "state.hpp"
#include "trunnion/bus/connection.hpp"
#include "trunnion/calibration/compress.hpp"
#include "trunnion/io/lcm_journal.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::app {

struct SessionOptions {
  bool unattended = false;  ///< a mount begins with its first message and ends when the channels fall silent
  double silence = 3.0;     ///< s that end it
};

class Session {
 public:
  /// Takes up what is recorded already. The references must outlive it.
  /// @throws Error (usage) for a run without a rig or whose recordings are no LCM logs, Error (input) for recordings
  /// that cannot be read
  Session(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& mounts,
          bus::Connection& connection, SharedState& state, const SessionOptions& options);

  /// Waits for messages, at most some 20 ms. @return false when every recording is there
  /// @throws Error (transport), Error (input) for what cannot be a recording
  bool step();

  /// What the operator's key or click means now: the next mount is in place, or this one is enough. From any thread.
  void next() { ++clicks_; }

  /// Whether the estimate has all that was recorded so far.
  [[nodiscard]] bool settled() const {
    return !estimator_.busy() && (!recording_ || handed_over_ == compressor_->windows());
  }

  /// Once step() has returned false.
  [[nodiscard]] const std::vector<calibration::TableRecording>& recordings() const { return recordings_; }
  [[nodiscard]] const RunInputs& inputs() const { return inputs_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// What a message holds, before it is taken.
  class Message final : public SampleSink {
   public:
    void imu(std::int64_t utime, const InertialSample<double>& sample) override { samples.push_back({utime, sample}); }
    void encoder(std::int64_t utime, double azimuth, double pitch) override {
      angles.push_back({utime, {azimuth, pitch}});
    }
    std::vector<std::pair<std::int64_t, InertialSample<double>>> samples;
    std::vector<std::pair<std::int64_t, std::array<double, 2>>> angles;
  };

  struct Arrivals {
    Clock::time_point last;
    bool silent = false;
    long long count = 0;  ///< samples since the rate was shown
    double rate = 0.0;
  };

  void on_imu(const io::LcmEvent& event) { on_message(event, true); }
  void on_encoder(const io::LcmEvent& event) { on_message(event, false); }
  void on_message(const io::LcmEvent& event, bool imu);
  void take(const io::LcmEvent& event, bool imu);
  void load_or_wait();
  void load(std::size_t index);
  void start();
  void fresh_recording();
  void finish_recording();
  void begin_again(const std::string& why);
  std::string discard_journal();
  void hand_over();
  void watch();
  void watch_channel(const char* name, Arrivals& arrivals, double now_silent);
  void say_once(bool& said, const std::string& text);
  void show_figures();
  [[nodiscard]] int mount_of(std::size_t index) const;

  const io::RunFile& run_;
  std::vector<std::string> mounts_;
  bus::Connection& connection_;
  SharedState& state_;
  SessionOptions options_;
  Estimator estimator_;
  std::atomic<int> clicks_{0};

  std::vector<calibration::TableRecording> recordings_;
  RunInputs inputs_;
  bool recording_ = false;
  Message message_;
  std::optional<io::LcmDecoder> decoder_;
  std::unique_ptr<calibration::Compressor> compressor_;
  std::unique_ptr<io::LcmJournal> journal_;
  std::size_t handed_over_ = 0;  // windows

  Arrivals imu_;
  Arrivals encoder_;
  Clock::time_point watched_;
  Clock::time_point flushed_;
  Clock::time_point shown_;
  Clock::time_point next_estimate_;
  bool arrived_ = false;  // since the recording began or was taken up
  long long said_strays_ = 0;
  long long restarts_ = 0;
  bool said_damage_ = false;
  bool said_saturation_ = false;
  bool said_two_ = false;
  bool said_loss_ = false;
  bool said_journal_ = false;
};

}  // namespace trunnion::app
