// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Our logs and messages against LCM's own reader, writer and generated types.

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <vector>

#include "matchers/log_request.hpp"
#include "matchers/refuses.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/io/gnss_messages.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion_lcm/attitude_t.hpp"
#include "trunnion_lcm/encoder_t.hpp"
#include "trunnion_lcm/gnss_orbit_t.hpp"
#include "trunnion_lcm/gnss_raw_t.hpp"
#include "trunnion_lcm/imu_batch_t.hpp"
#include "trunnion_lcm/imu_t.hpp"
#include "trunnion_lcm/index_t.hpp"
#include "trunnion_lcm/navigation_t.hpp"

namespace trunnion::io {
namespace {

TEST(LcmPeer, TheFingerprintsAreThoseOfTheGeneratedTypes) {
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::imu_t::getHash()), kImuFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::encoder_t::getHash()), kEncoderFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::imu_batch_t::getHash()), kImuBatchFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::index_t::getHash()), kIndexFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::navigation_t::getHash()), kNavigationFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::gnss_raw_t::getHash()), kGnssRawFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::gnss_orbit_t::getHash()), kGnssOrbitFingerprint);
  EXPECT_EQ(static_cast<std::uint64_t>(trunnion_lcm::attitude_t::getHash()), kAttitudeFingerprint);
}

template <class Message>
std::string encoded(const Message& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

TEST(LcmPeer, ReadsOurPhasesOrbitsAndAttitudesAndWeItsOwn) {
  const std::vector<SignalName> signals = {SignalName::parse("G1C"), SignalName::parse("C2I")};
  GnssRaw raw;
  raw.utime = 42;
  raw.sequence = 7;
  raw.antenna = 1;
  raw.epoch.time = {2320, 116400.25};
  for (int i = 0; i < 3; ++i) {
    SignalObservation o;
    o.satellite = {i == 2 ? SatelliteSystem::kBeidou : SatelliteSystem::kGps, 5 + i};
    o.signal = i == 2 ? 1 : 0;
    o.code = 2.1e7 + i;
    o.phase = 1.1e8 + 0.25 * i;
    o.doppler = -100.0 * i;
    o.half_cycle = i == 1;
    raw.epoch.at.push_back(o);
  }
  std::string message;
  encode_gnss_raw(raw, signals, message);
  trunnion_lcm::gnss_raw_t peer;
  ASSERT_EQ(peer.decode(message.data(), 0, static_cast<int>(message.size())), static_cast<int>(message.size()));
  EXPECT_EQ(peer.antenna, 1);
  EXPECT_EQ(peer.seconds, 116400.25);
  ASSERT_EQ(peer.num_signals, 3);
  EXPECT_EQ(peer.satellite[2], 307);
  EXPECT_EQ(peer.signal[0], '1' * 256 + 'C');
  EXPECT_EQ(peer.phase[1], 1.1e8 + 0.25);
  EXPECT_EQ(peer.half_cycle[1], 1);
  EXPECT_EQ(encoded(peer), message);
  const auto back = decode_gnss_raw(message, {signals[1]});
  ASSERT_TRUE(back.has_value());
  ASSERT_EQ(back->epoch.at.size(), 1U) << "the signal that was asked for";
  EXPECT_EQ(back->epoch.at[0].satellite.text(), "C07");
  EXPECT_EQ(back->epoch.at[0].doppler, -200.0);

  BroadcastOrbit orbit;
  orbit.system = SatelliteSystem::kGalileo;
  orbit.number = 12;
  orbit.toe = {2320, 7200.0};
  orbit.toc = {2320, 7200.0};
  orbit.toe_of_week = 7200.0;
  orbit.sqrt_a = 5440.6;
  orbit.cis = 1e-8;
  orbit.af1 = 1e-12;
  encode_gnss_orbit(1, 2, orbit, message);
  trunnion_lcm::gnss_orbit_t peer_orbit;
  ASSERT_EQ(peer_orbit.decode(message.data(), 0, static_cast<int>(message.size())), static_cast<int>(message.size()));
  EXPECT_EQ(peer_orbit.satellite, 112);
  EXPECT_EQ(peer_orbit.elements[0], 5440.6);
  EXPECT_EQ(peer_orbit.elements[14], 1e-8);
  EXPECT_EQ(peer_orbit.clock[1], 1e-12);
  const auto same = decode_gnss_orbit(message);
  ASSERT_TRUE(same.has_value());
  EXPECT_EQ(satellite_at(*same, {2320, 8000.0}).value().r, satellite_at(orbit, {2320, 8000.0}).value().r);

  AttitudeMessage attitude;
  attitude.utime = 9;
  attitude.status = AttitudeStatus::kFixed;
  attitude.satellites = 300;
  attitude.attitude.observable = 2;
  attitude.attitude.q_nb = Quaternion<double>(0.5, -0.5, 0.5, -0.5);
  attitude.attitude.covariance(0, 2) = 0.25;
  attitude.attitude.free_axis.x() = 1.0;
  encode_attitude(attitude, message);
  trunnion_lcm::attitude_t peer_attitude;
  ASSERT_EQ(peer_attitude.decode(message.data(), 0, static_cast<int>(message.size())),
            static_cast<int>(message.size()));
  EXPECT_EQ(peer_attitude.status, 4);
  EXPECT_EQ(peer_attitude.observable, 2);
  EXPECT_EQ(peer_attitude.satellites, 300);
  EXPECT_EQ(peer_attitude.attitude[3], -0.5);
  EXPECT_EQ(peer_attitude.covariance[2], 0.25);
  EXPECT_TRUE(std::isnan(peer_attitude.rate[0])) << "not estimated";
  const auto decoded = decode_attitude(message);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->satellites, 300);
  EXPECT_EQ(decoded->attitude.covariance(0, 2), 0.25);
  EXPECT_FALSE(decode_attitude(message.substr(1)).has_value());
  EXPECT_FALSE(decode_gnss_orbit(message).has_value());
  EXPECT_FALSE(decode_gnss_raw(message, signals).has_value());
}

