// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// CDR: four bytes that tell the order of bytes, then the members one after the other, each aligned to its own size from
// there on; a text is its length with the zero at its end, a sequence its length and its members. ROS 1: little-endian,
// nothing aligned, no zero at the end of a text, and the header has a number of 32 bits in front.

#include "ros_message.hpp"

#include <cmath>
#include <vector>

#include "little_endian.hpp"
#include "log_formats.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kEncapsulation = 4;
constexpr std::uint32_t kMostNames = 1000;

class RosFields {
 public:
  RosFields(std::string_view message, RosEncoding encoding) : text_(message), cdr_(encoding == RosEncoding::kCdr) {
    if (!cdr_) return;
    // kinds 0 and 1: plain CDR, 6 and 7: its second version, where nothing is aligned to more than four bytes
    const unsigned kind = text_.size() < kEncapsulation ? 0xffU : static_cast<unsigned char>(text_[1]);
    whole_ = kind <= 1 || kind == 6 || kind == 7;
    swap_ = (kind & 1U) == 0;
    widest_ = kind >= 6 ? 4 : 8;
    at_ = kEncapsulation;
  }

  template <class T>
  T number() {
    if (cdr_) {
      const std::size_t step = std::min(sizeof(T), widest_);
      at_ += (step - (at_ - kEncapsulation) % step) % step;
    }
    if (!whole_ || text_.size() < at_ + sizeof(T)) {
      whole_ = false;
      return T{};
    }
    const T v = load_little<T>(text_.data() + at_);
    at_ += sizeof(T);
    return swap_ ? reversed(v) : v;
  }

  std::string_view text() {
    const auto length = number<std::uint32_t>();
    if (!whole_ || text_.size() - at_ < length) {
      whole_ = false;
      return {};
    }
    const std::string_view found = text_.substr(at_, length);
    at_ += length;
    return cdr_ && !found.empty() && found.back() == '\0' ? found.substr(0, found.size() - 1) : found;
  }

  /// std_msgs/Header. @return its stamp [us]; nothing for one with a second of nanoseconds or more
  std::optional<std::int64_t> header() {
    if (!cdr_) number<std::uint32_t>();
    const std::int64_t seconds = number<std::int32_t>();
    const std::int64_t nanoseconds = number<std::uint32_t>();
    text();
    if (nanoseconds >= 1000000000) return std::nullopt;
    return 1000000 * seconds + (nanoseconds + 500) / 1000;
  }

  Vec3<double> vector() {
    Vec3<double> v;
    for (int i = 0; i < 3; ++i) v(i) = number<double>();
    return v;
  }

  /// Nine of them. @return the first
  double covariance() {
    const auto first = number<double>();
    for (int i = 1; i < 9; ++i) number<double>();
    return first;
  }

  [[nodiscard]] bool whole() const { return whole_; }

 private:
  std::string_view text_;
  bool cdr_;
  bool swap_ = false;
  bool whole_ = true;
  std::size_t widest_ = 8;
  std::size_t at_ = 0;
};

/// CDR, little-endian.
class CdrWriter {
 public:
  explicit CdrWriter(std::string& out) : out_(out) { out_.assign("\0\1\0\0", kEncapsulation); }

  template <class T>
  void number(T v) {
    while ((out_.size() - kEncapsulation) % sizeof(T) != 0) out_ += '\0';
    append_little(out_, v);
  }
  void text(std::string_view v) {
    number(static_cast<std::uint32_t>(v.size() + 1));
    out_.append(v);
    out_ += '\0';
  }
  void header(std::int64_t utime, const char* frame) {
    const std::int64_t seconds = utime / 1000000;
    number(static_cast<std::int32_t>(seconds));
    number(static_cast<std::uint32_t>(1000 * (utime - 1000000 * seconds)));
    text(frame);
  }
  void covariance(double first) {
    number(first);
    for (int i = 1; i < 9; ++i) number(0.0);
  }

 private:
  std::string& out_;
};

constexpr const char* kCut = "is shorter than its type";
constexpr const char* kNoStamp = "has a stamp with more than a second of nanoseconds";

}  // namespace

