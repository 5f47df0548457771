// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A million mutated messages through every decoder: each is decoded or left out, nothing else happens, and memory
/// stays where it was. Under the sanitize preset a memory error or undefined behaviour ends the test.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "fuzz/mutate.hpp"
#include "io/message_bytes.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

constexpr int kMessages = 1000000;
// kB; a decoder that believes a count asks for 16 GB. AddressSanitizer keeps what was freed for a while.
#if defined(__SANITIZE_ADDRESS__)
constexpr long kMostGrowth = 1000000;
#elif defined(__has_feature)
constexpr long kMostGrowth = __has_feature(address_sanitizer) ? 1000000 : 200000;
#else
constexpr long kMostGrowth = 200000;
#endif

long peak_kilobytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  long peak = 0;
  while (status >> word) {
    if (word == "VmHWM:") status >> peak;
  }
  return peak;
}

class Count final : public SampleSink {
 public:
  void imu(std::int64_t, const InertialSample<double>& sample) override {
    ++samples;
    finite = finite && sample.w.allFinite() && sample.f.allFinite();
  }
  void encoder(std::int64_t, double azimuth, double pitch) override {
    ++samples;
    finite = finite && std::isfinite(azimuth) && std::isfinite(pitch);
  }
  long long samples = 0;
  bool finite = true;
};

/// One channel under fire: its decoder, and a good message of it.
struct Target {
  LogChannels channels;
  bool imu = true;
  std::string seed;
};

std::vector<Target> targets() {
  std::vector<Target> all;
  const auto own = [&](bool imu, const std::string& seed) { all.push_back({{}, imu, seed}); };
  std::string message;
  const InertialSample<double> sample{Vec3<double>(0.1, 0.2, 0.3), Vec3<double>(1, 2, 9.8)};
  encode_imu(1700000000000000, 5, sample, message);
  own(true, message);
  encode_imu_batch(5, {1, 2, 3, 4}, {sample, sample, sample, sample}, message);
  own(true, message);
  encode_imu_counts({1, 2, {3, 4, 5, 6, 7, 8}, 9}, message);
  own(true, message);
  all.back().channels.sheet.counts.gyro.scale = all.back().channels.sheet.counts.accel.scale = 100.0;
  encode_encoder(1, 2, 0.5, 0.25, message);
  own(false, message);
  // a house whose time is split, in arrays that may be empty
  const auto split = std::make_shared<MessageMap>();
  const auto types = std::make_shared<LcmTypes>();
  types->add_text(
      "struct t { int8_t n; int32_t sec[n]; int8_t m; int32_t nsec[m]; double a[2]; double w[3], f[3]; int64_t stamp; "
      "}",
      "t");
  split->types = types;
  split->type = "t";
  split->clock = MessageMap::Clock::kSecondsAndNanoseconds;
  split->time = {{"sec", "nsec"}, "s"};
  split->angle = {{"a"}, "rad"};
  MessageBytes seconds(types->fingerprint("t"));
  seconds.i8(1).i32(5).i8(1).i32(6);
  for (int i = 0; i < 8; ++i) seconds.f64(0.5);
  seconds.i64(std::numeric_limits<std::int64_t>::min());
  Target encoders;
  encoders.imu = false;
  encoders.channels.encoder = {"X", split};
  encoders.seed = seconds.bytes();
  all.push_back(encoders);
  const auto units = std::make_shared<MessageMap>(*split);
  units->angle = {};
  units->gyro = {{"w"}, "rad/s"};
  units->accel = {{"f"}, "m/s^2"};
  Target unit = encoders;
  unit.imu = true;
  unit.channels.imu = {"X", units};
  unit.channels.encoder.map = nullptr;
  all.push_back(unit);
  for (const MessagePreset& preset : message_presets()) {
    Target target;
    const auto map = std::make_shared<const MessageMap>(preset.map);
    (preset.is_imu ? target.channels.imu : target.channels.encoder) = {"X", map};
    target.channels.sheet.rate_hz = 1000.0;
    target.imu = preset.is_imu;
    MessageBytes m(map->types->fingerprint(map->type));
    if (preset.name == "bot_core.kvh_raw_imu_batch_t") {
      m.i64(1).i32(3);
      for (int i = 0; i < 3; ++i) m.i64(i).i64(i).f64(1e-3).f64(1e-3).f64(1e-3).f64(1).f64(2).f64(9);
    } else if (preset.name == "bot_core.joint_state_t") {
      m.i64(1).i16(2).text("azimuth").text("pitch");
      for (int i = 0; i < 6; ++i) m.f32(0.5F);
    } else if (preset.name == "sensor_msgs.JointState") {
      m.i32(2).i32(2).i32(0).i32(0).i32(1).i32(2).i32(3).text("base").text("azimuth").text("pitch").f64(1).f64(2);
    } else if (preset.name == "sensor_msgs.Imu") {
      m.i32(1).i32(2).i32(3).text("imu_link");
      for (int i = 0; i < 4 + 9 + 3 + 9 + 3 + 9; ++i) m.f64(0.1 * i);
    } else if (preset.name == "drake.lcmt_iiwa_status") {
      m.i64(1).i32(2);
      for (int i = 0; i < 14; ++i) m.f64(0.1);
    } else {
      // the rest are of one size: filled up to it
      LcmFieldReader reader(*map->types, map->type, {});
      while (!reader.read(m.bytes()) && m.bytes().size() < 400) m.f32(0.5F);
    }
    target.seed = m.bytes();
    all.push_back(target);
  }
  return all;
}

