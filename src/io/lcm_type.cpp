// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_type.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <limits>

#include "big_endian.hpp"
#include "strict_yaml.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::io {
namespace {

constexpr int kDeepest = 32;              // types within types
constexpr std::size_t kLongest = 100000;  // steps of a reader
constexpr std::size_t kLargestDefinition = std::size_t{1} << 22U;
constexpr std::size_t kMostFiles = 10000;
constexpr long long kLargestDimension = 1LL << 28U;

constexpr std::size_t kMostBytes = std::size_t{1} << 40U;

std::size_t at_most(std::size_t bytes, std::size_t elements) {
  return bytes > kMostBytes / elements ? kMostBytes : bytes * elements;
}

constexpr std::array<const char*, 9> kPrimitives = {"int8_t",  "int16_t", "int32_t", "int64_t", "byte",
                                                    "boolean", "float",   "double",  "string"};

bool is_primitive(const std::string& type) {
  return std::any_of(kPrimitives.begin(), kPrimitives.end(), [&](const char* name) { return type == name; });
}

std::uint64_t stir(std::uint64_t v, char c) {
  const auto down = static_cast<std::uint64_t>(static_cast<std::int64_t>(v) >> 55U);  // the sign comes with it
  return ((v << 8U) ^ down) + static_cast<std::uint64_t>(static_cast<std::int64_t>(static_cast<signed char>(c)));
}

std::uint64_t stir(std::uint64_t v, const std::string& text) {
  v = stir(v, static_cast<char>(text.size()));
  for (const char c : text) v = stir(v, c);
  return v;
}

/// Words, numbers and punctuation of a definition; comments are passed over.
class Tokens {
 public:
  Tokens(std::string_view text, std::string file) : text_(text), file_(std::move(file)) { step(); }

  [[nodiscard]] const std::string& peek() const { return token_; }
  [[nodiscard]] bool at_end() const { return token_.empty(); }
  [[nodiscard]] int line() const { return token_line_; }

  std::string next(const char* expected) {
    if (at_end()) fail(std::string("ends where ") + expected + " should be");
    std::string token = token_;
    step();
    return token;
  }
  bool take(const char* token) {
    if (token_ != token) return false;
    step();
    return true;
  }
  void require(const char* token) {
    if (!take(token)) fail("should have '" + std::string(token) + "' before '" + printable(token_) + "'");
  }
  std::string name(const char* expected) {
    if (at_end()) return next(expected);
    if (std::isalpha(static_cast<unsigned char>(token_[0])) == 0 && token_[0] != '_')
      fail(std::string("should have ") + expected + ", has '" + printable(token_) + "'");
    return next(expected);
  }
  [[noreturn]] void fail(const std::string& what) const { throw input_error(file_, token_line_, "", what); }

