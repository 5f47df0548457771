// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "csv_headers.hpp"
#include "log_formats.hpp"
#include "strict_yaml.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

struct Unit {
  const char* name;
  const char* suffix;  // of a header name
  double si;
};

constexpr std::array<Unit, 5> kTimeUnits = {
    {{"s", "_s", 1.0}, {"ms", "_ms", 1e-3}, {"us", "_us", 1e-6}, {"ns", "_ns", 1e-9}, {"100us", "_100us", 1e-4}}};
constexpr std::array<Unit, 1> kWeekUnits = {{{"weeks", "_weeks", 604800.0}}};  // of GPS
constexpr double kGpsEpoch = 315964800.0;                                      // s since 1970, leap seconds not counted
constexpr std::array<Unit, 3> kRateUnits = {
    {{"rad/s", "_rad_s", 1.0}, {"deg/s", "_deg_s", kRadPerDeg}, {"deg/h", "_deg_h", kRadPerSPerDegPerH}}};
constexpr std::array<Unit, 3> kForceUnits = {
    {{"m/s^2", "_m_s2", 1.0}, {"g", "_g", kStandardGravity}, {"mg", "_mg", 1e-3 * kStandardGravity}}};
constexpr std::array<Unit, 2> kAngleUnits = {{{"rad", "_rad", 1.0}, {"deg", "_deg", kRadPerDeg}}};
constexpr std::array<Unit, 1> kLengthUnits = {{{"m", "_m", 1.0}}};
constexpr std::array<Unit, 1> kFrequencyUnits = {{{"Hz", "_hz", 1.0}}};
constexpr std::array<Unit, 1> kTemperatureUnits = {{{"deg_c", "_deg_c", 1.0}}};
constexpr std::array<Unit, 1> kNumberUnits = {{{"", "", 1.0}}};
constexpr double kLargestReading = 1e6;  // rad/s, m/s^2, rad
constexpr const char* kCounts = "counts";
constexpr const char* kSamples = "samples";  // of the time: the sheet has the rate
constexpr double kCounterWraps = 65536.0;    // samples: a counter of 16 bits, or one that never does
constexpr const char* kWeek = "week";
constexpr std::string_view kByteOrderMark("\xef\xbb\xbf", 3);
constexpr const char* kTemperature = "temperature";
constexpr double kHottest = 1000.0;  // degC
constexpr std::array<const char*, 6> kSensors = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};

struct Units {
  const Unit* first;
  std::size_t count;
};

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
  if (quantity == "temperature") return {kTemperatureUnits.data(), kTemperatureUnits.size()};
  if (quantity == "recording") return {kNumberUnits.data(), kNumberUnits.size()};
  if (quantity.rfind("accel_", 0) == 0) return {kForceUnits.data(), kForceUnits.size()};
  if (quantity == "h") return {kLengthUnits.data(), kLengthUnits.size()};
  return {kAngleUnits.data(), kAngleUnits.size()};
}

/// A column and how its numbers become SI: (number - zero) * si.
struct Column {
  std::string quantity;
  std::size_t index = 0;
  double si = 1.0;
  double zero = 0.0;
  double largest = std::numeric_limits<double>::infinity();
  bool optional = false;  // what is no number there is not known
  bool sparse = false;    // ... and a row without any of these is none
  bool is_time = false;
};

bool starts_number(const char* p, const char* end) {
  if (p != end && (*p == '+' || *p == '-')) ++p;
  return p != end && ((*p >= '0' && *p <= '9') || *p == '.');
}

bool is_utf_16(std::string_view text) { return text.substr(0, 2) == "\xff\xfe" || text.substr(0, 2) == "\xfe\xff"; }

