// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Each target's own formula, written here a second time from what its reader computes, with the numbers of the file.

#include "trunnion/io/export_format.hpp"

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "matchers/draw.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/units.hpp"

namespace trunnion::io {
namespace {

using Sample = InertialSample<double>;
using Target = std::function<Sample(const Sample&)>;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRate = 100.0 * kRadPerDeg;

/// A unit as a MEMS one errs, with installation of @p installed rad, and nothing that only some targets can say.
InertialUnit<double> linear_unit(unsigned seed, double installed = 0.05) {
  Draw draw(seed);
  InertialUnit<double> unit;
  for (Triad<double>* triad : {&unit.gyro, &unit.accel}) {
    triad->bias = draw.vector(triad == &unit.gyro ? 0.01 : 0.2);
    const Mat3<double> A = (Mat3<double>::Identity() + draw.matrix(0.01)) * rotation_exp(draw.vector(installed));
    triad->M = A - Mat3<double>::Identity();
  }
  return unit;
}

InertialUnit<double> full_unit(unsigned seed) {
  InertialUnit<double> unit = linear_unit(seed);
  Draw draw(seed + 1000);
  unit.g_sensitivity = draw.matrix(2e-5);
  unit.gyro.cubic = draw.vector(1e-4);
  unit.gyro.asymmetry = draw.vector(1e-4);
  unit.accel.quadratic = draw.vector(1e-5);
  return unit;
}

Exported exported(const char* format, const InertialUnit<double>& unit) {
  ExportRequest request;
  request.unit = unit;
  request.name = "MODEL 1";
  request.notes = {"a note"};
  return export_format(format).make(request);
}

/// Largest error of a target's correction against the true input, of rates and forces in its axes.
Sample worst(const InertialUnit<double>& unit, const Target& target, const Mat3<double>& C_tb, unsigned seed) {
  Draw draw(seed);
  Sample most;
  for (int i = 0; i < 200; ++i) {
    const Sample input{draw.vector(kRate), draw.vector(2.0 * kStandardGravity)};
    const Sample got = target(unit.distort(input));
    most.w = most.w.cwiseMax((got.w - C_tb * input.w).cwiseAbs());
    most.f = most.f.cwiseMax((got.f - C_tb * input.f).cwiseAbs());
  }
  return most;
}

Mat3<double> matrix_of(const YAML::Node& node) {
  Mat3<double> M;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) M(i, k) = node[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)].as<double>();
  }
  return M;
}

/// Three numbers of a line of comment: "#   gyro [rad/s]: [a, b, c]".
Vec3<double> vector_after(const std::string& text, const std::string& label) {
  const std::size_t at = text.find('[', text.find(label) + label.size());
  std::istringstream in(text.substr(at + 1));
  Vec3<double> v;
  char comma = 0;
  in >> v(0) >> comma >> v(1) >> comma >> v(2);
  EXPECT_TRUE(in) << label;
  return v;
}

bool is_lower(const Mat3<double>& M) { return M(0, 1) == 0.0 && M(0, 2) == 0.0 && M(1, 2) == 0.0; }

void figure_of(const char* format, const Sample& error) {
  std::printf("[ FIGURE   ] export %s: against its own formula %.1e deg/s, %.1e m/s^2\n", format,
              error.w.maxCoeff() / kRadPerDeg, error.f.maxCoeff());
}

/// Kalibr, IccSensors: f = M a + b, w = M_g C_gyro_i w + A (C_gyro_i a) + b.
Target kalibr_of(const std::string& text) {
  const YAML::Node imu = YAML::Load(text);
  EXPECT_EQ(imu["model"].as<std::string>(), "scale-misalignment");
  const Mat3<double> M_a = matrix_of(imu["accelerometers"]["M"]);
  const Mat3<double> M_g = matrix_of(imu["gyroscopes"]["M"]);
  const Mat3<double> C = matrix_of(imu["gyroscopes"]["C_gyro_i"]);
  const Mat3<double> A = matrix_of(imu["gyroscopes"]["A"]);
  EXPECT_TRUE(is_lower(M_a) && is_lower(M_g));
  EXPECT_LT((C * C.transpose() - Mat3<double>::Identity()).norm(), 1e-14);
  EXPECT_GT(C.determinant(), 0.0);
  const Vec3<double> b_g = vector_after(text, "gyro [rad/s]:");
  const Vec3<double> b_a = vector_after(text, "accelerometer [m/s^2]:");
  return [=](const Sample& y) {
    Sample x;
    x.f = M_a.inverse() * (y.f - b_a);
    x.w = (M_g * C).inverse() * (y.w - b_g - A * (C * x.f));
    return x;
  };
}

