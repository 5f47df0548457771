// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Independent work on all cores.

#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace trunnion::calibration {

/// Calls job(i) for i in [0, n), each once, in no order. Where one throws no other begins, and what the lowest i threw
/// is thrown here. @param most threads; 0: as many as the machine has
template <class Job>
void share_out(std::size_t n, const Job& job, unsigned most = 0) {
  std::vector<std::exception_ptr> failed(n);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < n; i = next++) {
      try {
        job(i);
      } catch (...) {
        failed[i] = std::current_exception();
        next = n;
      }
    }
  };
  std::vector<std::thread> threads;
  const std::size_t wanted =
      std::min<std::size_t>(n, most > 0 ? most : std::max(1U, std::thread::hardware_concurrency()));
  try {
    for (std::size_t t = 1; t < wanted; ++t) threads.emplace_back(work);
  } catch (const std::system_error&) {
    // no more threads to be had: those there are do the work
  }
  work();
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& one : failed) {
    if (one) std::rethrow_exception(one);
  }
}

}  // namespace trunnion::calibration
