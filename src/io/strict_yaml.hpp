// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// YAML read strictly: every key must be known, every type right; a fault names the file, the line and the field, and
/// for an unknown key the nearest known one.

#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "trunnion/core/linear.hpp"

namespace trunnion::io {

class StrictYaml {
 public:
  /// Parses a file whose key format is @p format. @throws Error (input)
  static StrictYaml load(const std::string& file, const std::string& format);

  /// The map must have no other keys than these.
  void only(const std::vector<std::string>& known) const;

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] StrictYaml at(const std::string& key) const;  ///< must be there
  [[nodiscard]] StrictYaml at(std::size_t index) const;
  [[nodiscard]] std::size_t length() const;             ///< of a sequence
  [[nodiscard]] std::vector<std::string> keys() const;  ///< of a map

  [[nodiscard]] std::string text() const;
  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] double number_in(double lowest, double highest) const;
  [[nodiscard]] double positive() const;
  [[nodiscard]] long long integer() const;
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_sequence() const { return node_.IsSequence(); }
  [[nodiscard]] bool is_null() const { return node_.IsNull(); }
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] double sigma() const;  ///< not negative; null, "not estimated", reads as zero

  using Scalar = double (StrictYaml::*)() const;
  [[nodiscard]] Vec3<double> vector(Scalar read = &StrictYaml::number) const;
  [[nodiscard]] Mat3<double> matrix(Scalar read = &StrictYaml::number) const;

  [[nodiscard]] double number_or(const std::string& key, double otherwise) const {
    return has(key) ? at(key).number() : otherwise;
  }

  /// Throws the fault of this node.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  StrictYaml(std::string file, std::string field, const YAML::Node& node)
      : file_(std::move(file)), field_(std::move(field)), node_(node) {}
  std::string file_;
  std::string field_;
  YAML::Node node_;
};

/// The entry of @p known with the least edit distance to @p word.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

}  // namespace trunnion::io