/// OpenVINS, Propagator: only the lower triangle of each D = T^-1 is kept.
Target openvins_of(const std::string& text) {
  EXPECT_EQ(text.rfind("%YAML:1.0\n", 0), 0U);
  // OpenCV's reader wants the items of a list deeper than its key, and takes a comment behind a name for a part of it
  std::istringstream lines(text);
  std::size_t key = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (line[indent] == '-') {
      EXPECT_GT(indent, key) << line;
    } else {
      key = indent;
    }
    EXPECT_TRUE(line[0] == '#' || line.find('#') == std::string::npos) << line;
  }
  const YAML::Node imu = YAML::Load(text.substr(text.find('\n')))["imu0"];
  EXPECT_EQ(imu["model"].as<std::string>(), "kalibr");
  const Mat3<double> D_w = matrix_of(imu["Tw"]).inverse().triangularView<Eigen::Lower>();
  const Mat3<double> D_a = matrix_of(imu["Ta"]).inverse().triangularView<Eigen::Lower>();
  const Mat3<double> R_gyro = matrix_of(imu["R_IMUtoGYRO"]).transpose();
  const Mat3<double> R_acc = matrix_of(imu["R_IMUtoACC"]).transpose();
  const Mat3<double> T_g = matrix_of(imu["Tg"]);
  const Vec3<double> b_g = vector_after(text, "gyro [rad/s]:");
  const Vec3<double> b_a = vector_after(text, "accelerometer [m/s^2]:");
  return [=](const Sample& y) {
    Sample x;
    x.f = R_acc * D_a * (y.f - b_a);
    x.w = R_gyro * D_w * (y.w - b_g - T_g * x.f);
    return x;
  };
}

/// imu_calib: SM raw - bias.
Target ros_of(const std::string& text) {
  const YAML::Node node = YAML::Load(text);
  EXPECT_EQ(node["SM"].size(), 9U);
  EXPECT_EQ(node["bias"].size(), 3U);
  Mat3<double> SM;
  Vec3<double> bias;
  for (std::size_t i = 0; i < 9; ++i) SM(static_cast<int>(i) / 3, static_cast<int>(i) % 3) = node["SM"][i].as<double>();
  for (std::size_t i = 0; i < 3; ++i) bias(static_cast<int>(i)) = node["bias"][i].as<double>();
  return [=](const Sample& y) { return Sample{y.w, SM * y.f - bias}; };
}

using Parameters = std::map<std::string, float>;

/// Lines of five fields behind tabs, as QGroundControl takes them; 9 is a single-precision number.
Parameters px4_parameters(const std::string& text) {
  Parameters all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> fields;
    std::istringstream cells(line);
    for (std::string field; std::getline(cells, field, '\t');) fields.push_back(field);
    EXPECT_EQ(fields.size(), 5U) << line;
    EXPECT_EQ(fields[4], fields[2].rfind("CAL_", 0) == 0 && fields[2].find("_ID") == std::string::npos ? "9" : "6")
        << line;
    all[fields[2]] = std::stof(fields[3]);
  }
  return all;
}

/// "NAME,VALUE", as Mission Planner takes them.
Parameters ardupilot_parameters(const std::string& text) {
  Parameters all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t comma = line.find(',');
    EXPECT_NE(comma, std::string::npos) << line;
    all[line.substr(0, comma)] = std::stof(line.substr(comma + 1));
  }
  return all;
}

