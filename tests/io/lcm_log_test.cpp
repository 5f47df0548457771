// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/io/lcm_log.hpp"
#include "matchers/log_request.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion::io {
namespace {

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    imu_utime.push_back(utime);
    samples.push_back(s);
  }
  void encoder(std::int64_t utime, double a, double p) override {
    encoder_utime.push_back(utime);
    azimuth.push_back(a);
    pitch.push_back(p);
  }
  void temperature(double told) override { celsius.push_back(told); }
  std::vector<double> celsius;
  std::vector<std::int64_t> imu_utime, encoder_utime;
  std::vector<InertialSample<double>> samples;
  std::vector<double> azimuth, pitch;
};

/// A log of n IMU and n encoder messages; the k-th IMU message may be spoilt before it is written.
std::string write_log(const TemporaryFolder& folder, int n, const std::function<void(int, std::string&)>& spoil = {}) {
  const std::string path = folder / "log.lcm";
  LcmLogWriter log(path);
  std::string message;
  for (int i = 0; i < n; ++i) {
    encode_imu(1000 + 2500 * i, i, {Vec3<double>(0.1 * i, -0.2, 0.3), Vec3<double>(1, 2, 9.8)}, message);
    if (spoil) spoil(i, message);
    log.write(1000 + 2500 * i, "IMU", message);
    encode_encoder(1000 + 2500 * i, i, 0.01 * i, -0.5, message);
    log.write(1000 + 2500 * i, "ENCODER", message);
  }
  log.commit();
  return path;
}

/// Bytes of one IMU and one encoder record: header, channel, data.
constexpr std::size_t kPair = 28 + 3 + 80 + 28 + 7 + 44;

std::string change(const TemporaryFolder& folder, const std::string& path,
                   const std::function<void(std::string&)>& edit) {
  std::string bytes = read_whole(path);
  edit(bytes);
  return folder.file("changed.lcm", bytes);
}

TEST(LcmRecording, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  Collect collect;
  const LogLosses losses = read_lcm_recording(log_request(write_log(folder, 100), {}, true), collect);
  EXPECT_EQ(losses.records, 0);
  EXPECT_EQ(losses.bytes, 0);
  ASSERT_EQ(collect.samples.size(), 100U);
  EXPECT_EQ(collect.imu_utime[7], 1000 + 2500 * 7);
  EXPECT_EQ(collect.samples[7].w, Vec3<double>(0.1 * 7, -0.2, 0.3));
  EXPECT_EQ(collect.azimuth[7], 0.01 * 7);
}

// A message states a temperature, or that it does not know: then it is told once, and what is none counts as unknown.
TEST(LcmRecording, TellsTheTemperature) {
  const TemporaryFolder folder;
  const InertialSample<double> sample{Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)};
  {
    LcmLogWriter log(folder / "warm.lcm");
    std::string message;
    std::int64_t t = 0;
    for (const double celsius : {std::nan(""), 21.5, 1e300, std::nan(""), -40.0}) {
      t += 2500;
      encode_imu(t, t / 2500, sample, message, celsius);
      log.write(t, "IMU", message);
    }
    encode_imu_batch(6, {t + 2500, t + 5000}, {sample, sample}, message, 30.0);
    log.write(t + 5000, "IMU", message);
    ImuCounts raw{t + 7500, 8, {1, 2, 3, 4, 5, 6}, 256 * 33};
    encode_imu_counts(raw, message);
    log.write(t + 7500, "IMU", message);
    raw = {t + 10000, 9, {1, 2, 3, 4, 5, 6}, ImuCounts::kNoTemperature};
    encode_imu_counts(raw, message);
    log.write(t + 10000, "IMU", message);
    log.commit();
  }
  Collect sink;
  LogChannels channels;
  channels.sheet.counts = {{1000.0, 0.0}, {100.0, 0.0}};
  read_lcm_recording(log_request(folder / "warm.lcm", channels, false), sink);
  ASSERT_EQ(sink.celsius.size(), 6U);
  EXPECT_EQ(sink.celsius[0], 21.5);
  EXPECT_TRUE(std::isnan(sink.celsius[1]));
  EXPECT_EQ(sink.celsius[2], -40.0);
  EXPECT_EQ(sink.celsius[3], 30.0);
  EXPECT_EQ(sink.celsius[4], 33.0);
  EXPECT_TRUE(std::isnan(sink.celsius[5]));
  EXPECT_EQ(sink.samples.size(), 9U);
}

// A record whose length was overwritten is lost, and one record only; the rest of the file is read.
TEST(LcmLog, SurvivesACorruptLength) {
  const TemporaryFolder folder;
  const std::string path = change(folder, write_log(folder, 1000), [](std::string& bytes) {
    for (const std::size_t record : {5U, 50U}) bytes.replace(record * kPair + 24, 4, "\x7f\xff\xff\xff");
  });
  Collect collect;
  const LogLosses losses = read_lcm_recording(log_request(path, {}, true), collect);
  EXPECT_EQ(losses.records, 2);
  EXPECT_EQ(losses.bytes, 2 * (28 + 3 + 80));
  EXPECT_EQ(collect.samples.size(), 998U);
  EXPECT_EQ(collect.azimuth.size(), 1000U);
}

