// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Ten thousand mutated RINEX files to their satellites' places, and mutated messages on to the attitude: each is read
/// or refused, and what comes out is finite.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fuzz/mutate.hpp"
#include "io/rinex_text.hpp"
#include "matchers/temporary_folder.hpp"
#include "trunnion/core/error.hpp"
#include "trunnion/io/antenna_epoch.hpp"
#include "trunnion/io/gnss_messages.hpp"
#include "trunnion/simulation/gnss_array.hpp"

namespace trunnion::io {
namespace {

constexpr int kMutations = 10000;

std::vector<SignalName> signals() {
  return {SignalName::parse("G1C"), SignalName::parse("G2W"), SignalName::parse("E1C"), SignalName::parse("C2I")};
}

/// As far as there is anything to compute.
void attitude_from(const ObservationEpoch& epoch, const OrbitBook& orbits) {
  LeftOut left_out;
  const auto antenna = antenna_epoch(epoch, signals(), orbits, left_out);
  const auto place = antenna_place(antenna);
  AntennaPlace there;
  if (place.ok()) {
    ASSERT_TRUE(place.value().r.allFinite());
    there = place.value();
  } else {
    there.r = Vec3<double>(-3817680.98, 3562840.07, 3650158.45);
  }
  const auto set = single_differences<double>(antenna, antenna, there, {});
  if (!set.ok()) return;
  const auto fix = resolve_baseline(set.value(), KnownLength<double>{1.0, 0.01});
  if (fix.ok()) {
    ASSERT_TRUE(fix.value().seen.value.allFinite());
  }
}

TEST(Mutations, OfRinex) {
  const TemporaryFolder folder;
  const std::string path = folder / "fuzz.rnx";
  const std::string seeds[] = {observations_3(), observations_2(), orbits_3(), orbits_2()};
  OrbitBook good;
  good.add(folder.file("good.nav", orbits_3()));
  std::mt19937_64 rng(20261126);
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    const int kind = i % 4;
    write_whole(path, mutate(seeds[kind], rng));
    try {
      if (kind < 2) {
        ObservationReader reader(path);
        reader.choose(signals());
        for (ObservationEpoch epoch; reader.next(epoch);) attitude_from(epoch, good);
      } else {
        OrbitBook book;
        book.add(path);
        book.each([](const BroadcastOrbit& orbit) {
          for (const double t : {0.0, 3600.0}) {
            const auto place = satellite_when_sending(orbit, orbit.toe + t, 2.2e7);
            if (place.ok()) {
              ASSERT_TRUE(place.value().r.allFinite() && std::isfinite(place.value().clock));
            }
          }
        });
      }
    } catch (const Error& e) {
      ++refused;
      ASSERT_EQ(e.code(), ExitCode::kInput) << e.what();
    }
  }
  std::printf("[ FIGURE   ] RINEX: %d mutations, %d read, %d refused\n", kMutations, kMutations - refused, refused);
  EXPECT_GT(refused, kMutations / 100);
  EXPECT_LT(refused, kMutations);
}

/// Two receivers of a simulated array; the slave's messages, and the orbits', mutated.
TEST(Mutations, OfGnssMessages) {
  simulation::GnssArrayOptions options;
  options.start = {2320, 116400.0};
  options.orbits = simulation::walker_constellation(30, options.start);
  options.antennas = {Vec3<double>::Zero(), Vec3<double>(1, 0, 0)};
  options.place = [](double) { return Vec3<double>(-3817680.98, 3562840.07, 3650158.45); };
  simulation::GnssArray array(options, simulation::example_2_stand_in());
  const std::vector<SignalName> gps = {SignalName::parse("G1C")};
  OrbitBook good;
  for (const BroadcastOrbit& orbit : options.orbits) good.add(orbit);
  const auto message_of = [&](const AntennaEpoch<kMostSignals>& antenna) {
    GnssRaw raw;
    raw.epoch.time = antenna.time;
    for (int i = 0; i < antenna.count; ++i) {
      const AntennaSignal& s = antenna.at[static_cast<std::size_t>(i)];
      raw.epoch.at.push_back(
          {{SatelliteSystem::kGps, s.satellite}, 0, s.code, s.phase, -s.range_rate / s.wavelength, false});
    }
    std::string message;
    encode_gnss_raw(raw, gps, message);
    return message;
  };
  const auto& seen = array.next();
  LeftOut left_out;
  const auto master = antenna_epoch(decode_gnss_raw(message_of(seen.antenna[0]), gps)->epoch, gps, good, left_out);
  const auto place = antenna_place(master);
  ASSERT_TRUE(place.ok());
  std::string seeds[3] = {message_of(seen.antenna[1]), {}, {}};
  encode_gnss_orbit(1, 2, options.orbits[0], seeds[1]);
  encode_attitude({}, seeds[2]);
  std::mt19937_64 rng(20261127);
  int decoded = 0;
  int fixed = 0;
  for (int i = 0; i < 3 * kMutations; ++i) {
    const std::string message = mutate(seeds[i % 3], rng);
    if (i % 3 == 0) {
      const auto read = decode_gnss_raw(message, gps);
      decoded += read.has_value();
      if (!read) continue;
      const auto slave = antenna_epoch(read->epoch, gps, good, left_out);
      (void)antenna_place(slave);
      const auto set = single_differences<double>(master, slave, place.value(), {});
      if (!set.ok()) continue;
      const auto epoch =
          resolve_epoch<1, double, kMostSignals>({set.value()}, RigidVectors<double, 1>(Vec3<double>(1, 0, 0), 0.005));
      fixed += epoch.status == AttitudeStatus::kFixed;
      ASSERT_TRUE(epoch.attitude.q_nb.coeffs().allFinite() && epoch.attitude.covariance.allFinite());
    } else if (i % 3 == 1) {
      const auto orbit = decode_gnss_orbit(message);
      decoded += orbit.has_value();
      if (!orbit) continue;
      const auto at_toe = satellite_at(*orbit, orbit->toe);
      if (at_toe.ok()) {
        ASSERT_TRUE(at_toe.value().r.allFinite());
      }
    } else {
      decoded += decode_attitude(message).has_value();
    }
  }
  std::printf("[ FIGURE   ] GNSS messages: %d mutations, %d decoded, %d fixed\n", 3 * kMutations, decoded, fixed);
  EXPECT_GT(decoded, 100);
  EXPECT_LT(decoded, 3 * kMutations);
  EXPECT_GT(fixed, 50) << "some go all the way";
}

}  // namespace
}  // namespace trunnion::io
