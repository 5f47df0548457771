// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How rungs 2 and up refuse: one exception that carries the exit code and where the fault lies. Rungs 0 and 1 never
/// include this file; they return a Status.

#pragma once

#include <stdexcept>

namespace trunnion {

/// Exit codes of the command: part of the interface, docs/reference/exit-codes.md.
enum class ExitCode : int {
  kDone = 0,
  kOutOfLimits = 1,
  kUsage = 2,
  kInput = 3,
  kNumerics = 4,
  kTransport = 5,
  kDefect = 70,
  kInterrupted = 130,
};

/// A refusal in the user's words: "file:line: field: what is wrong and what to do".
class Error : public std::runtime_error {
 public:
  template <class Text>
  Error(ExitCode code, const Text& what) : std::runtime_error(what), code_(code) {}

  [[nodiscard]] ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace trunnion
