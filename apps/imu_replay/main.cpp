// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <regex>
#include <set>

#include "../program.hpp"
#include "../terminal.hpp"
#include "trunnion/bus/replay.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/log_format.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string log;
  std::string url;
  double speed = 1.0;
  std::string pattern;
  std::vector<std::string> channels;
  double start = 0.0;
  double end = std::numeric_limits<double>::infinity();
  bool lossless = false;
  bool verbose = false;
};

ExitCode replay(const Options& o) {
  if (std::isnan(o.speed) || std::isnan(o.start) || std::isnan(o.end))  // no range of CLI11's refuses it
    throw Error(ExitCode::kUsage, "--speed, --start and --end are numbers");
  std::regex pattern;
  try {
    pattern = std::regex(o.pattern, std::regex::ECMAScript | std::regex::optimize);
  } catch (const std::regex_error& e) {
    throw Error(ExitCode::kUsage, "--regexp '" + o.pattern + "': " + e.what());
  }
  if (const io::LogFormat& format = io::format_of(o.log); !format.by_channel)
    throw io::input_error(o.log, 0, "",
                          std::string("is a ") + format.title + ": imu_calibrate convert makes an LCM log of it");
  io::LcmLogReader log(o.log);
  bus::Connection connection(o.url);
  if (o.lossless && !connection.lossless())
    throw Error(ExitCode::kUsage,
                connection.url() + ": drops what subscribers are too slow for; --lossless needs tcpq://");
  bus::ReplayOptions options;
  options.speed = o.lossless ? 0.0 : o.speed;
  options.start = o.start;
  options.end = o.end;
  const std::set<std::string, std::less<>> names(o.channels.begin(), o.channels.end());
  if (!names.empty() || !o.pattern.empty()) {
    options.chosen = [&](std::string_view channel) {
      return (names.empty() || names.find(channel) != names.end()) &&
             (o.pattern.empty() || std::regex_match(channel.begin(), channel.end(), pattern));
    };
  }
  ProgressLine progress;
  long long messages = 0;
  options.published = [&](const io::LcmEvent& event) {
    if (o.verbose) {
      std::printf("%lld %s %zu\n", static_cast<long long>(event.timestamp),
                  io::printable(std::string(event.channel)).c_str(), event.data.size());
    }
    if (++messages % 256 == 0)
      progress.show("replayed " + std::to_string(100 * event.byte / log.size()) + " %, " + std::to_string(messages) +
                    " messages");
  };
  options.goes_on = [] { return !interrupted(); };
  const auto begin = std::chrono::steady_clock::now();
  const bus::ReplayFigures figures = bus::replay(log, connection, options);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::fprintf(stderr, "%s: %lld messages, %lld bytes, %.3f s of log in %.3f s, at most %.3f ms late", o.log.c_str(),
               figures.messages, figures.bytes, figures.duration, took, 1e3 * figures.latest);
  if (log.lost_bytes() > 0)
    std::fprintf(stderr, "; %lld damaged records, %lld bytes passed over", log.lost_records(), log.lost_bytes());
  std::fprintf(stderr, "\n");
  if (interrupted()) return ExitCode::kInterrupted;
  if (figures.messages == 0) throw io::input_error(o.log, 0, "", "has no message that was chosen");
  return ExitCode::kDone;
}

}  // namespace

ExitCode run_replay(std::vector<std::string> arguments) {
  CLI::App app("Plays an LCM log back onto a bus, at the pace at which it was recorded.", "imu_replay");
  app.set_version_flag("--version", tool_name());
  Options o;
  app.add_option("log", o.log, "LCM log")->required();
  app.add_option("-l,--lcm-url", o.url, "Bus; default LCM_DEFAULT_URL, or LCM's own");
  app.add_option("-s,--speed", o.speed, "Times the recorded pace; 0 or less: without pauses")
      ->capture_default_str()
      ->check(CLI::Range(-1e9, 1e9));
  app.add_option("-e,--regexp", o.pattern, "Only channels that this regular expression matches as a whole");
  app.add_option("-c,--channel", o.channels, "Only this channel; may be given again");
  app.add_option("--start", o.start, "Seconds after the first event to begin at")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e12));
  app.add_option("--end", o.end, "Seconds after the first event to end at")->check(CLI::Range(0.0, 1e12));
  app.add_flag("--lossless", o.lossless, "As fast as the subscribers keep up: over tcpq, which waits for them");
  app.add_flag("-v,--verbose", o.verbose, "Print time, channel and size of each message");
  app.footer("Example:\n  imu_replay position_1.lcm --speed 4 --channel IMU --channel ENCODER");
  return run_program(app, std::move(arguments), [&] {
    catch_interrupts();
    return replay(o);
  });
}

}  // namespace trunnion::app

int main(int argc, char** argv) { return trunnion::app::main_of(argc, argv, trunnion::app::run_replay); }