/// (data - offset) scale, in single precision; the gyros have no scale.
Target autopilot_of(const Parameters& p, const std::string& offset, const std::string& scale, const std::string& gyro,
                    bool axis_first) {
  using Vec3f = Eigen::Vector3f;
  Vec3f o;
  Vec3f s;
  Vec3f g;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "XYZ"[i]);
    const auto name = [&](const std::string& of) {
      return axis_first ? of.substr(0, of.find('*')) + axis + of.substr(of.find('*') + 1) : of + axis;
    };
    o(i) = p.at(name(offset));
    s(i) = p.at(name(scale));
    g(i) = p.at(name(gyro));
  }
  return [=](const Sample& y) {
    const Vec3f f = (y.f.cast<float>() - o).cwiseProduct(s);
    const Vec3f w = y.w.cast<float>() - g;
    return Sample{w.cast<double>(), f.cast<double>()};
  };
}

Target px4_of(const std::string& text) {
  return autopilot_of(px4_parameters(text), "CAL_ACC0_*OFF", "CAL_ACC0_*SCALE", "CAL_GYRO0_*OFF", true);
}
Target ardupilot_of(const std::string& text) {
  return autopilot_of(ardupilot_parameters(text), "INS_ACCOFFS_", "INS_ACCSCAL_", "INS_GYROFFS_", false);
}

/// C (in - B), single precision.
Target vectornav_of(const std::string& text) {
  std::map<int, std::array<float, 12>> registers;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    EXPECT_EQ(line.back(), '\r');
    EXPECT_LT(line.size(), 256U) << "the unit's buffer";
    const std::size_t star = line.find('*');
    int sum = 0;
    for (std::size_t i = 1; i < star; ++i) sum ^= line[i];
    EXPECT_EQ(std::stoi(line.substr(star + 1, 2), nullptr, 16), sum) << line;
    if (line.rfind("$VNWRG,", 0) != 0) continue;
    std::istringstream cells(line.substr(7, star - 7));
    std::string cell;
    std::getline(cells, cell, ',');
    std::array<float, 12>& numbers = registers[std::stoi(cell)];
    for (float& number : numbers) {
      std::getline(cells, cell, ',');
      number = std::stof(cell);
    }
    EXPECT_TRUE(cells.eof());
  }
  const auto apply = [registers](int number, const Vec3<double>& in_) {
    const std::array<float, 12>& r = registers.at(number);
    Eigen::Matrix3f C;
    C << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    const Eigen::Vector3f B(r[9], r[10], r[11]);
    return Vec3<double>((C * (in_.cast<float>() - B)).cast<double>());
  };
  return [apply](const Sample& y) { return Sample{apply(84, y.w), apply(25, y.f)}; };
}

Target json_of(const std::string& text) {
  const auto tree = nlohmann::json::parse(text);
  const auto vector = [](const nlohmann::json& j) { return Vec3<double>(j[0], j[1], j[2]); };
  const auto matrix = [&](const nlohmann::json& j) {
    Mat3<double> M;
    for (std::size_t i = 0; i < 3; ++i) M.row(static_cast<int>(i)) = vector(j[i]).transpose();
    return M;
  };
  struct Numbers {
    Vec3<double> b, a, q, c;
    Mat3<double> A;
  };
  const auto numbers = [&](const char* name) {
    const auto& t = tree[name];
    return Numbers{vector(t["bias"]), vector(t["asymmetry"]), vector(t["quadratic"]), vector(t["cubic"]),
                   matrix(t["inverse_matrix"])};
  };
  const Numbers g = numbers("gyroscope");
  const Numbers a = numbers("accelerometer");
  const Mat3<double> H = matrix(tree["g_sensitivity"]);
  const auto straight = [](const Numbers& n, const Vec3<double>& y) {
    Vec3<double> u = n.A * (y - n.b);
    for (int step = 0; step < 8; ++step) {
      Vec3<double> bend;
      for (int i = 0; i < 3; ++i)
        bend(i) = std::abs(u(i)) * n.a(i) / 2.0 + u(i) * u(i) * n.q(i) + u(i) * u(i) * u(i) * n.c(i);
      u = n.A * (y - n.b - bend);
    }
    return u;
  };
  return [=](const Sample& y) {
    Sample x;
    x.f = straight(a, y.f);
    x.w = straight(g, y.w - H * x.f);
    return x;
  };
}