 private:
  [[nodiscard]] char at(std::size_t ahead) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  void skip_blank() {
    while (at_ < text_.size()) {
      if (at(0) == '/' && at(1) == '/') {
        while (at_ < text_.size() && at(0) != '\n') ++at_;
      } else if (at(0) == '/' && at(1) == '*') {
        at_ += 2;
        while (at_ < text_.size() && !(at(0) == '*' && at(1) == '/')) line_ += text_[at_++] == '\n' ? 1 : 0;
        at_ = std::min(at_ + 2, text_.size());
      } else if (std::isspace(static_cast<unsigned char>(at(0))) != 0) {
        line_ += text_[at_++] == '\n' ? 1 : 0;
      } else {
        return;
      }
    }
  }
  void step() {
    skip_blank();
    token_.clear();
    token_line_ = line_;
    const auto of_word = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' || c == '+';
    };
    if (at_ >= text_.size()) return;
    if (!of_word(at(0))) {
      token_ = at(0) == '\0' ? "?" : std::string(1, at(0));
      ++at_;
      return;
    }
    while (at_ < text_.size() && of_word(at(0))) token_ += text_[at_++];
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::string token_;
  int token_line_ = 1;
};

std::string in_package(const std::string& package, const std::string& name) {
  return package.empty() || is_primitive(name) || name.find('.') != std::string::npos ? name : package + "." + name;
}

LcmDimension dimension(Tokens& tokens, const LcmStruct& type) {
  LcmDimension d;
  d.text = tokens.next("the size of an array");
  if (std::isdigit(static_cast<unsigned char>(d.text[0])) != 0) {
    d.constant = d.text.size() < 20 ? std::strtoll(d.text.c_str(), nullptr, 0) : 0;
    if (d.constant <= 0 || d.constant > kLargestDimension) tokens.fail("array size '" + d.text + "'");
  } else {
    const auto size = std::find_if(type.members.begin(), type.members.end(),
                                   [&](const LcmMember& member) { return member.name == d.text; });
    if (size == type.members.end() || !size->dimensions.empty() || size->type.rfind("int", 0) != 0)
      tokens.fail("array size '" + printable(d.text) + "' is no integer declared before");
  }
  tokens.require("]");
  return d;
}

LcmStruct structure(Tokens& tokens, const std::string& package, const std::string& file) {
  LcmStruct type{file, tokens.line(), {}};
  tokens.require("{");
  while (!tokens.take("}")) {
    if (tokens.take("const")) {
      while (!tokens.take(";")) static_cast<void>(tokens.next("';'"));
      continue;
    }
    const std::string of = in_package(package, tokens.name("the type of a member"));
    do {
      LcmMember member{tokens.name("the name of a member"), of, {}};
      while (tokens.take("[")) member.dimensions.push_back(dimension(tokens, type));
      type.members.push_back(std::move(member));
    } while (tokens.take(","));
    tokens.require(";");
  }
  return type;
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// "omega[2]" to "omega" and 2; -1 without an index. @return false when the brackets are wrong
bool split_index(std::string& name, long long& index) {
  index = -1;
  const std::size_t bracket = name.find('[');
  if (bracket == std::string::npos) return true;
  const std::string number = name.substr(bracket + 1, name.size() - bracket - 2);
  if (name.back() != ']' || number.empty() || number.size() > 8 ||
      number.find_first_not_of("0123456789") != std::string::npos)
    return false;
  index = std::stoll(number);
  name.resize(bracket);
  return true;
}

}  // namespace

void LcmTypes::add(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    const std::string text = read_whole(path, kLargestDefinition);
    return add_text(text, path);
  }
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator at(path, fs::directory_options::skip_permission_denied, error), end;
       !error && at != end; at.increment(error)) {
    if (at->path().extension() == ".lcm") files.push_back(at->path().string());
    if (files.size() > kMostFiles) throw input_error(path, 0, "", "holds more than 10000 definitions");
  }
  if (error) throw input_error(path, 0, "", "cannot read: " + error.message());
  if (files.empty()) throw input_error(path, 0, "", "holds no .lcm file");
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) add_text(read_whole(file, kLargestDefinition), file);
}

void LcmTypes::add_text(std::string_view text, const std::string& file) {
  Tokens tokens(text, file);
  std::string package;
  while (!tokens.at_end()) {
    if (tokens.take("package")) {
      package = tokens.name("the name of the package");
      tokens.require(";");
    } else if (tokens.take("enum")) {
      while (!tokens.take("}")) static_cast<void>(tokens.next("'}'"));
      tokens.take(";");
    } else if (tokens.take("struct")) {
      const std::string name = in_package(package, tokens.name("the name of the type"));
      if (is_primitive(name)) tokens.fail("'" + name + "' is the name of a primitive type");
      types_[name] = structure(tokens, package, file);
      tokens.take(";");
    } else {
      tokens.fail("should have struct or package, has '" + printable(tokens.peek()) + "'");
    }
  }
}

const LcmStruct& LcmTypes::at(const std::string& type) const {
  const auto found = types_.find(type);
  if (found == types_.end()) {
    throw Error(ExitCode::kInput, "message type '" + printable(type) + "' is not defined" +
                                      (types_.empty() ? "" : "; did you mean '" + nearest(type, names()) + "'?"));
  }
  return found->second;
}

std::uint64_t LcmTypes::fingerprint(const std::string& type) const {
  std::map<std::string, std::optional<std::uint64_t>> known;
  return fingerprint(type, known);
}

