// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "strict_yaml.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kLargestYaml = std::size_t{1} << 22U;
constexpr int kDeepestNesting = 100;

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// Flow nesting deeper than any file of ours: yaml-cpp recurses, and would run out of stack.
bool too_deep(const std::string& text) {
  int depth = 0;
  std::size_t indent = 0;
  std::size_t dashes = 0;
  bool line_start = true;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == '\n') {
      line_start = true;
      indent = 0;
      dashes = 0;
    } else if (line_start && (c == ' ' || c == '-' || c == '?' || c == ':')) {
      ++indent;
      dashes += c == ' ' ? 0 : 1;
    } else {
      line_start = false;
    }
    if (depth > kDeepestNesting || indent > 4096 || dashes > static_cast<std::size_t>(kDeepestNesting)) return true;
  }
  return false;
}

/// The line of what follows a first document; 0: nothing. By the marks at the beginning of lines: yaml-cpp loads the
/// first alone, and does not end on all texts when it is to load all.
long long second_document(std::string_view text) {
  const auto is_mark = [](std::string_view line, std::string_view mark) {
    return line.substr(0, 3) == mark && (line.size() == 3 || line.find_first_of(" \t\r") == 3);
  };
  long long number = 0;
  bool content = false;
  bool ended = false;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    ++number;
    const bool begins = is_mark(line, "---");
    const bool ends = is_mark(line, "...");
    const std::size_t first = line.find_first_not_of(" \t\r", begins || ends ? 3 : 0);
    const bool says = first != std::string_view::npos && line[first] != '#' && line[0] != '%';
    if (content && (begins || (ended && says))) return number;
    ended = ended || (ends && content);
    content = content || says;
  }
  return 0;
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::string::npos;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

StrictYaml StrictYaml::load(const std::string& file, const std::string& format) {
  std::error_code unknown;
  if (std::filesystem::file_size(file, unknown) > kLargestYaml && !unknown)
    throw input_error(file, 0, "", "is larger than any " + format + ": a recording is named in a run file");
  const std::string text = read_whole(file, kLargestYaml);
  if (too_deep(text)) throw input_error(file, 0, "", "is nested too deep");
  if (const long long line = second_document(text))
    throw input_error(file, line, "", "begins another document: " + format + " is a file of its own");
  try {
    const YAML::Node node = YAML::Load(text);
    if (!node.IsMap()) throw input_error(file, 1, "", "is not a YAML map of keys, as " + format + " is");
    StrictYaml root(file, "", node);
    const std::string found = root.at("format").text();
    if (found != format) root.at("format").fail("should be " + format + ", is " + found);
    return root;
  } catch (const YAML::Exception& e) {
    throw input_error(file, e.mark.line + 1, "", "not YAML, as " + format + " is: " + printable(e.msg));
  }
}

void StrictYaml::fail(const std::string& what) const { throw input_error(file_, node_.Mark().line + 1, field_, what); }

void StrictYaml::only(const std::vector<std::string>& known) const {
  if (!node_.IsMap()) fail("should be a map of keys");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    const std::string field = field_.empty() ? key : field_ + "." + key;
    const long long line = entry.first.Mark().line + 1;
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw input_error(file_, line, field, "unknown key; did you mean '" + nearest(key, known) + "'?");
    }
    if (!seen.insert(key).second) throw input_error(file_, line, field, "stands twice");
  }
}

bool StrictYaml::has(const std::string& key) const { return node_.IsMap() && node_[key].IsDefined(); }

StrictYaml StrictYaml::at(const std::string& key) const {
  const std::string field = field_.empty() ? key : field_ + "." + key;
  if (!node_.IsMap()) fail("should be a map with the key '" + key + "'");
  const YAML::Node child = node_[key];
  if (!child.IsDefined()) throw input_error(file_, node_.Mark().line + 1, field, "is missing");
  return {file_, field, child};
}

StrictYaml StrictYaml::at(std::size_t index) const {
  return {file_, field_ + "[" + std::to_string(index) + "]", node_[index]};
}

std::size_t StrictYaml::length() const {
  if (!node_.IsSequence()) fail("should be a list");
  return node_.size();
}

std::vector<std::string> StrictYaml::keys() const {
  if (!node_.IsMap()) fail("should be a map of keys");
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) fail("has a key that is not a word");
    keys.push_back(entry.first.Scalar());
  }
  return keys;
}

std::string StrictYaml::text() const {
  if (!node_.IsScalar()) fail("should be a text");
  return node_.Scalar();
}

bool StrictYaml::is_number() const {
  if (!node_.IsScalar() || node_.Tag() == "!") return false;  // "!" marks a quoted text
  const std::string& word = node_.Scalar();
  double value = 0.0;
  const char* first = word.data() + (!word.empty() && word[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

double StrictYaml::number() const {
  if (!is_number())
    fail("should be a number, is '" + (node_.IsScalar() ? node_.Scalar() : std::string("not one")) + "'");
  const std::string& word = node_.Scalar();
  double value = 0.0;
  std::from_chars(word.data() + (word[0] == '+' ? 1 : 0), word.data() + word.size(), value);
  if (!std::isfinite(value)) fail("is not finite");
  return value;
}

double StrictYaml::number_in(double lowest, double highest) const {
  const double value = number();
  if (value < lowest || value > highest) {
    char range[64];
    std::snprintf(range, sizeof range, "should lie in [%g, %g], is %g", lowest, highest, value);
    fail(range);
  }
  return value;
}

double StrictYaml::positive() const {
  const double value = number();
  if (value <= 0.0) fail("should be positive");
  return value;
}

long long StrictYaml::integer() const {
  const double value = number();
  if (value != std::floor(value) || std::abs(value) > 9e15) fail("should be a whole number");
  return static_cast<long long>(value);
}

double StrictYaml::sigma() const {
  if (is_null()) return 0.0;
  const double value = number();
  if (value < 0.0) fail("is a sigma, and negative");
  return value;
}

Vec3<double> StrictYaml::vector(Scalar read) const {
  if (length() != 3) fail("should be a list of three numbers");
  Vec3<double> v;
  for (std::size_t i = 0; i < 3; ++i) v(static_cast<Eigen::Index>(i)) = (at(i).*read)();
  return v;
}

Mat3<double> StrictYaml::matrix(Scalar read) const {
  if (length() != 3) fail("should be three rows of three numbers");
  Mat3<double> M;
  for (std::size_t i = 0; i < 3; ++i) M.row(static_cast<Eigen::Index>(i)) = at(i).vector(read).transpose();
  return M;
}

}  // namespace trunnion::io
