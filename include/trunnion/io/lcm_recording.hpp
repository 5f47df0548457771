// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Recordings in LCM logs: the message types of package trunnion_lcm (src/bus/types), encoded and decoded.

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trunnion/core/error.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/positions/sample_sink.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion::io {

/// Fingerprints of the types: part of the format.
inline constexpr std::uint64_t kImuFingerprint = 0x12aff17a21db298cULL;
inline constexpr std::uint64_t kEncoderFingerprint = 0x0cb51f0098d46dacULL;
inline constexpr std::uint64_t kImuBatchFingerprint = 0x42742e60ae44bd0cULL;
inline constexpr std::uint64_t kIndexFingerprint = 0x724d29f1847a9b61ULL;
inline constexpr std::uint64_t kNavigationFingerprint = 0x95dc36850fa1a09cULL;

struct LcmChannels {
  std::string imu = "IMU";
  std::string encoder = "ENCODER";
};

struct LcmLosses {
  long long records = 0;
  long long bytes = 0;
};

/// Decodes messages of one log into a sink. A message that cannot be decoded is counted as damage, unless there are too
/// many of them: then the first fault is thrown, an Error (input) with the byte and the field. Values that are not
/// finite are refused at once.
class LcmDecoder {
 public:
  /// The references must outlive the decoder.
  LcmDecoder(const std::string& path, SampleSink& sink) : path_(path), sink_(sink) {}

  /// imu_t or imu_batch_t.
  void imu(const LcmEvent& event);
  /// encoder_t with two axes.
  void encoder(const LcmEvent& event);

  /// Call after the last message. @throws Error (input) when more than one message in a thousand could not be decoded
  void finish() const;

  [[nodiscard]] long long samples() const { return samples_; }
  [[nodiscard]] long long encoders() const { return encoders_; }
  /// Messages, and their bytes, that could not be decoded.
  [[nodiscard]] const LcmLosses& damaged() const { return damaged_; }

 private:
  void damage(const LcmEvent& event, const Error& fault);
  void deliver(const LcmEvent& event, std::int64_t utime, const InertialSample<double>& sample);
  void batch(const LcmEvent& event);
  [[nodiscard]] Error foreign(const LcmEvent& event, std::uint64_t fingerprint, const std::string& expected) const;

  const std::string& path_;
  SampleSink& sink_;
  long long samples_ = 0;
  long long encoders_ = 0;
  LcmLosses damaged_;
  std::optional<Error> first_fault_;
};

using Progress = std::function<void(double fraction)>;

/// Reads a log into @p sink: imu_t and imu_batch_t on the IMU channel, encoder_t on the encoder channel; other channels
/// are passed over.
/// @param need_encoder whether a log without encoder readings is refused
/// @throws Error (input) for a missing, empty or useless log, another type's fingerprint, or values that are not finite
LcmLosses read_lcm_recording(const std::string& path, const LcmChannels& channels, bool need_encoder, SampleSink& sink,
                             Sha256* digest = nullptr, const Progress& progress = {});

/// Puts other samples into a message of type imu_t or imu_batch_t that was decoded into as many; the rest stays.
void replace_samples(const std::vector<InertialSample<double>>& samples, std::string& message);

/// Encodes one message of type imu_t, or encoder_t with two axes, into @p out (cleared first).
void encode_imu(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample, std::string& out);
void encode_encoder(std::int64_t utime, std::int64_t sequence, double azimuth, double pitch, std::string& out);
/// Encodes one message of type navigation_t.
void encode_navigation(std::int64_t utime, std::int64_t sequence, const NavigationState<double>& state,
                       std::string& out);
/// The stamp of an index_t message [us]. @throws Error (input) when it is none
std::int64_t decode_index(const std::string& path, const LcmEvent& event);

}  // namespace trunnion::io