std::uint64_t LcmTypes::fingerprint(const std::string& type,
                                    std::map<std::string, std::optional<std::uint64_t>>& known) const {
  const LcmStruct& s = at(type);
  const auto found = known.find(type);
  if (found != known.end()) {
    if (!found->second) throw input_error(s.file, s.line, type, "contains itself");
    return *found->second;
  }
  known[type] = std::nullopt;
  std::uint64_t h = 0x12345678U;
  for (const LcmMember& member : s.members) {
    h = stir(h, member.name);
    if (is_primitive(member.type)) h = stir(h, member.type);
    h = stir(h, static_cast<char>(member.dimensions.size()));
    for (const LcmDimension& d : member.dimensions) {
      h = stir(h, static_cast<char>(d.constant > 0 ? 0 : 1));
      h = stir(h, d.text);
    }
  }
  for (const LcmMember& member : s.members) {
    if (!is_primitive(member.type)) h += fingerprint(member.type, known);
  }
  known[type] = (h << 1U) | (h >> 63U);
  return *known[type];
}

std::vector<std::string> LcmTypes::with_fingerprint(std::uint64_t fingerprint) const {
  std::vector<std::string> found;
  for (const auto& [name, type] : types_) {
    try {
      if (this->fingerprint(name) == fingerprint) found.push_back(name);
    } catch (const Error&) {
      continue;  // a type of a library that is not here cannot be the one
    }
  }
  return found;
}

std::uint64_t fingerprint_of(std::string_view message) { return message.size() >= 8 ? load_u64(message.data()) : 0; }

std::vector<std::string> LcmTypes::names() const {
  std::vector<std::string> names;
  names.reserve(types_.size());
  for (const auto& entry : types_) names.push_back(entry.first);
  return names;
}

LcmFieldReader::LcmFieldReader(const LcmTypes& types, const std::string& type, const std::vector<std::string>& paths)
    : type_(type), fingerprint_(types.fingerprint(type)), field_(paths.size()) {
  std::vector<Wanted> wanted;
  for (std::size_t i = 0; i < paths.size(); ++i) wanted.push_back({i, split(paths[i])});
  compile(types, type, wanted, 0);
  for (Step& step : program_) step.whole = at_most(step.bytes, step.constant);
}

bool LcmFieldReader::primitive_of(const std::string& type, Primitive& primitive) {
  constexpr std::array<Primitive, 9> kOf = {Primitive::kInt8,  Primitive::kInt16,  Primitive::kInt32,
                                            Primitive::kInt64, Primitive::kByte,   Primitive::kBoolean,
                                            Primitive::kFloat, Primitive::kDouble, Primitive::kString};
  for (std::size_t i = 0; i < kPrimitives.size(); ++i) {
    if (type == kPrimitives[i]) {
      primitive = kOf[i];
      return true;
    }
  }
  return false;
}

std::size_t LcmFieldReader::size_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::kInt64:
    case Primitive::kDouble:
      return 8;
    case Primitive::kInt32:
    case Primitive::kFloat:
      return 4;
    case Primitive::kInt16:
      return 2;
    case Primitive::kString:
      return 5;  // a length and the terminating zero
    case Primitive::kInt8:
    case Primitive::kByte:
    case Primitive::kBoolean:
      break;
  }
  return 1;
}

std::int64_t LcmFieldReader::integer(Primitive primitive, const char* p) {
  switch (primitive) {
    case Primitive::kInt64:
      return load_i64(p);
    case Primitive::kInt32:
      return static_cast<std::int32_t>(load_u32(p));
    case Primitive::kInt16:
      return static_cast<std::int16_t>(
          static_cast<std::uint16_t>(static_cast<unsigned char>(p[0]) << 8U | static_cast<unsigned char>(p[1])));
    case Primitive::kByte:
      return static_cast<unsigned char>(*p);
    default:
      return static_cast<signed char>(*p);
  }
}

/// Bytes that nothing is taken from; neighbours become one step.
void LcmFieldReader::skip(std::size_t bytes) {
  if (!program_.empty() && program_.back().operation == Operation::kSkip && program_.back().counters.empty() &&
      program_.back().constant == 1) {
    program_.back().bytes += bytes;
    return;
  }
  Step step;
  step.bytes = bytes;
  program_.push_back(step);
}

