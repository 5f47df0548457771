// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The entries of the list of exports, and how they print.

#pragma once

#include <string>

#include "trunnion/io/export_format.hpp"

namespace trunnion::io {

extern const ExportFormat kKalibrExport;
extern const ExportFormat kOpenVinsExport;
extern const ExportFormat kRosExport;
extern const ExportFormat kPx4Export;
extern const ExportFormat kArduPilotExport;
extern const ExportFormat kVectorNavExport;
extern const ExportFormat kMatlabExport;
extern const ExportFormat kJsonExport;

/// Steps of the fixed-point iteration in files that hold nonlinearity: to the last digit where it is a hundredth of
/// full scale.
inline constexpr int kExportedSteps = 8;

/// Eq. (5) by so many steps u <- A^-1 (y - b - n(u)), at the reference temperature.
InertialSample<double> corrected_in_steps(const InertialUnit<double>& unit, const InertialSample<double>& reading,
                                          int steps);

/// Rounded to single precision, as targets hold it. One number at a time, in a file of its own: of two conversions in a
/// row GCC 12 with -O3 leaves none where it vectorises them.
double to_single(double value);

/// The shortest text that reads back to the same double, with a point: YAML 1.1 takes 3e-06 for a word.
std::string exactly(double value);
/// "a, b, c", by rows.
std::string listed(const Vec3<double>& v, const char* between = ", ");
std::string listed(const Mat3<double>& M, const char* between = ", ");

/// The notes as lines of comment.
std::string commented(const ExportRequest& request, const char* mark);

/// A = L Q: L lower triangular, Q a rotation; eq. (3).
struct LowerAndRotation {
  Mat3<double> L;
  Mat3<double> Q;
};
LowerAndRotation lower_and_rotation(const Triad<double>& triad);

}  // namespace trunnion::io
