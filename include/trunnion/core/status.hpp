// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What happened, as a value: no exceptions on rungs 0 and 1.

#pragma once

#include <cstdint>

namespace trunnion {

enum class Status : std::uint8_t {
  kOk,
  kNotObservable,   ///< the data or the geometry cannot decide the answer
  kOutOfRange,      ///< an argument outside its stated range
  kMovingBase,      ///< what should stand still, or swing about a point, goes somewhere
  kSaturated,       ///< a reading at the end of its range
  kStuck,           ///< a channel that has not moved for as long as none can
  kTimeOut,         ///< what comes once a turn has not come
  kDamaged,         ///< a block whose check does not fit
  kOtherVersion,    ///< a block of another version of its format
  kOtherByteOrder,  ///< a block written for a machine of the other byte order
  kInconsistent,    ///< data that contradict each other, or what is known
  kAmbiguous,       ///< several answers that the data cannot tell apart
};

/// A value, or the reason why there is none. @code if (auto r = f(); r.ok()) use(r.value()); @endcode
template <class V>
class [[nodiscard]] Result {
 public:
  constexpr Result(const V& value) : value_(value) {}             // NOLINT(google-explicit-constructor)
  constexpr Result(Status status) : value_(), status_(status) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] constexpr bool ok() const { return status_ == Status::kOk; }
  [[nodiscard]] constexpr Status status() const { return status_; }
  /// The value; a default value when not ok().
  [[nodiscard]] constexpr const V& value() const { return value_; }

 private:
  V value_;
  Status status_ = Status::kOk;
};

}  // namespace trunnion
