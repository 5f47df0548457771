// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether the unit sits in the mount that the run says, told from what it feels in each.
///
///   e_m = angle(f, C_bp(m) f_p) at rest, |w - C_bp(m) w_p| / |w_p| in a turn, mean over the windows seen      ... (1)
///
/// with the nominal rig: a mount is right to some degrees or not at all.

#pragma once

#include <array>

#include "trunnion/calibration/encoder_course.hpp"
#include "trunnion/positions/observation.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

class MountWatch {
 public:
  enum class Verdict {
    kUnknown,  ///< too few windows
    kRight,
    kOther,  ///< another mount of the rig fits
    kNone,   ///< none does: an axis, a sign or a unit is wrong, or the fixture is not the drawn one
  };

  /// @param mount where the unit should be, index into Rig::mount
  MountWatch(const Rig& rig, const Site& site, int mount);

  /// Takes a window, and what the encoders read in its middle.
  void see(const ObservationWindow& window, const std::array<CourseValue, 2>& reading);

  [[nodiscard]] Verdict verdict() const;
  /// The mount that fits best.
  [[nodiscard]] int best() const;

 private:
  static constexpr int kEnough = 30;      // windows
  static constexpr double kRight = 0.25;  // eq. (1)

  [[nodiscard]] double error(int mount) const;

  const Rig& rig_;
  TwoAxisTable<double> table_;
  int mount_;
  std::array<double, kMaxMounts> sum_{};
  int windows_ = 0;
};

}  // namespace trunnion::calibration
