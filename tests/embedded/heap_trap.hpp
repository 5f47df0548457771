// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// malloc itself, counted: Eigen does not go through operator new. For one source of a program.

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdlib>

inline long g_allocations = 0;

extern "C" void* __libc_malloc(std::size_t);  // NOLINT(bugprone-reserved-identifier): glibc's own name

extern "C" void* malloc(std::size_t size) {
  ++g_allocations;
  return __libc_malloc(size);
}

/// Whether a dynamic matrix springs the trap.
inline bool trap_is_live() {
  const long before = g_allocations;
  const Eigen::VectorXd sprung =
      Eigen::VectorXd::Ones(100 + std::rand() % 2);  // NOLINT: any size the compiler cannot know
  return sprung.sum() >= 100.0 && g_allocations != before;
}
