// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the readers' tests share: a sink that keeps all, and a log of a few bytes.

#pragma once

#include <gmock/gmock.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/log_format.hpp"

namespace trunnion::io {

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    stamps.push_back(utime);
    samples.push_back(s);
  }
  void temperature(double celsius) override { temperatures.push_back(celsius); }
  void encoder(std::int64_t utime, double azimuth, double pitch) override {
    reading_stamps.push_back(utime);
    angles.push_back({azimuth, pitch});
  }
  std::vector<std::int64_t> stamps;
  std::vector<InertialSample<double>> samples;
  std::vector<double> temperatures;
  std::vector<std::int64_t> reading_stamps;
  std::vector<std::array<double, 2>> angles;
};

inline const InertialSample<double> kSample{Vec3<double>(0.25, -0.5, 0.125),
                                            Vec3<double>(1.5, -2.25, 9.75)};  // of few bits

/// Reads what a test writes.
class LogReading : public testing::Test {
 protected:
  LogLosses read(const std::string& text, const LogRequest& wish = {}) {
    LogRequest request = wish;
    request.path = folder_.file("a.log", text);
    collect_ = std::make_unique<Collect>();
    return read_log(request, *collect_);
  }
  std::string format(const std::string& text) { return format_of(folder_.file("a.log", text)).name; }
  TemporaryFolder folder_;
  std::unique_ptr<Collect> collect_;
};

}  // namespace trunnion::io
