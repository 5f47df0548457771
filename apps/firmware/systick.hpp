// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Instructions, counted by the Cortex-M's SysTick on an emulator whose clock is its instruction count: one is 2^8 ns
/// (-icount shift=8), so a tick of 40 ns (mps2, 25 MHz) or 31.25 ns (mps3, 32 MHz) is a fixed fraction of one. On
/// silicon the same ticks are cycles.

#pragma once

#include <cstdint>

namespace board {

#if defined(__ARM_ARCH_8_1M_MAIN__) || (defined(__ARM_ARCH) && __ARM_ARCH >= 8)
constexpr std::uint32_t kTicksIn1000 = 8192;
#else
constexpr std::uint32_t kTicksIn1000 = 6400;
#endif

inline volatile std::uint32_t& systick(std::uint32_t offset) {
  return *reinterpret_cast<volatile std::uint32_t*>(0xe000e010U + offset);
}
inline void start_systick() {
  systick(4) = 0xffffffU;
  systick(8) = 0;
  systick(0) = 5;  // on, by the processor's clock, no interrupt
}
inline std::uint32_t ticks() { return systick(8); }

/// Instructions since ticks() was @p from; less than 2 million.
inline std::uint32_t instructions_since(std::uint32_t from) {
  const std::uint32_t passed = (from - ticks()) & 0xffffffU;
  return passed / kTicksIn1000 * 1000U + passed % kTicksIn1000 * 1000U / kTicksIn1000;
}

}  // namespace board
