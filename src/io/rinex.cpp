// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/rinex.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr std::string_view kLetters = "GEJC";  // in the order of SatelliteSystem
constexpr double kBeidouBehind = 14.0;         // s, of its time against GPS time
constexpr std::size_t kLabel = 60;             // column of a header line's label
constexpr std::size_t kWidth = 16;             // of an observation: F14.3, loss of lock, strength
constexpr int kMostSatellites = 200;           // of an epoch
constexpr double kTolerable = 0.1;             // of lines that cannot be read

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

const Band* band_of(SatelliteSystem system, char band) {
  const auto* const found =
      std::find_if(kBands.begin(), kBands.end(), [&](const Band& b) { return b.system == system && b.band == band; });
  return found == kBands.end() ? nullptr : found;
}

std::string_view part(std::string_view text, std::size_t from, std::size_t count) {
  return from < text.size() ? text.substr(from, count) : std::string_view();
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(' ');
  return from == std::string_view::npos ? std::string_view() : text.substr(from, text.find_last_not_of(' ') - from + 1);
}

/// The whole of a field as a number; D for E as Fortran writes it. Nothing for blanks and for anything else.
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

/// "G05", " 5" of GPS. Nothing for another system.
std::optional<SatelliteName> satellite_name(std::string_view field) {
  const std::size_t system = field.empty() ? std::string_view::npos : kLetters.find(field[0] == ' ' ? 'G' : field[0]);
  const std::optional<int> number = integer(part(field, 1, 2));
  if (system == std::string_view::npos || !number || *number < 1 || *number > 99) return std::nullopt;
  return SatelliteName{static_cast<SatelliteSystem>(system), *number};
}

/// What a satellite's number of an observation could be, whatever the system.
bool names_a_satellite(std::string_view field) {
  return field.size() == 3 && std::string_view("GREJCIS ").find(field[0]) != std::string_view::npos &&
         integer(field.substr(1)).has_value();
}

}  // namespace

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
  return kLetters[static_cast<std::size_t>(system)] + std::string(digits.size() < 2 ? "0" : "") + digits;
}

std::string SignalName::text() const {
  return std::string{kLetters[static_cast<std::size_t>(system)], code[0], code[1]};
}

double SignalName::wavelength() const {
  const Band* const band = band_of(system, code[0]);
  if (band == nullptr) throw Error(ExitCode::kInput, text() + ": its system has no such band");
  return kLightSpeed / (1e6 * band->megahertz);
}

SignalName SignalName::parse(const std::string& text) {
  const std::size_t system = text.empty() ? std::string::npos : kLetters.find(text[0]);
  if (text.size() != 3 || system == std::string::npos ||
      band_of(static_cast<SatelliteSystem>(system), text[1]) == nullptr || text[2] < 'A' || text[2] > 'Z')
    throw Error(ExitCode::kUsage,
                "'" + text + "' names no signal: a system of G, E, J, C, a band, a letter, as in G1C");
  return {static_cast<SatelliteSystem>(system), {text[1], text[2]}};
}

ObservationReader::ObservationReader(std::string path) : path_(std::move(path)), text_(read_whole(path_)) {
  digest_ = sha256(text_);
  read_header();
}

bool ObservationReader::line(std::string_view& text) {
  if (next_ >= text_.size()) return false;
  std::size_t end = text_.find('\n', next_);
  if (end == std::string::npos) end = text_.size();
  text = std::string_view(text_).substr(next_, end - next_);
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  next_ = end + 1;
  ++line_;
  return true;
}

double ObservationReader::fraction() const {
  return text_.empty() ? 1.0 : static_cast<double>(std::min(next_, text_.size())) / static_cast<double>(text_.size());
}

