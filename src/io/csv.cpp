// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

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

constexpr std::array<Unit, 4> kTimeUnits = {
    {{"s", "_s", 1.0}, {"ms", "_ms", 1e-3}, {"us", "_us", 1e-6}, {"ns", "_ns", 1e-9}}};
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
};

bool starts_number(const char* p, const char* end) {
  if (p != end && (*p == '+' || *p == '-')) ++p;
  return p != end && ((*p >= '0' && *p <= '9') || *p == '.');
}

class Table {
 public:
  Table(const std::string& path, std::string& digest) : path_(path), text_(read_whole(path)) {
    digest = sha256(text_);
    if (text_.find_first_not_of(" \t\r\n") == std::string::npos) throw input_error(path_, 0, "", "is empty");
    next_ = text_.data();
    end_ = next_ + text_.size();
    if (text_.rfind("\xef\xbb\xbf", 0) == 0) next_ += 3;  // a byte-order mark
    const char* newline = static_cast<const char*>(std::memchr(next_, '\n', static_cast<std::size_t>(end_ - next_)));
    const std::string first(next_, newline != nullptr ? newline : end_);
    separator_ = first.find(',') != std::string::npos ? ',' : first.find(';') != std::string::npos ? ';' : ' ';
    const char* p = first.data();
    while (*p == ' ' || *p == '\t') ++p;
    if (!starts_number(p, first.data() + first.size())) {
      read_header(first);
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
      if (unit == kCounts) {
        const NominalScale<double>& counts = quantity[0] == 'g' ? sheet.counts.gyro : sheet.counts.accel;
        column.si = 1.0 / counts.scale;
        column.zero = counts.zero;
      } else {
        column.si = unit_in_si(quantity, unit);
      }
      if (quantity != "t") column.largest = kLargestReading;
      column.optional = quantity == kTemperature;
      columns_.push_back(column);
      last_ = std::max(last_, column.index);
      if (!column.optional) needed_ = std::max(needed_, column.index);
    }
    cells_.resize(last_ + 1);
  }

  /// Reads the next row; value[i] belongs to the i-th chosen quantity. @return false at the end
  bool row(double* value) {
    while (next_ != end_ && (*next_ == '\n' || *next_ == '\r' || *next_ == '#')) next_line();
    if (next_ == end_) return false;
    ++line_;
    const char* p = next_;
    std::size_t found = 0;
    for (; found <= last_; ++found) {
      while (p != end_ && (*p == ' ' || *p == '\t')) ++p;
      if (p == end_ || *p == '\n' || *p == '\r') break;
      const char* from = *p == '+' ? p + 1 : p;
      const auto [after, error] = std::from_chars(from, end_, cells_[found]);
      const bool number = error == std::errc{};
      p = number ? after : p;
      const char* cell_end = p;
      while (cell_end != end_ && *cell_end != '\n' && *cell_end != '\r' &&
             *cell_end != (separator_ == ' ' ? '\t' : separator_) && (separator_ != ' ' || *cell_end != ' ')) {
        ++cell_end;
      }
      if (!number || std::string_view(p, static_cast<std::size_t>(cell_end - p)).find_first_not_of(" \t") !=
                         std::string_view::npos) {
        const Column* const column = column_at(found);
        cells_[found] = std::nan("");
        if (column != nullptr && !column->optional) {
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
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const double cell = cells_[columns_[i].index];
      if (columns_[i].optional && !(std::abs(cell) < kHottest)) {
        value[i] = std::nan("");
        continue;
      }
      if (!std::isfinite(cell)) throw input_error(path_, line_, columns_[i].quantity, "is not finite");
      value[i] = (cell - columns_[i].zero) * columns_[i].si;
      if (std::abs(value[i]) > columns_[i].largest) {
        throw input_error(path_, line_, columns_[i].quantity, "is beyond any sensor");
      }
    }
    next_ = p;
    skip_rest();
    return true;
  }

  [[nodiscard]] long long line() const { return line_; }
  [[nodiscard]] bool has_header() const { return !names_.empty(); }
  [[nodiscard]] bool has_column(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
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
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end()) {
      throw input_error(
          path_, 1, quantity,
          "no column '" + name + "'" +
              (names_.empty() ? ": the file has no header" : "; nearest is '" + nearest(name, names_) + "'"));
    }
    return static_cast<std::size_t>(at - names_.begin());
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
        throw input_error(path_, 1, name,
                          "the header has no unit: name it one of " + wanted + ", or map it under columns");
      }
    }
    throw input_error(path_, 1, quantity, "no such column: name it one of " + wanted + ", or map it under columns");
  }

  std::string path_;
  std::string text_;
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  char separator_ = ',';
  std::vector<std::string> names_;
  std::vector<Column> columns_;
  std::vector<double> cells_;
  std::size_t last_ = 0;
  std::size_t needed_ = 0;
  long long line_ = 0;
};