std::optional<RosImu> decode_ros_imu(std::string_view message, RosEncoding encoding, std::string& wrong) {
  RosFields fields(message, encoding);
  RosImu imu;
  const std::optional<std::int64_t> utime = fields.header();
  for (int i = 0; i < 4; ++i) fields.number<double>();
  fields.covariance();
  imu.sample.w = fields.vector();
  const bool has_rate = fields.covariance() != -1.0;
  imu.sample.f = fields.vector();
  const bool has_force = fields.covariance() != -1.0;
  wrong = !fields.whole() ? kCut
          : !utime        ? kNoStamp
          : !has_rate     ? "says that it has no angular velocity"
          : !has_force    ? "says that it has no linear acceleration"
                          : "";
  if (!wrong.empty()) return std::nullopt;
  imu.utime = *utime;
  return imu;
}

namespace {

std::string joint_names(std::string_view message, RosEncoding encoding) {
  RosFields fields(message, encoding);
  static_cast<void>(fields.header());
  NameList names;
  for (std::uint32_t left = fields.number<std::uint32_t>(); left > 0 && fields.whole(); --left)
    names.add(std::string(fields.text()));
  return names.text();
}

}  // namespace

std::optional<RosAngles> decode_ros_joints(std::string_view message, RosEncoding encoding,
                                           const std::array<std::string, 2>& joints, std::string& wrong) {
  RosFields fields(message, encoding);
  RosAngles found;
  const std::optional<std::int64_t> utime = fields.header();
  const auto names = fields.number<std::uint32_t>();
  if (!fields.whole() || names > kMostNames) {
    wrong = fields.whole() ? "has more than a thousand names" : kCut;
    return std::nullopt;
  }
  std::array<std::optional<std::uint32_t>, 2> place;
  for (std::uint32_t k = 0; k < names; ++k) {
    const std::string_view name = fields.text();
    for (std::size_t i = 0; i < 2; ++i) {
      if (name == joints[i]) place[i] = k;
    }
  }
  const auto positions = fields.number<std::uint32_t>();
  std::array<bool, 2> there{};
  for (std::uint32_t k = 0; k < positions && fields.whole() && !(there[0] && there[1]); ++k) {
    const auto position = fields.number<double>();
    for (std::size_t i = 0; i < 2; ++i) {
      if (place[i] != k) continue;
      found.angle[i] = position;
      there[i] = true;
    }
  }
  wrong.clear();
  if (!fields.whole()) wrong = kCut;
  if (wrong.empty() && !utime) wrong = kNoStamp;
  for (std::size_t i = 0; i < 2 && wrong.empty(); ++i) {
    if (!there[i])
      wrong = "has no position of a joint '" + printable(joints[i]) + "', but of " + joint_names(message, encoding);
  }
  if (!wrong.empty()) return std::nullopt;
  found.utime = *utime;
  return found;
}

void encode_ros_imu(std::int64_t utime, const InertialSample<double>& sample, std::string& out) {
  CdrWriter cdr(out);
  cdr.header(utime, "imu");
  for (const double q : {0.0, 0.0, 0.0, 1.0}) cdr.number(q);
  cdr.covariance(-1.0);  // no orientation
  for (int i = 0; i < 3; ++i) cdr.number(sample.w(i));
  cdr.covariance(0.0);  // not known
  for (int i = 0; i < 3; ++i) cdr.number(sample.f(i));
  cdr.covariance(0.0);
}

void encode_ros_joints(std::int64_t utime, const std::array<std::string, 2>& joints, const std::array<double, 2>& angle,
                       std::string& out) {
  CdrWriter cdr(out);
  cdr.header(utime, "");
  cdr.number(std::uint32_t{2});
  for (const std::string& joint : joints) cdr.text(joint);
  cdr.number(std::uint32_t{2});
  for (const double position : angle) cdr.number(position);
  for (int empty = 0; empty < 2; ++empty) cdr.number(std::uint32_t{0});  // velocities, efforts
}

#define TRUNNION_ROS_SEPARATOR "================================================================================\n"
#define TRUNNION_ROS_HEADER                                                                       \
  TRUNNION_ROS_SEPARATOR                                                                          \
  "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" TRUNNION_ROS_SEPARATOR \
  "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"

const char* const kRosImuDefinition =
    "std_msgs/Header header\n"
    "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" TRUNNION_ROS_HEADER
        TRUNNION_ROS_SEPARATOR
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" TRUNNION_ROS_SEPARATOR
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

const char* const kRosJointStateDefinition =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] "
    "effort\n" TRUNNION_ROS_HEADER;

}  // namespace trunnion::io