void ObservationReader::read_header() {
  std::string_view text;
  bool ended = false;
  while (!ended && line(text)) {
    const std::string_view label = trimmed(part(text, kLabel, 20));
    if (line_ == 1) {
      if (label == "CRINEX VERS   / TYPE")
        throw input_error(path_, 1, "", "is compressed after Hatanaka: expand it with crx2rnx first");
      const std::optional<double> version = number(part(text, 0, 9));
      if (label != "RINEX VERSION / TYPE" || !version) throw input_error(path_, 1, "", "is no RINEX file");
      if (part(text, 20, 1) != "O") throw input_error(path_, 1, "", "is a RINEX file, but not of observations");
      version_ = static_cast<int>(std::lround(*version * 100.0));
      if (version_ < 200 || version_ >= 400)
        throw input_error(path_, 1, "",
                          "is RINEX of version " + std::string(trimmed(part(text, 0, 9))) + ": 2 and 3 are read");
    } else if (label == "APPROX POSITION XYZ") {
      for (std::size_t i = 0; i < 3; ++i) position_(static_cast<int>(i)) = number(part(text, 14 * i, 14)).value_or(0.0);
    } else if (label == "# / TYPES OF OBSERV") {
      types_of_version_2(text);
    } else if (label == "SYS / # / OBS TYPES") {
      types_of_version_3(text);
    } else if (label == "SYS / SCALE FACTOR") {
      throw input_error(path_, line_, "SYS / SCALE FACTOR", "is not read: convert the file without one");
    } else if (label == "TIME OF FIRST OBS") {
      const std::string_view system = trimmed(part(text, 48, 3));
      if (system == "BDT")
        seconds_of_beidou_ = true;
      else if (!system.empty() && system != "GPS" && system != "GAL" && system != "QZS")
        throw input_error(path_, line_, "TIME OF FIRST OBS",
                          "its time is of " + printable(std::string(system)) + ": GPS, GAL, QZS and BDT are read");
    }
    ended = label == "END OF HEADER";
  }
  if (line_ == 0) throw input_error(path_, 0, "", "is empty");
  if (!ended) throw input_error(path_, line_, "END OF HEADER", "is missing");
  if (types_.empty())
    throw input_error(path_, 0, version_ < 300 ? "# / TYPES OF OBSERV" : "SYS / # / OBS TYPES", "is missing");
}

void ObservationReader::types_of_version_2(std::string_view text) {
  // one list for every system
  for (std::size_t at = 10; at + 2 <= std::min(text.size(), kLabel); at += 6) {
    const std::string type(part(text, at, 2));
    if (type != "  ") types_[' '].push_back(type);
  }
}

void ObservationReader::types_of_version_3(std::string_view text) {
  if (part(text, 0, 1) != " ") listed_ = text[0];
  for (std::size_t at = 7; at + 3 <= std::min(text.size(), kLabel); at += 4) {
    std::string type(part(text, at, 3));
    if (type == "   ") break;
    if (version_ == 302 && listed_ == 'C' && type[1] == '1' && type[2] != 'P' && type[2] != 'D')
      type[1] = '2';  // B1 was band 1 there
    types_[listed_].push_back(type);
  }
}

std::vector<SignalName> ObservationReader::available() const {
  std::vector<SignalName> names;
  for (const char letter : kLetters) {
    const auto found = types_.find(version_ < 300 ? ' ' : letter);
    if (found == types_.end()) continue;
    const auto has = [&](const std::string& type) {
      return std::find(found->second.begin(), found->second.end(), type) != found->second.end();
    };
    const auto system = static_cast<SatelliteSystem>(kLetters.find(letter));
    for (const std::string& type : found->second) {
      if (band_of(system, type[1]) == nullptr) continue;
      SignalName name{system, {type[1], 'C'}};
      if (version_ < 300) {
        if ((type[0] != 'C' && type[0] != 'P') || !has(std::string{'L', type[1]})) continue;
        if (type[0] == 'P') name.code[1] = 'W';
        if (system == SatelliteSystem::kBeidou) name.code[1] = 'I';
      } else {
        if (type[0] != 'C' || !has("L" + type.substr(1))) continue;
        name.code[1] = type[2];
      }
      names.push_back(name);
    }
  }
  return names;
}

/// Of an event within the file: files that were joined have other types from there on.
void ObservationReader::new_header_line(std::string_view text, bool first) {
  const std::string_view label = trimmed(part(text, kLabel, 20));
  if (first) renewed_ = false;
  if (label == "# / TYPES OF OBSERV") {
    if (!renewed_) types_.clear();
    types_of_version_2(text);
    renewed_ = true;
  } else if (label == "SYS / # / OBS TYPES") {
    if (part(text, 0, 1) != " " && !text.empty()) types_.erase(text[0]);
    types_of_version_3(text);
  }
}