class Table {
 public:
  Table(const std::string& path, Sha256* digest) : path_(path), text_(read_whole(path)) {
    if (digest != nullptr) digest->update(text_);
    if (text_.find_first_not_of(" \t\r\n") == std::string::npos) throw input_error(path_, 0, "", "is empty");
    if (is_utf_16(text_)) throw input_error(path_, 0, "", "is a text in UTF-16: save it as UTF-8");
    next_ = text_.data();
    end_ = next_ + text_.size();
    if (std::string_view(text_).substr(0, kByteOrderMark.size()) == kByteOrderMark) next_ += kByteOrderMark.size();
    skip_preamble();
    const std::string_view first = current_line();
    separator_ = first.find(',') != std::string::npos ? ',' : first.find(';') != std::string::npos ? ';' : ' ';
    const char* p = first.data();
    while (p != first.data() + first.size() && (*p == ' ' || *p == '\t')) ++p;
    if (!starts_number(p, first.data() + first.size())) {
      read_header(std::string(first));
      header_line_ = line_ + 1;
      next_line();
    }
  }

  /// Finds the columns of the quantities, by map or by header. @throws Error naming what is missing
  void choose(const std::vector<std::string>& quantities, const ColumnMap& map, const SensorSheet& sheet) {
    for (const std::string& quantity : quantities) {
      Column column;
      column.quantity = quantity;
      std::string unit;
      const auto chosen = map.find(quantity);
      if (chosen != map.end()) {
        column.index = chosen->second.name.empty() ? static_cast<std::size_t>(chosen->second.index)
                                                   : find(chosen->second.name, quantity);
        unit = chosen->second.unit;
      } else {
        unit = find_by_name(quantity, column.index);
      }
      if (unit == kSamples) {
        if (!(sheet.rate_hz > 0.0))
          throw input_error(path_, header_line_, quantity, "counts samples, and no sheet says their rate_hz");
        column.si = 1.0 / sheet.rate_hz;
      } else if (unit == kCounts) {
        const NominalScale<double>& counts = quantity[0] == 'g' ? sheet.counts.gyro : sheet.counts.accel;
        column.si = 1.0 / counts.scale;
        column.zero = counts.zero;
      } else {
        column.si = unit_in_si(quantity, unit);
      }
      column.is_time = quantity == "t";
      if (!column.is_time && quantity != kWeek) column.largest = kLargestReading;
      column.optional = quantity == kTemperature;
      column.sparse = sparse_ && !column.is_time && quantity != kWeek;
      columns_.push_back(column);
      last_ = std::max(last_, column.index);
      if (!column.optional) needed_ = std::max(needed_, column.index);
    }
    cells_.resize(last_ + 1);
  }

  /// Reads the next row; value[i] belongs to the i-th chosen quantity. @return false at the end
  bool row(double* value) {
    while (read_row()) {
      std::size_t empty = 0;
      std::size_t sparse = 0;
      for (const Column& column : columns_) {
        if (!column.sparse) continue;
        ++sparse;
        if (std::isnan(cells_[column.index])) ++empty;
      }
      if (empty > 0 && empty == sparse) continue;  // a row of something else
      convert(value);
      return true;
    }
    return false;
  }

