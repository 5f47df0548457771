// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What readers of binary logs do with a sample: refuse what is no number, count what is beyond any sensor as damage,
/// and say in the end whether there was too much of it. A table, which people write, is refused at once, by its line.

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "trunnion/core/error.hpp"
#include "trunnion/positions/sample_sink.hpp"

namespace trunnion::io {

class SampleIntake {
 public:
  static constexpr double kLargestReading = 1e6;  ///< rad/s, m/s^2, and rad of a table's column

  /// @param sink must outlive the intake
  explicit SampleIntake(SampleSink& sink) : sink_(sink) {}

  /// @param fault makes an Error of a field and of what is wrong with it: it knows the place
  template <class Fault>
  void imu(std::int64_t utime, const InertialSample<double>& sample, std::size_t bytes, const Fault& fault) {
    const double w = std::abs(sample.w(0)) + std::abs(sample.w(1)) + std::abs(sample.w(2));
    const double f = std::abs(sample.f(0)) + std::abs(sample.f(1)) + std::abs(sample.f(2));
    if (!(w + f < kLargestReading)) {
      for (int i = 0; i < 6; ++i) {
        const double value = i < 3 ? sample.w(i) : sample.f(i - 3);
        const std::string field = (i < 3 ? "angular_rate[" : "specific_force[") + std::to_string(i % 3) + "]";
        if (!std::isfinite(value)) throw fault(field, "is not finite");
        if (std::abs(value) >= kLargestReading / 6.0) return damage(bytes, fault(field, "is beyond any sensor"));
      }
    }
    ++samples_;
    sink_.imu(utime, sample);
  }

  template <class Fault>
  void encoder(std::int64_t utime, const std::array<double, 2>& angle, std::size_t bytes, const Fault& fault) {
    for (std::size_t i = 0; i < angle.size(); ++i) {
      if (!std::isfinite(angle[i])) throw fault("angle[" + std::to_string(i) + "]", "is not finite");
      if (std::abs(angle[i]) > kLargestAngle) return damage(bytes, fault("angle", "is beyond a million turns"));
    }
    ++encoders_;
    sink_.encoder(utime, angle[0], angle[1]);
  }

  /// What is no temperature is not known: not a number.
  static double known_temperature(double celsius) {
    return celsius > kColdest && celsius < kHottest ? celsius : std::nan("");
  }

  void temperature(double celsius) {
    celsius = known_temperature(celsius);
    const bool known = std::isfinite(celsius);
    if (!known && !told_temperature_) return;
    told_temperature_ = known;
    sink_.temperature(celsius);
  }

  void damage(std::size_t bytes, const Error& fault) {
    if (!first_fault_) first_fault_ = fault;
    ++damaged_records_;
    damaged_bytes_ += static_cast<long long>(bytes);
  }

  /// A stretch of bytes within a log that no record could be read from; a log that was cut has none at its end.
  void lose(std::int64_t bytes, const Error& fault) {
    if (!first_loss_) first_loss_ = fault;
    ++lost_stretches_;
    lost_bytes_ += bytes;
  }

  /// Call after the last. @param bytes of the log, where lose() was told of it
  /// @throws Error, the first, when more than one record in a thousand is damaged, or one byte in a hundred lost
  void finish(std::int64_t bytes = 0) const {
    if (first_loss_ && static_cast<double>(lost_bytes_) > kTolerableLoss * static_cast<double>(bytes))
      throw Error(first_loss_->code(), std::string(first_loss_->what()) + "; " + std::to_string(lost_bytes_) + " of " +
                                           std::to_string(bytes) + " bytes cannot be read");
    const auto whole = static_cast<double>(samples_ + encoders_);
    if (first_fault_ && static_cast<double>(damaged_records_) > kTolerableDamage * whole) throw *first_fault_;
  }

  [[nodiscard]] long long samples() const { return samples_; }
  [[nodiscard]] long long encoders() const { return encoders_; }
  [[nodiscard]] long long damaged_records() const { return damaged_records_; }
  [[nodiscard]] long long damaged_bytes() const { return damaged_bytes_; }
  [[nodiscard]] long long lost_stretches() const { return lost_stretches_; }
  [[nodiscard]] std::int64_t lost_bytes() const { return lost_bytes_; }
  /// Where the first stretch was lost, and why; empty where none was.
  [[nodiscard]] std::string first_loss() const { return first_loss_ ? first_loss_->what() : std::string(); }
  /// What is wrong with the first that is damaged; empty where none is.
  [[nodiscard]] std::string first_fault() const { return first_fault_ ? first_fault_->what() : std::string(); }

 private:
  static constexpr double kTolerableDamage = 1e-3;  // what cannot be used, against what can
  static constexpr double kTolerableLoss = 0.01;    // of the bytes
  static constexpr double kLargestAngle = 1e7;      // rad
  static constexpr double kColdest = -273.15;       // degC
  static constexpr double kHottest = 1000.0;

  SampleSink& sink_;
  bool told_temperature_ = false;
  long long samples_ = 0;
  long long encoders_ = 0;
  long long damaged_records_ = 0;
  long long damaged_bytes_ = 0;
  long long lost_stretches_ = 0;
  std::int64_t lost_bytes_ = 0;
  std::optional<Error> first_fault_;
  std::optional<Error> first_loss_;
};

}  // namespace trunnion::io
