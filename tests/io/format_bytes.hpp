// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Logs of other programs, made byte by byte from their formats' descriptions.

#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion::io {

/// Host order is taken to be little-endian here.
template <class T>
void append_little(std::string& out, T v) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &v, sizeof v);
  out.append(bytes.data(), bytes.size());
}
template <class T>
void append_big(std::string& out, T v) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &v, sizeof v);
  for (std::size_t i = sizeof(T); i > 0; --i) out += bytes[i - 1];
}

// --- MIP: fields are length, descriptor, data

inline std::string mip_field(int descriptor, const std::string& data) {
  return std::string{static_cast<char>(data.size() + 2), static_cast<char>(descriptor)} + data;
}
inline std::string mip_vector(int descriptor, const Vec3<double>& v) {
  std::string data;
  for (int i = 0; i < 3; ++i) append_big(data, static_cast<float>(v(i)));
  return mip_field(descriptor, data);
}
inline std::string mip_accel(const Vec3<double>& g) { return mip_vector(0x04, g); }
inline std::string mip_gyro(const Vec3<double>& rad_s) { return mip_vector(0x05, rad_s); }
inline std::string mip_deltas(const Vec3<double>& rad, const Vec3<double>& g_s) {
  return mip_vector(0x07, rad) + mip_vector(0x08, g_s);
}
inline std::string mip_reference_time(std::int64_t ns) {
  std::string data;
  append_big(data, ns);
  return mip_field(0xD5, data);
}
inline std::string mip_period(std::int64_t ns) {
  std::string data;
  append_big(data, ns);
  return mip_field(0xD6, data);
}
inline std::string mip_gps_time(int descriptor, double tow, int week, int flags) {
  std::string data;
  append_big(data, tow);
  append_big(data, static_cast<std::uint16_t>(week));
  append_big(data, static_cast<std::uint16_t>(flags));
  return mip_field(descriptor, data);
}
inline std::string mip_packet(const std::vector<std::string>& fields, int set = 0x80) {
  std::string payload;
  for (const std::string& field : fields) payload += field;
  std::string packet = std::string("ue") + static_cast<char>(set) + static_cast<char>(payload.size()) + payload;
  unsigned a = 0;
  unsigned b = 0;
  for (const char c : packet) {
    a = (a + static_cast<unsigned char>(c)) & 0xffU;
    b = (b + a) & 0xffU;
  }
  return packet + static_cast<char>(a) + static_cast<char>(b);
}

// --- ULog

inline std::string ulog_head() { return std::string("ULog\x01\x12\x35\x01", 8) + std::string(8, '\0'); }
inline std::string ulog_message(char kind, const std::string& content) {
  std::string out;
  append_little(out, static_cast<std::uint16_t>(content.size()));
  return out + kind + content;
}
inline std::string ulog_subscribe(int instance, std::uint16_t number, const std::string& topic) {
  std::string content(1, static_cast<char>(instance));
  append_little(content, number);
  return ulog_message('A', content + topic);
}
inline std::string ulog_data(std::uint16_t number, const std::string& data) {
  std::string content;
  append_little(content, number);
  return ulog_message('D', content + data);
}
inline const char* const kCombinedFormat =
    "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t "
    "accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;";
inline std::string ulog_combined(std::uint16_t number, std::uint64_t stamp, const InertialSample<double>& s,
                                 std::int32_t relative) {
  std::string data;
  append_little(data, stamp);
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(s.w(i)));
  append_little(data, std::uint32_t{4000});
  append_little(data, relative);
  for (int i = 0; i < 3; ++i) append_little(data, static_cast<float>(s.f(i)));
  append_little(data, std::uint32_t{4000});
  return ulog_data(number, data);
}

// --- MCAP