TEST(Messages, AMillionMutatedOnesAreDecodedOrLeftOut) {
  const std::vector<Target> all = targets();
  std::vector<LcmDecoder> decoders;
  Count sink;
  for (const Target& target : all) {
    decoders.emplace_back("bus", sink, target.channels);
    LcmEvent event;
    event.byte = -1;
    event.data = target.seed;
    const long long before = sink.samples;
    target.imu ? decoders.back().imu(event) : decoders.back().encoder(event);
    ASSERT_GT(sink.samples, before) << "a good message of target " << decoders.size() << " is not decoded";
  }
  const long before = peak_kilobytes();
  std::mt19937_64 rng(20261126);
  long long refused = 0;
  for (int i = 0; i < kMessages; ++i) {
    const std::size_t t = static_cast<std::size_t>(i) % all.size();
    // two of three keep the fingerprint: what is behind it is to be reached
    std::string message =
        i % 3 == 0 ? mutate(all[t].seed, rng) : all[t].seed.substr(0, 8) + mutate(all[t].seed.substr(8), rng);
    LcmEvent event;
    event.number = i;
    event.byte = -1;
    event.channel = "X";
    event.data = message;
    try {
      all[t].imu ? decoders[t].imu(event) : decoders[t].encoder(event);
    } catch (const Error& e) {
      ++refused;
      ASSERT_EQ(e.code(), ExitCode::kInput) << e.what();
    }
  }
  long long damaged = 0;
  for (const LcmDecoder& decoder : decoders) damaged += decoder.damaged_records();
  const long growth = peak_kilobytes() - before;
  std::printf(
      "[ FIGURE   ] %d mutated messages of %zu types: %lld samples, %lld left out, %lld not finite, memory grew by %ld "
      "kB\n",
      kMessages, all.size(), sink.samples, damaged, refused, growth);
  EXPECT_TRUE(sink.finite);
  EXPECT_GT(damaged, kMessages / 10);
  EXPECT_GT(sink.samples, kMessages / 20);  // not all are caught at the door
  EXPECT_LT(growth, kMostGrowth);
}

TEST(Messages, MutatedDefinitionsAreReadOrRefused) {
  const std::string seed =
      "package p; struct a_t { const int32_t N = 3; int32_t n; double x[n][3]; string s; byte b[n]; }\n"
      "struct b_t { int64_t t; a_t a[2]; p.a_t c; } // and so on\n/* c */ enum e { A = 1 }\n";
  std::mt19937_64 rng(20261127);
  for (int i = 0; i < 50000; ++i) {
    try {
      LcmTypes types;
      types.add_text(mutate(seed, rng), "fuzz.lcm");
      for (const std::string& name : types.names()) {
        LcmFieldReader reader(types, name, {});
        reader.read(std::string(200, '\x01'));
      }
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ExitCode::kInput) << e.what();
    }
  }
}

}  // namespace
}  // namespace trunnion::io
