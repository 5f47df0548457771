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

}  // namespace

ExitCode run_program(CLI::App& app, std::vector<std::string> arguments, const std::function<ExitCode()>& run) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, on_end) == SIG_IGN) static_cast<void>(std::signal(signal, SIG_IGN));  // as nohup wants it
  }
  const std::string name = app.get_name();
  ExitCode code = ExitCode::kDone;
  try {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants it
    app.parse(arguments);
    code = run();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? ExitCode::kDone : ExitCode::kUsage;
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

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool interrupted() { return signalled != 0; }

}  // namespace trunnion::app
