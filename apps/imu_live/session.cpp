// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "session.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "../terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::app {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

constexpr auto kWatchEvery = milliseconds(50);
constexpr auto kFlushEvery = milliseconds(10);
constexpr auto kShowEvery = milliseconds(500);
constexpr auto kEstimateEvery = milliseconds(500);
constexpr long long kStraysOfAGap = 2;  // the first stamp of a channel after a silence is not trusted yet
constexpr double kSilent = 1.0;         // s
constexpr double kWorthKeeping = 10.0;  // s of a recording that was interrupted

}  // namespace

Session::Session(const io::RunFile& run, const io::RigFile& rig, const std::vector<std::string>& mounts,
                 bus::Connection& connection, SharedState& state, const SessionOptions& options)
    : run_(run),
      mounts_(mounts),
      connection_(connection),
      state_(state),
      options_(options),
      estimator_(run, rig, mounts, state),
      watched_(Clock::now()),
      shown_(watched_),
      next_estimate_(watched_) {
  if (run.recordings.size() > kMaxRecordings)
    throw Error(ExitCode::kInput,
                run.path + ": more than " + std::to_string(kMaxRecordings) + " recordings in one run");
  for (const io::RecordingFiles& files : run.recordings) {
    const std::string folder = std::filesystem::path(files.log).parent_path().string();
    std::error_code error;
    if (!files.log.empty() && !std::filesystem::exists(files.log, error) &&
        ::access(folder.empty() ? "." : folder.c_str(), W_OK) != 0)
      throw io::input_error(files.log, 0, "", std::string("cannot write: ") + std::strerror(errno));
    for (const io::RecordingFiles& other : run.recordings) {
      if (&other != &files && other.log == files.log && !files.log.empty())
        throw Error(ExitCode::kInput, run.path + ": two recordings have the log " + files.log);
    }
    if (files.log.empty() || files.mount.empty())
      throw Error(ExitCode::kInput, run.path +
                                        ": a live calibration records LCM logs on a rig: each recording needs a "
                                        "mount and a log");
  }
  state_.change([&](LiveState& s) {
    s.recordings = static_cast<int>(run_.recordings.size());
    s.model = run_.sheet.model;
    s.unattended = options_.unattended;
  });
  connection_.subscribe(run_.channels.imu_channel(), &Session::on_imu, *this);
  if (run_.channels.encoder_channel() == run_.channels.imu_channel())
    throw Error(ExitCode::kInput, run.path + ": the unit and the encoders have the same channel");
  connection_.subscribe(run_.channels.encoder_channel(), &Session::on_encoder, *this);
  load_or_wait();
}

int Session::mount_of(std::size_t index) const {
  return static_cast<int>(std::find(mounts_.begin(), mounts_.end(), run_.recordings[index].mount) - mounts_.begin());
}

/// Goes over the recordings that are there, up to the one that is to be recorded next.
void Session::load_or_wait() {
  namespace fs = std::filesystem;
  std::error_code error;
  while (recordings_.size() < run_.recordings.size()) {
    const std::size_t index = recordings_.size();
    const io::RecordingFiles& files = run_.recordings[index];
    state_.change([&](LiveState& s) {
      s.recording = static_cast<int>(index) + 1;
      s.mount = files.mount;
    });
    if (!fs::exists(files.log, error)) {
      const std::string part = io::LcmJournal::part_of(files.log);
      if (fs::exists(part, error) && fs::file_size(part, error) > 0) return start();
      state_.change([&](LiveState& s) {
        s.phase = Phase::kWaiting;
        s.guidance = options_.unattended ? "waiting for the unit in " + files.mount
                                         : "change to " + files.mount + ", press Enter";
      });
      return;
    }
    load(index);
  }
}

/// One that was recorded in an earlier session.
void Session::load(std::size_t index) {
  const io::RecordingFiles& files = run_.recordings[index];
  calibration::Compressor compressor(compress_options(run_, files));
  const io::LogLosses losses = io::read_recording(run_, files, compressor, inputs_.digests);
  inputs_.losses.records += losses.records;
  inputs_.losses.bytes += losses.bytes;
  inputs_.losses.samples += losses.samples;
  recordings_.push_back({compressor.finish(), mount_of(index)});
  estimator_.begin(static_cast<int>(index) + 1, mount_of(index));
  estimator_.add(recordings_.back().data);
  add_notice(state_, files.log + " is recorded already and is used; move it away to record " + files.mount + " again");
}