void LcmFieldReader::compile(const LcmTypes& types, const std::string& type, const std::vector<Wanted>& wanted,
                             int depth) {
  const LcmStruct& s = types.at(type);
  if (depth > kDeepest || program_.size() > kLongest) throw input_error(s.file, s.line, type, "is too deep");
  for (const Wanted& w : wanted) {
    std::string name = w.path.empty() ? "" : w.path.front();
    long long index = -1;
    const bool whole = split_index(name, index);
    const auto found =
        std::find_if(s.members.begin(), s.members.end(), [&](const LcmMember& member) { return member.name == name; });
    if (!whole || found == s.members.end()) {
      std::string fields;
      for (const LcmMember& member : s.members) fields += (fields.empty() ? "" : ", ") + member.name;
      throw Error(ExitCode::kInput, "message type '" + type + "' has no field '" +
                                        printable(w.path.empty() ? "" : w.path.front()) + "'; it has: " + fields);
    }
  }
  std::map<std::string, std::size_t> counters;
  for (const LcmMember& member : s.members) compile_member(types, member, wanted, counters, depth);
}

void LcmFieldReader::compile_member(const LcmTypes& types, const LcmMember& member, const std::vector<Wanted>& wanted,
                                    std::map<std::string, std::size_t>& counters, int depth) {
  Step step;
  for (const LcmDimension& d : member.dimensions) {
    if (d.constant > 0) {
      const auto constant = static_cast<std::size_t>(d.constant);
      if (step.constant > kMostBytes / constant) throw Error(ExitCode::kInput, type_ + ": array too large");
      step.constant *= constant;
    } else {
      step.counters.push_back(counters.at(d.text));
    }
  }
  std::vector<Wanted> inside;
  for (const Wanted& w : wanted) {
    std::string name = w.path.front();
    long long index = -1;
    split_index(name, index);
    if (name != member.name) continue;
    if (w.path.size() > 1) {
      if (index >= 0) throw Error(ExitCode::kInput, "'" + w.path.front() + "': an index may stand at the end only");
      inside.push_back({w.field, {w.path.begin() + 1, w.path.end()}});
    } else {
      step.captures.push_back({w.field, index});
    }
  }
  if (!primitive_of(member.type, step.primitive)) {
    if (!step.captures.empty())
      throw Error(ExitCode::kInput, "'" + member.name + "' is no number but a " + member.type + ": name a field of it");
    const std::size_t loop = program_.size();
    step.operation = Operation::kLoop;
    program_.push_back(step);
    const std::size_t before = program_.size();
    compile(types, member.type, inside, depth + 1);
    if (program_.size() == before) {  // a type without members takes no bytes
      program_.pop_back();
      return;
    }
    for (std::size_t i = before; i < program_.size(); ++i) {
      if (program_[i].counters.empty())
        program_[loop].bytes = at_most(program_[loop].bytes + at_most(program_[i].bytes, program_[i].constant), 1);
      if (program_[i].operation == Operation::kLoop) i = program_[i].target - 1;
    }
    Step end;
    end.operation = Operation::kEnd;
    end.target = loop;
    program_.push_back(end);
    program_[loop].target = program_.size();
    return;
  }
  if (!inside.empty())
    throw Error(ExitCode::kInput, "'" + member.name + "' is a " + member.type + " and has no fields");
  step.bytes = size_of(step.primitive);
  for (const Capture& capture : step.captures) {
    if (capture.index >= 0 && step.counters.empty() && static_cast<std::size_t>(capture.index) >= step.constant) {
      throw Error(ExitCode::kInput, "'" + member.name + "' has " + std::to_string(step.constant) + " elements, not " +
                                        std::to_string(capture.index + 1));
    }
    field_[capture.field].kind = step.primitive == Primitive::kString ? Kind::kText
                                 : step.primitive == Primitive::kDouble || step.primitive == Primitive::kFloat
                                     ? Kind::kReal
                                     : Kind::kInteger;
  }
  if (step.primitive == Primitive::kString) {
    step.operation = Operation::kTexts;
  } else if (member.dimensions.empty() && member.type.rfind("int", 0) == 0) {
    // any integer may be a count of arrays to come
    step.operation = Operation::kCount;
    step.counter = counters[member.name] = counter_.size();
    counter_.push_back(0);
  } else if (!step.captures.empty()) {
    step.operation = Operation::kTake;
  } else if (step.counters.empty()) {
    return skip(step.bytes * step.constant);
  }
  program_.push_back(step);
}

