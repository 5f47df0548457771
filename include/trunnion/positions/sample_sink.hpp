// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where samples go, whoever reads them: files, logs, a bus.

#pragma once

#include <cstdint>

#include "trunnion/error_model/inertial_unit.hpp"

namespace trunnion {

class SampleSink {
 public:
  SampleSink() = default;
  SampleSink(const SampleSink&) = delete;
  SampleSink& operator=(const SampleSink&) = delete;
  virtual ~SampleSink() = default;

  /// Angular rate [rad/s] and specific force [m/s^2], means over the period that ends at @p utime [us].
  virtual void imu(std::int64_t utime, const InertialSample<double>& sample) = 0;

  /// Reading of the unit's thermometer [degC]: of the samples that follow, until the next.
  virtual void temperature(double celsius) { static_cast<void>(celsius); }

  /// Readings of the outer and the inner encoder [rad] at @p utime [us].
  virtual void encoder(std::int64_t utime, double azimuth, double pitch) = 0;
};

}  // namespace trunnion
