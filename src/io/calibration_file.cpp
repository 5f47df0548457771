// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/calibration_file.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "strict_yaml.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

using Json = nlohmann::ordered_json;

/// The content as a tree, from which both forms are printed. @p null_zero: a sigma of zero is null, "not estimated".
Json number(double value, bool null_zero) { return null_zero && value == 0.0 ? Json(nullptr) : Json(value); }

Json list(const Vec3<double>& v, bool null_zero = false) {
  return Json::array({number(v.x(), null_zero), number(v.y(), null_zero), number(v.z(), null_zero)});
}

Json rows(const Mat3<double>& M, bool null_zero = false) {
  Json all = Json::array();
  for (int i = 0; i < 3; ++i) all.push_back(list(M.row(i).transpose(), null_zero));
  return all;
}

Json unit_tree(const InertialUnit<double>& unit, bool sigma, const char* part) {
  Json tree;
  const auto matrix = [&](const Triad<double>& triad) { return sigma ? rows(triad.M, true) : rows(triad.matrix()); };
  if (std::string_view(part) == "gyroscope") {
    tree["bias_rad_s"] = list(unit.gyro.bias, sigma);
    tree["matrix"] = matrix(unit.gyro);
    tree["cubic_s2_rad2"] = list(unit.gyro.cubic, sigma);
    if (!unit.gyro.asymmetry.isZero(0.0)) tree["asymmetry"] = list(unit.gyro.asymmetry, sigma);
    tree["g_sensitivity_s_m"] = rows(unit.g_sensitivity, sigma);
  } else {
    tree["bias_m_s2"] = list(unit.accel.bias, sigma);
    tree["matrix"] = matrix(unit.accel);
    tree["quadratic_s2_m"] = list(unit.accel.quadratic, sigma);
    if (!unit.accel.asymmetry.isZero(0.0)) tree["asymmetry"] = list(unit.accel.asymmetry, sigma);
    if (!unit.accel_place.isZero(0.0)) tree["place_m"] = rows(unit.accel_place.transpose(), sigma);
  }
  return tree;
}

Json rig_tree(const CalibrationValues& v, const std::vector<std::string>& mounts, bool sigma) {
  Json tree;
  tree["base_tilt_rad"] = Json::array({number(v.rig.tilt_x, sigma), number(v.rig.tilt_y, sigma)});
  tree["heading_rad"] = number(v.rig.heading, sigma);
  tree["axis_nonorthogonality_rad"] = number(v.rig.nonorthogonality, sigma);
  Json eccentricity = Json::array();
  for (const auto& e : v.rig.eccentricity)
    eccentricity.push_back(Json::array({number(e.cosine, sigma), number(e.sine, sigma)}));
  tree["encoder_eccentricity_rad"] = eccentricity;
  tree["mount_error_rad"] = Json::object();
  for (std::size_t m = 1; m < mounts.size(); ++m) tree["mount_error_rad"][mounts[m]] = list(v.mount_error[m], sigma);
  tree["imu_to_encoder_offset_s"] = number(v.clock_offset, sigma);
  tree["lever_arm_m"] = Json::object();
  for (std::size_t m = 0; m < mounts.size(); ++m) tree["lever_arm_m"][mounts[m]] = list(v.lever_arm[m], sigma);
  return tree;
}

/// "gyroscope_bias_rad_s_per_k2" of the second order.
std::string thermal_key(const char* of, std::size_t order) {
  return std::string(of) + "_per_k" + (order > 1 ? std::to_string(order) : "");
}

Json temperature_tree(const ThermalErrors<double>& thermal, int order, bool sigma) {
  Json tree;
  if (!sigma) {
    tree["reference_deg_c"] = thermal.reference;
    if (std::isfinite(thermal.lowest)) tree["range_deg_c"] = Json::array({thermal.lowest, thermal.highest});
  }
  for (std::size_t k = 1; k <= static_cast<std::size_t>(order); ++k) {
    tree[thermal_key("gyroscope_bias_rad_s", k)] = list(thermal.bias[k - 1].w, sigma);
    tree[thermal_key("accelerometer_bias_m_s2", k)] = list(thermal.bias[k - 1].f, sigma);
    tree[thermal_key("gyroscope_scale", k)] = list(thermal.scale[k - 1].w, sigma);
    tree[thermal_key("accelerometer_scale", k)] = list(thermal.scale[k - 1].f, sigma);
  }
  return tree;
}

Json geometry_tree(const Triad<double>& triad) {
  const TriadGeometry<double> parts = triad.geometry();
  return {{"scale", list(parts.scale)},
          {"nonorthogonality_rad", rows(parts.nonorthogonality)},
          {"installation_rad", list(parts.installation)}};
}

