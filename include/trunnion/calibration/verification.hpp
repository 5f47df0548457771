// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A recording that was not used, held against a calibration: corrected output minus what the table does.
///
///   d = mean of the window's samples - C_bp input(rig, encoders),   sd^2 = mean d^2 - (mean d)^2           ... (1)
///   floor^2 = N^2 / T + wander^2 (1 - 2 tau / D (1 - tau / D (1 - exp(-D / tau))))                          ... (2)
///
///   d = c + dM u + noise,   sigma(dM_ij) = sqrt((N^2 + 2 wander^2 tau) / T) sqrt((X^T X)^-1_jj)                ... (3)
///
/// (2): what white noise in windows of T and the wander about its own mean over a recording of D leave; no calibration
/// goes below. (3): what of the matrix is left, by least squares on the true input u, the wander taken for white of its
/// density at zero frequency: a deviation that noise hides in a window shows there. The table is the calibrated one
/// before and after. docs/theory/comparison.md, eq. 7-9.

#pragma once

#include <array>
#include <vector>

#include "trunnion/calibration/compress.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/turntable/rig.hpp"

namespace trunnion::calibration {

/// Of one sensor: x y z of the gyros [rad/s], then of the accelerometers [m/s^2].
struct AxisVerification {
  double mean_before = 0.0;
  double before = 0.0;  ///< standard deviation, eq. (1)
  double mean_after = 0.0;
  double after = 0.0;
  double floor = 0.0;  ///< eq. (2)
};

struct Verification {
  std::array<AxisVerification, 6> axis;
  std::array<Mat3<double>, 2> left;        ///< dM of eq. (3), of gyros and accelerometers
  std::array<Mat3<double>, 2> left_sigma;  ///< far beyond any use where these data do not tell
  long long windows = 0;
  double window = 0.0;                         ///< s
  std::vector<std::array<double, 13>> course;  ///< t, six differences before, six after: for a picture
};

/// @param before, after the same recording as it is and corrected sample by sample; @param mount index into Rig::mount
/// @throws Error (input) where the two do not have the same windows
Verification verify(const CompressedRecording& before, const CompressedRecording& after, int mount,
                    const CalibrationValues& values, const Rig& rig, const Site& site, const UnitNoise& noise);

}  // namespace trunnion::calibration
