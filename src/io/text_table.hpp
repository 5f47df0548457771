// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rows of numbers from a text with columns: which column is what, by the header, by the user or by the program that
/// wrote it, and each number in SI.

#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "csv_headers.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/sensor_sheet.hpp"

namespace trunnion::io {

constexpr std::string_view kByteOrderMark("\xef\xbb\xbf", 3);

inline bool is_utf_16(std::string_view text) {
  return text.substr(0, 2) == "\xff\xfe" || text.substr(0, 2) == "\xfe\xff";
}

/// A table of a program that is known, and what its columns are called in it.
struct KnownTable {
  const HeaderSet* set;
  std::string instrument;  ///< before each name of a sensor, with its colon, or empty
  std::string time;
};

class TextTable {
 public:
  static constexpr double kEmpty = std::numeric_limits<double>::infinity();  ///< of a temperature: no word of it

  TextTable(const std::string& path, Sha256* digest);
  /// Finds the columns of the quantities, by map or by header. @throws Error naming what is missing
  void choose(const std::vector<std::string>& quantities, const ColumnMap& map, const SensorSheet& sheet);
  /// Reads the next row; value[i] belongs to the i-th chosen quantity. @return false at the end
  bool row(double* value);
  [[nodiscard]] long long line() const { return line_; }
  /// The time of the last row: nanoseconds since 1970 would lose their last digits as seconds.
  [[nodiscard]] double microseconds() const { return microseconds_; }
  [[nodiscard]] bool has_header() const { return !names_.empty(); }
  [[nodiscard]] bool has_column(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Whose export this is, by its names, and of which of its instruments; nothing for nobody's that is known.
  /// @throws Error (input) where two instruments have all of a unit's columns
  [[nodiscard]] std::optional<KnownTable> known() const;
  /// How much of the text has been read, in [0, 1].
  [[nodiscard]] double done() const {
    return static_cast<double>(next_ - text_.data()) / static_cast<double>(text_.size());
  }
  /// From now on a row may lack all of a unit's readings: it is of another instrument.
  void allow_rows_of_others() { sparse_ = true; }

 private:
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

  /// The cells of the next line that is no comment. @return false at the end
  bool read_row();
  /// Its separator, its closing quote, or the end of the line.
  [[nodiscard]] const char* end_of_cell(const char* p, bool quoted) const;
  void convert(double* value);
  /// Lines above the header, as the programs that export tables write them.
  void skip_preamble();
  /// Lines that begin with # or % above the header; one that has a name for each cell of the row below is the header.
  void skip_comments();
  [[nodiscard]] std::string_view rest_of_line(const char* from) const;
  [[nodiscard]] std::string_view current_line() const { return rest_of_line(next_); }
  void skip_rest();
  void next_line();
  const Column* column_at(std::size_t index) const;
  void read_header(const std::string& line);
  /// Of the column of that name, or, where there is one only, of that name after an instrument's and a colon.
  /// @throws Error (input) naming what is near it, or that there are two
  std::size_t find(const std::string& name, const std::string& quantity) const;
  std::string find_by_name(const std::string& quantity, std::size_t& index) const;

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
  int sparse_columns_ = 0;
  int empty_ = 0;  // cells of sparse columns in the last row
  double microseconds_ = 0.0;
  long long line_ = 0;
};

}  // namespace trunnion::io
