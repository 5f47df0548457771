// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "column_units.hpp"

#include "trunnion/core/gps_time.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/csv.hpp"

namespace trunnion::io {
namespace {

constexpr std::array<Unit, 5> kTimeUnits = {
    {{"s", "_s", 1.0}, {"ms", "_ms", 1e-3}, {"us", "_us", 1e-6}, {"ns", "_ns", 1e-9}, {"100us", "_100us", 1e-4}}};
constexpr std::array<Unit, 1> kWeekUnits = {{{"weeks", "_weeks", kSecondsPerWeek}}};
constexpr std::array<Unit, 3> kRateUnits = {
    {{"rad/s", "_rad_s", 1.0}, {"deg/s", "_deg_s", kRadPerDeg}, {"deg/h", "_deg_h", kRadPerSPerDegPerH}}};
constexpr std::array<Unit, 3> kForceUnits = {
    {{"m/s^2", "_m_s2", 1.0}, {"g", "_g", kStandardGravity}, {"mg", "_mg", 1e-3 * kStandardGravity}}};
constexpr std::array<Unit, 2> kAngleUnits = {{{"rad", "_rad", 1.0}, {"deg", "_deg", kRadPerDeg}}};
constexpr std::array<Unit, 1> kLengthUnits = {{{"m", "_m", 1.0}}};
constexpr std::array<Unit, 1> kFrequencyUnits = {{{"Hz", "_hz", 1.0}}};
constexpr std::array<Unit, 1> kTemperatureUnits = {{{"deg_c", "_deg_c", 1.0}}};
constexpr std::array<Unit, 1> kNumberUnits = {{{"", "", 1.0}}};

}  // namespace

Units units_of(const std::string& quantity) {
  const auto ends_with = [&](const char* end) {
    const std::string_view tail(end);
    return quantity.size() > tail.size() && quantity.compare(quantity.size() - tail.size(), tail.size(), tail) == 0;
  };
  if (quantity == kWeek) return {kWeekUnits.data(), kWeekUnits.size()};
  if (quantity == "t" || quantity == "duration" || quantity == "transition")
    return {kTimeUnits.data(), kTimeUnits.size()};
  if (quantity.rfind("gyro_", 0) == 0 || ends_with("_rate")) return {kRateUnits.data(), kRateUnits.size()};
  if (ends_with("_frequency")) return {kFrequencyUnits.data(), kFrequencyUnits.size()};
  if (quantity == kTemperature) return {kTemperatureUnits.data(), kTemperatureUnits.size()};
  if (quantity == "recording") return {kNumberUnits.data(), kNumberUnits.size()};
  if (quantity.rfind("accel_", 0) == 0) return {kForceUnits.data(), kForceUnits.size()};
  if (quantity == "h") return {kLengthUnits.data(), kLengthUnits.size()};
  return {kAngleUnits.data(), kAngleUnits.size()};
}

double unit_in_si(const std::string& quantity, const std::string& unit) {
  const Units units = units_of(quantity);
  for (std::size_t i = 0; i < units.count; ++i) {
    if (unit == units.first[i].name) return units.first[i].si;
  }
  return 0.0;
}

bool unit_fits(const std::string& quantity, const std::string& unit, std::string& expected) {
  const Units units = units_of(quantity);
  expected.clear();
  bool fits = false;
  for (std::size_t i = 0; i < units.count; ++i) {
    expected += std::string(i == 0 ? "" : ", ") + units.first[i].name;
    fits = fits || unit == units.first[i].name;
  }
  if (quantity == "t") {
    expected += ", " + std::string(kSamples);
    fits = fits || unit == kSamples;
  }
  if (quantity[0] == 'g' || quantity.rfind("accel_", 0) == 0) {
    expected += ", counts";
    fits = fits || unit == kCounts;
  }
  return fits;
}

}  // namespace trunnion::io
