// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <atomic>
#include <cstdint>

/// One interrupt writes, one loop reads; neither waits, nothing is locked. When the reader is late the newest sample is
/// dropped and counted: a hole in time must be seen, not closed up.
template <class Sample, std::uint32_t Size>
class SampleRing {
  static_assert(Size >= 2 && (Size & (Size - 1)) == 0, "a power of two: the counters wrap");

 public:
  void push(const Sample& sample) {  // from the interrupt
    const std::uint32_t written = written_.load(std::memory_order_relaxed);
    if (written - read_.load(std::memory_order_acquire) == Size) {
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    ring_[written % Size] = sample;
    written_.store(written + 1, std::memory_order_release);
  }
  bool pop(Sample& sample) {  // from the loop
    const std::uint32_t read = read_.load(std::memory_order_relaxed);
    if (read == written_.load(std::memory_order_acquire)) return false;
    sample = ring_[read % Size];
    read_.store(read + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] std::uint32_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::array<Sample, Size> ring_{};
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> read_{0};
  std::atomic<std::uint32_t> lost_{0};
};