/// The file with its numbers at @p celsius, by its own equation.
std::string json_at(const std::string& text, double celsius) {
  auto tree = nlohmann::json::parse(text);
  const auto& thermal = tree["temperature"];
  const double t = std::min(std::max(celsius, thermal["lowest"].get<double>()), thermal["highest"].get<double>()) -
                   thermal["reference"].get<double>();
  for (const std::string sensor : {"gyroscope", "accelerometer"}) {
    auto& numbers = tree[sensor];
    Mat3<double> A;
    for (std::size_t i = 0; i < 3; ++i) {
      double power = 1.0;
      for (std::size_t k = 0; k < thermal[sensor + "_bias"].size(); ++k) {
        power *= t;
        numbers["bias"][i] = numbers["bias"][i].get<double>() + power * thermal[sensor + "_bias"][k][i].get<double>();
        numbers["matrix"][i][i] =
            numbers["matrix"][i][i].get<double>() + power * thermal[sensor + "_scale"][k][i].get<double>();
      }
      for (std::size_t j = 0; j < 3; ++j)
        A(static_cast<int>(i), static_cast<int>(j)) = numbers["matrix"][i][j].get<double>();
    }
    const Mat3<double> inverse = A.inverse();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        numbers["inverse_matrix"][i][j] = inverse(static_cast<int>(i), static_cast<int>(j));
    }
  }
  return tree.dump();
}

TEST(Export, TemperatureAndPlacesWithJson) {
  Draw draw(11);
  InertialUnit<double> unit = full_unit(4);
  unit.thermal.reference = 25.0;
  unit.thermal.lowest = -20.0;
  unit.thermal.highest = 60.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = std::pow(0.02, static_cast<double>(k + 1));
    unit.thermal.bias[k] = {draw.vector(0.01 * size), draw.vector(0.1 * size)};
    unit.thermal.scale[k] = {draw.vector(0.01 * size), draw.vector(0.01 * size)};
  }
  unit.accel_place = draw.matrix(0.02);
  const std::string text = exported("json", unit).text;
  for (const double celsius : {-40.0, -20.0, 0.0, 25.0, 60.0, 85.0}) {
    const Sample error = worst(unit.at(celsius), json_of(json_at(text, celsius)), Mat3<double>::Identity(), 1);
    EXPECT_LT(error.w.maxCoeff(), 1e-14) << celsius;
    EXPECT_LT(error.f.maxCoeff(), 1e-13) << celsius;
  }
  EXPECT_GT(worst(unit.at(60.0), json_of(text), Mat3<double>::Identity(), 1).f.maxCoeff(), 1e-3) << "it matters";
  const auto places = nlohmann::json::parse(text)["accelerometer"]["place"];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_EQ(places[i][j].get<double>(), unit.accel_place(static_cast<int>(j), static_cast<int>(i)));
  }
}

TEST(Export, FullMatricesWithKalibr) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    InertialUnit<double> unit = linear_unit(seed, 0.5);
    unit.g_sensitivity = Draw(seed + 7).matrix(2e-5);
    const Exported out = exported("kalibr", unit);
    const Sample error = worst(unit, kalibr_of(out.text), out.C_tb, seed);
    EXPECT_LT(error.w.maxCoeff(), 1e-13);
    EXPECT_LT(error.f.maxCoeff(), 1e-12);
    const Mat3<double> T = matrix_of(YAML::Load(out.text)["T_i_b"]);
    EXPECT_LT((T - out.C_tb).norm(), 1e-15);
    if (seed == 1) figure_of("kalibr", error);
  }
}

TEST(Export, FullMatricesWithOpenVins) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    InertialUnit<double> unit = linear_unit(seed, 0.5);
    unit.g_sensitivity = Draw(seed + 7).matrix(2e-5);
    const Sample error = worst(unit, openvins_of(exported("openvins", unit).text), Mat3<double>::Identity(), seed);
    EXPECT_LT(error.w.maxCoeff(), 1e-13);
    EXPECT_LT(error.f.maxCoeff(), 1e-12);
    if (seed == 1) figure_of("openvins", error);
  }
}

TEST(Export, AccelerometersWithRos) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const InertialUnit<double> unit = linear_unit(seed);
    const Sample error = worst(unit, ros_of(exported("ros", unit).text), Mat3<double>::Identity(), seed);
    EXPECT_LT(error.f.maxCoeff(), 1e-12);
    if (seed == 1) figure_of("ros (accelerometers)", {Vec3<double>::Zero(), error.f});
  }
}

