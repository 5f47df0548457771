// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reading logs, one of single samples and one of batches of eight, in our types and in another house's, beside LCM's
/// own reader and a bare read of the file, in one run: the ratios are what counts.

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "io/message_bytes.hpp"
#include "matchers/log_request.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion_lcm/imu_batch_t.hpp"
#include "trunnion_lcm/imu_t.hpp"

namespace trunnion::io {
namespace {

constexpr int kSamples = 2000000;
constexpr int kBatch = 8;

struct Logs {
  Logs() {
    LcmLogWriter one(singles);
    LcmLogWriter eight(batches);
    LcmLogWriter other(foreign);
    const MessageMap& map = message_preset("bot_core.ins_t").map;
    const std::uint64_t fingerprint = map.types->fingerprint(map.type);
    std::string message;
    std::vector<std::int64_t> stamps;
    std::vector<InertialSample<double>> samples;
    for (int i = 0; i < kSamples; ++i) {
      const std::int64_t utime = 1700000000000000 + 125LL * i;
      const InertialSample<double> sample{Vec3<double>(0.001 * (i % 997), 0.2, 0.3), Vec3<double>(1, 2, 9.8)};
      encode_imu(utime, i, sample, message);
      one.write(utime, "IMU", message);
      MessageBytes ins(fingerprint);
      ins.i64(utime).i64(0);
      for (int k = 0; k < 15; ++k) ins.f64(k < 3 ? sample.w(k) : 0.5);
      other.write(utime, "IMU", ins.bytes());
      stamps.push_back(utime);
      samples.push_back(sample);
      if (stamps.size() < kBatch) continue;
      encode_imu_batch(i + 1 - kBatch, stamps, samples, message);
      eight.write(utime, "IMU", message);
      stamps.clear();
      samples.clear();
    }
    one.commit();
    eight.commit();
    other.commit();
  }
  TemporaryFolder folder;
  std::string singles = folder / "singles.lcm";
  std::string batches = folder / "batches.lcm";
  std::string foreign = folder / "foreign.lcm";
};

const Logs& logs() {
  static const Logs made;
  return made;
}

class Sum final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& sample) override {
    sum += sample.w.x() + static_cast<double>(utime);
  }
  void encoder(std::int64_t, double, double) override {}
  double sum = 0.0;
};

template <class Read>
void measure(benchmark::State& state, const std::string& path, Read&& read) {
  for (auto _ : state) read(path);
  state.SetItemsProcessed(state.iterations() * kSamples);
}

void bare(const std::string& path) {
  static std::vector<char> block(std::size_t{1} << 18U);
  const int file = ::open(path.c_str(), O_RDONLY);
  while (::read(file, block.data(), block.size()) > 0) benchmark::DoNotOptimize(block.data());
  ::close(file);
}

template <class Message>
void peer(const std::string& path) {
  lcm::LogFile log(path, "r");
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    Message message;
    message.decode(event->data, 0, event->datalen);
    benchmark::DoNotOptimize(message);
  }
}

void peer_headers(const std::string& path) {
  lcm::LogFile log(path, "r");
  while (const lcm::LogEvent* event = log.readNextEvent()) benchmark::DoNotOptimize(event->timestamp);
}

void headers(const std::string& path) {
  LcmLogReader log(path);
  LcmEvent event;
  while (log.next(event)) benchmark::DoNotOptimize(event.timestamp);
}

void decoded(const std::string& path) {
  Sum sum;
  read_lcm_recording(log_request(path, {}, false), sum);
  benchmark::DoNotOptimize(sum.sum);
}

void decoded_by_map(const std::string& path) {
  Sum sum;
  LogChannels channels;
  channels.imu = {"IMU", std::make_shared<const MessageMap>(message_preset("bot_core.ins_t").map)};
  read_lcm_recording(log_request(path, channels, false), sum);
  benchmark::DoNotOptimize(sum.sum);
}

#define TRUNNION_MEASURE(name, log, ...)                                          \
  void name(benchmark::State& state) { measure(state, logs().log, __VA_ARGS__); } \
  BENCHMARK(name)->Unit(benchmark::kMillisecond)

TRUNNION_MEASURE(SinglesBareRead, singles, bare);
TRUNNION_MEASURE(SinglesLcmLogFileHeaders, singles, peer_headers);
TRUNNION_MEASURE(SinglesLcmLogFileDecoded, singles, peer<trunnion_lcm::imu_t>);
TRUNNION_MEASURE(SinglesOurHeaders, singles, headers);
TRUNNION_MEASURE(SinglesOurDecoded, singles, decoded);
TRUNNION_MEASURE(SinglesForeignOurDecoded, foreign, decoded_by_map);
TRUNNION_MEASURE(BatchesBareRead, batches, bare);
TRUNNION_MEASURE(BatchesLcmLogFileHeaders, batches, peer_headers);
TRUNNION_MEASURE(BatchesLcmLogFileDecoded, batches, peer<trunnion_lcm::imu_batch_t>);
TRUNNION_MEASURE(BatchesOurHeaders, batches, headers);
TRUNNION_MEASURE(BatchesOurDecoded, batches, decoded);

}  // namespace
}  // namespace trunnion::io
