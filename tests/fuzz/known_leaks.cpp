// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// urdfdom 3 loses a few hundred bytes for each file that it refuses: its own links point at each other. LeakSanitizer
/// is told so; leaks of ours it reports.

extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier): the sanitizer's name

extern "C" const char* __lsan_default_suppressions() {
  return "leak:urdf::parseURDF\nleak:liburdfdom_model\n";
}  // NOLINT