TEST(Export, OffsetsAndScalesWithAutopilots) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    InertialUnit<double> unit = linear_unit(seed, 0.0);
    unit.gyro.M.setZero();  // what the two can say
    unit.accel.M = Mat3<double>(unit.accel.M.diagonal().asDiagonal());
    for (const char* format : {"px4", "ardupilot"}) {
      const std::string text = exported(format, unit).text;
      const Target target = std::string(format) == "px4" ? px4_of(text) : ardupilot_of(text);
      const Sample error = worst(unit, target, Mat3<double>::Identity(), seed);
      EXPECT_LT(error.w.maxCoeff(), 4.0 * 6e-8 * kRate);
      EXPECT_LT(error.f.maxCoeff(), 4.0 * 6e-8 * 4.0 * kStandardGravity);
      if (seed == 1) figure_of(format, error);
    }
  }
}

TEST(Export, MatricesWithVectorNav) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const InertialUnit<double> unit = linear_unit(seed);
    const Sample error = worst(unit, vectornav_of(exported("vectornav", unit).text), Mat3<double>::Identity(), seed);
    EXPECT_LT(error.w.maxCoeff(), 8.0 * 6e-8 * kRate);
    EXPECT_LT(error.f.maxCoeff(), 8.0 * 6e-8 * 4.0 * kStandardGravity);
    if (seed == 1) figure_of("vectornav", error);
  }
}

TEST(Export, EverythingWithJson) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const InertialUnit<double> unit = full_unit(seed);
    const Sample error = worst(unit, json_of(exported("json", unit).text), Mat3<double>::Identity(), seed);
    EXPECT_LT(error.w.maxCoeff(), 1e-14);
    EXPECT_LT(error.f.maxCoeff(), 1e-13);
    if (seed == 1) figure_of("json", error);
  }
}

TEST(Export, SaysItsOwnFormula) {
  // what omissions() judges with is what the file makes its reader compute
  const std::map<std::string, Target (*)(const std::string&)> readers = {
      {"kalibr", kalibr_of},       {"openvins", openvins_of},   {"ros", ros_of},  {"px4", px4_of},
      {"ardupilot", ardupilot_of}, {"vectornav", vectornav_of}, {"json", json_of}};
  for (const auto& [name, reader] : readers) {
    SCOPED_TRACE(name);
    const Exported out = exported(name.c_str(), full_unit(3));
    const Target target = reader(out.text);
    Draw draw(5);
    for (int i = 0; i < 50; ++i) {
      const Sample y{draw.vector(kRate), draw.vector(20.0)};
      const double tolerance = 10.0 * export_format(name).precision;
      EXPECT_LT((target(y).w - out.correct(y).w).norm(), tolerance * 4.0);
      EXPECT_LT((target(y).f - out.correct(y).f).norm(), tolerance * 40.0);
    }
  }
}

std::vector<std::string> terms_left_out(const char* format, const InertialUnit<double>& unit) {
  ExportRequest request;
  request.unit = unit;
  std::vector<std::string> terms;
  for (const Omission& left : omissions(export_format(format), request, kRate)) terms.push_back(left.term);
  return terms;
}