void ObservationReader::choose(const std::vector<SignalName>& signals) {
  signals_ = signals;
  columns_.clear();
  bool any = false;
  for (const char letter : kLetters) {
    const auto found = types_.find(version_ < 300 ? ' ' : letter);
    if (found == types_.end()) continue;
    std::vector<Column>& columns = columns_[letter];
    columns.resize(found->second.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& type = found->second[c];
      for (std::size_t s = 0; s < signals.size(); ++s) {
        if (kLetters[static_cast<std::size_t>(signals[s].system)] != letter || signals[s].code[0] != type[1]) continue;
        const char attribute = signals[s].code[1];
        const bool precise = attribute == 'W' || attribute == 'P' || attribute == 'Y';
        if (version_ < 300 ? (type[0] == 'C' && precise) || (type[0] == 'P' && !precise) : type[2] != attribute)
          continue;
        columns[c] = {static_cast<int>(s), type[0] == 'P' ? 'C' : type[0]};
        any = any || type[0] == 'L';
      }
    }
  }
  if (any) return;
  std::string has;
  for (const SignalName& name : available()) has += (has.empty() ? "" : ", ") + name.text();
  throw input_error(path_, 0, "", "has none of the signals asked for; it has " + (has.empty() ? "no phase" : has));
}

void ObservationReader::lose(bool whole_epoch, const std::string& field, const std::string& what) {
  ++(whole_epoch ? losses_.epochs : losses_.satellites);
  if (losses_.first.empty()) losses_.first = input_error(path_, line_, field, what).what();
}

bool ObservationReader::time_of(std::string_view head, bool version_2, ObservationEpoch& epoch, int& flag, int& count) {
  const std::size_t base = version_2 ? 0 : 1;
  std::array<std::optional<int>, 5> date;
  std::size_t at = base;
  for (std::size_t i = 0; i < date.size(); ++i) {
    const std::size_t width = i == 0 && !version_2 ? 5 : 3;
    date[i] = integer(part(head, at, width));
    at += width;
  }
  const std::optional<double> second = number(part(head, at, 11));
  const std::optional<int> flagged = integer(part(head, version_2 ? 26 : 29, 3));
  const std::optional<int> satellites = integer(part(head, version_2 ? 29 : 32, 3));
  if (!flagged || !satellites || *satellites < 0 || *satellites > kMostSatellites) return false;
  flag = *flagged;
  count = *satellites;
  if (flag > 1) return flag <= 6;  // an event: its time may be blank
  if (!date[0] || !date[1] || !date[2] || !date[3] || !date[4] || !second) return false;
  int year = *date[0];
  if (version_2) year += year < 80 ? 2000 : 1900;
  if (year < 1980 || year > 2200 || *date[1] < 1 || *date[1] > 12 || *date[2] < 1 || *date[2] > 31 || *date[3] < 0 ||
      *date[3] > 24 || *date[4] < 0 || *date[4] > 60 || !(*second >= 0.0 && *second < 61.0))
    return false;
  epoch.time =
      gps_time(year, *date[1], *date[2], *date[3], *date[4], *second + (seconds_of_beidou_ ? kBeidouBehind : 0.0));
  return true;
}

/// One F14.3 with its loss of lock. @return false for a field that is neither blank nor whole
bool ObservationReader::take(std::string_view field, const Column& column, std::vector<SignalObservation>& found) {
  if (column.signal < 0) return true;
  const std::string_view value = field.substr(0, std::min<std::size_t>(field.size(), 14));
  if (trimmed(value).empty()) return true;
  // a line that was cut within a number leaves a number
  if (value.size() < 14 || value[10] != '.') return false;
  const std::optional<double> read = number(value);
  if (!read) return false;
  if (*read == 0.0) return true;
  std::size_t at = 0;
  while (at < found.size() && found[at].signal != column.signal) ++at;
  if (at == found.size()) found.emplace_back().signal = column.signal;
  SignalObservation& observation = found[at];
  if (column.kind == 'C') {
    if (!(*read > 1e7 && *read < 1e8)) return false;
    observation.code = *read;
  } else if (column.kind == 'L') {
    observation.phase = *read;
    const std::string_view lock = part(field, 14, 1);
    observation.half_cycle = !lock.empty() && lock[0] >= '0' && lock[0] <= '7' && ((lock[0] - '0') & 2) != 0;
  } else if (column.kind == 'D') {
    observation.doppler = *read;
  }
  return true;
}

void ObservationReader::keep(const SatelliteName& satellite, std::vector<SignalObservation>& found,
                             ObservationEpoch& epoch) {
  for (const SignalObservation& other : epoch.at) {
    if (other.satellite.index() == satellite.index()) {
      lose(false, satellite.text(), "is there twice in one epoch");
      return;
    }
  }
  for (SignalObservation& observation : found) {
    observation.satellite = satellite;
    epoch.at.push_back(observation);
  }
}