  [[nodiscard]] long long line() const { return line_; }
  /// The time of the last row: nanoseconds since 1970 would lose their last digits as seconds.
  [[nodiscard]] double microseconds() const { return microseconds_; }
  [[nodiscard]] bool has_header() const { return !names_.empty(); }
  [[nodiscard]] bool has_column(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Whose export this is, by its names; null for nobody's that is known.
  [[nodiscard]] const HeaderSet* header_set() const {
    for (const HeaderSet& set : header_sets()) {
      if (set.mark != nullptr && preamble_.find(set.mark) == std::string::npos) continue;
      const bool all = std::all_of(set.sensors.begin(), set.sensors.end(),
                                   [&](const char* name) { return place_of(name) < names_.size(); });
      if (all && place_of(set.time) < names_.size() && (set.week == nullptr || place_of(set.week) < names_.size()))
        return &set;
    }
    return nullptr;
  }

  /// From now on a row may lack all of a unit's readings: it is of another instrument.
  void allow_rows_of_others() { sparse_ = true; }

 private:
  /// The cells of the next line that is no comment. @return false at the end
  bool read_row() {
    while (next_ != end_ && (*next_ == '\n' || *next_ == '\r' || *next_ == '#')) next_line();
    if (next_ == end_) return false;
    ++line_;
    const char* p = next_;
    std::size_t found = 0;
    for (; found <= last_; ++found) {
      while (p != end_ && (*p == ' ' || (*p == '\t' && separator_ == ' '))) ++p;
      if (p == end_ || *p == '\n' || *p == '\r') break;
      const char* from = *p == '+' ? p + 1 : p;
      const auto [after, error] = std::from_chars(from, end_, cells_[found]);
      const bool number = error == std::errc{};
      p = number ? after : p;
      if (number && p != end_ && *p == separator_ && separator_ != ' ') {  // as it is almost always
        ++p;
        continue;
      }
      const char* cell_end = p;
      while (cell_end != end_ && *cell_end != '\n' && *cell_end != '\r' &&
             *cell_end != (separator_ == ' ' ? '\t' : separator_) && (separator_ != ' ' || *cell_end != ' ')) {
        ++cell_end;
      }
      if (!number || std::string_view(p, static_cast<std::size_t>(cell_end - p)).find_first_not_of(" \t") !=
                         std::string_view::npos) {
        const Column* const column = column_at(found);
        cells_[found] = std::nan("");
        if (column != nullptr && !column->optional && !(column->sparse && cell_end == p)) {
          throw input_error(path_, line_, column->quantity,
                            "should be a number, is '" + std::string(number ? from : p, cell_end) + "'");
        }
      }
      p = cell_end;
      if (p != end_ && *p == separator_ && separator_ != ' ') ++p;
    }
    if (found <= needed_) {
      throw input_error(
          path_, line_, "",
          "row too short: " + std::to_string(found) + " columns, " + std::to_string(needed_ + 1) + " needed");
    }
    for (; found <= last_; ++found) cells_[found] = std::nan("");
    next_ = p;
    skip_rest();
    return true;
  }

  /// (cell - zero) * si of every chosen column.
  void convert(double* value) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const double cell = cells_[columns_[i].index];
      if (columns_[i].optional && !(std::abs(cell) < kHottest)) {
        value[i] = std::nan("");
        continue;
      }
      if (!std::isfinite(cell)) throw input_error(path_, line_, columns_[i].quantity, "is not finite");
      value[i] = (cell - columns_[i].zero) * columns_[i].si;
      if (columns_[i].is_time) microseconds_ = cell * (1e6 * columns_[i].si);
      if (std::abs(value[i]) > columns_[i].largest) {
        throw input_error(path_, line_, columns_[i].quantity, "is beyond any sensor");
      }
    }
  }

  /// Lines above the header, as the programs that export tables write them.
  void skip_preamble() {
    constexpr std::size_t kMostPreamble = 64;
    const char* const begin = next_;
    const char* at = next_;
    long long lines = 0;
    bool of_dot = false;  // whose lines are many, and not marked
    const auto skip_to = [&](const char* to, long long count) {
      next_ = to;
      line_ = count;
      preamble_.assign(begin, to);
    };
    for (std::size_t i = 0; i < kMostPreamble && at != end_; ++i) {
      const auto* newline = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end_ - at)));
      const char* const after = newline != nullptr ? newline + 1 : end_;
      std::string_view line(at, static_cast<std::size_t>((newline != nullptr ? newline : end_) - at));
      line = line.substr(0, line.find_last_not_of(" \t\r,;") + 1);
      ++lines;
      const bool comment = line.empty() || line.rfind("//", 0) == 0 || line.rfind("sep=", 0) == 0;
      if (line == "DATA_START") return skip_to(after, lines);
      of_dot = of_dot || (next_ == at && line.rfind("DeviceTag:", 0) == 0);
      const bool of_preamble = comment || (of_dot && line.rfind("PacketCounter", 0) != 0);
      if (of_preamble && next_ == at) skip_to(after, lines);
      at = after;
    }
  }

  [[nodiscard]] std::string_view current_line() const {
    const auto* newline = static_cast<const char*>(std::memchr(next_, '\n', static_cast<std::size_t>(end_ - next_)));
    return {next_, static_cast<std::size_t>((newline != nullptr ? newline : end_) - next_)};
  }

  /// Of the column of that name, alone or after the name of its instrument and a colon; names_.size() for none.
  [[nodiscard]] std::size_t place_of(std::string_view name) const {
    std::size_t i = 0;
    for (; i < names_.size(); ++i) {
      std::string_view here = names_[i];
      if (here.size() > name.size() && here[here.size() - name.size() - 1] == ':')
        here.remove_prefix(here.size() - name.size());
      if (here == name) break;
    }
    return i;
  }

  void skip_rest() {
    const auto* newline = static_cast<const char*>(std::memchr(next_, '\n', static_cast<std::size_t>(end_ - next_)));
    next_ = newline != nullptr ? newline + 1 : end_;
  }
  void next_line() {
    skip_rest();
    ++line_;
  }

  const Column* column_at(std::size_t index) const {
    for (const Column& column : columns_) {
      if (column.index == index) return &column;
    }
    return nullptr;
  }

  void read_header(const std::string& line) {
    if (separator_ == ' ' && line.find('\t') != std::string::npos) separator_ = '\t';
    std::string name;
    const auto end_name = [&] {
      while (!name.empty() && (name.back() == ' ' || name.back() == '\r')) name.pop_back();
      if (!name.empty() && name[0] == '#') name.erase(0, name.find_first_not_of("# "));
      if (separator_ != ' ' || !name.empty()) names_.push_back(name);
      name.clear();
    };
    for (const char c : line) {
      if (c == separator_ || (separator_ == ' ' && c == '\t')) {
        end_name();
      } else if (!(name.empty() && c == ' ')) {
        name += c;
      }
    }
    end_name();
  }

  std::size_t find(const std::string& name, const std::string& quantity) const {
    const std::size_t at = place_of(name);
    if (at == names_.size()) {
      throw input_error(
          path_, header_line_, quantity,
          "no column '" + name + "'" +
              (names_.empty() ? ": the file has no header" : "; nearest is '" + nearest(name, names_) + "'"));
    }
    return at;
  }

  std::string find_by_name(const std::string& quantity, std::size_t& index) const {
    const Units units = units_of(quantity);
    std::string wanted;
    for (std::size_t i = 0; i < units.count; ++i) {
      const std::string name = quantity + units.first[i].suffix;
      wanted += (i == 0 ? "" : ", ") + name;
      const auto at = std::find(names_.begin(), names_.end(), name);
      if (at == names_.end()) continue;
      index = static_cast<std::size_t>(at - names_.begin());
      return units.first[i].name;
    }
    if (quantity == "t") {
      const auto at = std::find(names_.begin(), names_.end(), "utime");
      if (at != names_.end()) {
        index = static_cast<std::size_t>(at - names_.begin());
        return "us";
      }
    }
    for (const std::string& name : names_) {
      if (name == quantity) {
        throw input_error(path_, header_line_, name,
                          "the header has no unit: name it one of " + wanted + ", or map it under columns");
      }
    }
    throw input_error(path_, header_line_, quantity,
                      "no such column: name it one of " + wanted + ", or map it under columns");
  }

  std::string path_;
  std::string text_;
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  char separator_ = ',';
  std::string preamble_;
  long long header_line_ = 1;
  std::vector<std::string> names_;
  std::vector<Column> columns_;
  std::vector<double> cells_;
  std::size_t last_ = 0;
  std::size_t needed_ = 0;
  bool sparse_ = false;
  double microseconds_ = 0.0;
  long long line_ = 0;
};

