// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A vendor's HAL and a main loop, Cortex-M0+ without a floating-point unit: integers alone. The HAL is that of a Puya
// PY32F030, whose calls are those of ST's: HAL_SPI_TransmitReceive_DMA, HAL_GPIO_EXTI_Callback. The platform has an
// index pulse, seen by a timer's input capture.

#include "golden_calibration.hpp"
#include "py32f0xx_hal.h"
#include "sample_ring.hpp"
#include "trunnion/modulation/angle_bins.hpp"
#include "trunnion/modulation/turning_phase.hpp"

extern SPI_HandleTypeDef unit_spi;
extern TIM_HandleTypeDef index_timer;

namespace {

constexpr std::uint16_t kDataReady = GPIO_PIN_0;
constexpr std::int64_t kFullTurn = 150995000;  // what the axial counts out of a turn sum to: 2 pi kGyroScale rate

struct Raw {
  trunnion::UnitOutput<std::int32_t> counts;
  std::int32_t before;  // 65536ths of the sample before the index pulse, -1: there was none
};

SampleRing<Raw, 8> ring;
std::array<std::uint8_t, 14> sent{0x80 |
                                  0x1d};  // read from register 0x1d on: 6 bytes of force, 2 of temperature, 6 of rate
std::array<std::uint8_t, 14> received;

std::int32_t word(std::size_t at) { return static_cast<std::int16_t>(received[at] << 8U | received[at + 1]); }

trunnion::CountCorrection correction(golden::kCounts);
trunnion::AxialPhase phase(kFullTurn);
trunnion::AngleBins<23, 2000> bins;

}  // namespace

// The pin says that a sample is ready: start to fetch it, and leave.
extern "C" void HAL_GPIO_EXTI_Callback(std::uint16_t pin) {
  if (pin == kDataReady) (void)HAL_SPI_TransmitReceive_DMA(&unit_spi, sent.data(), received.data(), sent.size());
}

// It is here. The capture of the index is in timer ticks since the sample began, one 65536th of a sample each.
extern "C" void HAL_SPI_TxRxCpltCallback(SPI_HandleTypeDef*) {
  Raw raw{{word(8), word(10), word(12), word(0), word(2), word(4)}, -1};
  if (__HAL_TIM_GET_FLAG(&index_timer, TIM_FLAG_CC1) != RESET) {
    raw.before = static_cast<std::int32_t>(HAL_TIM_ReadCapturedValue(&index_timer, TIM_CHANNEL_1));
    __HAL_TIM_CLEAR_FLAG(&index_timer, TIM_FLAG_CC1);
  }
  ring.push(raw);
}

/// Called by the vendor's main() for ever. @return whether a turn is complete: what the unit adds is in @p split
bool loop(trunnion::TurnSplit<std::int32_t>& split) {
  Raw raw;
  bool complete = false;
  while (ring.pop(raw)) {
    const auto counts = correction.correct_saturated(raw.counts);
    const trunnion::BinaryAngle middle = phase.middle(counts[2]);
    const trunnion::IndexPulse pulse = raw.before < 0 ? trunnion::IndexPulse{} : phase.pulse(raw.before, counts[2]);
    if (pulse.before < 0) {
      if (bins.add(counts, middle) == trunnion::Status::kTimeOut) phase.restart();  // no index: the cable?
    } else if (bins.add_with_pulse(counts, middle, pulse)) {
      split = bins.turn().split();
      complete = split.valid && !bins.turn().record().saturated;
    }
  }
  return complete;
}
