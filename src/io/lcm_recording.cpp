// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_recording.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "big_endian.hpp"
#include "trunnion/io/fault.hpp"

namespace trunnion::io {
namespace {

constexpr std::size_t kImuHead = 8 + 8 + 8;
constexpr std::size_t kImuBytes = kImuHead + 6 * 8 + 8;
constexpr std::size_t kEncoderHead = 8 + 8 + 8 + 4;
constexpr std::size_t kBatchHead = 8 + 8 + 8 + 4;
constexpr std::size_t kBatchSample = 7 * 8;
constexpr long long kEventsPerProgress = 100000;
constexpr std::size_t kNamedChannels = 20;  // in a message
constexpr double kTolerableDamage = 1e-3;   // messages that cannot be decoded, against those that can
constexpr double kLargestReading = 1e6;     // rad/s, m/s^2
constexpr double kLargestAngle = 1e7;       // rad

std::string hexadecimal(std::uint64_t v) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(v));
  return text;
}

}  // namespace

void LcmDecoder::imu(const LcmEvent& event) {
  const char* p = event.data.data();
  const std::uint64_t fingerprint = event.data.size() >= 8 ? load_u64(p) : 0;
  if (fingerprint == kImuFingerprint && event.data.size() == kImuBytes) {
    InertialSample<double> sample;
    for (int i = 0; i < 3; ++i) {
      sample.w(i) = load_double(p + 24 + 8 * i);
      sample.f(i) = load_double(p + 48 + 8 * i);
    }
    deliver(event, load_i64(p + 8), sample);
  } else if (fingerprint == kImuBatchFingerprint && event.data.size() >= kBatchHead) {
    batch(event);
  } else {
    damage(event, foreign(event, fingerprint,
                          "trunnion_lcm.imu_t (" + hexadecimal(kImuFingerprint) + ") or trunnion_lcm.imu_batch_t (" +
                              hexadecimal(kImuBatchFingerprint) + ")"));
  }
}

void LcmDecoder::encoder(const LcmEvent& event) {
  const char* p = event.data.data();
  const std::uint64_t fingerprint = event.data.size() >= 8 ? load_u64(p) : 0;
  if (fingerprint != kEncoderFingerprint || event.data.size() < kEncoderHead) {
    return damage(event,
                  foreign(event, fingerprint, "trunnion_lcm.encoder_t (" + hexadecimal(kEncoderFingerprint) + ")"));
  }
  const auto axes = static_cast<std::int32_t>(load_u32(p + 24));
  if (axes != 2 || event.data.size() != kEncoderHead + 16) {
    return damage(event, input_error_at_byte(path_, event.byte, "num_axes",
                                             "is " + std::to_string(axes) + ", a two-axis table has 2"));
  }
  const double azimuth = load_double(p + kEncoderHead);
  const double pitch = load_double(p + kEncoderHead + 8);
  if (!std::isfinite(azimuth) || !std::isfinite(pitch)) {
    throw input_error_at_byte(path_, event.byte, std::isfinite(azimuth) ? "angle[1]" : "angle[0]", "is not finite");
  }
  if (std::abs(azimuth) > kLargestAngle || std::abs(pitch) > kLargestAngle) {
    return damage(event, input_error_at_byte(path_, event.byte, "angle", "is beyond a million turns"));
  }
  ++encoders_;
  sink_.encoder(load_i64(p + 8), azimuth, pitch);
}

void LcmDecoder::deliver(const LcmEvent& event, std::int64_t utime, const InertialSample<double>& sample) {
  for (int i = 0; i < 3; ++i) {
    for (const auto& [value, field] :
         {std::pair{sample.w(i), "angular_rate["}, std::pair{sample.f(i), "specific_force["}}) {
      if (std::abs(value) < kLargestReading) continue;
      const Error fault = input_error_at_byte(path_, event.byte, field + std::to_string(i) + "]",
                                              std::isfinite(value) ? "is beyond any sensor" : "is not finite");
      if (!std::isfinite(value)) throw fault;
      return damage(event, fault);
    }
  }
  ++samples_;
  sink_.imu(utime, sample);
}

void LcmDecoder::batch(const LcmEvent& event) {
  const char* p = event.data.data();
  const std::uint64_t n = load_u32(p + 24);
  if (event.data.size() != kBatchHead + kBatchSample * n + 8) {
    return damage(event,
                  input_error_at_byte(path_, event.byte, "num_samples", "does not fit the length of the message"));
  }
  const char* utime = p + kBatchHead;
  for (std::uint64_t k = 0; k < n; ++k) {
    InertialSample<double> sample;
    for (std::uint64_t i = 0; i < 3; ++i) {
      sample.w(static_cast<int>(i)) = load_double(utime + 8 * ((1 + i) * n + k));
      sample.f(static_cast<int>(i)) = load_double(utime + 8 * ((4 + i) * n + k));
    }
    deliver(event, load_i64(utime + 8 * k), sample);
  }
}

