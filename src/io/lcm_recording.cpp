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
constexpr std::size_t kCountsBytes = 8 + 8 + 8 + 7 * 4;
constexpr std::size_t kSequence = 16;  // where it is in every type
constexpr std::size_t kBatchSample = 7 * 8;
constexpr long long kEventsPerProgress = 100000;
constexpr std::size_t kNamedChannels = 20;  // in a message

}  // namespace

LcmDecoder::LcmDecoder(std::string source, SampleSink& sink, const LogChannels& channels)
    : source_(std::move(source)), intake_(sink), counts_(channels.sheet.counts) {
  if (channels.imu.map) imu_map_.emplace(channels.imu.map, channels.sheet);
  if (channels.encoder.map) encoder_map_.emplace(channels.encoder.map, channels.sheet);
}

void LcmDecoder::imu(const LcmEvent& event) {
  if (imu_map_) return mapped_imu(event);
  const char* p = event.data.data();
  const std::uint64_t fingerprint = fingerprint_of(event.data);
  InertialSample<double> sample;
  if (fingerprint == kImuFingerprint && event.data.size() == kImuBytes) {
    for (int i = 0; i < 3; ++i) {
      sample.w(i) = load_double(p + 24 + 8 * i);
      sample.f(i) = load_double(p + 48 + 8 * i);
    }
    imu_sequence_.add(load_i64(p + kSequence));
    intake_.temperature(load_double(p + kImuBytes - 8));
    deliver(event, load_i64(p + 8), sample);
  } else if (fingerprint == kImuBatchFingerprint && event.data.size() >= kBatchHead) {
    batch(event);
  } else if (const auto raw = decode_imu_counts(event.data)) {
    if (counts_.gyro.scale == 1.0 || counts_.accel.scale == 1.0)
      return damage(event,
                    "holds raw counts, and no sheet says what one is (scale_counts_per_rad_s, "
                    "scale_counts_per_m_s2)");
    for (std::size_t i = 0; i < 3; ++i) {
      sample.w(static_cast<int>(i)) = (raw->counts[i] - counts_.gyro.zero) / counts_.gyro.scale;
      sample.f(static_cast<int>(i)) = (raw->counts[i + 3] - counts_.accel.zero) / counts_.accel.scale;
    }
    imu_sequence_.add(raw->sequence);
    intake_.temperature(raw->celsius());
    deliver(event, raw->utime, sample);
  } else {
    damage(event, foreign(event, fingerprint,
                          "trunnion_lcm.imu_t (" + hexadecimal(kImuFingerprint) + ") or trunnion_lcm.imu_batch_t (" +
                              hexadecimal(kImuBatchFingerprint) + ")"));
  }
}

void LcmDecoder::mapped_imu(const LcmEvent& event) {
  const std::string wrong = imu_map_->imu(event, mapped_);
  if (!wrong.empty()) return damage(event, wrong);
  for (const MappedMessages::Sample& sample : mapped_) {
    // batches may overlap: what came before is not counted again
    if (imu_map_->has_sequence() && !imu_sequence_.add(sample.sequence)) continue;
    deliver(event, sample.utime, sample.value);
  }
}

void LcmDecoder::encoder(const LcmEvent& event) {
  if (encoder_map_) {
    std::int64_t utime = 0;
    std::int64_t sequence = 0;
    std::array<double, 2> angle{};
    const std::string wrong = encoder_map_->encoder(event, utime, sequence, angle);
    if (!wrong.empty()) return damage(event, wrong);
    if (encoder_map_->has_sequence()) encoder_sequence_.add(sequence);
    return deliver_angles(event, utime, angle);
  }
  const char* p = event.data.data();
  const std::uint64_t fingerprint = fingerprint_of(event.data);
  if (fingerprint != kEncoderFingerprint || event.data.size() < kEncoderHead) {
    return damage(event,
                  foreign(event, fingerprint, "trunnion_lcm.encoder_t (" + hexadecimal(kEncoderFingerprint) + ")"));
  }
  const auto axes = static_cast<std::int32_t>(load_u32(p + 24));
  if (axes != 2 || event.data.size() != kEncoderHead + 16)
    return damage(event, "num_axes", "is " + std::to_string(axes) + ", a two-axis table has 2");
  encoder_sequence_.add(load_i64(p + kSequence));
  deliver_angles(event, load_i64(p + 8), {load_double(p + kEncoderHead), load_double(p + kEncoderHead + 8)});
}

