// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rungs 0 and 1 without exceptions, RTTI or heap.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "heap_trap.hpp"
#include "trunnion/model.hpp"

namespace trunnion {
// every member, of every scalar
template class RevolutionAverage<std::int16_t>;
template class RevolutionAverage<std::int32_t>;
template class CountDemodulator<23, 4096>;
template class AngleBins<23, 4096>;
template class BasicCountCorrection<true>;
template class BasicCountCorrection<false>;
#define TRUNNION_INSTANTIATE(T)                    \
  template class RevolutionAverage<T>;             \
  template class IndexDemodulator<T>;              \
  template class Demodulator<T, 64>;               \
  template class SlowStates<T>;                    \
  template class TurnErrors<T>;                    \
  template class TwoPositionModulation<T>;         \
  template class Gyrocompass<T>;                   \
  template class SwingingAlignment<T>;             \
  template class FineAlignment<PreviousSample<T>>; \
  template class WheelDeadReckoning<T>;            \
  template class UnitCorrection<T>;                \
  template class TwoSpeedNavigator<T>;             \
  template class Attitude<T>;                      \
  template class Navigator<PreviousSample<T>>;     \
  template class Navigator<MultiSample<T, 2>>;     \
  template class Navigator<MultiSample<T, 3>>;     \
  template class Navigator<MultiSample<T, 4>>;     \
  template class Navigator<ExactSamples<T, 4>>;    \
  template class Navigator<ExactSamples<T, 6>>;    \
  template class Navigator<ExactSamples<T, 8>>;
TRUNNION_INSTANTIATE(float)
TRUNNION_INSTANTIATE(double)
TRUNNION_INSTANTIATE(long double)
}  // namespace trunnion