inline std::string mcap_text(const std::string& text) {
  std::string out;
  append_little(out, static_cast<std::uint32_t>(text.size()));
  return out + text;
}
inline std::string mcap_record(int kind, const std::string& content) {
  std::string out(1, static_cast<char>(kind));
  append_little(out, static_cast<std::uint64_t>(content.size()));
  return out + content;
}
inline std::string mcap_head() {
  return std::string("\x89MCAP0\r\n", 8) + mcap_record(1, mcap_text("ros2") + mcap_text("a test"));
}
inline std::string mcap_end() {
  return mcap_record(15, std::string(4, '\0')) + mcap_record(2, std::string(20, '\0')) +
         std::string("\x89MCAP0\r\n", 8);
}
inline std::string mcap_schema(std::uint16_t id, const std::string& name) {
  std::string out;
  append_little(out, id);
  return mcap_record(3, out + mcap_text(name) + mcap_text("ros2msg") + mcap_text("..."));
}
inline std::string mcap_channel(std::uint16_t id, std::uint16_t schema, const std::string& topic,
                                const std::string& encoding) {
  std::string out;
  append_little(out, id);
  append_little(out, schema);
  return mcap_record(4, out + mcap_text(topic) + mcap_text(encoding) + std::string(4, '\0'));
}
inline std::string mcap_message(std::uint16_t channel, const std::string& data, std::uint64_t log_time = 0) {
  std::string out;
  append_little(out, channel);
  append_little(out, std::uint32_t{0});
  append_little(out, log_time);
  append_little(out, log_time);
  return mcap_record(5, out + data);
}
inline std::string mcap_chunk(const std::string& compression, const std::string& packed, std::uint64_t size,
                              std::uint32_t crc) {
  std::string out(16, '\0');
  append_little(out, size);
  append_little(out, crc);
  out += mcap_text(compression);
  append_little(out, static_cast<std::uint64_t>(packed.size()));
  return mcap_record(6, out + packed);
}
/// CRC-32 of IEEE 802.3, bit by bit.
inline std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

// --- messages of ROS

class CdrBytes {
 public:
  CdrBytes() : text_("\0\1\0\0", 4) {}
  template <class T>
  CdrBytes& add(T v) {
    while ((text_.size() - 4) % sizeof(T) != 0) text_ += '\x55';
    append_little(text_, v);
    return *this;
  }
  CdrBytes& add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    text_ += text + '\0';
    return *this;
  }
  CdrBytes& covariance(double first) {
    add(first);
    for (int i = 1; i < 9; ++i) add(0.25);
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

inline std::string cdr_imu(std::uint32_t seconds, std::uint32_t nanoseconds, const InertialSample<double>& s,
                           double rate_covariance = 0.0, double force_covariance = 0.0) {
  CdrBytes cdr;
  cdr.add(static_cast<std::int32_t>(seconds)).add(nanoseconds).add(std::string("base"));
  for (int i = 0; i < 4; ++i) cdr.add(0.5);
  cdr.covariance(-1.0);
  for (int i = 0; i < 3; ++i) cdr.add(s.w(i));
  cdr.covariance(rate_covariance);
  for (int i = 0; i < 3; ++i) cdr.add(s.f(i));
  cdr.covariance(force_covariance);
  return cdr.text();
}
inline std::string cdr_joints(std::int32_t seconds, const std::vector<std::string>& names,
                              const std::vector<double>& positions) {
  CdrBytes cdr;
  cdr.add(seconds).add(std::uint32_t{0}).add(std::string());
  cdr.add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.add(name);
  cdr.add(static_cast<std::uint32_t>(positions.size()));
  for (const double position : positions) cdr.add(position);
  cdr.add(std::uint32_t{0}).add(std::uint32_t{0});
  return cdr.text();
}
inline std::string ros1_imu(std::uint32_t seconds, std::uint32_t nanoseconds, const InertialSample<double>& s) {
  std::string out;
  append_little(out, std::uint32_t{99});
  append_little(out, seconds);
  append_little(out, nanoseconds);
  out += mcap_text("base");
  for (int i = 0; i < 13; ++i) append_little(out, 0.0);
  for (int i = 0; i < 3; ++i) append_little(out, s.w(i));
  for (int i = 0; i < 9; ++i) append_little(out, 0.0);
  for (int i = 0; i < 3; ++i) append_little(out, s.f(i));
  for (int i = 0; i < 9; ++i) append_little(out, 0.0);
  return out;
}

}  // namespace trunnion::io
