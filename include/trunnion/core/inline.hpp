// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Inlining that does not depend on the user's level of optimisation.

#pragma once

/// For the arithmetic of the kernels that run once a sample: GCC leaves them as calls at -Os.
#if defined(__GNUC__)
#define TRUNNION_INLINE __attribute__((always_inline)) inline
#define TRUNNION_INLINE_LAMBDA __attribute__((always_inline))
#else
#define TRUNNION_INLINE inline
#define TRUNNION_INLINE_LAMBDA
#endif

/// For what is rarely taken: inlined, it would cost the frequent path registers.
#if defined(__GNUC__)
#define TRUNNION_COLD __attribute__((noinline, cold))
#else
#define TRUNNION_COLD
#endif

/// Keeps what stands before it before what stands after it, for the compiler alone, at no instruction: GCC at -O2 would
/// run independent 64-bit sums into one another until it is out of registers.
#if defined(__GNUC__)
#define TRUNNION_IN_ORDER __asm__ volatile("" ::: "memory")
#else
#define TRUNNION_IN_ORDER
#endif

/// Makes the pointer one value, which the compiler does not take apart into a base and an index again.
#if defined(__GNUC__)
#define TRUNNION_ONE_ADDRESS(pointer) __asm__("" : "+r"(pointer))
#else
#define TRUNNION_ONE_ADDRESS(pointer)
#endif