Json tree_of(const CalibrationFile& file) {
  const CalibrationRecord& r = file.record;
  Json tree;
  tree["format"] = "trunnion-calibration/1";
  tree["imu"] = {{"model", file.model}, {"serial", file.serial}};
  tree["gyroscope"] = unit_tree(r.value.unit, false, "gyroscope");
  tree["accelerometer"] = unit_tree(r.value.unit, false, "accelerometer");
  const int thermal_order = r.value.unit.thermal.order();
  if (thermal_order > 0) tree["temperature"] = temperature_tree(r.value.unit.thermal, thermal_order, false);
  tree["sigma"] = {{"gyroscope", unit_tree(r.sigma.unit, true, "gyroscope")},
                   {"accelerometer", unit_tree(r.sigma.unit, true, "accelerometer")}};
  if (thermal_order > 0) tree["sigma"]["temperature"] = temperature_tree(r.sigma.unit.thermal, thermal_order, true);
  if (r.has_rig) {
    tree["sigma"]["rig"] = rig_tree(r.sigma, file.mounts, true);
    tree["rig"] = rig_tree(r.value, file.mounts, false);
  }
  tree["geometry"] = {{"gyroscope", geometry_tree(r.value.unit.gyro)},
                      {"accelerometer", geometry_tree(r.value.unit.accel)}};
  tree["recordings"] = Json::array();
  for (std::size_t i = 0; i < static_cast<std::size_t>(r.recordings); ++i) {
    Json one;
    if (r.has_rig) one["mount"] = file.mounts[static_cast<std::size_t>(r.recording_mount[i])];
    one["gyroscope_bias_rad_s"] = list(r.value.recording_bias[i].w);
    one["accelerometer_bias_m_s2"] = list(r.value.recording_bias[i].f);
    tree["recordings"].push_back(one);
  }
  tree["gauge"] = file.gauge;
  tree["fit"] = {{"samples", r.fit.samples},       {"windows", r.fit.windows},
                 {"outliers", r.fit.outliers},     {"lost_records", r.fit.lost_records},
                 {"lost_bytes", r.fit.lost_bytes}, {"reduced_chi_square", r.fit.reduced_chi_square},
                 {"iterations", r.fit.iterations}};
  tree["verdict"] = file.within_limits ? "within_limits" : "out_of_limits";
  if (!file.within_limits) tree["out_of_limits"] = file.out_of_limits;
  tree["provenance"] = {{"tool", file.tool}, {"run", file.run}};
  if (file.seed >= 0) tree["provenance"]["seed"] = file.seed;
  tree["provenance"]["inputs"] = Json::array();
  for (const auto& [path, digest] : file.inputs)
    tree["provenance"]["inputs"].push_back({{"path", path}, {"sha256", digest}});
  return tree;
}

bool is_flat(const Json& value) {
  if (!value.is_structured()) return true;
  if (value.is_object()) return false;
  for (const Json& item : value) {
    if (item.is_object()) return false;
  }
  return true;
}

