// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// PX4 and ArduPilot: corrected f = (measured f - offset) scale, axis by axis, corrected w = measured w - offset; single
// precision, in the axes of the board that the sensor is on: after the driver has turned the chip's, before what turns
// the board's into those of the vehicle (PX4: CAL_*_ROT and SENS_BOARD_ROT; ArduPilot: AHRS_ORIENTATION).

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "export_formats.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::io {
namespace {

constexpr double kSingle = 6e-8;

struct Parameters {
  Vec3<double> accel_offset;
  Vec3<double> accel_scale;
  Vec3<double> gyro_offset;
};

Vec3<double> single(const Vec3<double>& v) { return v.unaryExpr(&to_single); }

/// A diagonal in place of the inverse matrix: its own.
/// @throws Error (input) for what no vehicle takes: scales that are not near one, offsets that are not finite
Parameters parameters_of(const InertialUnit<double>& unit) {
  constexpr double kLeast = 0.5;  // of a scale that corrects
  constexpr double kMost = 2.0;
  Parameters p{single(unit.accel.bias), single(unit.accel.matrix().inverse().diagonal()), single(unit.gyro.bias)};
  if (!(p.accel_scale.array() > kLeast && p.accel_scale.array() < kMost).all())
    throw Error(ExitCode::kInput,
                "a vehicle corrects each axis for itself, and the scales would be " + listed(p.accel_scale, ", ") +
                    ": for a unit that is mounted turned, calibrate in the axes of its board, and set "
                    "the board's rotation in the vehicle");
  if (!p.accel_offset.allFinite() || !p.gyro_offset.allFinite())
    throw Error(ExitCode::kInput, "the biases are too large for single precision");
  return p;
}

std::string nine_digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

Exported exported(const ExportRequest& request, const Parameters& p) {
  Exported out;
  out.text = commented(request, "#");
  out.correct = [p](const InertialSample<double>& y) {
    return InertialSample<double>{y.w - p.gyro_offset, (y.f - p.accel_offset).cwiseProduct(p.accel_scale)};
  };
  out.advice.emplace_back(
      "it holds for readings as the vehicle corrects them, after the driver's turn of the chip's axes and before the "
      "board's: those of a log have its offsets, scales and rotations in them, unless they were 0, 1 and none");
  return out;
}

Exported px4(const ExportRequest& request) {
  const Parameters p = parameters_of(request.unit);
  Exported out = exported(request, p);
  const auto line = [&](const std::string& name, const std::string& value, const char* type) {
    out.text += "1\t1\t" + name + "\t" + value + "\t" + type + "\n";
  };
  const std::string accel = "CAL_ACC" + std::to_string(request.instance);
  const std::string gyro = "CAL_GYRO" + std::to_string(request.instance);
  out.text += "#\n# Vehicle-Id Component-Id Name Value Type\n";
  if (request.accel_id != 0) line(accel + "_ID", std::to_string(request.accel_id), "6");
  if (request.gyro_id != 0) line(gyro + "_ID", std::to_string(request.gyro_id), "6");
  if (request.accel_id == 0 || request.gyro_id == 0)
    out.advice.emplace_back("PX4 takes the numbers for the device whose id " + accel + "_ID and " + gyro +
                            "_ID hold: state --accel-id and --gyro-id, or see that they are there");
  constexpr const char* kAxes = "XYZ";
  for (int i = 0; i < 3; ++i) line(accel + "_" + kAxes[i] + "OFF", nine_digits(p.accel_offset(i)), "9");
  for (int i = 0; i < 3; ++i) line(accel + "_" + kAxes[i] + "SCALE", nine_digits(p.accel_scale(i)), "9");
  for (int i = 0; i < 3; ++i) line(gyro + "_" + kAxes[i] + "OFF", nine_digits(p.gyro_offset(i)), "9");
  out.text += "# what is calibrated is not estimated or measured anew by the vehicle\n";
  line("SENS_IMU_AUTOCAL", "0", "6");
  line("IMU_GYRO_CAL_EN", "0", "6");
  out.advice.emplace_back(
      "SENS_IMU_AUTOCAL and IMU_GYRO_CAL_EN are 0 in the file: the vehicle would put its own estimates over these "
      "offsets");
  out.advice.emplace_back("restart the vehicle after loading: several versions pass over a change below 0.01");
  return out;
}

Exported ardupilot(const ExportRequest& request) {
  const Parameters p = parameters_of(request.unit);
  Exported out = exported(request, p);
  const auto line = [&](const std::string& name, double value) { out.text += name + "," + nine_digits(value) + "\n"; };
  const std::string which = request.instance == 0 ? "" : std::to_string(request.instance + 1);
  const std::string accel = "INS_ACC" + which;
  const std::string gyro = "INS_GYR" + which;
  if (request.accel_id != 0) out.text += accel + "_ID," + std::to_string(request.accel_id) + "\n";
  if (request.gyro_id != 0) out.text += gyro + "_ID," + std::to_string(request.gyro_id) + "\n";
  if (request.accel_id == 0 || request.gyro_id == 0)
    out.advice.emplace_back("ArduPilot takes offsets for the device whose id " + accel + "_ID and " + gyro +
                            "_ID hold: state --accel-id and --gyro-id, or calibrate the vehicle once before");
  constexpr const char* kAxes = "XYZ";
  for (int i = 0; i < 3; ++i) line(accel + "OFFS_" + kAxes[i], p.accel_offset(i));
  for (int i = 0; i < 3; ++i) line(accel + "SCAL_" + kAxes[i], p.accel_scale(i));
  for (int i = 0; i < 3; ++i) line(gyro + "OFFS_" + kAxes[i], p.gyro_offset(i));
  out.text += "# the offsets of the gyros are not measured anew at every start\n";
  line("INS_GYR_CAL", 0.0);
  out.advice.emplace_back(
      "INS_GYR_CAL is 0 in the file: the vehicle no longer measures its gyros' offsets at every start");
  if (p.accel_offset.cwiseAbs().maxCoeff() > 3.5 || p.accel_scale.minCoeff() < 0.8 || p.accel_scale.maxCoeff() > 1.2)
    out.advice.emplace_back(
        "ArduPilot documents offsets to 3.5 m/s^2 and scales from 0.8 to 1.2, and these are beyond");
  return out;
}

}  // namespace

const ExportFormat kPx4Export = {"px4", "PX4 parameters", ".params", kSingle, false, false, true, px4};
const ExportFormat kArduPilotExport = {"ardupilot", "ArduPilot parameters", ".param", kSingle, false, false, true,
                                       ardupilot};

}  // namespace trunnion::io
