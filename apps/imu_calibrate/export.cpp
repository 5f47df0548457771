// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include "../imu_correct/corrector.hpp"
#include "../outputs.hpp"
#include "../terminal.hpp"
#include "command.hpp"
#include "export_target.hpp"
#include "recordings.hpp"
#include "trunnion/error_model/flash_block.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/export_format.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/whole_file.hpp"

namespace trunnion::app {
namespace {

struct Options {
  std::string calibration;
  std::string format = "c";
  std::string output;
  std::string block;
  std::string sheet;
  std::string name = "calibration";
  int recording = 0;
  int bits = 16;
  int fraction = 6;
  bool float_only = false;
  TargetOptions target;
};

/// What is exported: the block, and what the header says about it.
struct Content {
  FlashBlock block;
  UnitOutput<double> error_bound{};
  UnitScale<double> scale;
  InertialUnit<double> unit;

  /// Terms of temperature that the coefficients do not carry.
  [[nodiscard]] bool beyond_second_order() const { return !unit.thermal.is_quadratic_bias(); }
  /// ... or anything else that the unit itself has and they have not.
  [[nodiscard]] bool needs_unit() const {
    return beyond_second_order() || !unit.accel_place.isZero(0.0) ||
           (unit.thermal.order() > 0 && std::isfinite(unit.thermal.lowest));
  }
};

/// printf into @p out.
__attribute__((format(printf, 2, 3))) void add(std::string& out, const char* format, ...) {
  std::array<char, 400> line{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line.data(), line.size(), format, arguments);
  va_end(arguments);
  out += line.data();
}

void add(std::string& out, const kernel::Triple<float>& v) {
  add(out, "{%aF, %aF, %aF}", static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}
void add(std::string& out, const kernel::Matrix<float>& A) {
  out += "{";
  add(out, A.x);
  out += ", ";
  add(out, A.y);
  out += ", ";
  add(out, A.z);
  out += "}";
}
void add(std::string& out, const UnitCorrection<float>::Axes& axes) {
  out += "{";
  add(out, axes.A);
  for (const auto* v : {&axes.c, &axes.c_1, &axes.c_2}) {
    out += ",\n     ";
    add(out, *v);
  }
  out += "}";
}
void add(std::string& out, const UnitCorrection<float>::Bend& bend) {
  out += "{";
  add(out, bend.A);
  out += ",\n     ";
  add(out, bend.half_asymmetry);
  out += ", ";
  add(out, bend.quadratic);
  out += ", ";
  add(out, bend.cubic);
  out += "}";
}
void add(std::string& out, const CountCoefficients::Row& row) {
  add(out, "{%" PRId32 ", %" PRId32 ", %" PRId32 "}", row[0], row[1], row[2]);
}
void add(std::string& out, const std::array<CountCoefficients::Axis, 3>& axes) {
  out += "{{";
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto& a = axes[i];
    add(out, "%s{%" PRId64 "LL, %" PRId64 "LL, %" PRId64 "LL,\n      ", i == 0 ? "" : ",\n     ", a.c, a.c_1, a.c_2);
    add(out, a.A);
    out += ", ";
    add(out, a.H);
    add(out, ", %" PRId32 ", %" PRId32 "}", a.quadratic, a.cubic);
  }
  out += "}}";
}

/// A name as it may stand in a line of comment: a backslash at its end would join the next.
std::string in_comment(const std::string& name) {
  std::string text = io::printable(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  return text;
}

/// What UnitCorrection does not carry: the unit itself, for StreamCorrection.
std::string unit_of_header(const InertialUnit<double>& unit, const UnitScale<double>& scale) {
  std::string out;
  out +=
      "// For StreamCorrection<float>(unit(), scale()): all orders of temperature, its range, and the size effect.\n";
  out += "inline trunnion::InertialUnit<float> unit() {\n  trunnion::InertialUnit<float> u;\n";
  const auto vector = [&](const std::string& of, const Vec3<double>& v) {
    if (!v.isZero(0.0)) add(out, "  u.%s << %aF, %aF, %aF;\n", of.c_str(), v.x(), v.y(), v.z());
  };
  const auto matrix = [&](const std::string& of, const Mat3<double>& M) {
    if (M.isZero(0.0)) return;
    add(out, "  u.%s << %aF, %aF, %aF, %aF, %aF, %aF, %aF, %aF, %aF;\n", of.c_str(), M(0, 0), M(0, 1), M(0, 2), M(1, 0),
        M(1, 1), M(1, 2), M(2, 0), M(2, 1), M(2, 2));
  };
  for (const auto& [name, triad] : {std::pair{"gyro", &unit.gyro}, std::pair{"accel", &unit.accel}}) {
    const std::string of = name;
    vector(of + ".bias", triad->bias);
    matrix(of + ".M", triad->M);
    vector(of + ".asymmetry", triad->asymmetry);
    vector(of + ".quadratic", triad->quadratic);
    vector(of + ".cubic", triad->cubic);
  }
  matrix("g_sensitivity", unit.g_sensitivity);
  add(out, "  u.thermal.reference = %aF;\n", unit.thermal.reference);
  if (std::isfinite(unit.thermal.lowest))
    add(out, "  u.thermal.lowest = %aF;\n  u.thermal.highest = %aF;\n", unit.thermal.lowest, unit.thermal.highest);
  for (std::size_t k = 0; k < unit.thermal.bias.size(); ++k) {
    const std::string at = "[" + std::to_string(k) + "]";
    vector("thermal.bias" + at + ".w", unit.thermal.bias[k].w);
    vector("thermal.bias" + at + ".f", unit.thermal.bias[k].f);
    vector("thermal.scale" + at + ".w", unit.thermal.scale[k].w);
    vector("thermal.scale" + at + ".f", unit.thermal.scale[k].f);
  }
  add(out, "  return u;\n}\ninline trunnion::UnitScale<float> scale() { return {{%aF, %aF}, {%aF, %aF}}; }\n",
      scale.gyro.scale, scale.gyro.zero, scale.accel.scale, scale.accel.zero);
  return out;
}

std::string header_of(const Content& content, const Options& o, const std::string& digest) {
  const FlashBlock& block = content.block;
  std::string out;
  add(out, "// Written by %s from %s,\n// SHA-256 %s. Do not edit.\n", tool_name().c_str(),
      in_comment(o.calibration).c_str(), digest.c_str());
  add(out, "// Unit: %s\n", in_comment(block.name.data()).c_str());
  if (o.recording > 0) add(out, "// Turn-on bias: recording %d\n", o.recording);
  out += "#pragma once\n// clang-format off\n\n#include \"trunnion/error_model/count_correction.hpp\"\n";
  out += content.needs_unit() ? "#include \"trunnion/error_model/stream_correction.hpp\"\n\n"
                              : "#include \"trunnion/error_model/inertial_unit.hpp\"\n\n";
  add(out, "namespace %s {\n\n", o.name.c_str());
  if (block.has_counts != 0) {
    add(out,
        "// For raw counts: rate [rad/s] = (count - %.17g) / %.17g, specific force [m/s^2] = (count - %.17g) / "
        "%.17g.\n",
        content.scale.gyro.zero, content.scale.gyro.scale, content.scale.accel.zero, content.scale.accel.scale);
  } else {
    out += "// For readings in rad/s and m/s^2.\n";
  }
  if (content.needs_unit()) out += unit_of_header(content.unit, content.scale);
  if (!content.beyond_second_order()) {
    out += "inline constexpr trunnion::UnitCorrection<float>::Coefficients kUnit = {\n    ";
    add(out, block.unit.accel);
    out += ",\n    ";
    add(out, block.unit.gyro);
    out += ",\n    ";
    add(out, block.unit.H);
    out += ",\n    ";
    add(out, block.unit.accel_bend);
    out += ",\n    ";
    add(out, block.unit.gyro_bend);
    add(out, ",\n    %aF, %aF};\n", static_cast<double>(block.unit.reference),
        static_cast<double>(block.unit.is_linear));
  }
  if (block.has_counts == 1) {
    const double per_count = static_cast<double>(1LL << o.fraction);
    add(out, "\n// Readings of %d bits in, corrected counts of 1/%lld out: SI = out / kGyroScale, out / kAccelScale.\n",
        o.bits, 1LL << o.fraction);
    add(out, "// Largest error against exact arithmetic, in counts out: gyros %.3f, accelerometers %.3f.\n",
        *std::max_element(content.error_bound.begin(), content.error_bound.begin() + 3),
        *std::max_element(content.error_bound.begin() + 3, content.error_bound.end()));
    add(out, "inline constexpr double kGyroScale = %.17g;   // counts out per rad/s\n",
        content.scale.gyro.scale * per_count);
    add(out, "inline constexpr double kAccelScale = %.17g;  // counts out per m/s^2\n",
        content.scale.accel.scale * per_count);
    out += "inline constexpr trunnion::CountCoefficients kCounts = {\n    ";
    add(out, block.counts.gyro);
    out += ",\n    ";
    add(out, block.counts.accel);
    add(out, ",\n    %" PRId32 ", %d, %d, %" PRId32 ", 0};\n", block.counts.reference, block.counts.bits,
        block.counts.shift, block.counts.is_linear);
  }
  add(out, "\n}  // namespace %s\n", o.name.c_str());
  return out;
}

/// Whether the sheet's counts can be those of a register of --bits.
void hold_against_sheet(const io::CalibrationFile& file, const io::SensorSheet& sheet, const Options& o) {
  if (!file.model.empty() && !sheet.model.empty() && file.model != sheet.model) {
    std::fprintf(stderr, "%s: is a sheet of %s, the calibration is of %s\n", o.sheet.c_str(),
                 io::printable(sheet.model).c_str(), io::printable(file.model).c_str());
  }
  check_counts(sheet, o.sheet, o.bits);
}

/// What count_calibration() refuses, in words.
std::string why_not(const InertialUnit<double>& unit, const UnitScale<double>& scale, const Options& o) {
  if (o.bits + o.fraction > 30)
    return "--bits and --fraction are " + std::to_string(o.bits + o.fraction) + " together, at most 30";
  std::string why = "does not fit the integer path (--float-only leaves it out):";
  const double full_scale = std::ldexp(1.0, o.bits - 1);
  const auto judge = [&](const char* name, const Triad<double>& triad, const NominalScale<double>& counts) {
    const double range = full_scale / counts.scale;
    const Mat3<double> A = triad.matrix().inverse();
    const double row = A.cwiseAbs().rowwise().sum().maxCoeff();
    const double zero =
        (A * (counts.scale * triad.bias + Vec3<double>::Constant(counts.zero))).cwiseAbs().maxCoeff() / full_scale;
    const double bend =
        (triad.quadratic.cwiseAbs() * std::abs(range) + triad.cubic.cwiseAbs() * range * range).maxCoeff();
    if (!(row < 1.99))
      why += std::string(" a row of the ") + name + "' inverse matrix sums to " + figure(row, 4) + ", at most 1.99;";
    if (!(zero < 1.0))
      why += std::string(" bias and zero of the ") + name + " are " + figure(zero, 3) + " of full scale, at most 1;";
    if (!(bend < 1.0 / 512.0))
      why += std::string(" the ") + name + "' nonlinearity is " + figure(100.0 * bend, 3) + " % of " +
             figure(std::abs(range), 4) + ", at most 0.195;";
  };
  judge("gyros", unit.gyro, scale.gyro);
  judge("accelerometers", unit.accel, scale.accel);
  if (!unit.gyro.asymmetry.isZero(0.0) || !unit.accel.asymmetry.isZero(0.0)) why += " an asymmetry is float only;";
  if (!unit.thermal.is_quadratic_bias()) why += " temperature is more than the biases' first and second order;";
  if (why.back() == ':')
    why += " g-sensitivity above an eighth of a count by a count, or all of it together too large;";
  why.pop_back();
  return why;
}

Content content_of(const io::CalibrationFile& file, const Options& o) {
  Content content;
  const InertialUnit<double> unit = io::unit_of(file, o.calibration, o.recording);
  if (!o.sheet.empty()) {
    const io::SensorSheet sheet = io::read_sensor_sheet(o.sheet);
    content.scale = sheet.counts;
    hold_against_sheet(file, sheet, o);
    content.block.has_counts = o.float_only ? 2 : 1;
    if (!o.float_only) {
      const auto made = count_calibration(unit, content.scale, o.bits, o.fraction);
      if (!made.ok()) throw io::input_error(o.calibration, 0, "", why_not(unit, content.scale, o));
      content.block.counts = made.value().coefficients;
      content.error_bound = made.value().error_bound;
    }
  }
  content.unit = unit;
  if (content.beyond_second_order() && !o.block.empty())
    throw io::input_error(o.calibration, 0, "temperature",
                          "a block holds the biases' first and second order, and here a scale moves too, or a bias "
                          "beyond that: write a header");
  const auto& thermal = unit.thermal;
  if (!content.beyond_second_order() && thermal.order() > 0 && std::isfinite(thermal.lowest))
    std::fprintf(stderr, "%s: was calibrated from %s to %s degC; the coefficients do not stop there, unit() does\n",
                 o.calibration.c_str(), figure(thermal.lowest, 4).c_str(), figure(thermal.highest, 4).c_str());
  if (!unit.accel_place.isZero(0.0)) {
    std::fprintf(stderr,
                 "%s: the size effect is not in the coefficients: up to %s m/s^2 at 1 rad/s; "
                 "StreamCorrection<float>(unit(), scale()) takes it\n",
                 o.calibration.c_str(), figure(unit.accel_place.colwise().norm().maxCoeff(), 2).c_str());
  }
  content.block.unit = UnitCorrection<float>(unit, content.scale).coefficients();
  const std::string name = file.model + (file.serial.empty() ? "" : " " + file.serial);
  if (!o.block.empty() && name.size() >= content.block.name.size())
    std::fprintf(stderr, "%s: the block holds 31 bytes of model and serial\n", o.calibration.c_str());
  std::memcpy(content.block.name.data(), name.data(), std::min(name.size(), content.block.name.size() - 1));
  content.block.seal();
  return content;
}

void export_calibration(const Options& o) {
  if (o.output.empty() && o.block.empty())
    throw Error(ExitCode::kUsage, "export: name an --output, a --block, or both");
  const std::string digest = io::sha256(io::read_whole(o.calibration));
  const Content content = content_of(io::read_calibration_file(o.calibration), o);
  if (!o.output.empty()) {
    io::write_whole(o.output, header_of(content, o, digest));
    std::printf("%s: header, %s\n", o.output.c_str(), content.block.has_counts == 1 ? "float and counts" : "float");
  }
  if (!o.block.empty()) {
    io::write_whole(o.block, {reinterpret_cast<const char*>(&content.block), sizeof(content.block)});
    std::printf("%s: flash block of version %u, %zu bytes, CRC %08x\n", o.block.c_str(), content.block.version,
                sizeof(content.block), content.block.crc);
  }
}

/// The extension of what another format writes: a --format that was forgotten.
void check_extension(const std::string& output, const std::string& format) {
  const std::string extension = std::filesystem::path(output).extension().string();
  const std::vector<io::ExportFormat>& others = io::export_formats();
  const bool header = extension == ".hpp" || extension == ".h";
  const bool of_another = std::any_of(others.begin(), others.end(),
                                      [&](const io::ExportFormat& other) { return extension == other.extension; });
  if (format == "c" ? of_another : header)
    throw Error(ExitCode::kUsage, output + ": --format " + format + " writes no " + extension);
}

/// What no namespace can be called: the words of C++17.
constexpr std::array<std::string_view, 73> kCppWords = {
    "alignas",  "alignof",  "and",     "and_eq",  "asm",       "auto",      "bitand",       "bitor",     "bool",
    "break",    "case",     "catch",   "char",    "class",     "compl",     "const",        "constexpr", "const_cast",
    "continue", "decltype", "default", "delete",  "do",        "double",    "dynamic_cast", "else",      "enum",
    "explicit", "export",   "extern",  "false",   "float",     "for",       "friend",       "goto",      "if",
    "inline",   "int",      "long",    "mutable", "namespace", "new",       "noexcept",     "not",       "not_eq",
    "nullptr",  "operator", "or",      "or_eq",   "private",   "protected", "public",       "register",  "return",
    "short",    "signed",   "sizeof",  "static",  "struct",    "switch",    "template",     "this",      "throw",
    "true",     "try",      "typedef", "union",   "unsigned",  "using",     "virtual",      "void",      "volatile",
    "while"};

/// A C++ name, by parts. @return what is wrong, or empty
std::string check_namespace(const std::string& text) {
  std::string_view rest(text);
  for (bool more = true; more;) {
    const std::size_t end = rest.find("::");
    const std::string_view part = rest.substr(0, end);
    more = end != std::string_view::npos;
    rest.remove_prefix(more ? end + 2 : rest.size());
    const bool named =
        !part.empty() && (part[0] < '0' || part[0] > '9') && std::all_of(part.begin(), part.end(), [](char c) {
          return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        });
    if (!named || std::find(kCppWords.begin(), kCppWords.end(), part) != kCppWords.end())
      return "should be a C++ namespace";
  }
  return "";
}

}  // namespace

void add_export(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("export", "Write a calibration for firmware, or for another program");
  auto o = std::make_shared<Options>();
  std::vector<std::string> formats = target_names();
  formats.insert(formats.begin(), "c");
  command->add_option("calibration", o->calibration, "Calibration file")->required();
  command->add_option("--format", o->format, "c: a header of constexpr coefficients" + target_titles())
      ->capture_default_str()
      ->check(CLI::IsMember(formats));
  command->add_option("-o,--output", o->output, "File to write");
  auto* block = command->add_option("--block", o->block,
                                    "Binary block for flash to write, little-endian, with version and CRC-32");
  auto* sheet = command->add_option("--sheet", o->sheet,
                                    "Sensor sheet. c: with the scale of raw counts, readings are counts then, and the "
                                    "coefficients of the integer path are written too; others: noise and rate");
  auto* bits = command->add_option("--bits", o->bits, "Of a raw count, sign included")
                   ->capture_default_str()
                   ->check(CLI::Range(2, 30))
                   ->needs(sheet);
  auto* fraction = command
                       ->add_option("--fraction", o->fraction,
                                    "Binary digits behind the point of a corrected count; with --bits at most 30")
                       ->capture_default_str()
                       ->check(CLI::Range(0, 28))
                       ->needs(sheet);
  auto* float_only =
      command->add_flag("--float-only", o->float_only, "With --sheet: the coefficients of the float path alone")
          ->needs(sheet);
  command->add_option("--recording", o->recording, "Use the turn-on bias of this recording, from 1; default the mean")
      ->check(CLI::Range(1, 1000));
  auto* name = command->add_option("--namespace", o->name, "Of the header's names")
                   ->capture_default_str()
                   ->check(CLI::Validator(check_namespace, "NAME"));
  auto* rate = command
                   ->add_option("--rate-deg-per-s", o->target.rate_deg_per_s,
                                "Other programs: at which the size of what they cannot say is stated")
                   ->capture_default_str()
                   ->check(CLI::PositiveNumber);
  auto* gyro_id =
      command->add_option("--gyro-id", o->target.gyro_id, "px4, ardupilot: of the gyros, CAL_GYRO0_ID or INS_GYR_ID")
          ->check(CLI::Range(1LL, 2147483647LL));
  auto* accel_id = command
                       ->add_option("--accel-id", o->target.accel_id,
                                    "px4, ardupilot: of the accelerometers, CAL_ACC0_ID or INS_ACC_ID")
                       ->check(CLI::Range(1LL, 2147483647LL));
  command->footer(
      "Example:\n  imu_calibrate export calibration.yaml --format kalibr -o imu.yaml\n  imu_calibrate export "
      "calibration.yaml --sheet sheet.yaml --bits 16 -o calibration.hpp --block "
      "calibration.bin");
  const std::vector<CLI::Option*> of_c = {block, bits, fraction, float_only, name};
  auto* instance =
      command->add_option("--instance", o->target.instance, "px4, ardupilot: which of the vehicle's units, from 0")
          ->check(CLI::Range(0, 2));
  const std::vector<CLI::Option*> of_vehicles = {gyro_id, accel_id, instance};
  command->callback([o, of_c, of_vehicles, rate, &exit_code] {
    const auto refuse = [&](const CLI::Option* option, const char* owner) {
      if (option->count() > 0) throw Error(ExitCode::kUsage, option->get_name() + " is for --format " + owner);
    };
    if (o->format == "c") {
      if (rate->count() > 0) throw Error(ExitCode::kUsage, "--rate-deg-per-s is for the formats of other programs");
    } else {
      for (const CLI::Option* option : of_c) refuse(option, "c");
    }
    if (o->format != "px4" && o->format != "ardupilot") {
      for (const CLI::Option* option : of_vehicles) refuse(option, "px4 or ardupilot");
    }
    check_outputs({o->output, o->block}, {o->calibration, o->sheet});
    check_extension(o->output, o->format);
    if (o->format == "c") {
      export_calibration(*o);
    } else {
      TargetOptions target = o->target;
      target.calibration = o->calibration;
      target.format = o->format;
      target.output = o->output;
      target.sheet = o->sheet;
      target.recording = o->recording;
      export_to_target(target);
    }
    exit_code = ExitCode::kDone;
  });
}

}  // namespace trunnion::app
