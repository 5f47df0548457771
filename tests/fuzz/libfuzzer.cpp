// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One target for libFuzzer: TRUNNION_FUZZ_TARGET names it.

#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trunnion::fuzz::TRUNNION_FUZZ_TARGET(data, size);
  return 0;
}
