// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text_table.hpp"

#include <charconv>
#include <cmath>
#include <cstring>

#include "column_units.hpp"
#include "log_formats.hpp"
#include "strict_yaml.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/sample_intake.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kMostColumns = 4096;

/// Whether a column is of that name, alone or after the name of its instrument and a colon.
bool ends_in(const std::string& column, std::string_view name) {
  if (column.size() < name.size() || column.compare(column.size() - name.size(), name.size(), name) != 0) return false;
  return column.size() == name.size() || column[column.size() - name.size() - 1] == ':';
}

bool is_outside_quotes(std::string_view line, char wanted) {
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == wanted && !quoted) return true;
  }
  return false;
}

bool starts_number(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t\""), line.size()));
  if (!line.empty() && (line[0] == '+' || line[0] == '-')) line.remove_prefix(1);
  return !line.empty() && ((line[0] >= '0' && line[0] <= '9') || line[0] == '.');
}

bool is_comment(std::string_view line) { return !line.empty() && (line[0] == '#' || line[0] == '%'); }

char separator_of(std::string_view line) {
  return is_outside_quotes(line, ',') ? ',' : is_outside_quotes(line, ';') ? ';' : ' ';
}

/// Empty ones at the end are none.
std::size_t cells_in(std::string_view line, char separator) {
  const auto parts = [separator](char c) { return c == separator || (separator == ' ' && c == '\t'); };
  std::size_t cells = 0;
  std::size_t filled = 0;
  bool quoted = false;
  bool in_cell = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (!quoted && parts(c)) {
      if (in_cell || separator != ' ') ++cells;
      in_cell = false;
    } else if (c != ' ' && c != '\t' && c != '\r' && c != '\n') {
      in_cell = true;
      filled = cells + 1;
    }
  }
  return filled;
}

constexpr const char* kReturnWithin = "has a carriage return within: lines should end in a line feed";

}  // namespace

TextTable::TextTable(const std::string& path, Sha256* digest) : path_(path), text_(read_whole(path)) {
  if (digest != nullptr) digest->update(text_);
  if (text_.find_first_not_of(" \t\r\n") == std::string::npos) throw input_error(path_, 0, "", "is empty");
  if (is_utf_16(text_)) throw input_error(path_, 0, "", "is a text in UTF-16: save it as UTF-8");
  next_ = text_.data();
  end_ = next_ + text_.size();
  if (std::string_view(text_).substr(0, kByteOrderMark.size()) == kByteOrderMark) next_ += kByteOrderMark.size();
  skip_preamble();
  skip_comments();
  const std::string_view first = current_line();
  separator_ = separator_of(first);
  if (first.substr(0, first.find_last_not_of('\r') + 1).find('\r') != std::string_view::npos)
    throw input_error(path_, line_ + 1, "", kReturnWithin);
  if (!starts_number(first)) {
    read_header(std::string(first));
    header_line_ = line_ + 1;
    next_line();
  }
}

void TextTable::choose(const std::vector<std::string>& quantities, const ColumnMap& map, const SensorSheet& sheet) {
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
    for (const Column& other : columns_) {
      if (other.index == column.index)
        throw input_error(path_, header_line_, quantity, "is of the same column as " + other.quantity);
    }
    column.is_time = quantity == "t";
    if (!column.is_time && quantity != kWeek) column.largest = SampleIntake::kLargestReading;
    column.optional = quantity == kTemperature;
    column.sparse = sparse_ && !column.is_time && quantity != kWeek;
    if (column.sparse) ++sparse_columns_;
    columns_.push_back(column);
    last_ = std::max(last_, column.index);
    if (!column.optional) needed_ = std::max(needed_, column.index);
  }
  cells_.resize(last_ + 1);
}

bool TextTable::row(double* value) {
  while (read_row()) {
    if (sparse_columns_ > 0 && empty_ == sparse_columns_) continue;  // a row of something else
    convert(value);
    return true;
  }
  return false;
}

std::optional<KnownTable> TextTable::known() const {
  for (const HeaderSet& set : header_sets()) {
    if (set.mark != nullptr && preamble_.find(set.mark) == std::string::npos) continue;
    const std::string_view first = set.sensors[0];
    std::optional<KnownTable> found;
    for (const std::string& name : names_) {
      if (!ends_in(name, first)) continue;
      const std::string instrument = name.substr(0, name.size() - first.size());
      const bool all = std::all_of(set.sensors.begin(), set.sensors.end(),
                                   [&](const char* sensor) { return has_column(instrument + sensor); });
      const std::string time = has_column(instrument + set.time) ? instrument + set.time : set.time;
      if (!all || !has_column(time) || (set.week != nullptr && !has_column(set.week))) continue;
      if (found)
        throw input_error(path_, header_line_, name,
                          "is there of '" + found->instrument + "' too: map the columns of one under columns:");
      found = KnownTable{&set, instrument, time};
    }
    if (found) return found;
  }
  return std::nullopt;
}