TEST(LcmPeer, ReadsOurNavigationAndWeItsIndex) {
  NavigationState<double> state;
  state.latitude = 0.7;
  state.height = 120.0;
  state.velocity = Vec3<double>(1.0, 2.0, 3.0);
  state.attitude = Quaternion<double>(0.5, -0.5, 0.5, -0.5);
  std::string message;
  encode_navigation(42, 7, state, message);
  trunnion_lcm::navigation_t navigation;
  ASSERT_EQ(navigation.decode(message.data(), 0, static_cast<int>(message.size())), static_cast<int>(message.size()));
  EXPECT_EQ(navigation.utime, 42);
  EXPECT_EQ(navigation.latitude, 0.7);
  EXPECT_EQ(navigation.height, 120.0);
  EXPECT_EQ(navigation.velocity[2], 3.0);
  EXPECT_EQ(navigation.attitude[3], -0.5);

  trunnion_lcm::index_t index;
  index.utime = 1234567;
  index.sequence = 1;
  index.turns = 9;
  std::string pulse(static_cast<std::size_t>(index.getEncodedSize()), '\0');
  ASSERT_EQ(index.encode(pulse.data(), 0, static_cast<int>(pulse.size())), static_cast<int>(pulse.size()));
  LcmEvent event;
  event.channel = "INDEX";
  event.data = pulse;
  EXPECT_EQ(decode_index("a.lcm", event), 1234567);
  pulse[0] = 'x';
  EXPECT_REFUSES(ExitCode::kInput, "is not of type index_t", decode_index("a.lcm", event));
}

TEST(LcmPeer, ReadsWhatWeWrite) {
  const TemporaryFolder folder;
  LcmLogWriter log(folder / "ours.lcm");
  std::string message;
  for (int i = 0; i < 50; ++i) {
    encode_imu(100 + i, i, {Vec3<double>(i, 0.5, -1), Vec3<double>(1, 2, 3)}, message);
    log.write(100 + i, "IMU", message);
    encode_encoder(100 + i, i, 0.25 * i, -0.125, message);
    log.write(100 + i, "ENCODER", message);
  }
  log.commit();
  lcm::LogFile peer(folder / "ours.lcm", "r");
  ASSERT_TRUE(peer.good());
  for (int i = 0; i < 50; ++i) {
    const lcm::LogEvent* event = peer.readNextEvent();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, 2 * i);
    EXPECT_EQ(event->timestamp, 100 + i);
    EXPECT_EQ(event->channel, "IMU");
    trunnion_lcm::imu_t imu{};
    ASSERT_EQ(imu.decode(event->data, 0, event->datalen), event->datalen);
    EXPECT_EQ(imu.utime, 100 + i);
    EXPECT_EQ(imu.sequence, i);
    EXPECT_EQ(imu.angular_rate[0], i);
    EXPECT_EQ(imu.specific_force[2], 3.0);
    event = peer.readNextEvent();
    ASSERT_NE(event, nullptr);
    trunnion_lcm::encoder_t encoder{};
    ASSERT_EQ(encoder.decode(event->data, 0, event->datalen), event->datalen);
    ASSERT_EQ(encoder.num_axes, 2);
    EXPECT_EQ(encoder.angle[0], 0.25 * i);
  }
  EXPECT_EQ(peer.readNextEvent(), nullptr);
}

class Collect final : public SampleSink {
 public:
  void imu(std::int64_t utime, const InertialSample<double>& s) override {
    stamps.push_back(utime);
    samples.push_back(s);
  }
  void encoder(std::int64_t, double, double) override {}
  std::vector<std::int64_t> stamps;
  std::vector<InertialSample<double>> samples;
};

TEST(LcmPeer, WeReadItsBatches) {
  const TemporaryFolder folder;
  {
    lcm::LogFile peer(folder / "theirs.lcm", "w");
    ASSERT_TRUE(peer.good());
    trunnion_lcm::imu_batch_t batch;
    batch.utime = 800;
    batch.sequence = 0;
    batch.num_samples = 8;
    batch.temperature = 25.0;
    for (int i = 0; i < 8; ++i) {
      batch.sample_utime.push_back(100 * (i + 1));
      batch.gyro_x.push_back(1.0 * i);
      batch.gyro_y.push_back(2.0 * i);
      batch.gyro_z.push_back(3.0 * i);
      batch.accel_x.push_back(4.0 * i);
      batch.accel_y.push_back(5.0 * i);
      batch.accel_z.push_back(6.0 * i);
    }
    std::vector<char> data(static_cast<std::size_t>(batch.getEncodedSize()));
    batch.encode(data.data(), 0, static_cast<int>(data.size()));
    lcm::LogEvent event;
    event.eventnum = 0;
    event.timestamp = 800;
    event.channel = "IMU";
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    peer.writeEvent(&event);
  }
  Collect collect;
  read_lcm_recording(log_request(folder / "theirs.lcm", {}, false), collect);
  ASSERT_EQ(collect.samples.size(), 8U);
  EXPECT_EQ(collect.stamps[3], 400);
  EXPECT_EQ(collect.samples[3].w, Vec3<double>(3, 6, 9));
  EXPECT_EQ(collect.samples[3].f, Vec3<double>(12, 15, 18));
}

}  // namespace
}  // namespace trunnion::io