std::int64_t to_utime(double us, const Table& table) {
  if (!(std::abs(us) < 9e18)) throw input_error(table.path(), table.line(), "t", "is beyond any clock");
  return static_cast<std::int64_t>(std::llround(us));
}

}  // namespace

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

void read_split_csv(const std::string& gyro_path, const std::string& accel_path, const ColumnMap& columns,
                    const SensorSheet& sheet, SampleSink& sink, std::string& gyro_digest, std::string& accel_digest) {
  Sha256 gyro_sha;
  Sha256 accel_sha;
  Table gyro(gyro_path, &gyro_sha);
  Table accel(accel_path, &accel_sha);
  gyro_digest = gyro_sha.finish();
  accel_digest = accel_sha.finish();
  ColumnMap map = columns;
  // without a header: time in seconds, then counts of x, y, z
  const auto by_default = [&](const Table& table, const std::string& quantity, int index, const char* unit) {
    if (!table.has_header() && map.count(quantity) == 0) map[quantity] = {"", index, unit};
  };
  if (gyro.has_header() != accel.has_header())
    throw input_error(gyro.has_header() ? accel_path : gyro_path, 1, "", "has no header, while the other file has one");
  by_default(gyro, "t", 0, "s");
  int column = 0;
  for (const char* sensor : kSensors) by_default(gyro, sensor, 1 + column++ % 3, kCounts);
  gyro.choose({"t", kSensors[0], kSensors[1], kSensors[2]}, map, sheet);
  accel.choose({"t", kSensors[3], kSensors[4], kSensors[5]}, map, sheet);
  std::array<double, 4> g{};
  std::array<double, 4> a{};
  for (;;) {
    const bool more_gyro = gyro.row(g.data());
    const bool more_accel = accel.row(a.data());
    if (more_gyro != more_accel) {
      const Table& longer = more_gyro ? gyro : accel;
      throw input_error(longer.path(), longer.line(), "", "has more rows than " + (more_gyro ? accel : gyro).path());
    }
    if (!more_gyro) return;
    if (std::abs(g[0] - a[0]) > 1e-4)
      throw input_error(accel_path, accel.line(), "t", "is not the stamp of the same row in " + gyro_path);
    sink.imu(to_utime(gyro.microseconds(), gyro), {Vec3<double>(g[1], g[2], g[3]), Vec3<double>(a[1], a[2], a[3])});
  }
}