void LcmDecoder::deliver_angles(const LcmEvent& event, std::int64_t utime, const std::array<double, 2>& angle) {
  intake_.encoder(utime, angle, event.data.size(),
                  [&](const std::string& field, const std::string& what) { return fault(event, field, what); });
}

void LcmDecoder::deliver(const LcmEvent& event, std::int64_t utime, const InertialSample<double>& sample) {
  intake_.imu(utime, sample, event.data.size(),
              [&](const std::string& field, const std::string& what) { return fault(event, field, what); });
}

void LcmDecoder::batch(const LcmEvent& event) {
  const char* p = event.data.data();
  const std::uint64_t n = load_u32(p + 24);
  if (event.data.size() != kBatchHead + kBatchSample * n + 8) {
    return damage(event, "num_samples", "does not fit the length of the message");
  }
  if (n > 0) imu_sequence_.add(load_i64(p + kSequence), static_cast<std::int64_t>(n));
  intake_.temperature(load_double(p + event.data.size() - 8));
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

void LcmDecoder::damage(const LcmEvent& event, const std::string& field, const std::string& what) {
  intake_.damage(event.data.size(), fault(event, field, what));
}

/// Of the message as a whole.
void LcmDecoder::damage(const LcmEvent& event, const std::string& what) {
  damage(event, "channel " + printable(std::string(event.channel)), what);
}

/// At a byte of a file, or of a bus the number of the message.
Error LcmDecoder::fault(const LcmEvent& event, const std::string& field, const std::string& what) const {
  if (event.byte >= 0) return input_error_at_byte(source_, event.byte, field, what);
  return input_error(source_, 0, "message " + std::to_string(event.number) + ": " + field, what);
}

std::string LcmDecoder::foreign(const LcmEvent& event, std::uint64_t fingerprint, const std::string& expected) const {
  std::string known;
  for (const MessagePreset& preset : message_presets()) {
    if (preset.map.types->fingerprint(preset.map.type) != fingerprint) continue;
    known = "; that is " + preset.name + ": state 'preset: " + preset.name + "' for the channel";
    break;
  }
  return "holds a message of another type, fingerprint " + hexadecimal(fingerprint) + ", " +
         std::to_string(event.data.size()) + " bytes" + known + "; expected " + expected;
}

LogLosses read_lcm_recording(const LogRequest& request, SampleSink& sink) {
  const std::string imu = request.channels.imu_channel();
  const std::string encoder = request.channels.encoder_channel();
  LcmLogReader log(request.path, request.digest);
  LcmDecoder decoder(request.path, sink, request.channels);
  LcmEvent event;
  long long events = 0;
  std::set<std::string, std::less<>> others;
  long long lost = 0;  // before a record that is whole: what follows the last was cut
  std::int64_t damage = 0;
  while (log.next(event)) {
    if (lost == 0) damage = event.byte;
    lost = log.lost_bytes();
    if (event.channel == imu) {
      decoder.imu(event);
    } else if (event.channel == encoder) {
      decoder.encoder(event);
    } else if (others.size() < kNamedChannels && others.find(event.channel) == others.end()) {
      others.emplace(event.channel);
    }
    ++events;
    if (request.progress && events % kEventsPerProgress == 0)
      request.progress(static_cast<double>(event.byte) / static_cast<double>(log.size()));
  }
  if (lost > 0)
    decoder.lose(lost, input_error_at_byte(request.path, damage, "", "before it is what belongs to no record"));
  if (events == 0)
    throw input_error(request.path, 0, "", "is of no format that is read, nor has it one whole LCM event");
  decoder.finish(log.size());
  std::string others_named;
  for (const std::string& name : others)
    others_named += (others_named.empty() ? "; other channels: " : ", ") + printable(name);
  if (request.need_imu && decoder.samples() == 0) {
    throw input_error(request.path, 0, "",
                      "no usable message on the IMU channel '" + imu + "'" + others_named +
                          (log.lost_bytes() > 0 ? "; " + std::to_string(log.lost_bytes()) + " bytes are damaged" : ""));
  }
  if (request.need_encoder && decoder.encoders() == 0) {
    throw input_error(request.path, 0, "", "no usable message on the encoder channel '" + encoder + "'" + others_named);
  }
  return {log.lost_records() + decoder.damaged_records(), log.lost_bytes() + decoder.damaged_bytes(),
          decoder.imu_sequence().numbered() ? decoder.imu_sequence().lost() : 0, ""};
}

bool replace_samples(const std::vector<InertialSample<double>>& samples, std::string& message) {
  const std::size_t n = samples.size();
  const std::uint64_t fingerprint = fingerprint_of(message);
  const bool batch = fingerprint == kImuBatchFingerprint;
  if (message.size() != (batch ? kBatchHead + kBatchSample * n + 8 : kImuBytes) ||
      (!batch && fingerprint != kImuFingerprint))
    return false;
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      const double value = i < 3 ? samples[k].w(static_cast<int>(i)) : samples[k].f(static_cast<int>(i) - 3);
      store_double(value, message.data() + (batch ? kBatchHead + 8 * ((1 + i) * n + k) : kImuHead + 8 * i));
    }
  }
  return true;
}

