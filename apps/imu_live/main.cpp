// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <optional>

#include "../imu_calibrate/result.hpp"
#include "../outputs.hpp"
#include "../program.hpp"
#include "../terminal.hpp"
#include "session.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/whole_file.hpp"
#ifdef TRUNNION_HAS_PAGE
#include "page.hpp"
#endif

namespace trunnion::app {
namespace {

constexpr auto kSayEvery = std::chrono::milliseconds(50);
constexpr auto kTwice = std::chrono::milliseconds(700);  // a second Enter within it is no answer to what is asked since

struct Options {
  std::string run;
  std::string output;
  std::string url;
  int port = 8765;
  bool no_page = false;
  SessionOptions session;
};

/// Enter on the terminal. @return false at the end of standard input
bool take_enter(bool& entered) {
  pollfd descriptor{STDIN_FILENO, POLLIN, 0};
  entered = false;
  if (::poll(&descriptor, 1, 0) <= 0) return true;
  char bytes[256];
  const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
  for (ssize_t i = 0; i < got; ++i) entered = entered || bytes[i] == '\n';
  return got > 0;
}

/// Words on stderr: notices as they come, the rest as one line that changes.
class Words {
 public:
  void say(const LiveState& s) {
    std::vector<std::string> lines;
    for (const auto& notice : s.notices) {
      if (notice.serial > said_) lines.push_back("[" + fixed(notice.t) + " s] " + notice.text);
    }
    if (!s.notices.empty()) said_ = s.notices.back().serial;
    // what to do is said without a terminal too, but when it is another thing, not another second of it
    const std::string what = s.guidance.substr(0, s.guidance.find(": "));
    if (what != guided_ && !s.guidance.empty()) lines.push_back(s.guidance);
    guided_ = what;
    if (!lines.empty()) progress_.reset();
    for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.c_str());
    if (!progress_) progress_.emplace();
    progress_->show(s.mount + " " + fixed(s.duration) + " s, " + fixed(s.imu.rate_hz) + " samples/s, " +
                    std::to_string(s.imu.lost) + " lost; " + std::to_string(s.within) + " of " +
                    std::to_string(s.entries.size()) + " sigmas within limits; " + s.guidance);
  }
  void end() { progress_.reset(); }

 private:
  static std::string fixed(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
  }
  std::optional<ProgressLine> progress_;
  long long said_ = 0;
  std::string guided_;
};

ExitCode live(const Options& o, SharedState& state) {
  const io::RunFile run = io::read_run_file(o.run);
  if (run.rig.empty()) throw Error(ExitCode::kInput, o.run + ": has no rig: live calibration is for a table");
  if (run.temperature > 0)
    throw Error(ExitCode::kInput, o.run +
                                      ": model: temperature: a running estimate cannot know the range to come: record "
                                      "the soak's channels to logs, and solve those");
  check_outputs({o.output}, files_of(run));
  const std::vector<std::string> mounts = mounts_of(run);
  const io::RigFile rig = io::read_rig(run.rig, run.outer_axis, run.inner_axis, mounts);
  if (o.output.empty()) std::fprintf(stderr, "without -o the calibration is printed and not written\n");
  if (!o.output.empty()) io::WholeFile(o.output);  // can it be written? Better known now than at the end
  bus::Connection connection(o.url);
  Session session(run, rig, mounts, connection, state, o.session);
#ifdef TRUNNION_HAS_PAGE
  std::unique_ptr<Page> page;
  if (!o.no_page) {
    page = std::make_unique<Page>(o.port, state, [&session] { session.next(); });
    std::fprintf(stderr, "page: %s\n", page->url().c_str());
  }
#endif
  Words words;
  bool input = true;
  auto said = std::chrono::steady_clock::now();
  auto changed = said - kTwice;
  Phase phase = Phase::kWaiting;
  int recording = 1;
  while (session.step()) {
    const auto now = std::chrono::steady_clock::now();
    if (now - said < kSayEvery) continue;
    said = now;
    if (interrupted()) {
      words.end();
      std::fprintf(stderr, "interrupted: start again with the same run file to go on\n");
      return ExitCode::kInterrupted;
    }
    bool entered = false;
    if (input) input = take_enter(entered);
    const LiveState shown = state.copy();
    if (shown.phase != phase || shown.recording != recording) changed = now;
    phase = shown.phase;
    recording = shown.recording;
    if (entered && now - changed > kTwice) session.next();
    words.say(shown);
  }
  end_on_signals();  // all is recorded: what remains can be begun again
  if (interrupted()) return ExitCode::kInterrupted;
  state.change([](LiveState& s) {
    s.phase = Phase::kSolving;
    s.guidance = "solving";
  });
  words.say(state.copy());
  calibration::Solution solution;
  io::CalibrationFile file;
  try {
    solution = calibration::solve_table(session.recordings(), rig.rig, run.site, table_options(run, mounts));
    file = calibration_of(run, solution, session.inputs(), mounts);
  } catch (const Error& e) {
    words.end();
    state.change([&](LiveState& s) {
      s.phase = Phase::kFailed;
      s.guidance = "no calibration";
      s.verdict = e.what();
    });
#ifdef TRUNNION_HAS_PAGE
    if (page) page->flush();
#endif
    throw;
  }
  words.end();
  print_calibration(solution, file, run.sheet.has_noise);
  if (!o.output.empty()) io::write_whole(o.output, io::to_yaml(file));
  state.change([&](LiveState& s) {
    s.entries =
        entries_of(run, solution.parameters, solution.x, solution.observability.covariance.diagonal().cwiseSqrt());
    s.within = count_within(s.entries);
    s.phase = Phase::kDone;
    s.guidance = "done";
    s.verdict = file.within_limits ? "within limits" : "out of limits";
    s.out_of_limits = file.out_of_limits;
    s.output = o.output;
  });
#ifdef TRUNNION_HAS_PAGE
  if (page) page->flush();
#endif
  return file.within_limits ? ExitCode::kDone : ExitCode::kOutOfLimits;
}

}  // namespace

ExitCode run_live(std::vector<std::string> arguments) {
  CLI::App app(
      "Calibrates a unit while the table turns it: says what to do next, shows every sigma, and ends with the "
      "calibration that `imu_calibrate solve` gives from the recordings.",
      "imu_live");
  app.set_version_flag("--version", tool_name());
  Options o;
  app.add_option("run", o.run, "Run file: its recordings are what is recorded, one after the other")->required();
  app.add_option("-o,--output", o.output, "Calibration file to write");
  app.add_option("-l,--lcm-url", o.url, "Bus; default LCM_DEFAULT_URL, or LCM's own");
  app.add_option("--port", o.port, "Of the page on 127.0.0.1; 0: any that is free")
      ->capture_default_str()
      ->check(CLI::Range(0, 65535));
  app.add_flag("--no-page", o.no_page, "Serve no page");
  app.add_flag("--unattended", o.session.unattended,
               "A mount begins with its first message and ends when the channels fall silent: no key is asked for");
  app.add_option("--silence-s", o.session.silence, "That ends a mount, unattended")
      ->capture_default_str()
      ->check(CLI::Range(0.2, 600.0));
  app.footer(
      "Example:\n  imu_live run.yaml -o calibration.yaml\n\nWhat was recorded survives: start again to go on. Exit "
      "codes: "
      "0 done, within limits; 1 done, out of limits; 2 usage; 3 input; 4 numerics; 5 bus or port; 70 defect; 130 "
      "interrupted.");
  return run_program(app, std::move(arguments), [&] {
    catch_interrupts();
    SharedState state;
    return live(o, state);
  });
}

}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_live); }