/// Bytes that are not UTF-8, of a name that a user gave, are replaced.
std::string text_of(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Block style for maps, flow style for numbers: JSON scalars and lists are YAML.
void print(const Json& value, int indent, std::string& out) {
  for (const auto& [key, child] : value.items()) {
    out += std::string(static_cast<std::size_t>(indent), ' ') + key + ":";
    if (is_flat(child) || child.empty()) {
      out += " " + text_of(child) + "\n";
    } else if (child.is_object()) {
      out += "\n";
      print(child, indent + 2, out);
    } else {
      out += "\n";
      for (const Json& item : child)
        out += std::string(static_cast<std::size_t>(indent) + 2, ' ') + "- " + text_of(item) + "\n";
    }
  }
}

void read_triads(const StrictYaml& root, bool sigma, InertialUnit<double>& unit) {
  const StrictYaml::Scalar scalar = sigma ? &StrictYaml::sigma : &StrictYaml::number;
  const auto matrix = [&](const StrictYaml& node) -> Mat3<double> {
    Mat3<double> M = node.matrix(scalar);
    if (!sigma) M.diagonal().array() -= 1.0;
    return M;
  };
  const StrictYaml gyro = root.at("gyroscope");
  gyro.only({"bias_rad_s", "matrix", "cubic_s2_rad2", "g_sensitivity_s_m", "asymmetry"});
  unit.gyro.bias = gyro.at("bias_rad_s").vector(scalar);
  unit.gyro.M = matrix(gyro.at("matrix"));
  if (gyro.has("cubic_s2_rad2")) unit.gyro.cubic = gyro.at("cubic_s2_rad2").vector(scalar);
  if (gyro.has("g_sensitivity_s_m")) unit.g_sensitivity = gyro.at("g_sensitivity_s_m").matrix(scalar);
  if (gyro.has("asymmetry")) unit.gyro.asymmetry = gyro.at("asymmetry").vector(scalar);
  const StrictYaml accel = root.at("accelerometer");
  accel.only({"bias_m_s2", "matrix", "quadratic_s2_m", "asymmetry", "place_m"});
  if (accel.has("asymmetry")) unit.accel.asymmetry = accel.at("asymmetry").vector(scalar);
  if (accel.has("place_m")) {
    unit.accel_place = accel.at("place_m").matrix(scalar).transpose();
    if (!sigma && !unit.accel_place.col(0).isZero(0.0))
      accel.at("place_m").fail("the first row should be zeros: the sensing point is where x is");
  }
  unit.accel.bias = accel.at("bias_m_s2").vector(scalar);
  unit.accel.M = matrix(accel.at("matrix"));
  if (accel.has("quadratic_s2_m")) unit.accel.quadratic = accel.at("quadratic_s2_m").vector(scalar);
  if (!sigma) {
    for (const auto& [node, triad] : {std::pair{gyro, &unit.gyro}, std::pair{accel, &unit.accel}}) {
      if (!(std::abs(triad->matrix().determinant()) > 1e-6)) node.at("matrix").fail("cannot be inverted");
    }
  }
}

void read_temperature(const StrictYaml& node, bool sigma, ThermalErrors<double>& thermal) {
  const StrictYaml::Scalar scalar = sigma ? &StrictYaml::sigma : &StrictYaml::number;
  std::vector<std::string> known;
  if (!sigma) {
    known = {"reference_deg_c", "range_deg_c"};
    thermal.reference = node.at("reference_deg_c").number_in(-273.15, 1000.0);
    if (node.has("range_deg_c")) {
      const StrictYaml range = node.at("range_deg_c");
      if (range.length() != 2) range.fail("should be two temperatures");
      thermal.lowest = range.at(0).number_in(-273.15, 1000.0);
      thermal.highest = range.at(1).number_in(thermal.lowest, 1000.0);
    }
  }
  for (std::size_t k = 1; k <= ThermalErrors<double>::kMostOrder; ++k) {
    const auto read = [&](const char* of, Vec3<double>& into) {
      known.push_back(thermal_key(of, k));
      if (node.has(known.back())) into = node.at(known.back()).vector(scalar);
    };
    read("gyroscope_bias_rad_s", thermal.bias[k - 1].w);
    read("accelerometer_bias_m_s2", thermal.bias[k - 1].f);
    read("gyroscope_scale", thermal.scale[k - 1].w);
    read("accelerometer_scale", thermal.scale[k - 1].f);
  }
  node.only(known);
}

void read_rig(const StrictYaml& rig, bool sigma, CalibrationValues& v, std::vector<std::string>& mounts) {
  const StrictYaml::Scalar scalar = sigma ? &StrictYaml::sigma : &StrictYaml::number;
  const auto number = [&](const StrictYaml& node) { return (node.*scalar)(); };
  rig.only({"base_tilt_rad", "heading_rad", "axis_nonorthogonality_rad", "encoder_eccentricity_rad", "mount_error_rad",
            "imu_to_encoder_offset_s", "lever_arm_m"});
  const StrictYaml tilt = rig.at("base_tilt_rad");
  if (tilt.length() != 2) tilt.fail("should be two numbers");
  v.rig.tilt_x = number(tilt.at(0));
  v.rig.tilt_y = number(tilt.at(1));
  v.rig.heading = number(rig.at("heading_rad"));
  v.rig.nonorthogonality = number(rig.at("axis_nonorthogonality_rad"));
  const StrictYaml eccentricity = rig.at("encoder_eccentricity_rad");
  if (eccentricity.length() != 2) eccentricity.fail("should be two pairs");
  for (std::size_t a = 0; a < 2; ++a) {
    if (eccentricity.at(a).length() != 2) eccentricity.at(a).fail("should be a pair");
    v.rig.eccentricity[a] = {number(eccentricity.at(a).at(0)), number(eccentricity.at(a).at(1))};
  }
  v.clock_offset = number(rig.at("imu_to_encoder_offset_s"));
  const StrictYaml levers = rig.at("lever_arm_m");
  if (mounts.empty()) mounts = levers.keys();
  if (mounts.empty() || mounts.size() > kMaxMounts)
    levers.fail("should name one to " + std::to_string(kMaxMounts) + " mounts");
  levers.only(mounts);
  rig.at("mount_error_rad").only(mounts);
  for (std::size_t m = 0; m < mounts.size(); ++m) {
    v.lever_arm[m] = levers.at(mounts[m]).vector(scalar);
    if (m > 0) v.mount_error[m] = rig.at("mount_error_rad").at(mounts[m]).vector(scalar);
  }
}

}  // namespace

