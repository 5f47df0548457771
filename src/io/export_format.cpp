// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/export_format.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/LU>

#include "export_formats.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

using Unit = InertialUnit<double>;

/// Axes and the corners of the cube: a sum of terms is largest at one of them, or near.
const std::vector<Vec3<double>>& directions() {
  static const std::vector<Vec3<double>> kAll = [] {
    std::vector<Vec3<double>> list;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x != 0 || y != 0 || z != 0) list.push_back(Vec3<double>(x, y, z).normalized());
        }
      }
    }
    return list;
  }();
  return kAll;
}

/// What is no number is larger than any.
InertialSample<double> larger(const InertialSample<double>& a, const InertialSample<double>& b) {
  const auto size = [](double x) { return std::isnan(x) ? std::numeric_limits<double>::infinity() : std::abs(x); };
  return {a.w.cwiseMax(b.w.unaryExpr(size)), a.f.cwiseMax(b.f.unaryExpr(size))};
}

struct Term {
  const char* name;
  void (*keep)(const Unit& from, Unit& to);
};

/// Each puts one thing of a unit into a perfect one.
const std::vector<Term>& terms() {
  static const std::vector<Term> kAll = {
      {"gyro bias", [](const Unit& from, Unit& to) { to.gyro.bias = from.gyro.bias; }},
      {"gyro scale", [](const Unit& from, Unit& to) { to.gyro.M.diagonal() = from.gyro.M.diagonal(); }},
      {"gyro cross-coupling",
       [](const Unit& from, Unit& to) {
         to.gyro.M = from.gyro.M;
         to.gyro.M.diagonal().setZero();
       }},
      {"gyro asymmetry", [](const Unit& from, Unit& to) { to.gyro.asymmetry = from.gyro.asymmetry; }},
      {"gyro quadratic", [](const Unit& from, Unit& to) { to.gyro.quadratic = from.gyro.quadratic; }},
      {"gyro cubic", [](const Unit& from, Unit& to) { to.gyro.cubic = from.gyro.cubic; }},
      {"g-sensitivity", [](const Unit& from, Unit& to) { to.g_sensitivity = from.g_sensitivity; }},
      {"accelerometer bias", [](const Unit& from, Unit& to) { to.accel.bias = from.accel.bias; }},
      {"accelerometer scale", [](const Unit& from, Unit& to) { to.accel.M.diagonal() = from.accel.M.diagonal(); }},
      {"accelerometer cross-coupling",
       [](const Unit& from, Unit& to) {
         to.accel.M = from.accel.M;
         to.accel.M.diagonal().setZero();
       }},
      {"accelerometer asymmetry", [](const Unit& from, Unit& to) { to.accel.asymmetry = from.accel.asymmetry; }},
      {"accelerometer quadratic", [](const Unit& from, Unit& to) { to.accel.quadratic = from.accel.quadratic; }},
      {"accelerometer cubic", [](const Unit& from, Unit& to) { to.accel.cubic = from.accel.cubic; }},
  };
  return kAll;
}

/// Over the range of the calibration, or ten kelvins from its reference where it states none.
Omission temperature_of(const Unit& unit, double rate) {
  InertialSample<double> size;
  const auto& thermal = unit.thermal;
  const bool bounded = std::isfinite(thermal.lowest) && std::isfinite(thermal.highest);
  const double from = bounded ? thermal.lowest : thermal.reference - 10.0;
  const double to = bounded ? thermal.highest : thermal.reference + 10.0;
  constexpr int kPlaces = 64;  // a polynomial may be largest within
  for (int k = 0; k <= kPlaces; ++k) {
    const double celsius = from + (to - from) * k / kPlaces;
    const auto bias = thermal.at(celsius, thermal.bias);
    const auto scale = thermal.at(celsius, thermal.scale);
    size = larger(size, {bias.w.cwiseAbs() + rate * scale.w.cwiseAbs(),
                         bias.f.cwiseAbs() + kStandardGravity * scale.f.cwiseAbs()});
  }
  std::array<char, 64> span{};
  std::snprintf(span.data(), span.size(), "temperature, from %.4g to %.4g degC", from, to);
  return {span.data(), size};
}

InertialSample<double> size_of_places(const Unit& unit, double rate) {
  InertialSample<double> size;
  for (const Vec3<double>& d : directions())
    size = larger(size, {Vec3<double>::Zero(), unit.size_effect(rate * d, Vec3<double>::Zero())});
  return size;
}