void Session::fresh_recording() {
  const io::RecordingFiles& files = run_.recordings[recordings_.size()];
  compressor_ = std::make_unique<calibration::Compressor>(compress_options(run_, files));
  decoder_.emplace(connection_.url(), message_, run_.channels);
  handed_over_ = 0;
  said_strays_ = restarts_ = 0;
  said_damage_ = said_saturation_ = said_two_ = said_loss_ = said_journal_ = false;
  arrived_ = false;
}

/// Begins the recording that is next, or takes up what is there of it.
void Session::start() {
  const std::size_t index = recordings_.size();
  const io::RecordingFiles& files = run_.recordings[index];
  fresh_recording();
  estimator_.begin(static_cast<int>(index) + 1, mount_of(index));
  recording_ = true;
  std::string unfit;
  journal_.reset();
  try {
    journal_ = std::make_unique<io::LcmJournal>(files.log, [&](const io::LcmEvent& event) {
      try {
        if (unfit.empty() && event.channel == run_.channels.imu_channel()) take(event, true);
        if (unfit.empty() && event.channel == run_.channels.encoder_channel()) take(event, false);
      } catch (const Error& e) {
        unfit = e.what();
      }
    });
  } catch (const Error& e) {
    // what is in memory already is worth more than the file
    if (inputs_.digests.size() == recordings_.size()) throw;
    say_once(said_journal_, std::string("nothing is recorded: ") + e.what() + "; the calibration goes on");
  }
  imu_.last = encoder_.last = Clock::now();
  imu_.silent = encoder_.silent = false;
  state_.change([](LiveState& s) {
    s.phase = Phase::kRecording;
    s.enough = false;
  });
  if (!unfit.empty()) return begin_again(unfit);
  if (journal_ && journal_->recovered() > 0) {
    add_notice(state_, "going on with " + files.mount + ": " + std::to_string(journal_->recovered()) +
                           " messages are there already" +
                           (journal_->dropped() > 0 ? ", " + std::to_string(journal_->dropped()) +
                                                          " bytes of one that was cut off are dropped"
                                                    : ""));
    hand_over();
  } else {
    add_notice(state_, "recording " + files.mount + " into " + files.log);
  }
}

void Session::on_message(const io::LcmEvent& event, bool imu) {
  Arrivals& arrivals = imu ? imu_ : encoder_;
  arrivals.last = Clock::now();
  if (!recording_ && recordings_.size() < run_.recordings.size() && options_.unattended) start();
  if (!recording_) {
    ++arrivals.count;
    return;
  }
  arrived_ = true;
  take(event, imu);
}

/// Decodes a message, journals it when it is good, and gives its samples to the windows.
void Session::take(const io::LcmEvent& event, bool imu) {
  message_.samples.clear();
  message_.angles.clear();
  std::string fault;
  const long long damaged = decoder_->damaged_records();
  try {
    imu ? decoder_->imu(event) : decoder_->encoder(event);
    if (decoder_->damaged_records() > damaged) fault = decoder_->first_fault();
  } catch (const Error& e) {  // a number that is none: live, one message is left out
    fault = e.what();
    message_.samples.clear();
    message_.angles.clear();
  }
  if (!fault.empty()) {
    state_.change([&](LiveState& s) { ++(imu ? s.imu : s.encoder).damaged; });
    say_once(said_damage_, "a message is left out: " + fault);
  }
  if (message_.samples.empty() && message_.angles.empty()) return;
  (imu ? imu_ : encoder_).count += static_cast<long long>(message_.samples.size() + message_.angles.size());
  const bool period_known = compressor_->figures().period > 0.0;
  try {
    for (const auto& [utime, sample] : message_.samples) compressor_->imu(utime, sample);
    for (const auto& [utime, angle] : message_.angles) compressor_->encoder(utime, angle[0], angle[1]);
  } catch (const Error& e) {
    // nothing of this journal was good yet: the stream is not what the run says
    if (!period_known && (!journal_ || journal_->recovered() == 0)) {
      if (journal_) discard_journal();
      throw;
    }
    return begin_again(e.what());
  }
  if (journal_) journal_->write(event.timestamp, event.channel, event.data);
}

