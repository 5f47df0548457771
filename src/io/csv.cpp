// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "column_units.hpp"
#include "log_formats.hpp"
#include "text_table.hpp"
#include "trunnion/core/gps_time.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr long long kRowsBetween = 65536;  // two words of progress
constexpr double kCounterWraps = 65536.0;  // samples: a counter of 16 bits, or one that never does

std::int64_t to_utime(double us, const TextTable& table) {
  if (!(std::abs(us) < 9e18)) throw input_error(table.path(), table.line(), "t", "is beyond any clock");
  return static_cast<std::int64_t>(std::llround(us));
}

}  // namespace

void read_split_csv(const std::string& gyro_path, const std::string& accel_path, const ColumnMap& columns,
                    const SensorSheet& sheet, SampleSink& sink, std::string& gyro_digest, std::string& accel_digest) {
  Sha256 gyro_sha;
  Sha256 accel_sha;
  TextTable gyro(gyro_path, &gyro_sha);
  TextTable accel(accel_path, &accel_sha);
  gyro_digest = gyro_sha.finish();
  accel_digest = accel_sha.finish();
  ColumnMap map = columns;
  // without a header: time in seconds, then counts of x, y, z
  const auto by_default = [&](const TextTable& table, const std::string& quantity, int index, const char* unit) {
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
      const TextTable& longer = more_gyro ? gyro : accel;
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
  TextTable table(path, &sha);
  digest = sha.finish();
  table.choose(quantities, {}, SensorSheet{});
  std::vector<double> values(quantities.size());
  while (table.row(values.data())) row(values.data());
}

namespace {

/// The user's columns, and for the rest those of a program that is known, where the names are not our own.
ColumnMap columns_of(const TextTable& table, const LogRequest& request, std::optional<KnownTable>& known) {
  ColumnMap map = request.columns;
  if (std::none_of(kSensors.begin(), kSensors.end(), [&](const char* s) { return map.count(s) != 0; }))
    known = table.known();
  if (!known) return map;
  const HeaderSet& set = *known->set;
  if (map.count("t") == 0) {
    map["t"] = {known->time, -1, set.time_unit};
    if (set.week != nullptr) map[kWeek] = {set.week, -1, "weeks"};
  }
  for (std::size_t i = 0; i < kSensors.size(); ++i)
    map[kSensors[i]] = {known->instrument + set.sensors[i], -1, i < 3 ? set.rate_unit : set.force_unit};
  return map;
}

LogLosses read_csv(const LogRequest& request, SampleSink& sink) {
  TextTable table(request.path, request.digest);
  std::optional<KnownTable> known;
  ColumnMap map = columns_of(table, request, known);
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
  if (known) table.allow_rows_of_others();
  table.choose(quantities, map, request.channels.sheet);
  const ColumnChoice time = map.count("t") != 0 ? map.at("t") : ColumnChoice{};
  const double wraps_at = time.unit == kSamples               ? 1e6 * kCounterWraps / request.channels.sheet.rate_hz
                          : known && time.name == known->time ? 1e6 * known->set->wraps_at * unit_in_si("t", time.unit)
                                                              : 0.0;
  double wrapped = 0.0;
  double last = 0.0;
  bool warm = false;  // a temperature was told, and holds
  long long rows = 0;
  long long without_week = 0;
  std::vector<double> v(quantities.size());
  while (table.row(v.data())) {
    if (request.progress && rows % kRowsBetween == 0) request.progress(table.done());
    ++rows;
    if (week > 0 && v[week] == 0.0) {
      ++without_week;
      continue;
    }
    const double t = table.microseconds();
    if (wraps_at > 0.0 && rows > 1 && last - t > 0.5 * wraps_at) wrapped += wraps_at;
    last = t;
    const std::int64_t utime =
        to_utime(t + wrapped + (week > 0 ? 1e6 * (static_cast<double>(kGpsEpoch) + v[week]) : 0.0), table);
    if (temperature > 0 && v[temperature] != TextTable::kEmpty) {  // a slow one leaves cells empty
      const bool was_warm = std::exchange(warm, std::isfinite(v[temperature]));
      if (warm || was_warm) sink.temperature(v[temperature]);
    }
    if (request.need_imu) sink.imu(utime, {Vec3<double>(v[1], v[2], v[3]), Vec3<double>(v[4], v[5], v[6])});
    if (request.need_encoder) sink.encoder(utime, v[angles], v[angles + 1]);
  }
  if (rows == 0) throw input_error(request.path, 0, "", "has no row of numbers");
  LogLosses losses;
  if (without_week > 0)
    losses.note = std::to_string(without_week) + " rows of GPS week 0, before the time was known, are left out";
  return losses;
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

/// The seconds that are nearest to the stamp, of which any reader makes the same microseconds.
void append_time(std::string& out, std::int64_t utime) {
  std::array<char, 32> text{};
  const double seconds = static_cast<double>(utime) / 1e6;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), seconds, std::chars_format::fixed);
  out.append(text.data(), result.ptr);
  out += ',';
}

/// Samples in one table, readings of encoders in another beside it.
class CsvWriter final : public LogWriter {
 public:
  explicit CsvWriter(const std::string& path) : path_(path), samples_(path) {
    samples_.write(
        "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,temperature_deg_c\n");
  }
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    row_.clear();
    append_time(row_, utime);
    for (int i = 0; i < 3; ++i) append_number(row_, sample.w(i), ',');
    for (int i = 0; i < 3; ++i) append_number(row_, sample.f(i), ',');
    if (told_) {
      append_number(row_, celsius_, '\n');
    } else {
      row_ += '\n';
    }
    samples_.write(row_);
  }
  void temperature(double celsius) override {
    celsius_ = celsius;
    told_ = true;
  }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    if (!readings_) {
      encoder_path_ = encoder_table_of(path_);
      readings_.emplace(encoder_path_);
      readings_->write("t_s,azimuth_rad,pitch_rad\n");
    }
    row_.clear();
    append_time(row_, utime);
    append_number(row_, azimuth, ',');
    append_number(row_, pitch, '\n');
    readings_->write(row_);
  }
  void commit() override {
    if (readings_) {
      readings_->settle();
      samples_.settle();
      samples_.remove_old();  // killed here, one half is missing: better than of another recording
      readings_->commit();
    }
    samples_.commit();
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
  double celsius_ = 0.0;  // "nan" once it is known no more
  bool told_ = false;
};

}  // namespace

std::string encoder_table_of(const std::string& path) {
  const std::filesystem::path table(path);
  return (table.parent_path() / (table.stem().string() + "_encoder" + table.extension().string())).string();
}

const LogFormat kCsvFormat = {
    "csv",
    "table",
    ".csv",
    is_text,
    read_csv,
    [](const std::string& path) -> std::unique_ptr<LogWriter> { return std::make_unique<CsvWriter>(path); },
    encoder_table_of};

}  // namespace trunnion::io
