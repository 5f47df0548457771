// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Everything of a unit, for programs that have no YAML: the forward model, the inverses of its matrices, its equations.

#include <Eigen/LU>
#include <cmath>
#include <nlohmann/json.hpp>

#include "export_formats.hpp"

namespace trunnion::io {
namespace {

using Json = nlohmann::ordered_json;

Json list(const Vec3<double>& v) { return {v.x(), v.y(), v.z()}; }
Json rows(const Mat3<double>& M) {
  Json all = Json::array();
  for (int i = 0; i < 3; ++i) all.push_back(list(M.row(i).transpose()));
  return all;
}

Json triad(const Triad<double>& t) {
  return {{"bias", list(t.bias)},
          {"matrix", rows(t.matrix())},
          {"inverse_matrix", rows(t.matrix().inverse())},
          {"asymmetry", list(t.asymmetry)},
          {"quadratic", list(t.quadratic)},
          {"cubic", list(t.cubic)}};
}

Exported json(const ExportRequest& request) {
  const InertialUnit<double>& unit = request.unit;
  Json tree = {{"schema", "trunnion/correction/1"}, {"unit", request.name}, {"notes", request.notes}};
  tree["units"] = "rad/s, m/s^2, degC, m";
  tree["equations"] = {
      "f = A_a^-1 (y_a - b_a - n_a(f))", "w = A_g^-1 (y_g - b_g - H f - n_g(w))",
      "n(u) = |u| asymmetry / 2 + u^2 quadratic + u^3 cubic, by axis; u <- A^-1 (y - b - n(u)) eight times, from n = 0",
      "at T: b + sum bias[k] t^k and A + diag(sum scale[k] t^k), k from 1, t = clamp(T, lowest, highest) - reference"};
  tree["gyroscope"] = triad(unit.gyro);
  tree["accelerometer"] = triad(unit.accel);
  tree["g_sensitivity"] = rows(unit.g_sensitivity);
  if (unit.thermal.order() > 0) {
    const auto& thermal = unit.thermal;
    Json& t = tree["temperature"];
    t["reference"] = thermal.reference;
    // null: to no end
    t["lowest"] = std::isfinite(thermal.lowest) ? Json(thermal.lowest) : Json(nullptr);
    t["highest"] = std::isfinite(thermal.highest) ? Json(thermal.highest) : Json(nullptr);
    for (int k = 0; k < thermal.order(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      t["gyroscope_bias"].push_back(list(thermal.bias[i].w));
      t["accelerometer_bias"].push_back(list(thermal.bias[i].f));
      t["gyroscope_scale"].push_back(list(thermal.scale[i].w));
      t["accelerometer_scale"].push_back(list(thermal.scale[i].f));
    }
  }
  if (!unit.accel_place.isZero(0.0)) {
    tree["accelerometer"]["place"] = rows(unit.accel_place.transpose());
    tree["equations"].push_back(
        "first, with place r_i [m] of accelerometer i: y_a_i - row i of A_a (w' x r_i + w x (w x r_i))");
  }
  Exported out;
  out.text = tree.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  out.correct = [unit](const InertialSample<double>& y) { return corrected_in_steps(unit, y, kExportedSteps); };
  return out;
}

}  // namespace

const ExportFormat kJsonExport = {"json", "JSON with equations and inverses", ".json", 1e-9, true, true, true, json};

}  // namespace trunnion::io
