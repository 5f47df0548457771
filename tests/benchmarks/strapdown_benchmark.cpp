// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// strapdown_benchmark <algorithm> <samples> [<repeats>]: navigates a ring of coning increments (1 deg, 10 Hz, 400 Hz),
// prints ns per sample, the best of the repeats. Built at -O2 by tests/benchmarks/strapdown, which also counts its
// instructions.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "trunnion/core/units.hpp"
#include "trunnion/strapdown/navigator.hpp"

namespace {

using namespace trunnion;

constexpr std::size_t kRing = 1200;  // thirty turns of the cone, and a whole number of every update

template <class T>
std::vector<Increment<T>> ring() {
  std::vector<Increment<T>> samples;
  const double h = 1.0 / 400.0;
  const double w = 2.0 * kPi * 10.0;
  const double a = kRadPerDeg;
  for (std::size_t i = 0; i < kRing; ++i) {
    const double m = w * h * (static_cast<double>(i) + 0.5);
    const double half = std::sin(0.5 * w * h);
    const double axial = -2.0 * w * std::sin(0.5 * a) * std::sin(0.5 * a) * h;
    const double across = 2.0 * std::sin(a) * half;
    samples.push_back({Vec3<double>(axial, -across * std::sin(m), across * std::cos(m)).cast<T>(),
                       Vec3<double>(0.1 * h * std::sin(m), 0.1 * h * std::cos(m), -9.8 * h).cast<T>()});
  }
  return samples;
}

template <class Algorithm>
void run(long long count, int repeats) {
  using T = typename Algorithm::Scalar;
  const std::vector<Increment<T>> samples = ring<T>();
  NavigationState<double> start;
  start.latitude = 0.8;
  start.height = 100.0;
  double best = 1e9;
  double digest = 0.0;
  for (int k = 0; k < repeats; ++k) {
    Navigator<Algorithm> navigator(start, static_cast<T>(1.0 / 400.0));
    const auto from = std::chrono::steady_clock::now();
    std::size_t at = 0;
    for (long long i = 0; i < count; ++i) {
      if (navigator.add(samples[at]) != Status::kOk) std::abort();
      if (++at == kRing) at = 0;
    }
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - from;
    best = std::min(best, time.count() / static_cast<double>(count));
    digest += static_cast<double>(navigator.state().height);
  }
  std::printf("%.1f ns/sample (height %.6f)\n", best, digest / repeats);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string algorithm = argv[1];
  const long long count = std::atoll(argv[2]);
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 1;
  if (algorithm == "previous")
    run<PreviousSample<double>>(count, repeats);
  else if (algorithm == "previous-float")
    run<PreviousSample<float>>(count, repeats);
  else if (algorithm == "2")
    run<MultiSample<double, 2>>(count, repeats);
  else if (algorithm == "4")
    run<MultiSample<double, 4>>(count, repeats);
  else if (algorithm == "exact4")
    run<ExactSamples<double, 4>>(count, repeats);
  else if (algorithm == "exact6")
    run<ExactSamples<double, 6>>(count, repeats);
  else if (algorithm == "exact8")
    run<ExactSamples<double, 8>>(count, repeats);
  else
    return 2;
  return 0;
}
