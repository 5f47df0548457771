// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A vendor's HAL and a main loop, Cortex-M0+ without a floating-point unit: integers alone. The HAL is that of a Puya
// PY32F030, whose calls are those of ST's: HAL_SPI_TransmitReceive_DMA, HAL_GPIO_EXTI_Callback. The platform has an
// index pulse, seen by a timer's input capture.

#include "golden_calibration.hpp"
#include "py32f0xx_hal.h"
#include "sample_ring.hpp"
#include "trunnion/error_model/channel_watch.hpp"
#include "trunnion/modulation/angle_bins.hpp"
#include "trunnion/modulation/turning_phase.hpp"

extern SPI_HandleTypeDef unit_spi;
extern TIM_HandleTypeDef index_timer;

namespace {

constexpr std::uint16_t kDataReady = GPIO_PIN_0;
// what the axial counts out of a turn sum to: 2 pi by kGyroScale [counts by rad/s] by 400 samples/s
constexpr auto kFullTurn = static_cast<std::int64_t>(2.0 * 3.14159265358979 * golden::kGyroScale * 400.0);

struct Raw {
  trunnion::UnitOutput<std::int32_t> counts;
  std::int32_t temperature;  // 1/256 degC
  std::int32_t before;       // 65536ths of the sample before the index pulse, -1: there was none
};

SampleRing<Raw, 8> ring;
std::array<std::uint8_t, 14> sent{0x80 |
                                  0x1d};  // read from register 0x1d on: 6 bytes of force, 2 of temperature, 6 of rate
std::array<std::uint8_t, 14> received;

std::int32_t word(std::size_t at) { return static_cast<std::int16_t>(received[at] << 8U | received[at + 1]); }

std::int32_t captured = -1;  // of the sample that is being fetched

trunnion::ChannelWatch watch(32760, 32760, 2000);
trunnion::CountCorrection correction(golden::kCounts);
trunnion::AxialPhase phase(kFullTurn);
trunnion::AngleBins<23, 2000> bins;

}  // namespace

// The pin says that a sample is ready, and so that the next one begins: what the index's timer captured belongs to the
// one that is complete. Its ticks count from the last data-ready, a 65536th of a sample each. Start to fetch, and
// leave.
extern "C" void HAL_GPIO_EXTI_Callback(std::uint16_t pin) {
  if (pin != kDataReady) return;
  captured = -1;
  if (__HAL_TIM_GET_FLAG(&index_timer, TIM_FLAG_CC1) != RESET) {
    captured = static_cast<std::int32_t>(HAL_TIM_ReadCapturedValue(&index_timer, TIM_CHANNEL_1));
    __HAL_TIM_CLEAR_FLAG(&index_timer, TIM_FLAG_CC1);
  }
  __HAL_TIM_SET_COUNTER(&index_timer, 0);
  (void)HAL_SPI_TransmitReceive_DMA(&unit_spi, sent.data(), received.data(), sent.size());
}

// It is here: 132.48 counts a kelvin, zero at 25 degC.
extern "C" void HAL_SPI_TxRxCpltCallback(SPI_HandleTypeDef*) {
  ring.push({{word(8), word(10), word(12), word(0), word(2), word(4)}, 25 * 256 + word(6) * 256 / 132, captured});
}

/// Called by the vendor's main() for ever. @return whether a turn is complete: what the unit adds is in @p split
bool loop(trunnion::TurnSplit<std::int32_t>& split) {
  Raw raw;
  bool complete = false;
  while (ring.pop(raw)) {
    correction.set_temperature(raw.temperature);
    const bool saturated = watch.look(raw.counts) == trunnion::Status::kSaturated;
    if (saturated) bins.turn().mark_saturated();
    const auto counts = correction.correct_saturated(raw.counts);
    const trunnion::BinaryAngle middle = phase.middle(counts[2]);
    const trunnion::IndexPulse pulse = raw.before < 0 ? trunnion::IndexPulse{} : phase.pulse(raw.before, counts[2]);
    if (pulse.before < 0) {
      if (bins.add(counts, middle) == trunnion::Status::kTimeOut) phase.restart();  // no index: the cable?
      continue;
    }
    if (bins.add_with_pulse(counts, middle, pulse)) {
      split = bins.turn().split();
      complete = split.valid && !bins.turn().record().saturated && bins.turn().record().passed_over == 0;
    }
    if (saturated) bins.turn().mark_saturated();  // the turn that begins has its share of it
  }
  return complete;
}