// A plausible but wrong length would swallow the records behind it: the sync words inside give it away.
TEST(LcmLog, SurvivesAPlausibleWrongLength) {
  const TemporaryFolder folder;
  const std::string path = change(folder, write_log(folder, 100), [](std::string& bytes) {
    bytes.replace(5 * kPair + 24, 4, std::string("\0\0\x10\0", 4));
  });
  Collect collect;
  EXPECT_EQ(read_lcm_recording(log_request(path, {}, true), collect).records, 1);
  EXPECT_EQ(collect.samples.size(), 99U);
  EXPECT_EQ(collect.azimuth.size(), 100U);
}

TEST(LcmLog, CountsTheRecordsThatAStretchOfDamageTook) {
  const TemporaryFolder folder;
  const std::string path = change(folder, write_log(folder, 1000), [](std::string& bytes) {
    bytes.replace(10 * kPair, 5 * kPair, std::string(5 * kPair, 'x'));
  });
  Collect collect;
  const LogLosses losses = read_lcm_recording(log_request(path, {}, true), collect);
  EXPECT_EQ(losses.records, 10);
  EXPECT_EQ(losses.bytes, static_cast<long long>(5 * kPair));
  EXPECT_EQ(collect.samples.size(), 995U);
}

TEST(LcmLog, ThatIsDamagedThroughoutIsRefused) {
  const TemporaryFolder folder;
  const std::string path = change(folder, write_log(folder, 100), [](std::string& bytes) {
    for (const std::size_t pair : {80U, 60U, 40U, 20U}) bytes.insert(pair * kPair, std::string(400, '\0'));
  });
  Collect collect;
  EXPECT_REFUSES(ExitCode::kInput, "1600 of ", read_lcm_recording(log_request(path, {}, true), collect));
}

TEST(LcmLog, SurvivesACutEnd) {
  const TemporaryFolder folder;
  const std::string path =
      change(folder, write_log(folder, 100), [](std::string& bytes) { bytes.resize(bytes.size() - 10); });
  Collect collect;
  EXPECT_EQ(read_lcm_recording(log_request(path, {}, true), collect).records, 1);
  EXPECT_EQ(collect.samples.size(), 100U);
  EXPECT_EQ(collect.azimuth.size(), 99U);
}

// Real logs begin with LCM_SELF_TEST, which holds no LCM message.
TEST(LcmRecording, PassesOverOtherChannels) {
  const TemporaryFolder folder;
  LcmLogWriter log(folder / "log.lcm");
  std::string message;
  log.write(1, "LCM_SELF_TEST", "lcm self test");
  encode_imu(1000, 0, {Vec3<double>::Zero(), Vec3<double>(0, 0, 9.8)}, message);
  log.write(2, "IMU", message);
  log.commit();
  Collect collect;
  read_lcm_recording(log_request(folder / "log.lcm", {}, false), collect);
  EXPECT_EQ(collect.samples.size(), 1U);
}

TEST(LcmRecording, RefusesWhatItCannotUse) {
  const TemporaryFolder folder;
  Collect collect;
  EXPECT_REFUSES(ExitCode::kInput, "cannot read: No such file",
                 read_lcm_recording(log_request(folder / "none.lcm", {}, true), collect));
  EXPECT_REFUSES(ExitCode::kInput, "is empty",
                 read_lcm_recording(log_request(folder.file("empty.lcm", ""), {}, true), collect));
  EXPECT_REFUSES(
      ExitCode::kInput, "is of no format that is read",
      read_lcm_recording(log_request(folder.file("noise.lcm", std::string(5000, '\xed')), {}, true), collect));
  LogChannels other;
  other.encoder.name = "TABLE";
  EXPECT_REFUSES(ExitCode::kInput, "no usable message on the encoder channel 'TABLE'",
                 read_lcm_recording(log_request(write_log(folder, 10), other, true), collect));
  const std::size_t encoder_record = 2 * kPair + 28 + 3 + 80;
  const auto foreign = [&](int messages) {
    return change(folder, write_log(folder, messages),
                  [&](std::string& b) { b.replace(encoder_record + 28 + 7, 8, std::string(8, '\0')); });
  };
  EXPECT_REFUSES(ExitCode::kInput,
                 "byte " + std::to_string(encoder_record) +
                     ": channel ENCODER: holds a message of another type, fingerprint 0x0000000000000000",
                 read_lcm_recording(log_request(foreign(10), {}, true), collect));
  // one in two thousand is damage, and counted
  EXPECT_EQ(read_lcm_recording(log_request(foreign(1000), {}, true), collect).records, 1);
}

TEST(LcmRecording, RefusesValuesThatAreNotFinite) {
  const TemporaryFolder folder;
  Collect collect;
  const auto spoilt = [&](double value) {
    return write_log(folder, 10, [value](int i, std::string& message) {
      if (i == 3) encode_imu(1000 + 2500 * 3, 3, {Vec3<double>(0, value, 0), Vec3<double>(0, 0, 9.8)}, message);
    });
  };
  const std::string where = "log.lcm: byte " + std::to_string(3 * kPair) + ": angular_rate[1]: is not finite";
  EXPECT_REFUSES(ExitCode::kInput, where, read_lcm_recording(log_request(spoilt(std::nan("")), {}, true), collect));
  EXPECT_REFUSES(ExitCode::kInput, where,
                 read_lcm_recording(log_request(spoilt(std::numeric_limits<double>::infinity()), {}, true), collect));
}

}  // namespace
}  // namespace trunnion::io