bool TextTable::read_row() {
  const auto is_blank = [&] {
    const char* p = next_;
    while (p != end_ && (*p == ' ' || *p == '\t' || *p == '\r' || *p == separator_)) ++p;
    return p == end_ || *p == '\n' || *p == '#' || *p == '%';
  };
  while (next_ != end_ && is_blank()) next_line();
  if (next_ == end_) return false;
  ++line_;
  const char* p = next_;
  std::size_t found = 0;
  empty_ = 0;
  bool after_separator = false;
  for (; found <= last_; ++found) {
    while (p != end_ && (*p == ' ' || (*p == '\t' && separator_ == ' '))) ++p;
    if (!after_separator && (p == end_ || *p == '\n' || *p == '\r')) break;
    const bool quoted = p != end_ && *p == '"';
    if (quoted) ++p;
    const char* from = p != end_ && *p == '+' ? p + 1 : p;
    const auto [after, error] = std::from_chars(from, end_, cells_[found]);
    const bool number = error == std::errc{};
    p = number ? after : p;
    if (number && !quoted && p != end_ && *p == separator_ && separator_ != ' ') {  // as it is almost always
      ++p;
      after_separator = true;
      continue;
    }
    const char* const cell_end = end_of_cell(p, quoted);
    if (!number || std::string_view(p, static_cast<std::size_t>(cell_end - p)).find_first_not_of(" \t") !=
                       std::string_view::npos) {
      const Column* const column = column_at(found);
      const bool empty = !number && cell_end == p;
      cells_[found] = empty ? kEmpty : std::nan("");
      if (column != nullptr && column->sparse && empty) {
        ++empty_;
      } else if (column != nullptr && !column->optional) {
        throw input_error(
            path_, line_, column->quantity,
            "should be a number, is '" + printable(std::string(number ? from : p, cell_end)) + "'" +
                (number && *p == ',' && std::count(p, cell_end, ',') == 1 ? ": a decimal comma, where a point is read"
                                                                          : ""));
      }
    }
    p = quoted ? end_of_cell(cell_end, false) : cell_end;
    after_separator = p != end_ && *p == separator_ && separator_ != ' ';
    if (after_separator) ++p;
  }
  if (found <= needed_) {
    throw input_error(
        path_, line_, "",
        "row too short: " + std::to_string(found) + " columns, " + std::to_string(needed_ + 1) + " needed");
  }
  std::fill(cells_.begin() + static_cast<std::ptrdiff_t>(found), cells_.end(), kEmpty);
  next_ = p;
  skip_rest();
  const auto* feed = static_cast<const char*>(std::memchr(p, '\r', static_cast<std::size_t>(next_ - p)));
  while (feed != nullptr && feed != next_ && *feed == '\r') ++feed;
  if (feed != nullptr && feed != next_ && *feed != '\n') throw input_error(path_, line_, "", kReturnWithin);
  if (has_header() && (after_separator || separator_ == ' ')) {
    const std::size_t cells = found + cells_in({p, static_cast<std::size_t>(next_ - p)}, separator_);
    if (cells > names_.size())
      throw input_error(path_, line_, "",
                        "has " + std::to_string(cells) + " cells under a header of " + std::to_string(names_.size()) +
                            ": decimal commas, or names of rows that the header has no name for?");
  }
  return true;
}

const char* TextTable::end_of_cell(const char* p, bool quoted) const {
  for (; p != end_ && *p != '\n' && *p != '\r'; ++p) {
    if (quoted && *p == '"' && p + 1 != end_ && p[1] == '"') {  // a quote within
      ++p;
    } else if (quoted ? *p == '"' : *p == separator_ || (separator_ == ' ' && *p == '\t')) {
      break;
    }
  }
  return p;
}

