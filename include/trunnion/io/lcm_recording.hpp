// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Recordings in LCM logs: the message types of package trunnion_lcm (src/bus/types), encoded and decoded.

#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trunnion/core/error.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/io/message_map.hpp"
#include "trunnion/io/sample_intake.hpp"
#include "trunnion/positions/sample_sink.hpp"
#include "trunnion/positions/sequence_watch.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace trunnion::io {

/// Fingerprints of the types: part of the format.
inline constexpr std::uint64_t kImuFingerprint = 0x12aff17a21db298cULL;
inline constexpr std::uint64_t kEncoderFingerprint = 0x0cb51f0098d46dacULL;
inline constexpr std::uint64_t kImuBatchFingerprint = 0x42742e60ae44bd0cULL;
inline constexpr std::uint64_t kIndexFingerprint = 0x724d29f1847a9b61ULL;
inline constexpr std::uint64_t kNavigationFingerprint = 0x95dc36850fa1a09cULL;
inline constexpr std::uint64_t kImuCountsFingerprint = 0x9ecd1788d10210a8ULL;

/// Decodes messages of one log into a sink. A message that cannot be decoded is counted as damage, unless there are too
/// many of them: then the first fault is thrown, an Error (input) with the byte and the field. Values that are not
/// finite are refused at once.
class LcmDecoder {
 public:
  /// @param source of the messages, for messages to people: a file, or the address of a bus
  /// @param sink must outlive the decoder
  /// @throws Error (input) for a map that does not fit its type
  LcmDecoder(std::string source, SampleSink& sink, const LogChannels& channels = {});

  /// imu_t, imu_batch_t or imu_counts_t; with a map, its type.
  void imu(const LcmEvent& event);
  /// encoder_t with two axes; with a map, its type.
  void encoder(const LcmEvent& event);

  /// Call after the last message. @param bytes of the log, where lose() was told of it
  /// @throws Error (input) when more than one message in a thousand could not be decoded, or a byte in a hundred is
  /// lost
  void finish(std::int64_t bytes = 0) const { intake_.finish(bytes); }
  /// Bytes of the log that belong to no record, up to one that is whole.
  void lose(std::int64_t bytes, const Error& fault) { intake_.lose(bytes, fault); }

  [[nodiscard]] long long samples() const { return intake_.samples(); }
  [[nodiscard]] long long encoders() const { return intake_.encoders(); }
  /// Messages, and their bytes, that could not be decoded.
  [[nodiscard]] long long damaged_records() const { return intake_.damaged_records(); }
  [[nodiscard]] long long damaged_bytes() const { return intake_.damaged_bytes(); }
  /// What is wrong with the first of them; empty where none is.
  [[nodiscard]] std::string first_fault() const { return intake_.first_fault(); }
  [[nodiscard]] const SequenceWatch& imu_sequence() const { return imu_sequence_; }
  [[nodiscard]] const SequenceWatch& encoder_sequence() const { return encoder_sequence_; }

 private:
  void damage(const LcmEvent& event, const std::string& field, const std::string& what);
  void damage(const LcmEvent& event, const std::string& what);
  void deliver(const LcmEvent& event, std::int64_t utime, const InertialSample<double>& sample);
  void batch(const LcmEvent& event);
  void mapped_imu(const LcmEvent& event);
  void deliver_angles(const LcmEvent& event, std::int64_t utime, const std::array<double, 2>& angle);
  [[nodiscard]] Error fault(const LcmEvent& event, const std::string& field, const std::string& what) const;
  [[nodiscard]] std::string foreign(const LcmEvent& event, std::uint64_t fingerprint,
                                    const std::string& expected) const;

  std::string source_;
  SampleIntake intake_;
  UnitScale<double> counts_;
  std::optional<MappedMessages> imu_map_;
  std::optional<MappedMessages> encoder_map_;
  std::vector<MappedMessages::Sample> mapped_;
  SequenceWatch imu_sequence_;
  SequenceWatch encoder_sequence_;
};

/// Reads a log into @p sink: the IMU channel and the encoder channel; other channels are passed over.
/// @throws Error (input) for a missing, empty or useless log, another type's fingerprint, or values that are not finite
LogLosses read_lcm_recording(const LogRequest& request, SampleSink& sink);

/// Puts other samples into a message of type imu_t or imu_batch_t that was decoded into as many; the rest stays.
/// @return false for a message of another type, which stays as it is
bool replace_samples(const std::vector<InertialSample<double>>& samples, std::string& message);

/// Encodes one message of type imu_t, or encoder_t with two axes, into @p out (cleared first).
/// A @p temperature [degC] that is not known is not a number.
void encode_imu(std::int64_t utime, std::int64_t sequence, const InertialSample<double>& sample, std::string& out,
                double temperature = std::numeric_limits<double>::quiet_NaN());
/// Encodes one message of type imu_batch_t: as many samples as stamps, the first of them number @p sequence.
void encode_imu_batch(std::int64_t sequence, const std::vector<std::int64_t>& utime,
                      const std::vector<InertialSample<double>>& samples, std::string& out,
                      double temperature = std::numeric_limits<double>::quiet_NaN());
/// The content of a message of type imu_counts_t.
struct ImuCounts {
  std::int64_t utime = 0;
  std::int64_t sequence = 0;
  UnitOutput<std::int32_t> counts{};
  std::int32_t temperature = 0;  ///< 1/256 degC, or kNoTemperature

  static constexpr std::int32_t kNoTemperature = std::numeric_limits<std::int32_t>::min();
  /// degC; not a number where it is not measured, or is none
  [[nodiscard]] double celsius() const;
};
/// @return nothing for a message of another type
std::optional<ImuCounts> decode_imu_counts(std::string_view message);
/// Encodes one message of type imu_counts_t: gyro x, y, z, accelerometer x, y, z, and 1/256 degC.
void encode_imu_counts(const ImuCounts& sample, std::string& out);
void encode_encoder(std::int64_t utime, std::int64_t sequence, double azimuth, double pitch, std::string& out);
/// Encodes one message of type navigation_t.
void encode_navigation(std::int64_t utime, std::int64_t sequence, const NavigationState<double>& state,
                       std::string& out);
/// The stamp of an index_t message [us]. @throws Error (input) when it is none
std::int64_t decode_index(const std::string& path, const LcmEvent& event);

}  // namespace trunnion::io