/// Sets the journal aside; what is not worth keeping goes. @return where it is kept, or nothing
std::string Session::discard_journal() {
  std::string kept = journal_->set_aside();
  journal_.reset();
  std::error_code error;
  if (compressor_->elapsed() < kWorthKeeping && std::filesystem::remove(kept, error)) kept.clear();
  return kept;
}

/// The recording cannot go on: it is kept aside, and begins anew.
void Session::begin_again(const std::string& why) {
  const io::RecordingFiles& files = run_.recordings[recordings_.size()];
  const std::string kept = journal_ ? discard_journal() : std::string();
  add_notice(state_, why + "; the recording of " + files.mount + " begins again" +
                         (kept.empty() ? "" : ", what there was is kept as " + kept));
  fresh_recording();
  estimator_.abandon();
  try {
    journal_ = std::make_unique<io::LcmJournal>(files.log, nullptr);
  } catch (const Error& e) {
    say_once(said_journal_, std::string("nothing is recorded: ") + e.what() + "; the calibration goes on");
  }
}

/// What came since the last time, to the estimator.
void Session::hand_over() {
  const auto begin = Clock::now();
  calibration::CompressedRecording part = compressor_->so_far(handed_over_);
  handed_over_ += part.windows.size();
  estimator_.add(std::move(part));
  // the course so far takes longer the longer it is: the bus is to wait a twentieth of the time at most
  next_estimate_ = Clock::now() + std::max<Clock::duration>(kEstimateEvery, 20 * (Clock::now() - begin));
}

void Session::finish_recording() {
  const std::size_t index = recordings_.size();
  const io::RecordingFiles& files = run_.recordings[index];
  calibration::TableRecording recording;
  recording.mount = mount_of(index);
  try {
    recording.data = compressor_->finish();
  } catch (const Error& e) {
    if (options_.unattended) throw;
    begin_again(e.what());
    return;
  }
  const std::string digest = journal_ ? journal_->finish() : std::string();
  if (!digest.empty()) {
    inputs_.digests.emplace_back(files.log, digest);
  } else {
    add_notice(state_, "the recording of " + files.mount + " is lost" + (journal_ ? ": " + journal_->failure() : "") +
                           "; the calibration goes on without it");
  }
  journal_.reset();
  if (decoder_->imu_sequence().numbered()) inputs_.losses.samples += decoder_->imu_sequence().lost();
  calibration::CompressedRecording part;
  part.name = recording.data.name;
  part.figures = recording.data.figures;
  part.course = recording.data.course;
  part.windows.assign(recording.data.windows.begin() + static_cast<std::ptrdiff_t>(handed_over_),
                      recording.data.windows.end());
  estimator_.add(std::move(part));
  show_figures();
  const SequenceWatch& sequence = decoder_->imu_sequence();
  add_notice(state_, files.mount + " is recorded: " + std::to_string(decoder_->samples()) + " samples, " +
                         std::to_string(sequence.numbered() ? sequence.lost() : 0) + " lost on the way, " +
                         std::to_string(recording.data.figures.missing) + " missing between their stamps");
  const LiveState seen = state_.copy();
  const auto open = std::count_if(seen.steps.begin(), seen.steps.end(),
                                  [](const LiveState::Step& step) { return step.seen < step.asked; });
  if (open > 0 && !seen.enough) {
    add_notice(state_, std::to_string(open) + " of " + std::to_string(seen.steps.size()) +
                           " steps of its plan were not seen; to record " + files.mount +
                           " again, start anew without " + files.log);
  }
  recording_ = false;
  recordings_.push_back(std::move(recording));
  load_or_wait();
}

void Session::say_once(bool& said, const std::string& text) {
  if (!said) add_notice(state_, text);
  said = true;
}

void Session::watch_channel(const char* name, Arrivals& arrivals, double now_silent) {
  if (now_silent > kSilent && !arrivals.silent) {
    arrivals.silent = true;
    add_notice(state_, std::string("lost channel: no message of ") + name + " for " + figure(now_silent, 2) + " s");
  } else if (arrivals.silent && now_silent < kSilent) {
    arrivals.silent = false;
    add_notice(state_, std::string("a message of ") + name + " again");
  }
}

