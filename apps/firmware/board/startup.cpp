// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// From reset to board::run() on a Cortex-M: vectors, floating-point unit, data, a painted stack, constructors. A fault
// says so and ends the machine with 70.

#include <cstdint>
#include <cstring>

#include "semihosting.hpp"

extern "C" {
extern std::uint32_t stack_begin[], stack_end[], data_begin[], data_end[], data_load[], bss_begin[], bss_end[];
using Function = void (*)();
extern const Function init_begin[], init_end[];
void reset();
}

namespace board {

std::intptr_t semihosting(std::intptr_t operation, const void* arguments) {
  register std::intptr_t r0 __asm__("r0") = operation;
  register const void* r1 __asm__("r1") = arguments;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

namespace {
constexpr std::uint32_t kPaint = 0xdeadbeefU;

}  // namespace

std::uint32_t stack_used() {
  const std::uint32_t* at = stack_begin;
  while (at != stack_end && *at == kPaint) ++at;
  return static_cast<std::uint32_t>(stack_end - at) * 4U;
}

}  // namespace board

extern "C" {
void fault() {
  board::print("fault\n");
  board::exit(70);
}
// by their names in CMSIS; what an image does not define is a fault
__attribute__((weak, alias("fault"))) void SVC_Handler();
__attribute__((weak, alias("fault"))) void PendSV_Handler();
__attribute__((weak, alias("fault"))) void SysTick_Handler();
}

struct Vectors {
  std::uint32_t* stack;
  Function reset;
  Function faults[14];
};
__attribute__((section(".vectors"), used))
const Vectors vectors = {stack_end,
                         reset,
                         {fault, fault, fault, fault, fault, fault, fault, fault, fault, SVC_Handler, fault, fault,
                          PendSV_Handler, SysTick_Handler}};

// Paints below where it stands itself, so it must not be inlined into something deep.
__attribute__((noreturn, used)) void reset() {
#if defined(__ARM_FP)
  // CPACR: full access to CP10 and CP11, before the first floating-point instruction
  *reinterpret_cast<volatile std::uint32_t*>(0xe000ed88U) |= 0xfU << 20U;
  __asm__ volatile("dsb\n isb" ::: "memory");
#endif
  std::uint32_t* here;
  __asm__ volatile("mov %0, sp" : "=r"(here));
  for (std::uint32_t* at = stack_begin; at < here - 8; ++at) *at = board::kPaint;
  std::memcpy(data_begin, data_load, static_cast<std::size_t>(data_end - data_begin) * 4U);
  std::memset(bss_begin, 0, static_cast<std::size_t>(bss_end - bss_begin) * 4U);
  for (const Function* f = init_begin; f != init_end; ++f) (*f)();
  board::exit(board::run());
}
