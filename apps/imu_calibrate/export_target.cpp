// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "export_target.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "../terminal.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/export_format.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

constexpr std::array<std::string_view, 23> kMatlabWords = {
    "break",    "case",           "catch", "classdef",  "continue", "do",         "else",   "elseif", "end",    "for",
    "function", "global",         "if",    "otherwise", "parfor",   "persistent", "return", "spmd",   "switch", "try",
    "until",    "unwind_protect", "while"};

/// MATLAB calls a function by the name of its file.
std::string function_of(const std::string& output) {
  std::string stem = std::filesystem::path(output).stem().string();
  bool is_name = !stem.empty() && std::isalpha(static_cast<unsigned char>(stem[0])) != 0 && stem.size() < 64;
  for (const char c : stem) is_name = is_name && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
  is_name = is_name && std::find(kMatlabWords.begin(), kMatlabWords.end(), stem) == kMatlabWords.end();
  if (!is_name || std::filesystem::path(output).extension() != ".m")
    throw Error(ExitCode::kUsage, output +
                                      ": MATLAB calls a function by its file: a .m of letters, digits and _, a letter "
                                      "first, no word of the language");
  return stem;
}

std::string sizes(const InertialSample<double>& size) {
  std::string text;
  if (size.w.maxCoeff() > 1e-9) text += figure(size.w.maxCoeff() / kRadPerDeg, 3) + " deg/s";
  if (size.f.maxCoeff() > 1e-9) text += (text.empty() ? "" : " and ") + figure(size.f.maxCoeff(), 3) + " m/s^2";
  return text;
}

}  // namespace

std::vector<std::string> target_names() {
  std::vector<std::string> names;
  for (const io::ExportFormat& format : io::export_formats()) names.emplace_back(format.name);
  return names;
}

std::string target_titles() {
  std::string titles;
  for (const io::ExportFormat& format : io::export_formats())
    titles += std::string("; ") + format.name + ": " + format.title;
  return titles;
}

void export_to_target(const TargetOptions& o) {
  const io::ExportFormat& format = io::export_format(o.format);
  if (o.output.empty()) throw Error(ExitCode::kUsage, "export: name an --output");
  const io::CalibrationFile file = io::read_calibration_file(o.calibration);
  io::ExportRequest request;
  request.unit = io::unit_of(file, o.calibration, o.recording);
  request.name = file.model + (file.serial.empty() ? "" : " " + file.serial);
  request.gyro_id = o.gyro_id;
  request.accel_id = o.accel_id;
  request.instance = o.instance;
  if (!o.sheet.empty()) request.sheet = io::read_sensor_sheet(o.sheet);
  if (o.format == "matlab") request.function = function_of(o.output);
  request.notes = {"Written by " + tool_name() + " from " + io::printable(o.calibration),
                   "SHA-256 " + io::sha256(io::read_whole(o.calibration)), "Unit: " + io::printable(request.name)};
  if (o.recording > 0) request.notes.push_back("Turn-on bias: recording " + std::to_string(o.recording));
  const double rate = o.rate_deg_per_s * kRadPerDeg;
  if (!request.unit.gyro.converges_at(Vec3<double>::Constant(rate)) ||
      !request.unit.accel.converges_at(Vec3<double>::Constant(kStandardGravity)))
    throw io::input_error(o.calibration, 0, "",
                          "its nonlinear terms cannot be undone at " + figure(o.rate_deg_per_s, 4) +
                              " deg/s and 1 g: they are no small corrections there (--rate-deg-per-s)");
  static_cast<void>(format.make(request));  // what it refuses is the whole unit, and none of its terms
  const std::string at = " at " + figure(o.rate_deg_per_s, 4) + " deg/s and 1 g";
  std::vector<std::string> words;
  for (const io::Omission& left : io::omissions(format, request, rate))
    words.push_back("Left out: " + left.term + ", up to " + sizes(left.size) + at);
  request.notes.insert(request.notes.end(), words.begin(), words.end());
  const io::Exported exported = format.make(request);
  io::write_whole(o.output, exported.text);
  std::printf("%s: %s\n", o.output.c_str(), format.title);
  for (const std::string& word : words) std::fprintf(stderr, "%s\n", word.c_str());
  const InertialSample<double> all = io::departure(format, request, rate);
  if (all.w.maxCoeff() > 1e-6 * rate || all.f.maxCoeff() > 1e-6)
    std::fprintf(stderr, "In all%s its readings are off by up to %s%s%s\n",
                 format.holds_biases ? "" : ", besides the biases,", sizes(all).c_str(), at.c_str(),
                 request.unit.thermal.order() > 0 ? " and the reference temperature" : "");
  for (const std::string& advice : exported.advice) std::fprintf(stderr, "%s: %s\n", o.format.c_str(), advice.c_str());
}

}  // namespace trunnion::app