void TextTable::convert(double* value) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const double cell = cells_[columns_[i].index];
    if (columns_[i].optional) {
      value[i] = cell == kEmpty ? kEmpty : SampleIntake::known_temperature(cell);
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

void TextTable::skip_preamble() {
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

void TextTable::skip_comments() {
  const auto is_empty = [](std::string_view line) { return line.find_first_not_of(" \t\r") == std::string_view::npos; };
  while (next_ != end_ && is_comment(current_line())) {
    const std::string_view line = current_line();
    const char* const from = next_;
    const long long at = line_;
    next_line();
    while (next_ != end_ && is_empty(current_line())) next_line();
    const std::string_view next = current_line();
    const std::string_view names = line.substr(std::min(line.find_first_not_of("#% "), line.size()));
    const bool tabs = separator_of(next) == ' ' && names.find('\t') != std::string_view::npos;
    const char separator = tabs ? '\t' : separator_of(next);
    const std::size_t named = cells_in(names, separator);
    const std::size_t numbers = cells_in(next, separator);
    if (starts_number(next) && (separator == ' ' ? named == numbers : named >= numbers)) {
      next_ = from;
      line_ = at;
      return;
    }
  }
}

std::string_view TextTable::rest_of_line(const char* from) const {
  const auto* newline = static_cast<const char*>(std::memchr(from, '\n', static_cast<std::size_t>(end_ - from)));
  return {from, static_cast<std::size_t>((newline != nullptr ? newline : end_) - from)};
}

void TextTable::skip_rest() {
  const auto* newline = static_cast<const char*>(std::memchr(next_, '\n', static_cast<std::size_t>(end_ - next_)));
  next_ = newline != nullptr ? newline + 1 : end_;
}

void TextTable::next_line() {
  skip_rest();
  ++line_;
}

const TextTable::Column* TextTable::column_at(std::size_t index) const {
  for (const Column& column : columns_) {
    if (column.index == index) return &column;
  }
  return nullptr;
}

void TextTable::read_header(const std::string& line) {
  if (separator_ == ' ' && line.find('\t') != std::string::npos) separator_ = '\t';
  std::string name;
  bool quoted = false;
  const auto end_name = [&] {
    while (!name.empty() && (name.back() == ' ' || name.back() == '\r')) name.pop_back();
    if (is_comment(name)) name.erase(0, name.find_first_not_of("#% "));
    if (separator_ != ' ' || !name.empty()) names_.push_back(name);
    name.clear();
  };
  for (const char c : line) {
    if (c == '"' && (quoted || name.empty())) {
      quoted = !quoted;
    } else if (!quoted && (c == separator_ || (separator_ == ' ' && c == '\t'))) {
      end_name();
    } else if (!(name.empty() && c == ' ')) {
      name += c;
    }
  }
  end_name();
  if (names_.size() > kMostColumns)
    throw input_error(path_, line_ + 1, "", "has more than " + std::to_string(kMostColumns) + " columns");
}

std::size_t TextTable::find(const std::string& name, const std::string& quantity) const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (ends_in(names_[i], name)) places.push_back(i);
  }
  const auto is_whole = [&](std::size_t i) { return names_[i].size() == name.size(); };
  const auto whole = std::find_if(places.begin(), places.end(), is_whole);
  if (whole != places.end()) {
    const bool repeats = quantity == "t" || quantity == kWeek;  // once more beside each instrument
    if (!repeats && std::count_if(places.begin(), places.end(), is_whole) > 1)
      throw input_error(path_, header_line_, quantity, "is there twice, as '" + name + "'");
    return *whole;
  }
  if (places.empty()) {
    throw input_error(
        path_, header_line_, quantity,
        "no column '" + name + "'" +
            (names_.empty() ? ": the file has no header" : "; nearest is '" + printable(nearest(name, names_)) + "'"));
  }
  if (places.size() > 1)
    throw input_error(path_, header_line_, quantity,
                      "is '" + names_[places[0]] + "' and '" + names_[places[1]] + "': write one of them out");
  return places[0];
}

std::string TextTable::find_by_name(const std::string& quantity, std::size_t& index) const {
  const Units units = units_of(quantity);
  std::string wanted;
  const char* unit = nullptr;  // of the column that was found
  const auto look_for = [&](const std::string& name, const char* its_unit) {
    wanted += (wanted.empty() ? "" : ", ") + name;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] != name) continue;
      if (unit != nullptr)
        throw input_error(path_, header_line_, quantity,
                          "is there twice, as '" + names_[index] + "' and '" + name + "': map one under columns:");
      index = i;
      unit = its_unit;
    }
  };
  for (std::size_t i = 0; i < units.count; ++i) look_for(quantity + units.first[i].suffix, units.first[i].name);
  if (quantity == "t") look_for("utime", "us");
  if (unit != nullptr) return unit;
  for (const std::string& name : names_) {
    if (name == quantity) {
      throw input_error(
          path_, header_line_, name,
          "the header has no unit: name it one of " + wanted + ", or map it under columns: in a run file");
    }
  }
  if (names_.empty())
    throw input_error(path_, header_line_, quantity,
                      "no such column: the file has no header; map its columns by index under columns: in a run file");
  NameList own;
  for (const std::string& name : names_) own.add(name);
  throw input_error(path_, header_line_, quantity,
                    "no such column in this header: name it one of " + wanted +
                        ", or map one of its own under columns: in a run file: " + own.text());
}

}  // namespace trunnion::io
