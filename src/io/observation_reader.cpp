// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/observation_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rinex_fields.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {

using namespace rinex;

namespace {

constexpr std::size_t kWidth = 16;    // of an observation: F14.3, loss of lock, strength
constexpr int kMostSatellites = 200;  // of an epoch
constexpr double kTolerable = 0.1;    // of lines that cannot be read

/// What a satellite's number of an observation could be, whatever the system.
bool names_a_satellite(std::string_view field) {
  return field.size() == 3 && std::string_view("GREJCIS ").find(field[0]) != std::string_view::npos &&
         integer(field.substr(1)).has_value();
}

}  // namespace

ObservationReader::ObservationReader(std::string path) : path_(std::move(path)), text_(read_whole(path_)) {
  digest_ = sha256(text_);
  read_header();
}

bool ObservationReader::line(std::string_view& text) {
  if (!take_line(text_, next_, text)) return false;
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
      if (!has_band(system, type[1])) continue;
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

}  // namespace trunnion::io
