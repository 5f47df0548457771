// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Reads stream.bin, runs the chain over it and prints its digest, what a sample costs, and how deep the stack went.
// FIRMWARE_INTEGER takes the front end alone. For what the chain weighs: FIRMWARE_WEIGH leaves its digest out, and
// FIRMWARE_EMPTY the chain itself.

#include "board/semihosting.hpp"
#include "golden.hpp"
#include "systick.hpp"

namespace {

constexpr int kBlock = 32;
firmware::Sample block[kBlock];
#if defined(FIRMWARE_EMPTY)
constexpr const char* kName = "empty";
#elif defined(FIRMWARE_INTEGER)
constexpr const char* kName = "front end";
firmware::FrontEnd front(golden::kCounts, firmware::kStartAngle);
firmware::Corrected corrected;
bool turned;
#else
constexpr const char* kName = "chain";
firmware::GoldenChain chain = firmware::golden_chain();
#endif

}  // namespace

int board::run() {
  const std::intptr_t file = board::open("stream.bin", 10);
  if (file < 0) {
    board::print("stream.bin: not there\n");
    return 3;
  }
  firmware::Digest digest;
  board::start_systick();
  std::uint32_t samples = 0;
  std::uint32_t instructions = 0;
  std::uint32_t refused = 0;
  for (;;) {
    const std::size_t bytes = board::read(file, block, sizeof(block));
    const int count = static_cast<int>(bytes / sizeof(firmware::Sample));
    if (count == 0) break;
    const std::uint32_t from = board::ticks();
    for (int i = 0; i < count; ++i) {
#if defined(FIRMWARE_EMPTY)
      digest.add(block[i].counts[0]);
#elif defined(FIRMWARE_INTEGER)
      refused += front.add(block[i], corrected) != trunnion::Status::kOk ? 1U : 0U;
      turned = turned || corrected.turn;
#else
      refused += chain.add(block[i]) != trunnion::Status::kOk ? 1U : 0U;
#endif
    }
    instructions += board::instructions_since(from);
    samples += static_cast<std::uint32_t>(count);
#if defined(FIRMWARE_WEIGH)
#elif defined(FIRMWARE_INTEGER)
    firmware::add(digest, front.modulation().record());
    if (turned) firmware::add(digest, front.modulation().split());
    turned = false;
#elif !defined(FIRMWARE_EMPTY)
    firmware::add(digest, chain.front().modulation().record());
    firmware::add(digest, chain.front().modulation().split_as<float>());
    firmware::add(digest, chain.navigator());
#endif
  }
  board::print(kName);
  board::print(" digest ");
  board::print_hex(digest.value());
  board::print(" samples ");
  board::print(samples);
  board::print(" refused ");
  board::print(refused);
  board::print(" instructions ");
  board::print(samples > 0 ? instructions / samples : 0U);
  board::print(" stack ");
  board::print(board::stack_used());
  board::print("\n");
  return samples > 0 ? 0 : 3;
}