namespace {
/// Every hot path of modulation, alignment and dead reckoning. @return something that depends on all of it
template <class T>
T turn_and_align() {
  using namespace trunnion;
  const T h = T(0.01);
  const TurnErrorNoise<T> noise = {T(1e-4), T(2e-4), T(1e-7), T(1e-7), T(1e-3), T(5e-4), T(3e-4), T(1e-2)};
  TwoPositionModulation<T> platform(h, T(0), T(0), {T(2), T(5), T(1)}, noise, noise);
  Demodulator<T, 256> encoder(T(0));
  SlowStates<T> slow({T(1e-3), T(0.3), T(1e-6), T(0.5), T(0.01), T(0.035), T(1e-3)});
  WheelDeadReckoning<T> wheel({T(0.3), AxleSide::kLeft, T(0), T(0.01)}, T(0), h);
  NavigationState<T> place;
  place.latitude = T(0.7);
  FineAlignment<PreviousSample<T>> fine(
      place, h, 10, Vec3<T>::Zero(),
      {T(1e-4), T(1e-3), T(0), T(0), T(0.01), T(0.01), T(0.1), T(0.1), T(1e-3), T(0.01)});
  SwingingAlignment<T> swinging(T(0.7), T(10), h);
  Gyrocompass<T> compass;
  RevolutionAverage<std::int32_t> counts(2, 62832, 0);
  FlipSample<T> sample;
  for (int i = 0; i < 1500; ++i) {
    const T angle = T(0.0314159265) * (T(i) + T(0.5));
    const T c = T(std::cos(angle));
    const T s = T(std::sin(angle));
    sample.main = {Vec3<T>(T(0.01) * c, T(-0.01) * s, i < 200 ? T(0) : T(3.14159265)),
                   Vec3<T>(T(9.8) * c, T(-9.8) * s, T(0))};
    sample.auxiliary = sample.main;
    sample.has_pulse = i % 200 == 0;
    sample.flip = i > 1000 && i < 1050 ? FlipSwitch::kBetween : FlipSwitch::kFirst;
    (void)platform.add(sample);
    (void)encoder.add(sample.main, angle, h);
    slow.add(sample.main.w.template head<2>(), s, c, T(3.14159265), h);
    (void)wheel.add(sample.main);
    const Increment<T> at_rest{Vec3<T>::Zero(), Vec3<T>(T(0), T(0), T(-0.098))};
    (void)fine.add(at_rest);
    (void)swinging.add(at_rest);
    (void)compass.add({Vec3<T>(T(5e-5), T(0), T(0)), Vec3<T>(T(0), T(0), T(-9.8))}, T(i));
    if (sample.has_pulse)
      (void)counts.add_with_pulse({1, 2, 400, 4, 5, 6}, 100);
    else
      counts.add({1, 2, 400, 4, 5, 6});
  }
  const auto turn = encoder.whole_turn();
  return platform.interval().body.f.sum() + turn.value().f.sum() + slow.state().sum() + wheel.heading() +
         fine.result().value().covariance.sum() + swinging.attitude().value().w() +
         compass.solve(T(1e-6)).value().heading + T(counts.turn().turns);
}

/// Every hot path in integers, and the navigator behind them. @return something that depends on all of it
float turn_in_integers() {
  using namespace trunnion;
  static const CountCalibration made = count_calibration({}, {{1000.0, 0.0}, {200.0, 0.0}}, 16, 6).value();
  CountCorrection correction(made.coefficients);
  ChannelWatch watch(32767, 32767, 400);
  EncoderPhase encoder(0);
  AxialPhase axial(1000000);
  CountDemodulator<23, 1000> demodulator;
  AngleBins<23, 1000> bins;
  TwoSpeedNavigator<float> navigator(NavigationState<float>{}, 0.01F, 5);
  Attitude<float> attitude(Quaternion<float>::Identity());
  InertialUnit<float> unit;
  unit.thermal.scale[4].w.x() = 1e-15F;
  unit.accel_place(0, 1) = 0.01F;
  StreamCorrection<float> stream(unit);
  float sum = 0.0F;
  for (int i = 1; i < 1500; ++i) {
    const UnitOutput<std::int32_t> raw{i % 7, -i % 5, 500 + i % 3, i % 11, 3, -2000};
    correction.set_temperature(i / 100);
    stream.set_temperature(static_cast<float>(i / 100));
    sum += stream.correct(0.0025 * i, {Vec3<float>(0.1F, 0.2F, 0.3F), Vec3<float>(1.0F, 2.0F, 9.8F)}).f.sum();
    if (watch.look(raw) == Status::kSaturated) demodulator.mark_saturated();
    const auto counts = correction.correct(raw);
    const EncoderPhase::Step step = encoder.add(static_cast<BinaryAngle>(i) * 21474836U);
    sum += static_cast<float>(axial.middle(counts[2]) >> 16U);
    if (step.pulse.before < 0) {
      (void)demodulator.add(counts, sin_cos(step.middle));
      (void)bins.add(counts, step.middle);
    } else {
      (void)axial.pulse(step.pulse.before, counts[2]);
      (void)bins.add_with_pulse(counts, step.middle, step.pulse);
      if (demodulator.add_with_pulse(counts, sin_cos(step.middle), step.pulse))
        sum += demodulator.split_as<float>().unit[0] + static_cast<float>(bins.turn().split().unit[0]);
    }
    const Increment<float> increment{Vec3<float>(1e-4F, 0.0F, 0.0F), Vec3<float>(0.0F, 0.0F, -0.098F)};
    (void)navigator.add(increment);
    (void)attitude.add(increment.angle, increment.angle);
  }
  return sum + navigator.state().velocity.sum() + attitude.q().w();
}
}  // namespace

int main() {
  using namespace trunnion;
  if (!trap_is_live()) {
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
  sum.f.x() += turn_in_integers();
  sum.w.x() += turn_and_align<float>();
  sum.w.y() += static_cast<float>(turn_and_align<double>());
  sum.w.z() += static_cast<float>(turn_and_align<long double>());
  const TriadGeometry<float> parts = unit.gyro.geometry();
  const long used = g_allocations - before;
  std::printf("%ld allocations, sum %g\n", used, static_cast<double>(sum.w.sum() + sum.f.sum() + parts.scale.sum()));
  return used == 0 ? 0 : 1;
}