void read_columns_csv(const std::string& path, const std::vector<std::string>& quantities,
                      const std::function<void(const double*)>& row, std::string& digest) {
  Sha256 sha;
  Table table(path, &sha);
  digest = sha.finish();
  table.choose(quantities, {}, SensorSheet{});
  std::vector<double> values(quantities.size());
  while (table.row(values.data())) row(values.data());
}

namespace {

/// The user's columns, and for the rest those of a program that is known, where the names are not our own.
ColumnMap columns_of(const Table& table, const LogRequest& request, const HeaderSet*& set) {
  ColumnMap map = request.columns;
  set = table.header_set();
  if (set == nullptr || std::any_of(kSensors.begin(), kSensors.end(), [&](const char* s) { return map.count(s) != 0; }))
    set = nullptr;
  if (set == nullptr) return map;
  if (map.count("t") == 0) {
    map["t"] = {set->time, -1, set->time_unit};
    if (set->week != nullptr) map[kWeek] = {set->week, -1, "weeks"};
  }
  for (std::size_t i = 0; i < kSensors.size(); ++i)
    map[kSensors[i]] = {set->sensors[i], -1, i < 3 ? set->rate_unit : set->force_unit};
  return map;
}

LogLosses read_csv(const LogRequest& request, SampleSink& sink) {
  Table table(request.path, request.digest);
  const HeaderSet* set = nullptr;
  ColumnMap map = columns_of(table, request, set);
  // a table of encoders alone has a time of its own, unless its columns are said
  if (!request.need_imu && map.count("azimuth") == 0 && map.count("pitch") == 0) map.clear();
  std::vector<std::string> quantities = {"t"};
  if (request.need_imu) quantities.insert(quantities.end(), kSensors.begin(), kSensors.end());
  if (request.need_encoder) quantities.insert(quantities.end(), {"azimuth", "pitch"});
  const std::size_t angles = request.need_imu ? 7 : 1;
  std::size_t temperature = 0;
  std::size_t week = 0;
  const auto also = [&](const char* quantity, std::size_t& place) {
    place = quantities.size();
    quantities.emplace_back(quantity);
  };
  if (request.need_imu && (map.count(kTemperature) != 0 || table.has_column("temperature_deg_c")))
    also(kTemperature, temperature);
  if (map.count(kWeek) != 0) also(kWeek, week);
  if (set != nullptr) table.allow_rows_of_others();
  table.choose(quantities, map, request.channels.sheet);
  const ColumnChoice time = map.count("t") != 0 ? map.at("t") : ColumnChoice{};
  const double wraps_at = time.unit == kSamples ? 1e6 * kCounterWraps / request.channels.sheet.rate_hz
                          : set != nullptr && time.name == set->time ? 1e6 * set->wraps_at * unit_in_si("t", time.unit)
                                                                     : 0.0;
  double wrapped = 0.0;
  double last = 0.0;
  long long rows = 0;
  std::vector<double> v(quantities.size());
  while (table.row(v.data())) {
    const double t = table.microseconds();
    if (wraps_at > 0.0 && rows > 0 && last - t > 0.5 * wraps_at) wrapped += wraps_at;
    last = t;
    const std::int64_t utime = to_utime(t + wrapped + (week > 0 ? 1e6 * (kGpsEpoch + v[week]) : 0.0), table);
    if (temperature > 0 && std::isfinite(v[temperature])) sink.temperature(v[temperature]);  // a slow one: empty cells
    if (request.need_imu) sink.imu(utime, {Vec3<double>(v[1], v[2], v[3]), Vec3<double>(v[4], v[5], v[6])});
    if (request.need_encoder) sink.encoder(utime, v[angles], v[angles + 1]);
    ++rows;
  }
  return {};
}

/// Text, for the most part ASCII.
bool is_text(std::string_view head) {
  if (is_utf_16(head)) return true;
  if (head.substr(0, kByteOrderMark.size()) == kByteOrderMark) head.remove_prefix(kByteOrderMark.size());
  std::size_t high = 0;
  for (const char c : head) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 && c != '\t' && c != '\r' && c != '\n' && c != '\f') return false;
    high += byte >= 0x80 ? 1 : 0;
  }
  return 10 * high <= head.size();
}