bool ObservationReader::read_3(std::string_view head, ObservationEpoch& epoch) {
  int flag = 0;
  int count = 0;
  if (!time_of(head, false, epoch, flag, count)) {
    lose(true, "epoch", "cannot be read");
    return false;
  }
  std::vector<SignalObservation> found;
  std::string_view text;
  for (int i = 0; i < count; ++i) {
    if (next_ < text_.size() && text_[next_] == '>') {
      lose(false, "epoch", "has fewer satellites than it says");
      break;
    }
    if (!line(text)) {
      lose(false, "epoch", "ends before its satellites");
      break;
    }
    if (flag > 1) {
      new_header_line(text, i == 0);
      continue;
    }
    ++read_;
    const std::string_view name = part(text, 0, 3);
    if (!names_a_satellite(name)) {
      lose(false, "satellite", "'" + printable(std::string(name)) + "' is none");
      continue;
    }
    const std::optional<SatelliteName> satellite = satellite_name(name);
    if (!satellite) continue;
    const auto columns = columns_.find(kLetters[static_cast<std::size_t>(satellite->system)]);
    if (columns == columns_.end()) continue;
    found.clear();
    bool whole = true;
    for (std::size_t c = 0; c < columns->second.size() && whole; ++c)
      whole = take(part(text, 3 + kWidth * c, kWidth), columns->second[c], found);
    if (whole)
      keep(*satellite, found, epoch);
    else
      lose(false, satellite->text(), "has an observation that is cut or no number");
  }
  if (flag > 1 && !signals_.empty()) choose(signals_);
  return flag <= 1;
}

bool ObservationReader::read_2(std::string_view head, ObservationEpoch& epoch) {
  int flag = 0;
  int count = 0;
  if (!time_of(head, true, epoch, flag, count)) {
    lose(true, "epoch", "cannot be read");
    return false;
  }
  std::string_view text = head;
  if (flag > 1) {
    for (int i = 0; i < count && line(text); ++i) new_header_line(text, i == 0);
    if (!signals_.empty()) choose(signals_);
    return false;
  }
  std::vector<std::optional<SatelliteName>> names;
  for (int i = 0; i < count; ++i) {
    if (i > 0 && i % 12 == 0 && !line(text)) break;
    const std::string_view name = part(text, 32 + 3 * static_cast<std::size_t>(i % 12), 3);
    if (!names_a_satellite(name)) {
      lose(true, "epoch", "its list of satellites cannot be read");
      return false;
    }
    names.push_back(satellite_name(name));
  }
  const std::size_t types = types_.at(' ').size();
  std::vector<SignalObservation> found;
  for (const std::optional<SatelliteName>& satellite : names) {
    found.clear();
    bool whole = true;
    const std::vector<Column>* columns = nullptr;
    if (satellite) {
      const auto of = columns_.find(kLetters[static_cast<std::size_t>(satellite->system)]);
      if (of != columns_.end()) columns = &of->second;
    }
    for (std::size_t c = 0; c < types; ++c) {
      if (c % 5 == 0) {
        if (!line(text)) {
          lose(false, "epoch", "ends before its satellites");
          return true;
        }
        ++read_;
      }
      if (columns != nullptr) whole = take(part(text, kWidth * (c % 5), kWidth), (*columns)[c], found) && whole;
    }
    if (columns == nullptr) continue;
    if (whole)
      keep(*satellite, found, epoch);
    else
      lose(false, satellite->text(), "has an observation that is cut or no number");
  }
  return true;
}

/// To the next line that may begin an epoch.
bool ObservationReader::next_epoch_line(std::string_view& text) {
  while (line(text)) {
    if (trimmed(text).empty()) continue;
    if (version_ < 300 || text[0] == '>') return true;
    lose(false, "", "'" + printable(std::string(part(text, 0, 20))) + "' stands outside an epoch");
  }
  return false;
}

void ObservationReader::check() const {
  const long long lost = losses_.epochs + losses_.satellites;
  if (static_cast<double>(lost) > kTolerable * static_cast<double>(std::max<long long>(read_, 1)))
    throw Error(ExitCode::kInput, losses_.first + "; so are " + std::to_string(lost - 1) + " others of " +
                                      std::to_string(read_) + " lines");
}

