// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Prints the digests of apps/firmware/exact.hpp. Build it with contraction off: a fused product has other bits.

#include "board/semihosting.hpp"
#include "exact.hpp"

namespace {

template <class Source>
void show(const char* name, std::uint32_t samples) {
  const firmware::Exact exact = firmware::exact<Source>(samples);
  board::print(name);
  board::print(" integers ");
  board::print_hex(exact.integers);
  board::print(" floats ");
  board::print_hex(exact.floats);
  board::print(" refused ");
  board::print(exact.refused);
  board::print("\n");
}

}  // namespace

int board::run() {
  show<firmware::Turning>("stream 100000", 100000);
  show<firmware::Extremes>("extremes 1000000", 1000000);
  return 0;
}
