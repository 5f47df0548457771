// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// VectorNav's registers 25 and 84: corrected = C (measured - B), twelve numbers of single precision each, applied after
// the factory's own calibration.

#include <Eigen/LU>
#include <array>
#include <cstdio>

#include "export_formats.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::io {
namespace {

struct Register {
  Mat3<double> C;
  Vec3<double> B;
};

constexpr std::size_t kLongestCommand = 249;  // of 255 bytes with $, checksum and line end

/// "$" and the command, its checksum behind "*".
std::string command(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), "*%02X\r\n", sum);
  return "$" + text + end.data();
}

std::string nine_decimals(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.9f", value);
  return text.data();
}

std::string write_register(int number, const Register& r) {
  std::string text = "VNWRG," + std::to_string(number);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) text += "," + nine_decimals(r.C(i, k));
  }
  for (int i = 0; i < 3; ++i) text += "," + nine_decimals(r.B(i));
  if (text.size() > kLongestCommand || !r.C.allFinite() || !r.B.allFinite())
    throw Error(ExitCode::kInput, "register " + std::to_string(number) + " does not hold its numbers: " + text);
  return command(text);
}

Register register_of(const Triad<double>& triad) {
  return {triad.matrix().inverse().unaryExpr(&to_single), triad.bias.unaryExpr(&to_single)};
}

Exported vectornav(const ExportRequest& request) {
  const Register accel = register_of(request.unit.accel);
  const Register gyro = register_of(request.unit.gyro);
  Exported out;
  out.text = write_register(25, accel) + write_register(84, gyro) + command("VNWNV") + command("VNRST");
  out.correct = [accel, gyro](const InertialSample<double>& y) {
    return InertialSample<double>{gyro.C * (y.w - gyro.B), accel.C * (y.f - accel.B)};
  };
  out.advice.emplace_back(
      "send the lines to a unit at rest whose registers 25 and 84 were as delivered when it was calibrated; the last "
      "two write to its flash and restart it");
  return out;
}

}  // namespace

const ExportFormat kVectorNavExport = {"vectornav", "VectorNav registers 25 and 84", ".txt", 6e-8, false, false, true,
                                       vectornav};

}  // namespace trunnion::io