void encode_imu(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample, std::string& out,
                double temperature) {
  out.clear();
  append_unsigned(out, kImuFingerprint);
  append_i64(out, utime);
  append_i64(out, sequence);
  for (int i = 0; i < 3; ++i) append_double(out, sample.w(i));
  for (int i = 0; i < 3; ++i) append_double(out, sample.f(i));
  append_double(out, temperature);
}

void encode_imu_batch(std::int64_t sequence, const std::vector<std::int64_t>& utime,
                      const std::vector<InertialSample<double>>& samples, std::string& out, double temperature) {
  out.clear();
  append_unsigned(out, kImuBatchFingerprint);
  append_i64(out, utime.empty() ? 0 : utime.back());
  append_i64(out, sequence);
  append_unsigned(out, static_cast<std::uint32_t>(samples.size()));
  for (const std::int64_t t : utime) append_i64(out, t);
  for (int i = 0; i < 6; ++i) {
    for (const auto& sample : samples) append_double(out, i < 3 ? sample.w(i) : sample.f(i - 3));
  }
  append_double(out, temperature);
}

void encode_imu_counts(const ImuCounts& sample, std::string& out) {
  out.clear();
  append_unsigned(out, kImuCountsFingerprint);
  append_i64(out, sample.utime);
  append_i64(out, sample.sequence);
  for (const std::int32_t count : sample.counts) append_unsigned(out, static_cast<std::uint32_t>(count));
  append_unsigned(out, static_cast<std::uint32_t>(sample.temperature));
}

double ImuCounts::celsius() const {
  return SampleIntake::known_temperature(temperature / 256.0);
}  // kNoTemperature is none

std::optional<ImuCounts> decode_imu_counts(std::string_view message) {
  const char* p = message.data();
  if (message.size() != kCountsBytes || load_u64(p) != kImuCountsFingerprint) return std::nullopt;
  ImuCounts sample;
  sample.utime = load_i64(p + 8);
  sample.sequence = load_i64(p + kSequence);
  for (std::size_t i = 0; i < sample.counts.size(); ++i)
    sample.counts[i] = static_cast<std::int32_t>(load_u32(p + kImuHead + 4 * i));
  sample.temperature = static_cast<std::int32_t>(load_u32(p + kImuHead + 24));
  return sample;
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
