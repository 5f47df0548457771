// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Two receivers 0.9902 m apart on a roof, five minutes, truth known: every epoch alone, GPS L1, satellites at random.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "trunnion/attitude/wahba.hpp"
#include "trunnion/core/units.hpp"
#include "trunnion/interferometer/attitude_tracker.hpp"
#include "trunnion/io/antenna_epoch.hpp"

namespace trunnion {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(TRUNNION_DATA) / "gnss_baseline";
const Vec3<double> kTruth(-0.96466567, -0.22320141, -0.00959992);
constexpr double kLength = 0.99020;
constexpr int kMost = 16;

/// Single differences of every epoch, of the signals named.
template <class T>
std::vector<SingleDifferences<T, kMostSignals>> epochs_of(const std::vector<io::SignalName>& signals,
                                                          const SignalNoise& noise) {
  io::ObservationReader base((kFolder / "base.obs").string());
  io::ObservationReader rover((kFolder / "rover.obs").string());
  base.choose(signals);
  rover.choose(signals);
  io::OrbitBook orbits;
  orbits.add((kFolder / "base.nav").string());
  io::ObservationEpoch a;
  io::ObservationEpoch b;
  io::LeftOut left_out;
  std::vector<SingleDifferences<T, kMostSignals>> epochs;
  while (base.next(a) && rover.next(b)) {
    const auto master = io::antenna_epoch(a, signals, orbits, left_out);
    const auto slave = io::antenna_epoch(b, signals, orbits, left_out);
    const auto place = antenna_place(master);
    EXPECT_TRUE(place.ok());
    const auto set = single_differences<T>(master, slave, place.value(), noise);
    EXPECT_TRUE(set.ok());
    epochs.push_back(set.value());
  }
  EXPECT_TRUE(left_out.without_orbit.empty());
  return epochs;
}

template <class T>
bool right(const SingleDifferences<T, kMost>& set, const std::array<T, kMost>& cycles) {
  const DoubleDifferences<T, kMost> pairs(set);
  for (int k = 0; k < pairs.count(); ++k) {
    const auto& s = set[pairs.satellite(k)];
    const auto& r = set[pairs.reference(k)];
    const double phase = static_cast<double>(s.phase) - static_cast<double>(r.phase);
    const double whole =
        std::round(phase + (s.e - r.e).template cast<double>().dot(kTruth) / static_cast<double>(s.wavelength));
    if (static_cast<double>(cycles[static_cast<std::size_t>(pairs.satellite(k))]) != whole) return false;
  }
  return true;
}

struct Rates {
  int trials = 0, plain = 0, known = 0, accepted = 0, wrong = 0, off = 0, off_wrong = 0, off_accepted = 0;
};

template <class T>
Rates rates_of(int n, const std::vector<SingleDifferences<T, kMostSignals>>& epochs, bool all_of_them) {
  std::mt19937_64 rng(20240624U + static_cast<unsigned>(n));
  Rates rates;
  // 2 mm: the surveyed length; 10 mm: one that is wrong by as much
  const KnownLength<T> length{T(kLength), T(0.002)};
  const KnownLength<T> wrong_length{T(kLength + 0.010), T(0.010)};
  for (const auto& epoch : epochs) {
    for (int draw = 0; draw < 10; ++draw) {
      auto sky = epoch;
      if (sky.count < n) continue;
      std::shuffle(sky.at.begin(), sky.at.begin() + sky.count, rng);
      SingleDifferences<T, kMost> set;
      Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
      for (int i = 0; i < n; ++i) {
        set[set.count++] = sky[i];
        Eigen::Vector4d h;
        h << sky[i].e.template cast<double>(), 1.0;
        sum += h * h.transpose();
      }
      const double pdop = std::sqrt(Eigen::Matrix4d(sum.inverse()).topLeftCorner<3, 3>().trace());
      if (!(pdop < 8.0)) continue;
      ++rates.trials;
      const auto known = resolve_baseline(set, length);
      if (known.ok()) {
        const bool good = right(set, known.value().cycles);
        rates.known += good;
        rates.accepted += known.value().accepted;
        rates.wrong += known.value().accepted && !good;
      }
      if (!all_of_them) continue;
      const auto plain = resolve_baseline(set, KnownLength<T>());
      rates.plain += plain.ok() && right(set, plain.value().cycles);
      const auto off = resolve_baseline(set, wrong_length);
      if (off.ok()) {
        const bool good = right(set, off.value().cycles);
        rates.off += good;
        rates.off_accepted += off.value().accepted;
        rates.off_wrong += off.value().accepted && !good;
      }
    }
  }
  return rates;
}

const SignalNoise kNoise{0.25, 0.0015, 10.0 * kRadPerDeg};

TEST(RealBaseline, IsFixedFromOneEpochByItsLength) {
  if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << "no recordings: " << kFolder;
  const std::vector<io::SignalName> gps = {io::SignalName::parse("G1C")};
  const auto epochs = epochs_of<double>(gps, kNoise);
  const auto in_float = epochs_of<float>(gps, kNoise);
  ASSERT_EQ(epochs.size(), 301U);
  for (const int n : {4, 5, 6, 7, 8}) {
    const Rates r = rates_of(n, epochs, true);
    const Rates f = rates_of(n, in_float, false);
    const double percent = 100.0 / r.trials;
    std::printf(
        "[ FIGURE ] 0.99 m, GPS L1, one epoch, %d satellites (%d draws): right by the length %.2f %%, in float %.2f "
        "%%, plain "
        "LAMBDA %.1f %%; accepted %.1f %%, of all wrong and accepted %.3f %%; length 10 mm wrong, sigma 10 mm: right "
        "%.2f %%, accepted %.1f %%, "
        "wrong and accepted %.3f %%\n",
        n, r.trials, percent * r.known, 100.0 * f.known / f.trials, percent * r.plain, percent * r.accepted,
        percent * r.wrong, percent * r.off, percent * r.off_accepted, percent * r.off_wrong);
    if (n == 5) {
      EXPECT_GE(percent * r.known, 90.0);
    }
    if (n >= 6) {
      EXPECT_GE(percent * r.known, 99.0);
      EXPECT_GE(percent * r.off, 97.0);
      EXPECT_LE(percent * r.wrong, 0.1);
      EXPECT_LE(percent * r.off_wrong, 0.1);
    }
    EXPECT_NEAR(100.0 * f.known / f.trials, percent * r.known, 0.3);
  }
}

/// Half a cycle that no receiver tells of, on each satellite in turn, the whole recording through.
TEST(RealBaseline, IsNotFixedWronglyByHalfACycle) {
  if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << "no recordings: " << kFolder;
  const std::vector<io::SignalName> gps = {io::SignalName::parse("G1C")};
  for (const double mask : {10.0, 17.0, 20.0}) {
    const auto epochs = epochs_of<double>(gps, {0.3, 0.002, mask * kRadPerDeg});
    int fixed = 0;
    int wrong = 0;
    int all = 0;
    for (int i = 0; i < epochs[0].count; ++i) {
      const int satellite = epochs[0][i].satellite;
      ArrayResolver<double, 1, kMostSignals> resolver(RigidVectors<double, 1>(Vec3<double>(kLength, 0, 0), 0.005), {});
      for (auto set : epochs) {
        for (int k = 0; k < set.count; ++k) set[k].phase += set[k].satellite == satellite ? 0.5 : 0.0;
        const auto epoch = resolver.resolve({set});
        ++all;
        if (epoch.status != AttitudeStatus::kFixed) continue;
        ++fixed;
        wrong += (epoch.seen.value - kTruth).norm() > 0.05;
      }
    }
    std::printf("[ FIGURE ] half a cycle on one of %d satellites, each in turn: fixed %.1f %%, of all wrong %.2f %%\n",
                epochs[0].count, 100.0 * fixed / all, 100.0 * wrong / all);
    EXPECT_LE(1000 * wrong, all) << mask;
  }
}

TEST(RealBaseline, PointsWhereTheSurveySays) {
  if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << "no recordings: " << kFolder;
  const Vec3<double> direction = kTruth.normalized();
  const double yaw = std::atan2(direction.y(), direction.x());
  const double pitch = std::asin(-direction.z());
  struct Case {
    const char* name;
    std::vector<const char*> signals;
  };
  for (const Case& c : {Case{"GPS L1", {"G1C"}}, Case{"GPS, Galileo, QZSS, BeiDou", {"G1C", "E1C", "J1C", "C2I"}}}) {
    std::vector<io::SignalName> signals;
    for (const char* name : c.signals) signals.push_back(io::SignalName::parse(name));
    double sum[2] = {};
    double square[2] = {};
    int fixed = 0;
    const auto epochs = epochs_of<double>(signals, kNoise);
    for (const auto& set : epochs) {
      const auto fix = resolve_baseline(set, KnownLength<double>{kLength, 0.005});
      if (!fix.ok() || !fix.value().accepted) continue;
      const auto attitude =
          attitude_from_vectors(fix.value().seen, RigidVectors<double, 1>(Vec3<double>(kLength, 0, 0), 0.005));
      ASSERT_TRUE(attitude.ok());
      const Vec3<double> euler = euler_angles(attitude.value().q_nb);
      const double off[2] = {std::remainder(euler.z() - yaw, 2.0 * kPi) / kRadPerDeg, (euler.y() - pitch) / kRadPerDeg};
      for (int i = 0; i < 2; ++i) {
        sum[i] += off[i];
        square[i] += off[i] * off[i];
      }
      ++fixed;
    }
    const double n = fixed;
    const double scatter[2] = {std::sqrt(square[0] / n - sum[0] / n * sum[0] / n),
                               std::sqrt(square[1] / n - sum[1] / n * sum[1] / n)};
    std::printf(
        "[ FIGURE ] 0.99 m, %s, epochs alone: %d of %zu fixed; yaw %+.3f deg off, scatter %.3f; pitch %+.3f deg off, "
        "scatter %.3f\n",
        c.name, fixed, epochs.size(), sum[0] / n, scatter[0], sum[1] / n, scatter[1]);
    EXPECT_EQ(fixed, 301);
    // the survey's and the multipath's own, as an independent program found them: up to 0.10 and 0.15 deg
    EXPECT_LT(std::abs(sum[0] / n), 0.12);
    EXPECT_LT(std::abs(sum[1] / n), 0.18);
    EXPECT_LT(scatter[0], 0.08);
    EXPECT_LT(scatter[1], 0.17);
  }
}

/// Directions and differences against an independent program's export of the same files.
TEST(RealBaseline, HasTheSingleDifferencesOfAnotherProgram) {
  std::ifstream file(kFolder / "sd_L1.txt");
  if (!file) GTEST_SKIP() << "no recordings: " << kFolder;
  std::vector<io::SignalName> signals;
  for (const char* name : {"G1C", "E1C", "J1C", "C2I"}) signals.push_back(io::SignalName::parse(name));
  SignalNoise all = kNoise;
  all.mask = 0.0;
  const auto epochs = epochs_of<double>(signals, all);
  // one epoch: lines of one time
  std::map<std::string, std::array<double, 6>> theirs;
  double first = 0.0;
  for (std::string line; std::getline(file, line);) {
    if (line[0] == '#') continue;
    std::istringstream words(line);
    double t = 0.0;
    std::string name;
    std::array<double, 8> v{};
    words >> t >> name;
    for (double& number : v) words >> number;
    if (first == 0.0) first = t;
    if (t != first) break;
    theirs[name] = {v[2], v[3], v[4], v[5], v[6], v[7]};
  }
  int compared = 0;
  double direction = 0.0;
  double phase = 0.0;
  // double differences inside a system; the clocks are in theirs
  std::map<int, std::pair<double, std::array<double, 6>>> reference;
  for (int i = 0; i < epochs[0].count; ++i) {
    const auto& s = epochs[0][i];
    const io::SatelliteName name{static_cast<SatelliteSystem>(s.satellite / 100), s.satellite % 100};
    const auto found = theirs.find(name.text());
    if (found == theirs.end()) continue;
    direction = std::max(direction, (s.e - Vec3<double>(found->second[0], found->second[1], found->second[2])).norm());
    const auto [first_of, is_first] = reference.insert({s.group, {s.phase, found->second}});
    ++compared;
    if (is_first) continue;
    const double ours = s.phase - first_of->second.first;
    const double other = found->second[5] - first_of->second.second[5];
    phase = std::max(phase, std::abs(std::remainder(ours - other, 1.0)) * s.wavelength);
  }
  std::printf(
      "[ FIGURE ] %d satellites of four systems against another program: directions within %.1e, double differences "
      "within %.2f mm\n",
      compared, direction, 1e3 * phase);
  EXPECT_GT(compared, 30);
  EXPECT_LT(direction, 6e-6);
  EXPECT_LT(phase, 0.2e-3);
}

}  // namespace
}  // namespace trunnion