void Session::show_figures() {
  const auto now = Clock::now();
  const double past = duration<double>(now - shown_).count();
  shown_ = now;
  const auto show = [&](Arrivals& arrivals, LiveState::Channel& into) {
    if (past > 0.1) arrivals.rate = static_cast<double>(arrivals.count) / past;
    arrivals.count = 0;
    into.rate_hz = arrivals.rate;
    into.silent_s = recording_ ? duration<double>(now - arrivals.last).count() : 0.0;
  };
  const auto count = [](const SequenceWatch& sequence, LiveState::Channel& into) {
    into.lost = sequence.numbered() ? sequence.lost() : 0;
    into.late = sequence.late();
  };
  state_.change([&](LiveState& s) {
    show(imu_, s.imu);
    show(encoder_, s.encoder);
    if (!compressor_) return;
    count(decoder_->imu_sequence(), s.imu);
    count(decoder_->encoder_sequence(), s.encoder);
    s.imu.samples = decoder_->samples();
    s.encoder.samples = decoder_->encoders();
    s.duration = compressor_->elapsed();
    s.saturated = compressor_->figures().saturated;
    s.strays = compressor_->strays();
  });
}

/// What is noticed between messages.
void Session::watch() {
  const auto now = Clock::now();
  const auto silent = [&](const Arrivals& a) { return duration<double>(now - a.last).count(); };
  if (journal_ && !journal_->failure().empty())
    say_once(said_journal_, "nothing more is recorded: " + journal_->failure() + "; the calibration goes on");
  if (recording_) {
    // unattended both are silent where a mount ends
    const bool both = options_.unattended && silent(imu_) > kSilent && silent(encoder_) > kSilent;
    if (!both || silent(imu_) > options_.silence + kSilent) {
      watch_channel("the unit", imu_, silent(imu_));
      watch_channel("the encoders", encoder_, silent(encoder_));
    }
    const SequenceWatch& sequence = decoder_->imu_sequence();
    const long long strays = compressor_->strays();
    // not each: a clock that keeps jumping would leave no room for anything else
    if (strays > 2 * said_strays_ + kStraysOfAGap && !sequence.two_publishers()) {
      add_notice(state_, "a clock jumped: " + std::to_string(strays) + " stamps out of their order are left out");
      said_strays_ = strays;
    }
    if (sequence.restarts() > restarts_) {
      restarts_ = sequence.restarts();
      add_notice(state_,
                 "the unit's publisher began again: if the unit was switched off, its turn-on bias is another; then "
                 "end this recording and start it anew");
    }
    if (sequence.two_publishers()) say_once(said_two_, "two publishers on channel " + run_.channels.imu_channel());
    if (sequence.numbered() && sequence.lost() > 0)
      say_once(said_loss_, std::to_string(sequence.lost()) + " samples were lost on the way, and counting");
    if (compressor_->figures().saturated > 0)
      say_once(said_saturation_, "saturated: samples at or past the range of the sheet; turn slower");
    if (now > next_estimate_ && !estimator_.busy()) hand_over();
  }
  if (now - shown_ > kShowEvery) show_figures();
  int clicks = clicks_.exchange(0);
  if (options_.unattended && recording_ && silent(imu_) > options_.silence && silent(encoder_) > options_.silence) {
    // one that was taken up may have been whole when the program was killed: then nothing more comes
    if (arrived_ || (journal_ && journal_->recovered() > 0 && state_.copy().enough)) clicks = 1;
  }
  if (clicks == 0) return;
  if (recording_) {
    finish_recording();
  } else {
    start();
  }
}

bool Session::step() {
  if (recordings_.size() == run_.recordings.size()) return false;
  connection_.handle(20);
  const auto now = Clock::now();
  if (journal_ && now - flushed_ > kFlushEvery) {
    journal_->flush();
    flushed_ = now;
  }
  if (now - watched_ < kWatchEvery) return true;
  watched_ = now;
  watch();
  return recordings_.size() < run_.recordings.size();
}

}  // namespace trunnion::app