bool ObservationReader::next(ObservationEpoch& epoch) {
  std::string_view head;
  while (next_epoch_line(head)) {
    ++read_;
    epoch.at.clear();
    if (version_ < 300 ? !read_2(head, epoch) : !read_3(head, epoch)) continue;
    if (started_ && !(epoch.time - last_ > 0.0)) {
      lose(true, "epoch", "is not later than the one before");
      continue;
    }
    started_ = true;
    last_ = epoch.time;
    return true;
  }
  check();
  return false;
}

namespace {

/// One message: the number of its lines, and what it says. @return false when a needed number is missing
bool read_orbit(const std::vector<std::string_view>& lines, bool version_2, BroadcastOrbit& orbit) {
  const std::size_t first = version_2 ? 22 : 23;
  const std::size_t rest = version_2 ? 3 : 4;
  std::array<std::array<double, 4>, 8> v{};
  for (std::size_t i = 0; i < 7; ++i) {
    for (std::size_t k = 0; k < (i == 0 ? 3U : 4U); ++k) {
      const std::optional<double> value =
          number(i == 0 ? part(lines[0], first + 19 * k, 19) : part(lines[i], rest + 19 * k, 19));
      if (value)
        v[i][k] = *value;
      else if (i < 5 || (i == 5 && k == 0) || (i == 6 && k == 1))
        return false;
    }
  }
  orbit.af0 = v[0][0], orbit.af1 = v[0][1], orbit.af2 = v[0][2];
  orbit.crs = v[1][1], orbit.delta_n = v[1][2], orbit.m0 = v[1][3];
  orbit.cuc = v[2][0], orbit.e = v[2][1], orbit.cus = v[2][2], orbit.sqrt_a = v[2][3];
  orbit.toe_of_week = v[3][0], orbit.cic = v[3][1], orbit.omega0 = v[3][2], orbit.cis = v[3][3];
  orbit.i0 = v[4][0], orbit.crc = v[4][1], orbit.omega = v[4][2], orbit.omega_dot = v[4][3];
  orbit.i_dot = v[5][0];
  if (!(orbit.toe_of_week >= 0.0 && orbit.toe_of_week < kSecondsPerWeek) || !(std::abs(v[6][1]) < 1e6)) return false;
  const auto health = static_cast<int>(v[6][1]);
  // Galileo: the lowest three bits are of E1; QZSS: the lowest is of another signal
  orbit.healthy = orbit.system == SatelliteSystem::kGalileo ? (health & 7) == 0
                  : orbit.system == SatelliteSystem::kQzss  ? (health & ~1) == 0
                                                            : health == 0;
  return true;
}

}  // namespace

void OrbitBook::add(const BroadcastOrbit& orbit) {
  constexpr std::size_t kMost = 100;  // of a satellite: four days
  std::vector<BroadcastOrbit>& all = orbits_[SatelliteName{orbit.system, orbit.number}.index()];
  for (BroadcastOrbit& known : all) {
    if (orbit.toe - known.toe == 0.0) {  // a bus repeats them
      known = orbit;
      return;
    }
  }
  if (all.size() == kMost) {
    all.erase(all.begin());
    --count_;
  }
  all.push_back(orbit);
  ++count_;
}

