// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reading and compressing a log of single-sample messages beside a bare loop of LCM's own reader, and the whole solve,
/// in one run: the ratios are what counts.

#include <benchmark/benchmark.h>

#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "calibration/experiment.hpp"
#include "matchers/log_request.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion_lcm/encoder_t.hpp"
#include "trunnion_lcm/imu_t.hpp"

namespace trunnion {
namespace {

/// The three logs of the experiment, written once.
const std::vector<std::string>& logs() {
  static const TemporaryFolder folder;
  static const std::vector<std::string> paths = [] {
    std::vector<std::string> made;
    const simulation::TableRunSettings settings;
    const Rig rig = calibration::cyclic_rig();
    const Site site = calibration::bench();
    const CalibrationValues truth = simulation::draw_truth(settings, rig, site, kMounts);
    for (int m = 0; m < kMounts; ++m) {
      made.push_back(folder / ("position_" + std::to_string(m + 1) + ".lcm"));
      io::LcmLogWriter log(made.back());
      std::string message;
      simulation::run_table(settings, truth, rig, site,
                            simulation::motion_of(simulation::experiment(-10.0 * kRadPerDeg, 70.0 * kRadPerDeg, m)), m,
                            m,
                            {[&](std::int64_t t, std::int64_t n, const InertialSample<double>& s) {
                               io::encode_imu(t, n, s, message);
                               log.write(t, "IMU", message);
                             },
                             [&](std::int64_t t, std::int64_t n, double a, double p) {
                               io::encode_encoder(t, n, a, p, message);
                               log.write(t, "ENCODER", message);
                             }});
      log.commit();
    }
    return made;
  }();
  return paths;
}

calibration::CompressedRecording compress(const std::string& path, io::Sha256* digest) {
  calibration::Compressor compressor({});
  io::read_lcm_recording(io::log_request(path, {}, true, digest), compressor);
  return compressor.finish();
}

void LcmLogFileDecodesAndDiscards(benchmark::State& state) {
  long long samples = 0;
  for (auto _ : state) {
    lcm::LogFile log(logs().front(), "r");
    while (const lcm::LogEvent* event = log.readNextEvent()) {
      if (event->channel == "IMU") {
        trunnion_lcm::imu_t message;
        message.decode(event->data, 0, event->datalen);
        benchmark::DoNotOptimize(message);
        ++samples;
      } else {
        trunnion_lcm::encoder_t message;
        message.decode(event->data, 0, event->datalen);
        benchmark::DoNotOptimize(message);
      }
    }
  }
  state.SetItemsProcessed(samples);
}
BENCHMARK(LcmLogFileDecodesAndDiscards)->Unit(benchmark::kMillisecond);

void WeReadAndCompress(benchmark::State& state) {
  long long samples = 0;
  std::size_t bytes = 0;
  double minutes = 1.0;
  for (auto _ : state) {
    const calibration::CompressedRecording recording = compress(logs().front(), nullptr);
    samples += recording.figures.samples;
    bytes = recording.windows.size() * sizeof(ObservationWindow) + recording.course.bytes();
    minutes = recording.figures.duration / 60.0;
  }
  state.SetItemsProcessed(samples);
  state.counters["kB_per_minute"] = static_cast<double>(bytes) / 1000.0 / minutes;
}
BENCHMARK(WeReadAndCompress)->Unit(benchmark::kMillisecond);

void WeReadDigestAndCompress(benchmark::State& state) {
  long long samples = 0;
  for (auto _ : state) {
    io::Sha256 digest;
    samples += compress(logs().front(), &digest).figures.samples;
    benchmark::DoNotOptimize(digest.finish());
  }
  state.SetItemsProcessed(samples);
}
BENCHMARK(WeReadDigestAndCompress)->Unit(benchmark::kMillisecond);

void WeSolveTheThreeLogs(benchmark::State& state) {
  long long samples = 0;
  for (auto _ : state) {
    std::vector<calibration::TableRecording> recordings;
    for (const std::string& path : logs())
      recordings.push_back({compress(path, nullptr), static_cast<int>(recordings.size())});
    calibration::TableSolveOptions options;
    options.noise = simulation::TableRunSettings().noise;
    const calibration::Solution solution =
        calibration::solve_table(recordings, calibration::cyclic_rig(), calibration::bench(), options);
    samples += solution.record.fit.samples;
  }
  state.SetItemsProcessed(samples);
}
BENCHMARK(WeSolveTheThreeLogs)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace trunnion

BENCHMARK_MAIN();
