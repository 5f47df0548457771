// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A function of MATLAB and GNU Octave: eq. (2) and (5) with all nonlinearity and all orders of temperature.

#include "export_formats.hpp"
#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion::io {
namespace {

std::string matrix(const Mat3<double>& M) {
  std::string text = "[";
  for (int i = 0; i < 3; ++i) text += (i == 0 ? "" : "; ") + listed(Vec3<double>(M.row(i).transpose()));
  return text + "]";
}

/// A row of numbers: what a reading, a row too, is computed with.
std::string row(const Vec3<double>& v) { return "[" + listed(v) + "]"; }

std::string triad(const char* name, const Triad<double>& t) {
  const std::string of(name);
  return of + ".matrix = " + matrix(t.matrix()) + ";\n" + of + ".bias = " + row(t.bias) + ";\n" + of +
         ".asymmetry = " + row(t.asymmetry) + ";\n" + of + ".quadratic = " + row(t.quadratic) + ";\n" + of +
         ".cubic = " + row(t.cubic) + ";\n";
}

std::string orders(const char* name, const ThermalErrors<double>& thermal, bool of_bias, bool of_gyro) {
  std::string text = std::string(name) + " = [";
  for (int k = 0; k < thermal.order(); ++k) {
    const auto& order = (of_bias ? thermal.bias : thermal.scale)[static_cast<std::size_t>(k)];
    text += (k == 0 ? "" : "; ") + listed(of_gyro ? order.w : order.f);
  }
  return text + "];\n";
}

std::string bound(double celsius, const char* beyond) { return std::isfinite(celsius) ? exactly(celsius) : beyond; }

Exported matlab(const ExportRequest& request) {
  const InertialUnit<double>& unit = request.unit;
  const bool moves = unit.thermal.order() > 0;
  Exported out;
  std::string& text = out.text;
  text = "function [w, f] = " + request.function + "(gyro, accel" + (moves ? ", celsius" : "") +
         ")\n% True angular rate w [rad/s] and specific force f [m/s^2] of readings, a row a sample (N by 3)";
  text += moves ? ";\n% celsius: the unit's temperature, a number or one a row.\n" : ".\n";
  text += commented(request, "%");
  text +=
      "% gyro = matrix w + bias + g_sensitivity f + n(w), accel = matrix f + bias + n(f),\n"
      "% n(u) = |u| asymmetry / 2 + u^2 quadratic + u^3 cubic.\n";
  text += triad("g", unit.gyro) + triad("a", unit.accel) + "H = " + matrix(unit.g_sensitivity) + ";\n";
  if (moves) {
    text += "reference = " + exactly(unit.thermal.reference) + ";  % degC, and the range of the calibration\n";
    text += "lowest = " + bound(unit.thermal.lowest, "-Inf") + ";\nhighest = " + bound(unit.thermal.highest, "Inf") +
            ";\n% of (celsius - reference)^k, a row each k\n";
    text += orders("g.bias_k", unit.thermal, true, true) + orders("a.bias_k", unit.thermal, true, false) +
            orders("g.scale_k", unit.thermal, false, true) + orders("a.scale_k", unit.thermal, false, false);
    text +=
        "t = min(max(celsius(:), lowest), highest) - reference;\n"
        "t(isnan(celsius(:))) = 0;  % not known\n"
        "if numel(t) == 1, t = repmat(t, size(gyro, 1), 1); end\n"
        "powers = t .^ (1:" +
        std::to_string(unit.thermal.order()) +
        ");\n"
        "f = straightened(accel - powers * a.bias_k, a, powers * a.scale_k);\n"
        "w = straightened(gyro - powers * g.bias_k - f * H', g, powers * g.scale_k);\n";
  } else {
    text += "f = straightened(accel, a, 0);\nw = straightened(gyro - f * H', g, 0);\n";
  }
  text +=
      "end\n\n"
      "function u = straightened(y, triad, scale)\n"
      "% a fixed-point iteration over n(u) and the scale that moves\n"
      "linear = y - triad.bias;\n"
      "u = linear / triad.matrix';\n"
      "for step = 1:" +
      std::to_string(kExportedSteps) +
      "\n"
      "  n = abs(u) .* triad.asymmetry / 2 + u.^2 .* triad.quadratic + u.^3 .* triad.cubic;\n"
      "  u = (linear - n - scale .* u) / triad.matrix';\n"
      "end\nend\n";
  out.correct = [unit](const InertialSample<double>& y) { return corrected_in_steps(unit, y, kExportedSteps); };
  return out;
}

}  // namespace

const ExportFormat kMatlabExport = {"matlab", "function of MATLAB and Octave", ".m", 1e-9, true, false, true, matlab};

}  // namespace trunnion::io