std::int64_t to_utime(double t, const Table& table) {
  const double us = t * 1e6;
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
  if (quantity[0] == 'g' || quantity.rfind("accel_", 0) == 0) {
    expected += ", counts";
    fits = fits || unit == kCounts;
  }
  return fits;
}

void read_imu_csv(const std::string& path, const ColumnMap& columns, const SensorSheet& sheet, SampleSink& sink,
                  std::string& digest) {
  Table table(path, digest);
  std::vector<std::string> quantities = {"t"};
  quantities.insert(quantities.end(), kSensors.begin(), kSensors.end());
  const bool has_temperature = columns.count(kTemperature) != 0 || table.has_column("temperature_deg_c");
  if (has_temperature) quantities.emplace_back(kTemperature);
  table.choose(quantities, columns, sheet);
  std::array<double, 8> v{};
  while (table.row(v.data())) {
    if (has_temperature && std::isfinite(v[7])) sink.temperature(v[7]);  // a slow thermometer leaves cells empty
    sink.imu(to_utime(v[0], table), {Vec3<double>(v[1], v[2], v[3]), Vec3<double>(v[4], v[5], v[6])});
  }
}

void read_split_csv(const std::string& gyro_path, const std::string& accel_path, const ColumnMap& columns,
                    const SensorSheet& sheet, SampleSink& sink, std::string& gyro_digest, std::string& accel_digest) {
  Table gyro(gyro_path, gyro_digest);
  Table accel(accel_path, accel_digest);
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
    sink.imu(to_utime(g[0], gyro), {Vec3<double>(g[1], g[2], g[3]), Vec3<double>(a[1], a[2], a[3])});
  }
}

void read_encoder_csv(const std::string& path, const ColumnMap& columns, SampleSink& sink, std::string& digest) {
  Table table(path, digest);
  ColumnMap map;
  for (const char* quantity : {"azimuth", "pitch"}) {
    if (columns.count(quantity) != 0) map[quantity] = columns.at(quantity);
  }
  if (!map.empty() && columns.count("t") != 0) map["t"] = columns.at("t");
  table.choose({"t", "azimuth", "pitch"}, map, SensorSheet{});
  std::array<double, 3> v{};
  while (table.row(v.data())) sink.encoder(to_utime(v[0], table), v[1], v[2]);
}

void read_columns_csv(const std::string& path, const std::vector<std::string>& quantities,
                      const std::function<void(const double*)>& row, std::string& digest) {
  Table table(path, digest);
  table.choose(quantities, {}, SensorSheet{});
  std::vector<double> values(quantities.size());
  while (table.row(values.data())) row(values.data());
}

std::string imu_csv_header() {
  return "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
}

void append_imu_csv(double t, const InertialSample<double>& sample, std::string& out) {
  std::array<char, 32> text{};
  const auto append = [&](double value, char after) {
    const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
    out.append(text.data(), result.ptr);
    out += after;
  };
  append(t, ',');
  for (int i = 0; i < 3; ++i) append(sample.w(i), ',');
  for (int i = 0; i < 3; ++i) append(sample.f(i), i == 2 ? '\n' : ',');
}

}  // namespace trunnion::io
