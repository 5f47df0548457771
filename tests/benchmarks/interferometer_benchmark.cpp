// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An epoch of the interferometer: fix and attitude of one baseline, of three antennas jointly, in float and double.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/interferometer/attitude_tracker.hpp"
#include "trunnion/simulation/gaussian.hpp"

namespace {

using namespace trunnion;
constexpr int kMost = 16;

/// Epochs at random, both baselines' whole cycles unknown, code 0.3 m, phase 3 mm.
template <class T>
std::vector<std::array<SingleDifferences<T, kMost>, 2>> epochs_of(int satellites) {
  simulation::Gaussian random(1, static_cast<std::uint64_t>(satellites));
  std::vector<std::array<SingleDifferences<T, kMost>, 2>> epochs(256);
  for (auto& sets : epochs) {
    const Quaternion<double> q = Quaternion<double>(random(), random(), random(), random()).normalized();
    for (int i = 0; i < satellites; ++i) {
      Vec3<double> e;
      do e = Vec3<double>(random(), random(), -std::abs(random())).normalized();
      while (e.z() > -std::sin(10.0 * kRadPerDeg));
      const double master_code = 0.3 * random();
      const double master_phase = 0.003 * random();
      for (int s = 0; s < 2; ++s) {
        auto& set = sets[static_cast<std::size_t>(s)];
        SingleDifference<T>& d = set[set.count++];
        const double range = -e.dot(q * Vec3<double>(Vec3<double>::Unit(s)));
        d.e = e.cast<T>();
        d.wavelength = T(0.1902936728);
        d.code_sigma = T(0.3);
        d.phase_sigma = T(0.003);
        d.satellite = i;
        d.code = static_cast<T>(range + 0.3 * random() - master_code);
        d.phase = static_cast<T>((range + 0.003 * random() - master_phase) / 0.1902936728);
      }
    }
  }
  return epochs;
}

template <class T>
void one_baseline(benchmark::State& state) {
  const auto epochs = epochs_of<T>(static_cast<int>(state.range(0)));
  const RigidVectors<T, 1> figure(Vec3<T>(T(1), T(0), T(0)), T(0.005));
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(resolve_epoch<1, T, kMost>({epochs[k++ % epochs.size()][0]}, figure));
}

template <class T>
void three_antennas(benchmark::State& state) {
  const auto epochs = epochs_of<T>(static_cast<int>(state.range(0)));
  Eigen::Matrix<T, 3, 2> b;
  b << T(1), T(0), T(0), T(1), T(0), T(0);
  const RigidVectors<T, 2> figure(b, T(0.005));
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(resolve_epoch<2, T, kMost>(epochs[k++ % epochs.size()], figure));
}

BENCHMARK(one_baseline<double>)->Arg(5)->Arg(6)->Arg(7)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);
BENCHMARK(one_baseline<float>)->Arg(6)->Arg(8)->Unit(benchmark::kMicrosecond);
BENCHMARK(three_antennas<double>)->Arg(5)->Arg(6)->Arg(7)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);
BENCHMARK(three_antennas<float>)->Arg(6)->Arg(8)->Unit(benchmark::kMicrosecond);

}  // namespace
