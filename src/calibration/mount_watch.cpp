// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/mount_watch.hpp"

#include <algorithm>
#include <cmath>

namespace trunnion::calibration {
namespace {

constexpr double kStill = 0.02;    // rad/s
constexpr double kTurning = 0.15;  // rad/s: the unit's bias and a clock offset are small against it

}  // namespace

MountWatch::MountWatch(const Rig& rig, const Site& site, int mount)
    : rig_(rig), table_(rig.geometry, TwoAxisErrors<double>(), site.latitude, site.gravity), mount_(mount) {}

void MountWatch::see(const ObservationWindow& window, const std::array<CourseValue, 2>& reading) {
  const double rate = std::abs(reading[0].rate) + std::abs(reading[1].rate);
  if (rate > kStill && rate < kTurning) return;
  const auto motion = [](const CourseValue& v) { return AxisMotion<double>{v.angle, v.rate, v.acceleration}; };
  const InertialSample<double> input =
      table_.input(motion(reading[0]), motion(reading[1]), Vec3<double>(Vec3<double>::Zero()));
  ++windows_;
  for (int m = 0; m < rig_.mounts; ++m) {
    const Mat3<double> C_bp = rig_.mount[static_cast<std::size_t>(m)].C_pb.transpose();
    const Vec3<double> w = C_bp * input.w;
    const Vec3<double> f = C_bp * input.f;
    const double force = std::acos(std::clamp(f.normalized().dot(window.mean.f.stableNormalized()), -1.0, 1.0));
    const double turn = rate < kStill ? 0.0 : std::min(2.0, (window.mean.w - w).norm() / w.norm());
    sum_[static_cast<std::size_t>(m)] += std::max(force, turn);
  }
}

double MountWatch::error(int mount) const { return sum_[static_cast<std::size_t>(mount)] / std::max(1, windows_); }

int MountWatch::best() const {
  int best = 0;
  for (int m = 1; m < rig_.mounts; ++m) best = error(m) < error(best) ? m : best;
  return best;
}

MountWatch::Verdict MountWatch::verdict() const {
  if (windows_ < kEnough) return Verdict::kUnknown;
  if (error(mount_) < kRight) return Verdict::kRight;
  return error(best()) < kRight ? Verdict::kOther : Verdict::kNone;
}

}  // namespace trunnion::calibration
