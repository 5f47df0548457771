// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rungs 0 and 1 without exceptions, RTTI or heap. malloc itself is watched: Eigen does not go through operator new.

#include <cstdio>
#include <cstdlib>

#include "trunnion/model.hpp"

namespace {
long g_allocations = 0;
}  // namespace

extern "C" void* __libc_malloc(std::size_t);  // NOLINT(bugprone-reserved-identifier): glibc's own name

extern "C" void* malloc(std::size_t size) {
  ++g_allocations;
  return __libc_malloc(size);
}

int main() {
  using namespace trunnion;
  // the trap is live: a dynamic matrix springs it
  const long before_trap = g_allocations;
  {
    const Eigen::VectorXd sprung =
        Eigen::VectorXd::Ones(100 + std::rand() % 2);  // NOLINT: any size the compiler cannot know
    if (sprung.sum() < 100.0) return 2;
  }
  if (g_allocations == before_trap) {
    std::puts("the heap trap is not live");
    return 1;
  }

  const long before = g_allocations;
  InertialUnit<float> unit;
  unit.gyro.cubic = Vec3<float>(1e-5F, 1e-5F, 1e-5F);
  const UnitCorrection<float> correction(unit);
  const TwoAxisTable<float> table(TwoAxisGeometry{}, TwoAxisErrors<float>{}, 0.7, 9.8F);
  InertialSample<float> sum;
  for (int i = 0; i < 100; ++i) {
    const auto t = static_cast<float>(i);
    const InertialSample<float> input =
        table.input({0.01F * t, 0.5F, 0.0F}, {0.02F * t, 0.1F, 0.0F}, Vec3<float>(0.01F, 0.0F, 0.0F));
    const InertialSample<float> output = correction.correct(unit.distort(input));
    sum.w += output.w;
    sum.f += output.f;
  }
  Navigator<PreviousSample<float>> navigator(NavigationState<float>{}, 0.01F);
  Navigator<ExactSamples<float, 6>> exact(NavigationState<float>{}, 0.01F);
  for (int i = 0; i < 600; ++i) {
    const Increment<float> increment{Vec3<float>(1e-3F, 0.0F, 0.0F), Vec3<float>(0.0F, 0.0F, -0.098F)};
    if (navigator.add(increment) != Status::kOk || exact.add(increment) != Status::kOk) return 3;
  }
  sum.f += navigator.state().velocity + exact.state().velocity;
  const TriadGeometry<float> parts = unit.gyro.geometry();
  const long used = g_allocations - before;
  std::printf("%ld allocations, sum %g\n", used, static_cast<double>(sum.w.sum() + sum.f.sum() + parts.scale.sum()));
  return used == 0 ? 0 : 1;
}
