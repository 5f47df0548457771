// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/rinex_names.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "rinex_fields.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::io {
namespace rinex {

bool take_line(std::string_view text, std::size_t& next, std::string_view& line) {
  if (next >= text.size()) return false;
  std::size_t end = text.find('\n', next);
  if (end == std::string_view::npos) end = text.size();
  line = text.substr(next, end - next);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  next = end + 1;
  return true;
}

std::string_view part(std::string_view text, std::size_t from, std::size_t count) {
  return from < text.size() ? text.substr(from, count) : std::string_view();
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(' ');
  return from == std::string_view::npos ? std::string_view() : text.substr(from, text.find_last_not_of(' ') - from + 1);
}

std::optional<double> number(std::string_view field) {
  field = trimmed(field);
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  std::array<char, 32> digits{};
  if (field.empty() || field.size() > digits.size()) return std::nullopt;
  for (std::size_t i = 0; i < field.size(); ++i) digits[i] = field[i] == 'D' || field[i] == 'd' ? 'E' : field[i];
  double value = 0.0;
  const char* const end = digits.data() + field.size();
  const auto [after, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc{} || after != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> integer(std::string_view field) {
  field = trimmed(field);
  int value = 0;
  const auto [after, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (field.empty() || error != std::errc{} || after != field.data() + field.size()) return std::nullopt;
  return value;
}

std::optional<SatelliteName> satellite_name(std::string_view field) {
  const std::size_t system = field.empty() ? std::string_view::npos : kLetters.find(field[0] == ' ' ? 'G' : field[0]);
  const std::optional<int> number = integer(part(field, 1, 2));
  if (system == std::string_view::npos || !number || *number < 1 || *number > 99) return std::nullopt;
  return SatelliteName{static_cast<SatelliteSystem>(system), *number};
}

}  // namespace rinex

namespace {

struct Band {
  SatelliteSystem system;
  char band;
  double megahertz;
};
constexpr std::array<Band, 18> kBands = {{{SatelliteSystem::kGps, '1', 1575.42},
                                          {SatelliteSystem::kGps, '2', 1227.60},
                                          {SatelliteSystem::kGps, '5', 1176.45},
                                          {SatelliteSystem::kGalileo, '1', 1575.42},
                                          {SatelliteSystem::kGalileo, '5', 1176.45},
                                          {SatelliteSystem::kGalileo, '7', 1207.14},
                                          {SatelliteSystem::kGalileo, '8', 1191.795},
                                          {SatelliteSystem::kGalileo, '6', 1278.75},
                                          {SatelliteSystem::kQzss, '1', 1575.42},
                                          {SatelliteSystem::kQzss, '2', 1227.60},
                                          {SatelliteSystem::kQzss, '5', 1176.45},
                                          {SatelliteSystem::kQzss, '6', 1278.75},
                                          {SatelliteSystem::kBeidou, '1', 1575.42},
                                          {SatelliteSystem::kBeidou, '2', 1561.098},
                                          {SatelliteSystem::kBeidou, '5', 1176.45},
                                          {SatelliteSystem::kBeidou, '6', 1268.52},
                                          {SatelliteSystem::kBeidou, '7', 1207.14},
                                          {SatelliteSystem::kBeidou, '8', 1191.795}}};

const Band* find_band(SatelliteSystem system, char band) {
  const auto* const found =
      std::find_if(kBands.begin(), kBands.end(), [&](const Band& b) { return b.system == system && b.band == band; });
  return found == kBands.end() ? nullptr : found;
}

}  // namespace

bool rinex::has_band(SatelliteSystem system, char band) { return find_band(system, band) != nullptr; }

GpsTime gps_time(int year, int month, int day, int hour, int minute, double second) {
  // days since 1980-01-06: Fliegel & Van Flandern, CACM 11 (1968), 657
  const int a = (month - 14) / 12;
  const int julian =
      day - 32075 + 1461 * (year + 4800 + a) / 4 + 367 * (month - 2 - a * 12) / 12 - 3 * ((year + 4900 + a) / 100) / 4;
  const int days = julian - 2444245;
  const int week = days >= 0 ? days / 7 : -1;
  return GpsTime{week, 0.0} + ((days - 7 * week) * 86400.0 + hour * 3600.0 + minute * 60.0 + second);
}

std::string SatelliteName::text() const {
  const std::string digits = std::to_string(number);
  return rinex::kLetters[static_cast<std::size_t>(system)] + std::string(digits.size() < 2 ? "0" : "") + digits;
}

std::string SignalName::text() const {
  return std::string{rinex::kLetters[static_cast<std::size_t>(system)], code[0], code[1]};
}

double SignalName::wavelength() const {
  const Band* const band = find_band(system, code[0]);
  if (band == nullptr) throw Error(ExitCode::kInput, text() + ": its system has no such band");
  return kLightSpeed / (1e6 * band->megahertz);
}

SignalName SignalName::parse(const std::string& text) {
  const std::size_t system = text.empty() ? std::string::npos : rinex::kLetters.find(text[0]);
  if (text.size() != 3 || system == std::string::npos ||
      find_band(static_cast<SatelliteSystem>(system), text[1]) == nullptr || text[2] < 'A' || text[2] > 'Z')
    throw Error(ExitCode::kUsage,
                "'" + text + "' names no signal: a system of G, E, J, C, a band, a letter, as in G1C");
  return {static_cast<SatelliteSystem>(system), {text[1], text[2]}};
}

}  // namespace trunnion::io