void append_number(std::string& out, double value, char after) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  out.append(text.data(), result.ptr);
  out += after;
}

/// Samples in one table, readings of encoders in another beside it.
class CsvWriter final : public LogWriter {
 public:
  explicit CsvWriter(const std::string& path) : path_(path), samples_(path) { samples_.write(imu_csv_header(true)); }
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    row_.clear();
    append_imu_csv(1e-6 * static_cast<double>(utime), sample, row_);
    row_.back() = ',';
    if (std::isfinite(celsius_)) append_number(row_, celsius_, '\n');
    if (row_.back() != '\n') row_ += '\n';
    samples_.write(row_);
  }
  void temperature(double celsius) override { celsius_ = celsius; }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    if (!readings_) {
      encoder_path_ = encoder_table_of(path_);
      readings_.emplace(encoder_path_);
      readings_->write("t_s,azimuth_rad,pitch_rad\n");
    }
    row_.clear();
    append_number(row_, 1e-6 * static_cast<double>(utime), ',');
    append_number(row_, azimuth, ',');
    append_number(row_, pitch, '\n');
    readings_->write(row_);
  }
  void commit() override {
    if (readings_) readings_->commit();
    try {
      samples_.commit();
    } catch (...) {
      std::error_code ignored;
      if (readings_) std::filesystem::remove(encoder_path_, ignored);  // both, or neither
      throw;
    }
  }
  [[nodiscard]] std::vector<std::string> files() const override {
    return readings_ ? std::vector<std::string>{path_, encoder_path_} : std::vector<std::string>{path_};
  }

 private:
  std::string path_;
  std::string encoder_path_;
  WholeFile samples_;
  std::optional<WholeFile> readings_;
  std::string row_;
  double celsius_ = std::nan("");
};

}  // namespace

std::string encoder_table_of(const std::string& path) {
  const std::filesystem::path table(path);
  return (table.parent_path() / (table.stem().string() + "_encoder" + table.extension().string())).string();
}

std::string imu_csv_header(bool temperature) {
  return std::string("t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2") +
         (temperature ? ",temperature_deg_c\n" : "\n");
}

void append_imu_csv(double t, const InertialSample<double>& sample, std::string& out) {
  append_number(out, t, ',');
  for (int i = 0; i < 3; ++i) append_number(out, sample.w(i), ',');
  for (int i = 0; i < 3; ++i) append_number(out, sample.f(i), i == 2 ? '\n' : ',');
}

const LogFormat kCsvFormat = {
    "csv",    "table",
    ".csv",   is_text,
    read_csv, [](const std::string& path) -> std::unique_ptr<LogWriter> { return std::make_unique<CsvWriter>(path); }};

}  // namespace trunnion::io
