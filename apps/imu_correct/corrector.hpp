// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages in, corrected messages out, by the code that runs in firmware.

#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trunnion/error_model/count_correction.hpp"
#include "trunnion/error_model/stream_correction.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/sensor_sheet.hpp"

namespace trunnion::app {

struct CorrectorOptions {
  std::string calibration;  ///< a calibration file, or the block of `imu_calibrate export --block`
  std::string sheet;        ///< what a raw count is; empty: none are expected
  int recording = 0;        ///< whose turn-on bias; 0: the mean
  int bits = 16;
  int fraction = 6;
  bool in_floating_point = false;  ///< raw counts too
};

/// Whether the sheet's counts can be those of a register of @p bits.
/// @throws Error (input) for a scale that makes no raw counts, or a range that the register does not hold
void check_counts(const io::SensorSheet& sheet, const std::string& path, int bits);

/// What is wrong with a sample that can_be_undone() is false for.
constexpr const char* kNotUndone = "is so large that the nonlinear terms of the calibration cannot be undone";

/// Whether @p corrected is the input to @p unit, and not what an iteration ended at that does not converge.
bool can_be_undone(const InertialUnit<double>& unit, const InertialSample<double>& corrected);

/// One calibration along one stream of samples. A new file makes a new one.
class Corrector {
 public:
  /// @throws Error (input) for files that cannot be read or do not fit together
  explicit Corrector(const CorrectorOptions& options);

  /// @param utime [us]; @param temperature [degC]; not a number where it is not known: that of before holds on, in the
  /// beginning the calibration's reference
  [[nodiscard]] InertialSample<double> correct(std::int64_t utime, const InertialSample<double>& reading,
                                               double temperature);
  /// Raw counts, in integers where the calibration allows it.
  [[nodiscard]] InertialSample<double> correct(const io::ImuCounts& raw);

  /// can_be_undone() of what correct() made; of a block: whether it is finite.
  [[nodiscard]] bool undoes(const InertialSample<double>& corrected) const;

  [[nodiscard]] bool takes_si() const { return si_.has_value() || si_float_.has_value(); }
  [[nodiscard]] bool takes_counts() const { return integers_ || counts_.has_value() || counts_float_.has_value(); }
  /// Samples so far that stated no temperature, of a calibration that has terms of it.
  [[nodiscard]] long long without_temperature() const { return without_temperature_; }
  /// For messages: how raw counts are corrected.
  [[nodiscard]] const char* path() const;

 private:
  void take_temperature(double celsius);
  void read_block(const CorrectorOptions& options, const UnitScale<double>& scale);

  InertialUnit<double> unit_;  // perfect where a block says what it is
  std::optional<StreamCorrection<double>> si_;
  std::optional<UnitCorrection<float>> si_float_;  // of a block
  std::optional<StreamCorrection<double>> counts_;
  std::optional<UnitCorrection<float>> counts_float_;
  std::unique_ptr<CountCoefficients> integers_;
  double gyro_out_ = 1.0;  // SI of a count out
  double accel_out_ = 1.0;
  bool thermal_ = false;
  double celsius_ = std::numeric_limits<double>::quiet_NaN();  // the last that was stated
  long long without_temperature_ = 0;
};

/// Messages of one channel, corrected.
class CorrectedMessages {
 public:
  /// @param source for messages
  CorrectedMessages(const std::string& source, const io::LogChannels& channels);

  /// @return the corrected message; nothing when it could not be decoded: why() says it
  const std::string* correct(const io::LcmEvent& event, Corrector& corrector);

  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] long long samples() const { return samples_; }
  [[nodiscard]] long long damaged() const { return damaged_; }
  [[nodiscard]] long long damaged_bytes() const { return damaged_bytes_; }
  /// Of a log, after the last message. @throws Error (input) when more than one in a thousand was left out
  void finish() const;
  [[nodiscard]] const SequenceWatch& sequence() const { return mapped_ ? decoder_.imu_sequence() : sequence_; }

 private:
  class Samples final : public SampleSink {
   public:
    void imu(std::int64_t utime, const InertialSample<double>& sample) override {
      stamps.push_back(utime);
      values.push_back(sample);
    }
    void temperature(double told) override { celsius = told; }
    void encoder(std::int64_t, double, double) override {}
    std::vector<std::int64_t> stamps;
    std::vector<InertialSample<double>> values;
    double celsius = std::numeric_limits<double>::quiet_NaN();
  };

  const std::string* left_out(const io::LcmEvent& event, const std::string& why);

  Samples taken_;
  io::LcmDecoder decoder_;
  bool mapped_;
  SequenceWatch sequence_;
  std::string message_;
  std::string why_;
  std::string first_fault_;
  long long samples_ = 0;
  long long damaged_ = 0;
  long long damaged_bytes_ = 0;
};

}  // namespace trunnion::app
