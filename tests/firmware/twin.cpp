// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The host's twin of the firmware images: what they print, it prints. "firmware_twin stream FILE" writes the samples
// that they read; "firmware_twin exact" and "firmware_twin chain" print digests as exact_image.cpp and chain_image.cpp
// do.

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "exact.hpp"

namespace {

constexpr int kSamples = 20000;
constexpr int kBlock = 32;

template <class Source>
void show(const char* name, std::uint32_t samples) {
  const firmware::Exact exact = firmware::exact<Source>(samples);
  std::printf("%s integers %016llx floats %016llx refused %u\n", name, static_cast<unsigned long long>(exact.integers),
              static_cast<unsigned long long>(exact.floats), exact.refused);
}

int write_stream(const char* path) {
  std::ofstream file(path, std::ios::binary);
  firmware::Turning turning;
  for (int i = 0; i < kSamples; ++i) {
    const firmware::Sample s = turning.next();
    file.write(reinterpret_cast<const char*>(&s), sizeof(s));
  }
  return file.good() ? 0 : 3;
}

void show_chain() {
  firmware::Digest chain_digest;
  firmware::Digest front_digest;
  firmware::GoldenChain chain = firmware::golden_chain();
  firmware::FrontEnd front(golden::kCounts, firmware::kStartAngle);
  firmware::Corrected corrected;
  bool turned = false;
  unsigned refused_by_chain = 0;
  unsigned refused_by_front = 0;
  firmware::Turning turning;
  for (int i = 0; i < kSamples; ++i) {
    const firmware::Sample s = turning.next();
    refused_by_chain += chain.add(s) != trunnion::Status::kOk ? 1U : 0U;
    refused_by_front += front.add(s, corrected) != trunnion::Status::kOk ? 1U : 0U;
    turned = turned || corrected.turn;
    if ((i + 1) % kBlock != 0 && i + 1 != kSamples) continue;
    firmware::add(chain_digest, chain.front().modulation().record());
    firmware::add(chain_digest, chain.front().modulation().split_as<float>());
    firmware::add(chain_digest, chain.navigator());
    firmware::add(front_digest, front.modulation().record());
    if (turned) firmware::add(front_digest, front.modulation().split());
    turned = false;
  }
  std::printf("chain digest %016llx samples %d refused %u\n", static_cast<unsigned long long>(chain_digest.value()),
              kSamples, refused_by_chain);
  std::printf("front end digest %016llx samples %d refused %u\n", static_cast<unsigned long long>(front_digest.value()),
              kSamples, refused_by_front);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "stream" && argc == 3) return write_stream(argv[2]);
  if (what == "exact") {
    show<firmware::Turning>("stream 100000", 100000);
    show<firmware::Extremes>("extremes 1000000", 1000000);
  } else if (what == "chain") {
    show_chain();
  } else {
    std::fprintf(stderr, "usage: firmware_twin stream FILE | exact | chain\nExample: firmware_twin exact\n");
    return 2;
  }
  return 0;
}
