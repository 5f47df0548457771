// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From single differences to a filtered attitude without exceptions, RTTI or heap, in float and double.

#include <cmath>
#include <cstdio>

#include "heap_trap.hpp"
#include "trunnion/attitude/fixed_interval_smoother.hpp"
#include "trunnion/attitude/quaternion_ekf.hpp"
#include "trunnion/interferometer/antenna_signals.hpp"
#include "trunnion/interferometer/attitude_tracker.hpp"

namespace trunnion {
namespace {

constexpr int kMost = 12;

/// Eight satellites, a body that yaws; no noise but a pattern. @return something that depends on all of it
template <class T, int M, bool Coloured>
T track(int satellites) {
  Eigen::Matrix<T, 3, M> b;
  b.col(0) << T(1), T(0), T(0);
  if (M == 2) b.col(M - 1) << T(0), T(1), T(0);
  TrackerOptions<T> options;
  options.noise.coloured = Coloured ? T(1) : T(0);
  AttitudeTracker<T, M, kMost, Coloured> tracker(RigidVectors<T, M>(b, T(0.002)), options);
  std::array<AttitudeRecord<T, M, Coloured>, 20> records;
  T sum = T(0);
  for (int k = 0; k < 20; ++k) {
    const T yaw = T(0.01) * T(k);
    std::array<SingleDifferences<T, kMost>, static_cast<std::size_t>(M)> sets;
    for (int s = 0; s < M; ++s) {
      auto& set = sets[static_cast<std::size_t>(s)];
      for (int i = 0; i < satellites; ++i) {
        SingleDifference<T>& d = set[set.count++];
        const T azimuth = T(0.8) * T(i);
        const T elevation = T(0.3) + T(0.15) * T(i);
        d.e << std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), -std::sin(elevation);
        d.wavelength = T(0.1903);
        d.code_sigma = T(0.3);
        d.phase_sigma = T(0.002);
        d.satellite = i;
        const Vec3<T> x = turn_about_z<T>(std::sin(yaw), std::cos(yaw), b.col(s));
        const T range = -d.e.dot(x);
        d.code = range + T(0.1) * T(i * 7 % 5 - 2);
        d.phase = (range + T(0.001) * T((i + k) % 3 - 1)) / d.wavelength + T(3 * i);
      }
    }
    (void)tracker.turn(T(0.5), Vec3<T>::Zero(), Vec3<T>::Zero());
    const auto out = tracker.add(T(0.5), sets);
    records[static_cast<std::size_t>(k)] = tracker.filter().record();
    sum += out.attitude.q_nb.w() + T(out.epoch.satellites);
  }
  if (smooth(records.data(), 20) != Status::kOk) return T(-1);
  QuaternionEkf<T> paper(records[0].after.q_nb, T(0), T(0.01), T(1e-4), T(0.1));
  (void)paper.predict(T(1));
  (void)paper.update(records[1].after.q_nb);
  return sum + records[0].after.q_nb.z() + paper.q_nb().z();
}

/// The part in double: satellites' places, the antenna's, the differences.
double locate() {
  BroadcastOrbit orbit;
  orbit.sqrt_a = 5153.7;
  orbit.i0 = 0.96;
  AntennaEpoch<kMost> epoch;
  for (int i = 0; i < 8; ++i) {
    orbit.omega0 = 0.7 * i;
    orbit.m0 = 0.9 * i;
    AntennaSignal& signal = epoch.at[static_cast<std::size_t>(epoch.count++)];
    signal.sent = satellite_when_sending(orbit, {0, 0.0}, 2.2e7).value();
    signal.code = range_to(signal.sent.r, Vec3<double>(6378137.0, 0.0, 0.0));
    signal.satellite = i;
    signal.wavelength = 0.19;
  }
  const auto place = antenna_place(epoch, Vec3<double>(6.3e6, 1e4, 0.0));
  return place.value().r.norm() + single_differences<double, kMost>(epoch, epoch, place.value(), {}).value().count;
}

}  // namespace
}  // namespace trunnion

int main() {
  using namespace trunnion;
  if (!trap_is_live()) {
    std::puts("the heap trap is not live");
    return 1;
  }
  const long before = g_allocations;
  double sum = locate();
  for (const int satellites : {8, 4}) {
    sum += track<double, 2, true>(satellites) + static_cast<double>(track<float, 1, false>(satellites));
  }
  const long used = g_allocations - before;
  std::printf("%ld allocations, sum %g\n", used, sum);
  return used == 0 && std::isfinite(sum) ? 0 : 1;
}
