// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Message definitions of other people (.lcm files), read at run time: their fingerprints, and readers that take fields
/// out of messages by path, without generated code.
///
///   fingerprint = rotl(h(type) + sum over nested members of fingerprint(nested), 1)                   ... (1)
///
/// with h over the members' names, primitive types and dimensions. It does not know the type's own name: types of the
/// same members share it.

#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trunnion::io {

/// One dimension of a member: a number, or the name of an earlier member that holds it.
struct LcmDimension {
  std::string text;        ///< as written: it is part of the fingerprint
  long long constant = 0;  ///< 0: variable
};

struct LcmMember {
  std::string name;
  std::string type;  ///< a primitive, or a full name "package.type"
  std::vector<LcmDimension> dimensions;
};

struct LcmStruct {
  std::string file;
  int line = 0;
  std::vector<LcmMember> members;
};

/// The definitions known.
class LcmTypes {
 public:
  /// Reads a .lcm file, or every one below a folder. A type defined again with the same members is fine.
  /// @throws Error (input) naming file, line and what was expected
  void add(const std::string& path);

  /// The same from text; @p file is for messages.
  void add_text(std::string_view text, const std::string& file);

  /// @throws Error (input) for a type that is not defined, with the nearest name
  [[nodiscard]] const LcmStruct& at(const std::string& type) const;

  /// Eq. (1). @throws Error (input) when the type or one within it is not defined, or contains itself
  [[nodiscard]] std::uint64_t fingerprint(const std::string& type) const;

  /// Names of the types with this fingerprint; those that cannot be computed are left out.
  [[nodiscard]] std::vector<std::string> with_fingerprint(std::uint64_t fingerprint) const;

  [[nodiscard]] std::vector<std::string> names() const;

 private:
  /// @param known what was computed already; nothing for a type that is being computed
  std::uint64_t fingerprint(const std::string& type, std::map<std::string, std::optional<std::uint64_t>>& known) const;
  std::map<std::string, LcmStruct> types_;
};

/// The fingerprint that a message begins with; zero for one that is too short.
std::uint64_t fingerprint_of(std::string_view message);

/// Takes the fields at some paths out of messages of one type. A path goes through nested types and arrays of them:
/// "header.stamp.sec", "raw_imu.delta_rotation" (all of them, in order), "omega[2]" (one of an array).
///
/// read() is bounded by the message: a count that does not fit into what is left ends it, nothing is allocated by a
/// count alone.
class LcmFieldReader {
 public:
  enum class Kind { kInteger, kReal, kText };

  /// @throws Error (input) for a path that is not there, with the fields that are
  LcmFieldReader(const LcmTypes& types, const std::string& type, const std::vector<std::string>& paths);

  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }
  [[nodiscard]] Kind kind(std::size_t path) const { return field_[path].kind; }

  /// @return false when the message is not of the type, is cut short or too long, or a count in it is negative
  bool read(std::string_view message);

  /// What the last read() found at path number @p path; integers are exact, texts are views into the message.
  [[nodiscard]] const std::vector<std::int64_t>& integers(std::size_t path) const { return field_[path].integer; }
  [[nodiscard]] const std::vector<double>& reals(std::size_t path) const { return field_[path].real; }
  [[nodiscard]] const std::vector<std::string_view>& texts(std::size_t path) const { return field_[path].text; }

 private:
  enum class Primitive : std::uint8_t { kInt8, kInt16, kInt32, kInt64, kByte, kBoolean, kFloat, kDouble, kString };
  enum class Operation : std::uint8_t { kSkip, kCount, kTake, kTexts, kLoop, kEnd };

  struct Capture {
    std::size_t field;
    long long index;  ///< of a run: this element only; negative: all
  };
  struct Step {
    Operation operation = Operation::kSkip;
    Primitive primitive = Primitive::kInt8;
    std::vector<Capture> captures;
    std::size_t counter = 0;            ///< where a count is kept
    std::size_t bytes = 0;              ///< of an element, at least
    std::size_t constant = 1;           ///< elements: constant * the counters
    std::size_t whole = 0;              ///< bytes of them, where there is no counter
    std::vector<std::size_t> counters;  ///< ...
    std::size_t target = 0;             ///< of a loop: behind its end; of an end: its loop
  };
  struct Field {
    Kind kind = Kind::kReal;
    std::vector<std::int64_t> integer;
    std::vector<double> real;
    std::vector<std::string_view> text;
  };
  struct Wanted {
    std::size_t field;
    std::vector<std::string> path;  ///< what is left of it
  };

  static bool primitive_of(const std::string& type, Primitive& primitive);
  static std::size_t size_of(Primitive primitive);
  static std::int64_t integer(Primitive primitive, const char* p);
  void compile(const LcmTypes& types, const std::string& type, const std::vector<Wanted>& wanted, int depth);
  void compile_member(const LcmTypes& types, const LcmMember& member, const std::vector<Wanted>& wanted,
                      std::map<std::string, std::size_t>& counters, int depth);
  void skip(std::size_t bytes);
  void take(const Step& step, const Capture& capture, const char* from, std::size_t count);
  [[nodiscard]] bool elements(const Step& step, std::size_t left, std::size_t& count) const;

  std::string type_;
  std::uint64_t fingerprint_ = 0;
  std::vector<Step> program_;
  std::vector<Field> field_;
  std::vector<std::int64_t> counter_;
  std::vector<std::size_t> turns_left_;  // of the open loops
};

}  // namespace trunnion::io
