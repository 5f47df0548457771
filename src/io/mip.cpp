// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// MicroStrain's inertial protocol. A packet: 0x75 0x65, descriptor set, length of the payload, payload, two bytes of
// Fletcher's checksum over all before. The payload is fields: length with itself, descriptor, data; numbers are
// big-endian. Sensor data (set 0x80) and its stamps are in one packet.

#include <cmath>
#include <optional>

#include "big_endian.hpp"
#include "byte_stream.hpp"
#include "log_formats.hpp"
#include "trunnion/core/gps_time.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/positions/channel_clock.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kHeader = 4;
constexpr std::size_t kChecksum = 2;
constexpr std::int64_t kLongestPacket = 261;
constexpr std::uint8_t kSensorSet = 0x80;
constexpr std::int64_t kLongestStep = 1000000;  // us, between two packets of increments

std::uint8_t byte_at(const char* p) { return static_cast<std::uint8_t>(*p); }

bool begins_packet(const char* p) { return byte_at(p) == 0x75 && byte_at(p + 1) == 0x65; }

/// Whether @p length bytes end in the checksum of those before.
bool sums_up(const char* p, std::size_t length) {
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (std::size_t i = 0; i + kChecksum < length; ++i) {
    a = static_cast<std::uint8_t>(a + byte_at(p + i));
    b = static_cast<std::uint8_t>(b + a);
  }
  return byte_at(p + length - 2) == a && byte_at(p + length - 1) == b;
}

Vec3<double> vector_at(const char* p) {
  return {static_cast<double>(load_float(p)), static_cast<double>(load_float(p + 4)),
          static_cast<double>(load_float(p + 8))};
}

/// Fields of one packet of sensor data.
struct SensorPacket {
  std::optional<Vec3<double>> rate;            // rad/s
  std::optional<Vec3<double>> force;           // m/s^2
  std::optional<Vec3<double>> delta_angle;     // rad
  std::optional<Vec3<double>> delta_velocity;  // m/s
  std::optional<std::int64_t> reference_ns;
  std::optional<std::int64_t> period_ns;
  std::optional<std::int64_t> gps_us;

  /// @return false for a field whose length is not that of its kind, and for a second of its kind
  bool take(std::uint8_t descriptor, const char* p, std::size_t length) {
    switch (descriptor) {
      case 0x04:
        return length == 12 && set(force, kStandardGravity * vector_at(p));
      case 0x05:
        return length == 12 && set(rate, vector_at(p));
      case 0x07:
        return length == 12 && set(delta_angle, vector_at(p));
      case 0x08:
        return length == 12 && set(delta_velocity, kStandardGravity * vector_at(p));
      case 0x12:  // time of week, week, flags
      case 0xD3: {
        if (length != 12) return false;
        const double tow = load_double(p);
        const std::uint32_t week_and_flags = load_u32(p + 8);
        const auto flags = static_cast<std::uint16_t>(week_and_flags);
        const bool valid = descriptor == 0xD3 ? (flags & 3U) == 3U : (flags & 4U) != 0U;
        if (valid && tow >= 0.0 && tow < kSecondsPerWeek + 1.0)
          gps_us = utime_of({static_cast<int>(week_and_flags >> 16U), tow});
        return true;
      }
      case 0xD5:
        return length == 8 && set(reference_ns, load_i64(p));
      case 0xD6:
        return length == 8 && set(period_ns, load_i64(p));
      default:
        return true;
    }
  }

  [[nodiscard]] std::optional<std::int64_t> reference_us() const {
    if (!reference_ns) return std::nullopt;
    return *reference_ns / 1000 + (*reference_ns % 1000 >= 500 ? 1 : 0);
  }

 private:
  template <class T, class U>
  static bool set(std::optional<T>& field, const U& value) {
    if (field) return false;
    field = value;
    return true;
  }
};

class MipReader {
 public:
  MipReader(const LogRequest& request, SampleSink& sink)
      : request_(request), stream_(request.path, request.digest), intake_(sink) {
    if (!request.channels.imu.name.empty())
      throw input_error(
          request.path, 0, "",
          "is a MIP stream: it has no channel '" + printable(request.channels.imu.name) + "', but one unit");
  }