void LcmDecoder::damage(const LcmEvent& event, const Error& fault) {
  if (!first_fault_) first_fault_ = fault;
  ++damaged_.records;
  damaged_.bytes += static_cast<long long>(event.data.size());
}

void LcmDecoder::finish() const {
  const auto whole = static_cast<double>(samples_ + encoders_);
  if (first_fault_ && static_cast<double>(damaged_.records) > kTolerableDamage * whole) throw *first_fault_;
}

Error LcmDecoder::foreign(const LcmEvent& event, std::uint64_t fingerprint, const std::string& expected) const {
  return input_error_at_byte(path_, event.byte, "channel " + std::string(event.channel),
                             "holds a message of another type, fingerprint " + hexadecimal(fingerprint) + ", " +
                                 std::to_string(event.data.size()) + " bytes; expected " + expected);
}

LcmLosses read_lcm_recording(const std::string& path, const LcmChannels& channels, bool need_encoder, SampleSink& sink,
                             Sha256* digest, const Progress& progress) {
  LcmLogReader log(path, digest);
  LcmDecoder decoder(path, sink);
  LcmEvent event;
  long long events = 0;
  std::set<std::string, std::less<>> others;
  while (log.next(event)) {
    if (event.channel == channels.imu) {
      decoder.imu(event);
    } else if (event.channel == channels.encoder) {
      decoder.encoder(event);
    } else if (others.size() < kNamedChannels && others.find(event.channel) == others.end()) {
      others.emplace(event.channel);
    }
    if (progress && ++events % kEventsPerProgress == 0)
      progress(static_cast<double>(event.byte) / static_cast<double>(log.size()));
  }
  decoder.finish();
  std::string others_named;
  for (const std::string& name : others)
    others_named += (others_named.empty() ? "; other channels: " : ", ") + printable(name);
  if (decoder.samples() == 0) {
    throw input_error(path, 0, "",
                      "no usable message on the IMU channel '" + channels.imu + "'" + others_named +
                          (log.lost_bytes() > 0 ? "; " + std::to_string(log.lost_bytes()) + " bytes are damaged" : ""));
  }
  if (need_encoder && decoder.encoders() == 0) {
    throw input_error(path, 0, "",
                      "no usable message on the encoder channel '" + channels.encoder + "'" + others_named);
  }
  return {log.lost_records() + decoder.damaged().records, log.lost_bytes() + decoder.damaged().bytes};
}

void replace_samples(const std::vector<InertialSample<double>>& samples, std::string& message) {
  const std::size_t n = samples.size();
  const bool batch = load_u64(message.data()) == kImuBatchFingerprint;
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      const double value = i < 3 ? samples[k].w(static_cast<int>(i)) : samples[k].f(static_cast<int>(i) - 3);
      store_double(value, message.data() + (batch ? kBatchHead + 8 * ((1 + i) * n + k) : kImuHead + 8 * i));
    }
  }
}

void encode_imu(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample, std::string& out) {
  out.clear();
  append_unsigned(out, kImuFingerprint);
  append_i64(out, utime);
  append_i64(out, sequence);
  for (int i = 0; i < 3; ++i) append_double(out, sample.w(i));
  for (int i = 0; i < 3; ++i) append_double(out, sample.f(i));
  append_double(out, std::nan(""));
}

void encode_encoder(std::int64_t utime, std::int64_t sequence, double azimuth, double pitch, std::string& out) {
  out.clear();
  append_unsigned(out, kEncoderFingerprint);
  append_i64(out, utime);
  append_i64(out, sequence);
  append_unsigned(out, std::uint32_t{2});
  append_double(out, azimuth);
  append_double(out, pitch);
}

void encode_navigation(std::int64_t utime, std::int64_t sequence, const NavigationState<double>& state,
                       std::string& out) {
  out.clear();
  append_unsigned(out, kNavigationFingerprint);
  append_i64(out, utime);
  append_i64(out, sequence);
  for (const double value : {state.latitude, state.longitude, state.height}) append_double(out, value);
  for (int i = 0; i < 3; ++i) append_double(out, state.velocity(i));
  const Quaternion<double>& q = state.attitude;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) append_double(out, value);
}

std::int64_t decode_index(const std::string& path, const LcmEvent& event) {
  constexpr std::size_t kIndexSize = 28;
  if (event.data.size() != kIndexSize || load_u64(event.data.data()) != kIndexFingerprint)
    throw input_error_at_byte(path, event.byte, "channel " + std::string(event.channel), "is not of type index_t");
  return static_cast<std::int64_t>(load_u64(event.data.data() + 8));
}

}  // namespace trunnion::io