TEST(Export, NamesWhatItOmitsWithItsSize) {
  InertialUnit<double> unit = full_unit(4);
  EXPECT_THAT(terms_left_out("json", unit), IsEmpty());
  EXPECT_THAT(terms_left_out("matlab", unit), IsEmpty());
  EXPECT_THAT(terms_left_out("kalibr", unit),
              testing::ElementsAre("gyro asymmetry", "gyro cubic", "accelerometer quadratic",
                                   "turn-on biases, which its reader estimates itself"));
  EXPECT_THAT(terms_left_out("vectornav", unit), Contains("g-sensitivity"));
  EXPECT_THAT(terms_left_out("px4", unit), Contains("gyro scale"));
  EXPECT_THAT(terms_left_out("px4", unit), Contains("accelerometer cross-coupling"));
  EXPECT_THAT(terms_left_out("ros", unit), Contains("gyro bias"));
  unit.thermal.bias[0].w << 1e-5, 0.0, 0.0;
  unit.accel_place(1, 1) = 0.003;
  EXPECT_THAT(terms_left_out("json", unit), IsEmpty());
  EXPECT_THAT(terms_left_out("matlab", unit), testing::ElementsAre("size effect"));
  EXPECT_THAT(terms_left_out("openvins", unit), Contains("temperature, from -10 to 10 degC"));

  // a size effect alone: w^2 r, in the whole too
  InertialUnit<double> wide;
  wide.accel_place(1, 1) = 0.003;
  ExportRequest of_wide;
  of_wide.unit = wide;
  EXPECT_NEAR(departure(export_format("matlab"), of_wide, kRate).f.y(), 0.003 * kRate * kRate, 1e-9);

  // however bent, the formula with eight steps leaves nothing of it
  InertialUnit<double> strong = unit;
  strong.accel_place.setZero();
  strong.thermal = {};
  strong.gyro.cubic << 1e-3, 1e-3, 1e-3;
  EXPECT_THAT(terms_left_out("matlab", strong), IsEmpty());

  // a cubic alone: at 100 deg/s about one axis the reading is off by cubic rate^3
  InertialUnit<double> bent;
  bent.gyro.cubic << 2e-4, 0.0, 0.0;
  ExportRequest request;
  request.unit = bent;
  const std::vector<Omission> left = omissions(export_format("vectornav"), request, kRate);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_NEAR(left[0].size.w.x(), 2e-4 * kRate * kRate * kRate, 1e-6 * kRate);
}

TEST(Export, PerfectUnitsLeaveNothingOut) {
  for (const ExportFormat& format : export_formats())
    EXPECT_THAT(terms_left_out(format.name, {}), IsEmpty()) << format.name;
}

TEST(Export, NumbersOfYamlHaveAPoint) {
  // YAML 1.1, which Kalibr's reader speaks, takes 3e-06 for a word
  InertialUnit<double> unit;
  unit.g_sensitivity(0, 1) = 3e-6;
  for (const char* format : {"kalibr", "openvins"}) {
    EXPECT_THAT(exported(format, unit).text, HasSubstr("3.0e-06")) << format;
    EXPECT_THAT(exported(format, unit).text, testing::Not(HasSubstr(" 0,"))) << format;
  }
}

TEST(Export, NoiseAndRateOfASheet) {
  ExportRequest request;
  request.sheet.has_noise = true;
  request.sheet.noise.gyro = {2e-5, 3e-6, 200.0};
  request.sheet.noise.accel = {3e-4, 2e-4, 50.0};
  request.sheet.rate_hz = 400.0;
  const YAML::Node imu = YAML::Load(export_format("kalibr").make(request).text);
  EXPECT_EQ(imu["gyroscope_noise_density"].as<double>(), 2e-5);
  EXPECT_EQ(imu["update_rate"].as<double>(), 400.0);
  // a Gauss-Markov process of sigma and tau begins as a walk of sigma sqrt(2 / tau) sqrt(t)
  EXPECT_DOUBLE_EQ(imu["accelerometer_random_walk"].as<double>(), 2e-4 * std::sqrt(2.0 / 50.0));
  EXPECT_THAT(export_format("kalibr").make(request).advice, testing::ElementsAre(HasSubstr("rostopic")));
  request.sheet.has_noise = false;
  EXPECT_THAT(export_format("kalibr").make(request).advice,
              testing::Contains(HasSubstr("the noise is not in the file")));
}

TEST(Export, DeviceIdsAndStartUp) {
  ExportRequest request;
  request.accel_id = 1310988;
  request.gyro_id = 1310730;
  EXPECT_THAT(export_format("px4").make(request).text, HasSubstr("1\t1\tCAL_ACC0_ID\t1310988\t6\n"));
  EXPECT_THAT(export_format("px4").make(request).text, HasSubstr("1\t1\tCAL_GYRO0_ID\t1310730\t6\n"));
  EXPECT_THAT(export_format("ardupilot").make(request).text, HasSubstr("INS_GYR_CAL,0\n"));
  request.instance = 1;
  EXPECT_THAT(export_format("px4").make(request).text, HasSubstr("\tCAL_GYRO1_ZOFF\t"));
  EXPECT_THAT(export_format("ardupilot").make(request).text,
              HasSubstr("INS_ACC2SCAL_Y,1\nINS_ACC2SCAL_Z,1\nINS_GYR2OFFS_X,0\n"));
}

}  // namespace
}  // namespace trunnion::io
