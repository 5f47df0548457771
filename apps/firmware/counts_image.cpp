// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Instructions of each kernel, the call and the loop taken away: the mean of 512 calls (32 without floating point) of a
// function that is not inlined, less that of an empty one with the same arguments.

#include "board/semihosting.hpp"
#include "golden.hpp"
#include "systick.hpp"
#include "trunnion/modulation/angle_bins.hpp"
#include "trunnion/strapdown/attitude.hpp"

namespace {

using namespace trunnion;

#if defined(__ARM_FP)
constexpr int kCalls = 512;
#else
constexpr int kCalls = 32;  // of some ten thousand instructions: the counter has 24 bits
#endif
constexpr int kRing = 32;

struct Inputs {
  UnitOutput<std::int32_t> counts;
  InertialSample<float> reading;
  float temperature;
  Increment<float> first, second;
  BinaryAngle angle;
  SinCos phasor;
};
Inputs ring[kRing];
volatile std::int32_t sink;

void fill() {
  firmware::Turning turning;
  for (Inputs& in : ring) {
    const firmware::Sample s = turning.next();
    in.counts = s.counts;
    for (int i = 0; i < 3; ++i) {
      in.reading.w(i) = static_cast<float>(s.counts[static_cast<std::size_t>(i)]);
      in.reading.f(i) = static_cast<float>(s.counts[static_cast<std::size_t>(i) + 3]);
    }
    in.temperature = 27.0F;
    in.first = {in.reading.w * 1e-6F, in.reading.f * 1e-5F};
    in.second = {in.reading.w * 1.1e-6F, in.reading.f * 0.9e-5F};
    in.angle = s.angle;
    in.phasor = sin_cos(s.angle);
  }
}

#define KERNEL __attribute__((noinline)) void

KERNEL empty(const Inputs&, void*) { __asm__ volatile(""); }

// 1
KERNEL correct_3x3(const Inputs& in, void* out) {
  const kernel::Triple<float> y = kernel::triple(in.reading.w);
  *static_cast<kernel::Triple<float>*>(out) = golden::kUnit.gyro.c + golden::kUnit.gyro.A * y;
}
constexpr UnitCorrection<float> kUnit(golden::kUnit);
KERNEL correct_unit(const Inputs& in, void* out) {
  *static_cast<InertialSample<float>*>(out) = kUnit.correct(in.reading, in.temperature);
}
KERNEL correct_unit_at_reference(const Inputs& in, void* out) {
  *static_cast<InertialSample<float>*>(out) = kUnit.correct(in.reading);
}

// 2
struct Triad {
  std::int64_t c[3];
  std::array<std::int32_t, 3> out;
};
KERNEL counts_3x3(const Inputs& in, void* state) {
  auto& t = *static_cast<Triad*>(state);
  const int s = golden::kCounts.shift;
  t.out = kernel::rows(t.c, golden::kCounts.gyro, kernel::moved_up(in.counts[0], s), kernel::moved_up(in.counts[1], s),
                       kernel::moved_up(in.counts[2], s));
}
KERNEL counts_3x3_saturated(const Inputs& in, void* state) {
  auto& t = *static_cast<Triad*>(state);
  const CountCoefficients& k = golden::kCounts;
  t.out = kernel::rows(t.c, k.gyro, kernel::limited(in.counts[0], k.bits, k.shift),
                       kernel::limited(in.counts[1], k.bits, k.shift), kernel::limited(in.counts[2], k.bits, k.shift));
}
struct Unit {
  CountCorrection correction{golden::kCounts};
  UnitOutput<std::int32_t> out;
};
KERNEL counts_unit(const Inputs& in, void* state) {
  auto& u = *static_cast<Unit*>(state);
  u.out = u.correction.correct(in.counts);
}
KERNEL counts_unit_saturated(const Inputs& in, void* state) {
  auto& u = *static_cast<Unit*>(state);
  u.out = u.correction.correct_saturated(in.counts);
}

// 3
using Sum = RevolutionAverage<std::int32_t, firmware::kMostSamples, false>;
KERNEL sum_turn(const Inputs& in, void* state) { (void)static_cast<Sum*>(state)->add(in.counts); }
using Demodulator = CountDemodulator<firmware::kBits, firmware::kMostSamples>;
KERNEL demodulate(const Inputs& in, void* state) { (void)static_cast<Demodulator*>(state)->add(in.counts, in.phasor); }
KERNEL demodulate_angle(const Inputs& in, void* state) {
  (void)static_cast<Demodulator*>(state)->add(in.counts, sin_cos(in.angle));
}
using Bins = AngleBins<firmware::kBits, firmware::kMostSamples>;
KERNEL bins(const Inputs& in, void* state) { (void)static_cast<Bins*>(state)->add(in.counts, in.angle); }
KERNEL bins_pulse(const Inputs& in, void* state) {
  (void)static_cast<Bins*>(state)->add_with_pulse(in.counts, in.angle, {0, 0, 1, 0});
}
KERNEL axial_phase(const Inputs& in, void* state) {
  sink = static_cast<std::int32_t>(static_cast<AxialPhase*>(state)->middle(in.counts[2]));
}
KERNEL sine(const Inputs& in, void* out) { *static_cast<SinCos*>(out) = sin_cos(in.angle); }
KERNEL watch(const Inputs& in, void* state) { (void)static_cast<ChannelWatch*>(state)->look(in.counts); }

// 4
KERNEL attitude(const Inputs& in, void* state) {
  (void)static_cast<Attitude<float>*>(state)->add(in.first.angle, in.second.angle);
}
using Fast = TwoSpeedNavigator<float>;
KERNEL strapdown(const Inputs& in, void* state) { (void)static_cast<Fast*>(state)->add(in.first, in.second); }

// 5
KERNEL chain(const Inputs& in, void* state) {
  const firmware::Sample s{in.counts, in.angle, 25 * 256};
  (void)static_cast<firmware::GoldenChain*>(state)->add(s);
}

using Kernel = void (*)(const Inputs&, void*);

std::uint32_t total(Kernel kernel, void* state, int calls = kCalls) {
  const std::uint32_t from = board::ticks();
  for (int i = 0; i < calls; ++i) kernel(ring[i & (kRing - 1)], state);
  return board::instructions_since(from);
}

void show(const char* name, Kernel kernel, void* state) {
  const std::uint32_t bare = total(empty, state);
  const std::uint32_t full = total(kernel, state);
  board::print(name);
  board::print(" ");
  board::print((full - bare + kCalls / 2) / kCalls);
  board::print("\n");
}

std::int64_t room[64];
Triad triad;
Unit unit;
Sum turn(2, 1000000, 0);
Demodulator demodulator;
Bins angle_bins;
AxialPhase axial(firmware::kFullTurn);
ChannelWatch channel_watch(32760, 32760, 1500);
Attitude<float> gimbal(Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F));
constexpr float kShort = 1e-5F;  // so that no slow step falls into the calls
Fast fast(firmware::golden_chain().navigator().wander_state(), kShort, 10000);
Fast earth(firmware::golden_chain().navigator().wander_state(), kShort, 1);
firmware::GoldenChain whole = firmware::golden_chain();

}  // namespace

