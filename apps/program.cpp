// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "program.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>

#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

volatile std::sig_atomic_t signalled = 0;
void on_signal(int) { signalled = 1; }

/// The program ends as it would have; of its outputs nothing is left that is not whole.
void on_end(int signal) {
  io::remove_unfinished();
  static_cast<void>(std::signal(signal, SIG_DFL));
  static_cast<void>(std::raise(signal));
}

/// Unless the signal is ignored, as nohup wants it.
void handle(int signal, void (*handler)(int)) {
  if (std::signal(signal, handler) == SIG_IGN) static_cast<void>(std::signal(signal, SIG_IGN));
}

}  // namespace

ExitCode run_program(CLI::App& app, std::vector<std::string> arguments, const std::function<ExitCode()>& run) {
  end_on_signals();
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));  // a file beyond its limit is an error, as a full disk is
  const std::string name = app.get_name();
  ExitCode code = ExitCode::kDone;
  try {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants it
    app.parse(arguments);
    code = run();
  } catch (const CLI::ParseError& e) {
    if (app.exit(e) != 0) return ExitCode::kUsage;
  } catch (const Error& e) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), e.what());
    return e.code();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: a defect of ours, please report it: %s\n", name.c_str(), e.what());
    return ExitCode::kDefect;
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::fprintf(stderr, "%s: cannot write the result to standard output\n", name.c_str());
    return ExitCode::kInput;
  }
  return code;
}

int main_of(int argc, char** argv, const std::function<ExitCode(std::vector<std::string>)>& program) {
  try {
    return static_cast<int>(program({argv + 1, argv + argc}));
  } catch (...) {
    return static_cast<int>(ExitCode::kDefect);
  }
}

void end_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle(signal, on_end);
}

void catch_interrupts() {
  // SIGINT also where a script's shell has it ignored, as it does for all it starts in the background: it is how they
  // end
  for (const int signal : {SIGINT, SIGTERM}) static_cast<void>(std::signal(signal, on_signal));
}

bool interrupted() { return signalled != 0; }

}  // namespace trunnion::app