/// Elements of a step: false when a count is negative or they cannot fit into @p left bytes.
bool LcmFieldReader::elements(const Step& step, std::size_t left, std::size_t& count) const {
  count = step.constant;
  if (step.counters.empty()) return step.whole <= left;
  const std::size_t most = left / step.bytes;
  for (const std::size_t counter : step.counters) {
    const std::int64_t n = counter_[counter];
    if (n < 0) return false;
    if (n == 0) {
      count = 0;
      return true;
    }
    if (count > most / static_cast<std::size_t>(n)) return false;
    count *= static_cast<std::size_t>(n);
  }
  return count <= most;
}

void LcmFieldReader::take(const Step& step, const Capture& capture, const char* from, std::size_t count) {
  Field& field = field_[capture.field];
  std::size_t first = 0;
  if (capture.index >= 0) {
    first = static_cast<std::size_t>(capture.index);
    if (first >= count) return;
    count = first + 1;
  }
  const char* p = from + first * step.bytes;
  if (step.primitive == Primitive::kDouble || step.primitive == Primitive::kFloat) {
    std::size_t at = field.real.size();
    field.real.resize(at + count - first);
    for (std::size_t i = first; i < count; ++i, p += step.bytes)
      field.real[at++] = step.primitive == Primitive::kDouble ? load_double(p) : static_cast<double>(load_float(p));
  } else {
    std::size_t at = field.integer.size();
    field.integer.resize(at + count - first);
    for (std::size_t i = first; i < count; ++i, p += step.bytes) field.integer[at++] = integer(step.primitive, p);
  }
}

bool LcmFieldReader::read(std::string_view message) {
  for (Field& field : field_) {
    field.integer.clear();
    field.real.clear();
    field.text.clear();
  }
  turns_left_.clear();
  if (message.size() < 8 || fingerprint_of(message) != fingerprint_) return false;
  const char* p = message.data() + 8;
  const char* const end = message.data() + message.size();
  const auto left = [&] { return static_cast<std::size_t>(end - p); };
  for (std::size_t at = 0; at < program_.size(); ++at) {
    const Step& step = program_[at];
    std::size_t count = 0;
    if (step.operation == Operation::kEnd) {
      if (--turns_left_.back() > 0) {
        at = step.target;
      } else {
        turns_left_.pop_back();
      }
      continue;
    }
    if (!elements(step, left(), count)) return false;
    switch (step.operation) {
      case Operation::kSkip:
        p += step.bytes * count;
        break;
      case Operation::kCount: {
        const std::int64_t value = integer(step.primitive, p);
        counter_[step.counter] = value;
        for (const Capture& capture : step.captures) field_[capture.field].integer.push_back(value);
        p += step.bytes;
        break;
      }
      case Operation::kTake:
        for (const Capture& capture : step.captures) take(step, capture, p, count);
        p += step.bytes * count;
        break;
      case Operation::kTexts:
        for (std::size_t i = 0; i < count; ++i) {
          if (left() < 4) return false;
          const std::size_t length = load_u32(p);  // the terminating zero is one of them
          p += 4;
          if (length == 0 || length > left() || p[length - 1] != '\0') return false;
          for (const Capture& capture : step.captures) {
            if (capture.index < 0 || static_cast<std::size_t>(capture.index) == i)
              field_[capture.field].text.emplace_back(p, length - 1);
          }
          p += length;
        }
        break;
      case Operation::kLoop:
        if (count == 0) {
          at = step.target - 1;
        } else {
          turns_left_.push_back(count);
        }
        break;
      case Operation::kEnd:
        break;
    }
  }
  return p == end;
}

}  // namespace trunnion::io
