// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a stamp of a channel is the next one.

#pragma once

#include <cstdint>

namespace trunnion {

/// Judges the stamps of one channel.
///
/// A stamp that does not increase, or that leaps by more than a second, is a stray until the next stamp continues from
/// it: one damaged stamp costs one message. Stamps that stay behind, or more than ten minutes ahead, are another clock.
class ChannelClock {
 public:
  enum class Verdict {
    kNext,
    kNextAndFirstWasStray,  ///< use it, and forget the only one that was accepted before
    kDuplicate,
    kStray,
    kReset
  };

  static constexpr int kResetAfter = 20;                      ///< messages that stay away
  static constexpr std::int64_t kLeap = 1000000;              ///< us
  static constexpr std::int64_t kLongestSilence = 600000000;  ///< us; also bounds what a hostile stamp can ask for

  /// a - b [us]; unsigned inside, so that hostile stamps wrap and do not overflow.
  static std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }

  Verdict judge(std::int64_t utime) {
    if (accepted_ == 0) return accept(utime);
    const std::int64_t step = difference(utime, last_);
    if (step > 0 && step <= kLeap) return accept(utime);
    if (step == 0) return Verdict::kDuplicate;
    const std::int64_t from_candidate = difference(utime, candidate_);
    const bool continues = astray_ > 0 && from_candidate > 0 && from_candidate <= kLeap;
    if (continues && accepted_ == 1) {
      accept(utime);
      return Verdict::kNextAndFirstWasStray;
    }
    if (continues && step > 0 && step <= kLongestSilence) return accept(utime);
    candidate_ = utime;
    return ++astray_ >= kResetAfter ? Verdict::kReset : Verdict::kStray;
  }

 private:
  Verdict accept(std::int64_t utime) {
    last_ = utime;
    astray_ = 0;
    ++accepted_;
    return Verdict::kNext;
  }

  std::int64_t last_ = 0;
  std::int64_t candidate_ = 0;
  long long accepted_ = 0;
  int astray_ = 0;
};

}  // namespace trunnion