InertialSample<double> departure_of(const Unit& unit, const Exported& exported, double rate) {
  InertialSample<double> most;
  for (const Vec3<double>& axis : directions()) {
    for (const Vec3<double>& up : directions()) {
      const InertialSample<double> input{rate * axis, kStandardGravity * up};
      const InertialSample<double> target = exported.correct(unit.distort(input));
      most = larger(most, {target.w - exported.C_tb * input.w, target.f - exported.C_tb * input.f});
    }
  }
  return most;
}

}  // namespace

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> kFormats = {kKalibrExport,    kOpenVinsExport,  kRosExport,    kPx4Export,
                                                     kArduPilotExport, kVectorNavExport, kMatlabExport, kJsonExport};
  return kFormats;
}

const ExportFormat& export_format(const std::string& name) {
  std::string known;
  for (const ExportFormat& format : export_formats()) {
    if (name == format.name) return format;
    known += std::string(known.empty() ? "" : ", ") + format.name;
  }
  throw Error(ExitCode::kUsage, "no export '" + name + "'; there are " + known);
}

InertialSample<double> departure(const ExportFormat& format, const ExportRequest& request, double rate) {
  InertialSample<double> most = departure_of(request.unit, format.make(request), rate);
  if (!format.holds_places) most.f += size_of_places(request.unit, rate).f;
  return most;
}

std::vector<Omission> omissions(const ExportFormat& format, const ExportRequest& request, double rate) {
  std::vector<Omission> all;
  const auto counts = [](double size, double of) { return size > 1e-9 * of; };
  ExportRequest one = request;
  const auto is_turned = [](const Unit& unit) {
    constexpr double kLeast = 0.1;
    return unit.gyro.matrix().determinant() < kLeast || unit.accel.matrix().determinant() < kLeast;
  };
  for (const Term& term : terms()) {
    one.unit = Unit();
    term.keep(request.unit, one.unit);
    if (is_turned(one.unit)) continue;  // the scales alone of a unit whose axes are turned are those of none
    const InertialSample<double> size = departure_of(one.unit, format.make(one), rate);
    const double rounding = 4.0 * format.precision;
    if (counts(size.w.maxCoeff() - rounding * rate, rate) ||
        counts(size.f.maxCoeff() - rounding * kStandardGravity, 10.0))
      all.push_back({term.name, size});
  }
  if (request.unit.thermal.order() > 0 && !format.holds_temperature) all.push_back(temperature_of(request.unit, rate));
  const InertialSample<double> bias{request.unit.gyro.bias.cwiseAbs(), request.unit.accel.bias.cwiseAbs()};
  if (!format.holds_biases && bias.w.norm() + bias.f.norm() > 0.0)
    all.push_back({"turn-on biases, which its reader estimates itself", bias});
  if (!request.unit.accel_place.isZero(0.0) && !format.holds_places)
    all.push_back({"size effect", size_of_places(request.unit, rate)});
  return all;
}

InertialSample<double> corrected_in_steps(const Unit& unit, const InertialSample<double>& reading, int steps) {
  const auto straight = [steps](const Triad<double>& triad, const Vec3<double>& linear) {
    const Mat3<double> inverse = triad.matrix().inverse();
    Vec3<double> u = inverse * linear;
    for (int step = 0; step < steps; ++step) u = inverse * (linear - triad.nonlinearity(u));
    return u;
  };
  InertialSample<double> input;
  input.f = straight(unit.accel, reading.f - unit.accel.bias);
  input.w = straight(unit.gyro, reading.w - unit.gyro.bias - unit.g_sensitivity * input.f);
  return input;
}

double to_single(double value) { return static_cast<double>(static_cast<float>(value)); }

std::string exactly(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  std::string digits(text.data(), result.ptr);
  if (digits.find('.') == std::string::npos) digits.insert(std::min(digits.find('e'), digits.size()), ".0");
  return digits;
}

std::string listed(const Vec3<double>& v, const char* between) {
  return exactly(v.x()) + between + exactly(v.y()) + between + exactly(v.z());
}

std::string listed(const Mat3<double>& M, const char* between) {
  std::string text;
  for (int i = 0; i < 3; ++i) text += (i == 0 ? "" : between) + listed(Vec3<double>(M.row(i).transpose()), between);
  return text;
}

std::string commented(const ExportRequest& request, const char* mark) {
  std::string text;
  for (const std::string& note : request.notes) text += std::string(mark) + " " + note + "\n";
  return text;
}

LowerAndRotation lower_and_rotation(const Triad<double>& triad) {
  const Mat3<double> A = triad.matrix();
  LowerAndRotation split;
  split.Q = rotation_exp(triad.geometry().installation);
  split.L = A * split.Q.transpose();
  split.L.triangularView<Eigen::StrictlyUpper>().setZero();
  return split;
}

}  // namespace trunnion::io