int board::run() {
  fill();
  board::start_systick();
  show("correct_3x3_float", correct_3x3, room);
  show("correct_unit_float", correct_unit, room);
  show("correct_unit_float_at_reference", correct_unit_at_reference, room);
  show("correct_3x3_counts", counts_3x3, &triad);
  show("correct_3x3_counts_saturated", counts_3x3_saturated, &triad);
  show("correct_unit_counts", counts_unit, &unit);
  show("correct_unit_counts_saturated", counts_unit_saturated, &unit);
  show("turn_sum", sum_turn, &turn);
  show("turn_sum_demodulate", demodulate, &demodulator);
  show("turn_sum_demodulate_by_angle", demodulate_angle, &demodulator);
  show("turn_bins", bins, &angle_bins);
  show("axial_phase", axial_phase, &axial);
  show("sin_cos", sine, room);
  show("channel_watch", watch, &channel_watch);
  show("attitude_two_samples", attitude, &gimbal);
  show("strapdown_two_samples", strapdown, &fast);
  const std::uint32_t without = total(strapdown, &fast);
  board::print("strapdown_earth ");  // a slow step with every update, less those updates without
  board::print((total(strapdown, &earth) - without) / kCalls);
  board::print("\nturn_bins_pulse ");
  board::print(total(bins_pulse, &angle_bins, 16) / 16);
  board::print("\nchain_sample ");
  board::print(total(chain, &whole) / kCalls);
  board::print("\n");
  sink = static_cast<std::int32_t>(room[0]);
  return 0;
}
