// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the sequence numbers of a channel say of the way: losses, repeats, a publisher that began again, two at once.

#pragma once

#include <cstdint>

namespace trunnion {

/// Counts over one channel. A number behind the expected one, or far ahead of it, is late until the next one follows
/// it: then the publisher has begun again, or, when the old numbers go on between them, there are two.
class SequenceWatch {
 public:
  static constexpr std::int64_t kLongestGap = 10000000;  ///< samples; beyond it is another count
  static constexpr std::int64_t kRepeats = 256;          ///< samples behind: batches may overlap

  /// Takes a message of @p count samples whose first has number @p sequence.
  /// @return whether it is new; a repeat or a late one is not
  bool add(std::int64_t sequence, std::int64_t count = 1) {
    const auto after = [&](std::int64_t n) {
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(n) + static_cast<std::uint64_t>(count));
    };
    if (received_ == 0) {
      next_ = after(sequence);
      received_ += count;
      return true;
    }
    const std::int64_t ahead = difference(sequence, next_);
    if (ahead >= 0 && ahead <= kLongestGap) {
      lost_ += ahead;
      next_ = after(sequence);
      received_ += count;
      astray_ = false;
      return true;
    }
    if (ahead < 0 && ahead >= -kRepeats) {
      late_ += count;
      return false;
    }
    const bool follows = has_candidate_ && sequence == candidate_;
    const bool goes_on_between = follows && !astray_;
    candidate_ = after(sequence);
    has_candidate_ = true;
    if (goes_on_between) {
      ++interleaved_;
    } else if (follows) {
      ++restarts_;
      next_ = candidate_;
      received_ += count;
      has_candidate_ = false;
      astray_ = false;
      return true;
    } else {
      late_ += count;
    }
    astray_ = true;
    return false;
  }

  [[nodiscard]] long long received() const { return received_; }
  [[nodiscard]] long long lost() const { return lost_; }
  [[nodiscard]] long long late() const { return late_; }          ///< repeats and latecomers
  [[nodiscard]] long long restarts() const { return restarts_; }  ///< counts that began again
  /// Whether the publisher numbers its samples at all.
  [[nodiscard]] bool numbered() const { return received_ > late_; }
  [[nodiscard]] bool two_publishers() const { return interleaved_ > kTwo; }

 private:
  static constexpr long long kTwo = 3;  // chance repeats are not that many

  static std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }

  std::int64_t next_ = 0;
  std::int64_t candidate_ = 0;
  bool has_candidate_ = false;
  bool astray_ = false;  // the last message did not follow
  long long received_ = 0;
  long long lost_ = 0;
  long long late_ = 0;
  long long restarts_ = 0;
  long long interleaved_ = 0;
};

}  // namespace trunnion
