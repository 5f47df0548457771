// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/calibration/mount_watch.hpp"

#include <gtest/gtest.h>

#include "calibration/experiment.hpp"

namespace trunnion::calibration {
namespace {

/// Verdict of a watch for @p said on a simulated recording in @p mount, of its first @p windows; the case may be turned
/// in it.
MountWatch watch_of(const Rig& rig, int mount, int said, int windows,
                    const Mat3<double>& C_turned = Mat3<double>::Identity()) {
  simulation::TableRunSettings settings;
  const CalibrationValues truth = simulation::draw_truth(settings, rig, bench(), 3);
  Compressor compressor({});
  simulation::run_table(settings, truth, rig, bench(),
                        simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, 0)), mount,
                        mount,
                        {[&](std::int64_t t, std::int64_t, const InertialSample<double>& s) {
                           compressor.imu(t, {C_turned * s.w, C_turned * s.f});
                         },
                         [&](std::int64_t t, std::int64_t, double a, double p) { compressor.encoder(t, a, p); }});
  const CompressedRecording data = compressor.finish();
  MountWatch watch(rig, bench(), said);
  for (int k = 0; k < windows; ++k) {
    const ObservationWindow& window = data.windows[static_cast<std::size_t>(k)];
    if (data.course.covers(window.t - window.half_width, window.t + window.half_width))
      watch.see(window, data.course.at(window.t));
  }
  return watch;
}

TEST(MountWatch, TellsEveryMountFromEveryOtherInItsFirstRest) {
  const Rig rig = cyclic_rig();
  for (int mount = 0; mount < 3; ++mount) {
    for (int said = 0; said < 3; ++said) {
      const MountWatch watch = watch_of(rig, mount, said, 140);
      EXPECT_EQ(watch.verdict(), mount == said ? MountWatch::Verdict::kRight : MountWatch::Verdict::kOther);
      EXPECT_EQ(watch.best(), mount);
    }
  }
}

TEST(MountWatch, OfTheWholeExperimentTheVerdictIsTheSame) {
  const Rig rig = cyclic_rig();
  EXPECT_EQ(watch_of(rig, 1, 1, 7000).verdict(), MountWatch::Verdict::kRight);
  EXPECT_EQ(watch_of(rig, 1, 2, 7000).verdict(), MountWatch::Verdict::kOther);
}

TEST(MountWatch, ACaseUpsideDownIsInNoMount) {
  const Mat3<double> turned = Eigen::AngleAxisd(kPi, Vec3<double>::UnitX()).toRotationMatrix();
  EXPECT_EQ(watch_of(cyclic_rig(), 0, 0, 140, turned).verdict(), MountWatch::Verdict::kNone);
}

TEST(MountWatch, SaysNothingOfTooFewWindows) {
  EXPECT_EQ(watch_of(cyclic_rig(), 0, 1, 20).verdict(), MountWatch::Verdict::kUnknown);
}

}  // namespace
}  // namespace trunnion::calibration