  LogLosses read() {
    ByteProgress progress(request_.progress);
    while (stream_.have(kHeader + kChecksum)) {
      const std::size_t length = kHeader + byte_at(stream_.data() + 3) + kChecksum;
      if (!begins_packet(stream_.data()) || !stream_.have(length) || !sums_up(stream_.data(), length)) {
        stream_.skip(1);
        ++lost_;
        continue;
      }
      found();
      if (byte_at(stream_.data() + 2) == kSensorSet) sensor(length);
      stream_.skip(length);
      progress.show(stream_);
    }
    const std::int64_t cut = lost_ + static_cast<std::int64_t>(stream_.available());
    if (cut > kLongestPacket) found();
    std::string note;
    const auto say = [&](long long count, const char* what) {
      if (count > 0) note += (note.empty() ? "" : ", ") + std::to_string(count) + " packets of sensor data " + what;
    };
    say(without_time_, "without a stamp");
    say(without_pair_, "with either rates or specific forces, not both");
    say(without_period_, "with increments after a gap");
    require(request_, intake_, stream_.size(), note.empty() ? "MIP packets" : note);
    return losses_of(intake_, cut > kLongestPacket ? 0 : cut, note);
  }

 private:
  /// A packet, or the end: what lies between it and the last one is lost.
  void found() {
    if (lost_ == 0) return;
    const std::int64_t bytes = lost_;
    intake_.lose(bytes, AtByte(request_.path, stream_.offset() - bytes)("", "is no packet"));
    lost_ = 0;
  }

  void sensor(std::size_t length) {
    const AtByte fault(request_.path, stream_.offset());
    SensorPacket packet;
    const char* const p = stream_.data();
    for (std::size_t at = kHeader; at + kChecksum < length;) {
      const std::size_t field = byte_at(p + at);
      if (field < 2 || at + field + kChecksum > length || !packet.take(byte_at(p + at + 1), p + at + 2, field - 2))
        return intake_.damage(length,
                              fault("field " + std::to_string(byte_at(p + at + 1)), "has a wrong length, or is twice"));
      at += field;
    }
    if (clock_ == Clock::kNone && packet.reference_ns) clock_ = Clock::kReference;
    if (clock_ == Clock::kNone && packet.gps_us) clock_ = Clock::kGps;
    const std::optional<std::int64_t> utime = clock_ == Clock::kReference ? packet.reference_us() : packet.gps_us;
    const double period = 1e-9 * static_cast<double>(packet.period_ns.value_or(1000 * steady_step(utime)));
    // increments are of the unit's own period: where it does not state it, a step like the one before
    if (!packet.rate && !packet.force && packet.delta_angle && packet.delta_velocity) {
      if (!(period > 0.0)) {
        if (utime) ++without_period_;
        return;
      }
      packet.rate = *packet.delta_angle / period;
      packet.force = *packet.delta_velocity / period;
    }
    if (packet.rate && packet.force && utime) {
      intake_.imu(*utime, {*packet.rate, *packet.force}, length, fault);
    } else if (packet.rate && packet.force) {
      ++without_time_;
    } else if (packet.rate || packet.force) {
      ++without_pair_;
    }
  }

  /// The step to this stamp [us] where it is like the one before; zero where it is not, or none is known.
  std::int64_t steady_step(const std::optional<std::int64_t>& utime) {
    if (!utime) return 0;
    const std::int64_t step = last_ ? ChannelClock::difference(*utime, *last_) : 0;
    const bool steady =
        step > 0 && step_ > 0 && std::abs(static_cast<double>(step - step_)) < 0.2 * static_cast<double>(step_);
    last_ = utime;
    step_ = step;
    return steady && step < kLongestStep ? step : 0;
  }

  enum class Clock { kNone, kReference, kGps };

  const LogRequest& request_;
  ByteStream stream_;
  SampleIntake intake_;
  Clock clock_ = Clock::kNone;  // of the first packet, and of all: they count from different days
  std::int64_t step_ = 0;
  std::optional<std::int64_t> last_;
  std::int64_t lost_ = 0;  // bytes since the last packet
  long long without_time_ = 0;
  long long without_pair_ = 0;
  long long without_period_ = 0;
};

bool is_mip(std::string_view head) {
  for (std::size_t at = 0; at + kHeader + kChecksum <= head.size(); ++at) {
    const char* const p = head.data() + at;
    if (!begins_packet(p)) continue;
    const std::size_t length = kHeader + byte_at(p + 3) + kChecksum;
    if (at + length > head.size() || !sums_up(p, length)) continue;
    if (at == 0 || at + length + 2 > head.size() || begins_packet(p + length)) return true;
  }
  return false;
}

LogLosses read_mip(const LogRequest& request, SampleSink& sink) { return MipReader(request, sink).read(); }

}  // namespace

const LogFormat kMipFormat = {"mip", "MicroStrain MIP stream", ".mip", is_mip, read_mip, nullptr};

}  // namespace trunnion::io