void OrbitBook::add(const std::string& path) {
  const std::string text = read_whole(path);
  digest_ = sha256(digest_ + text);
  std::size_t next = 0;
  long long line_number = 0;
  const auto line = [&](std::string_view& found) {
    if (next >= text.size()) return false;
    std::size_t end = text.find('\n', next);
    if (end == std::string::npos) end = text.size();
    found = std::string_view(text).substr(next, end - next);
    if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
    next = end + 1;
    ++line_number;
    return true;
  };
  std::string first_fault;
  const auto lose = [&](const std::string& field, const std::string& what) {
    ++losses_.satellites;
    if (first_fault.empty()) first_fault = input_error(path, line_number, field, what).what();
    if (losses_.first.empty()) losses_.first = first_fault;
  };
  std::string_view head;
  bool version_2 = false;
  bool ended = false;
  while (!ended && line(head)) {
    const std::string_view label = trimmed(part(head, kLabel, 20));
    if (line_number == 1) {
      const std::optional<double> version = number(part(head, 0, 9));
      if (label != "RINEX VERSION / TYPE" || !version) throw input_error(path, 1, "", "is no RINEX file");
      if (!(*version >= 2.0 && *version < 4.0))
        throw input_error(path, 1, "",
                          "is RINEX of version " + std::string(trimmed(part(head, 0, 9))) + ": 2 and 3 are read");
      if (part(head, 20, 1) != "N")
        throw input_error(path, 1, "", "is a RINEX file, but not of GPS or mixed navigation");
      version_2 = *version < 3.0;
    }
    ended = label == "END OF HEADER";
  }
  if (line_number == 0) throw input_error(path, 0, "", "is empty");
  if (!ended) throw input_error(path, line_number, "END OF HEADER", "is missing");
  bool any = false;
  std::vector<std::string_view> lines;
  bool pending = line(head);
  while (pending) {
    const char letter = version_2 ? 'G' : head.empty() ? ' ' : head[0];
    if (!version_2 && (letter < 'A' || letter > 'Z')) {  // the rest of a message that was passed over
      pending = line(head);
      continue;
    }
    const std::string name = version_2 ? "G" + std::string(part(head, 0, 2)) : std::string(part(head, 0, 3));
    const std::optional<SatelliteName> satellite = satellite_name(name);
    lines.assign(1, head);
    std::string_view following;
    bool more = true;
    while (lines.size() < 8 && (more = line(following))) {
      if (!version_2 && !following.empty() && following[0] >= 'A' && following[0] <= 'Z') break;
      lines.push_back(following);
    }
    const bool cut = lines.size() < 8;
    if (satellite && lines.size() >= 7) {
      BroadcastOrbit orbit;
      orbit.system = satellite->system;
      orbit.number = satellite->number;
      std::array<std::optional<int>, 5> date;
      for (std::size_t i = 0; i < date.size(); ++i)
        date[i] = version_2 ? integer(part(head, 2 + 3 * i, 3))
                            : integer(i == 0 ? part(head, 3, 5) : part(head, 5 + 3 * i, 3));
      const std::optional<double> second = number(version_2 ? part(head, 17, 5) : part(head, 20, 3));
      const bool dated = date[0] && date[1] && date[2] && date[3] && date[4] && second && *date[1] >= 1 &&
                         *date[1] <= 12 && *date[0] >= 0 && *date[0] < 2200 && *date[2] >= 1 && *date[2] <= 31 &&
                         std::abs(*date[3]) < 25 && std::abs(*date[4]) < 61;
      if (dated && read_orbit(lines, version_2, orbit)) {
        int year = *date[0];
        if (version_2) year += year < 80 ? 2000 : 1900;
        const double behind = orbit.system == SatelliteSystem::kBeidou ? kBeidouBehind : 0.0;
        const GpsTime toc = gps_time(year, *date[1], *date[2], *date[3], *date[4], *second);
        GpsTime toe{toc.week, orbit.toe_of_week};
        if (toe - toc > 0.5 * kSecondsPerWeek) --toe.week;
        if (toe - toc < -0.5 * kSecondsPerWeek) ++toe.week;
        orbit.toc = toc + behind;
        orbit.toe = toe + behind;
        add(orbit);
        any = true;
      } else {
        lose(satellite->text(), "a message of its orbit that is cut or no number");
      }
    } else if (satellite) {
      lose(satellite->text(), "a message of its orbit that is cut");
    }
    if (cut && more) {
      head = following;
    } else {
      pending = line(head);
    }
  }
  if (!any)
    throw first_fault.empty() ? input_error(path, 0, "", "holds no orbit of GPS, Galileo, QZSS or BeiDou")
                              : Error(ExitCode::kInput, first_fault);
}

void OrbitBook::each(const std::function<void(const BroadcastOrbit&)>& visit) const {
  for (const auto& [satellite, orbits] : orbits_) {
    for (const BroadcastOrbit& orbit : orbits) visit(orbit);
  }
}

const BroadcastOrbit* OrbitBook::at(const SatelliteName& satellite, const GpsTime& time) const {
  const auto found = orbits_.find(satellite.index());
  if (found == orbits_.end()) return nullptr;
  const BroadcastOrbit* best = nullptr;
  double nearest = kOrbitLasts;
  for (const BroadcastOrbit& orbit : found->second) {
    const double off = std::abs(orbit.toe - time);
    if (!(off <= nearest)) continue;
    nearest = off;
    best = &orbit;
  }
  // an older message that calls it healthy is no excuse
  return best != nullptr && best->healthy ? best : nullptr;
}

}  // namespace trunnion::io
