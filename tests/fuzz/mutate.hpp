// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bytes as damage and malice leave them.

#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace trunnion {

/// Flips bits, overwrites, deletes, repeats and inserts: one to eight strokes.
inline std::string mutate(std::string bytes, std::mt19937_64& rng) {
  const auto below = [&](std::size_t n) { return n == 0 ? std::size_t{0} : static_cast<std::size_t>(rng() % n); };
  static const std::vector<std::string> kWords = {"-1",
                                                  "1e999",
                                                  "nan",
                                                  "inf",
                                                  "0",
                                                  "null",
                                                  "[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  ":",
                                                  "\"",
                                                  "<",
                                                  ">",
                                                  "/>",
                                                  "\n",
                                                  "\t",
                                                  ",",
                                                  "99999999999999999999",
                                                  "- ",
                                                  "&a",
                                                  "*a",
                                                  "!!",
                                                  "<robot>",
                                                  std::string("\0", 1),
                                                  "\xff\xff\xff\xff",
                                                  "\x7f\xff\xff\xff",
                                                  "\xed\xa1\xda\x01"};
  const std::size_t strokes = 1 + below(8);
  for (std::size_t s = 0; s < strokes && !bytes.empty(); ++s) {
    const std::size_t at = below(bytes.size());
    const std::size_t length = std::min(bytes.size() - at, below(32) + 1);
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(rng());
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 4:
        bytes.insert(at, kWords[below(kWords.size())]);
        break;
      default: {
        const std::string& word = kWords[below(kWords.size())];
        bytes.replace(at, std::min(word.size(), bytes.size() - at), word);
        break;
      }
    }
  }
  return bytes;
}

}  // namespace trunnion