std::string to_yaml(const CalibrationFile& file) {
  std::string out;
  print(tree_of(file), 0, out);
  return out;
}

std::string to_json(const CalibrationFile& file) {
  return tree_of(file).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

CalibrationFile read_calibration_file(const std::string& path) {
  const StrictYaml root = StrictYaml::load(path, "trunnion-calibration/1");
  root.only({"format", "imu", "gyroscope", "accelerometer", "temperature", "sigma", "rig", "geometry", "recordings",
             "gauge", "fit", "verdict", "out_of_limits", "provenance"});
  CalibrationFile file;
  if (root.has("imu")) {
    root.at("imu").only({"model", "serial"});
    file.model = root.at("imu").at("model").text();
    if (root.at("imu").has("serial")) file.serial = root.at("imu").at("serial").text();
  }
  CalibrationRecord& r = file.record;
  read_triads(root, false, r.value.unit);
  if (root.has("temperature")) read_temperature(root.at("temperature"), false, r.value.unit.thermal);
  r.has_rig = root.has("rig");
  if (r.has_rig) read_rig(root.at("rig"), false, r.value, file.mounts);
  if (root.has("sigma")) {
    const StrictYaml sigma = root.at("sigma");
    sigma.only({"gyroscope", "accelerometer", "temperature", "rig"});
    read_triads(sigma, true, r.sigma.unit);
    if (sigma.has("temperature")) read_temperature(sigma.at("temperature"), true, r.sigma.unit.thermal);
    if (sigma.has("rig") && r.has_rig) read_rig(sigma.at("rig"), true, r.sigma, file.mounts);
  }
  r.mounts = static_cast<int>(file.mounts.size());
  if (root.has("recordings")) {
    const StrictYaml recordings = root.at("recordings");
    if (recordings.length() > kMaxRecordings) recordings.fail("are more than " + std::to_string(kMaxRecordings));
    r.recordings = static_cast<int>(recordings.length());
    for (std::size_t i = 0; i < recordings.length(); ++i) {
      const StrictYaml one = recordings.at(i);
      one.only({"mount", "gyroscope_bias_rad_s", "accelerometer_bias_m_s2"});
      if (r.has_rig) {
        const auto at = std::find(file.mounts.begin(), file.mounts.end(), one.at("mount").text());
        if (at == file.mounts.end())
          one.at("mount").fail("is no mount of the rig; did you mean '" + nearest(one.at("mount").text(), file.mounts) +
                               "'?");
        r.recording_mount[i] = static_cast<int>(at - file.mounts.begin());
      }
      r.value.recording_bias[i] = {one.at("gyroscope_bias_rad_s").vector(), one.at("accelerometer_bias_m_s2").vector()};
    }
  }
  if (root.has("gauge")) {
    for (std::size_t i = 0; i < root.at("gauge").length(); ++i) file.gauge.push_back(root.at("gauge").at(i).text());
  }
  if (root.has("verdict")) {
    const std::string verdict = root.at("verdict").text();
    if (verdict != "within_limits" && verdict != "out_of_limits")
      root.at("verdict").fail("should be within_limits or out_of_limits");
    file.within_limits = verdict == "within_limits";
  }
  if (root.has("provenance") && root.at("provenance").has("inputs")) {
    const StrictYaml inputs = root.at("provenance").at("inputs");
    for (std::size_t i = 0; i < inputs.length(); ++i)
      file.inputs.emplace_back(inputs.at(i).at("path").text(), inputs.at(i).at("sha256").text());
  }
  return file;
}

InertialUnit<double> unit_of(const CalibrationFile& file, const std::string& path, int recording) {
  InertialUnit<double> unit = file.record.value.unit;
  if (recording <= 0) return unit;
  if (recording > file.record.recordings) {
    throw input_error(path, 0, "recordings",
                      "has " + std::to_string(file.record.recordings) + ", not " + std::to_string(recording));
  }
  const auto& bias = file.record.value.recording_bias[static_cast<std::size_t>(recording - 1)];
  unit.gyro.bias = bias.w;
  unit.accel.bias = bias.f;
  return unit;
}

}  // namespace trunnion::io
