// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Bare metal, Cortex-M4F: a data-ready interrupt fills a ring, the main loop corrects in float and navigates. The
// calibration is the flash block of `imu_calibrate export --block`. Here SysTick stands in for the sensor's data-ready
// pin, and the golden stream for its registers.

#include "board/semihosting.hpp"
#include "sample_ring.hpp"
#include "stream.hpp"
#include "systick.hpp"
#include "trunnion/error_model/flash_block.hpp"
#include "trunnion/strapdown/two_speed_navigator.hpp"

__asm__(
    ".section .rodata.calibration\n.balign 8\n.global calibration_block\ncalibration_block: .incbin "
    "\"calibration.bin\"\n"
    ".text\n");
extern "C" const unsigned char calibration_block[];

namespace {
constexpr float kPeriod = 1.0F / 400.0F;
// 43.5 deg north, 125.5 deg east, 220 m, level, heading north: trunnion::wander_state<float>(...) of a host
const trunnion::WanderState<float> kStart = {
    {0.178157344F, 0.801921785F, 0.35103333F, 0.449291974F}, {1.0F, 0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 220.0F};
SampleRing<firmware::Sample, 16> ring;
firmware::Turning sensor;
}  // namespace

// Takes the sample and nothing else: some hundred cycles, and it may interrupt the navigation anywhere.
extern "C" void SysTick_Handler() { ring.push(sensor.next()); }

int board::run() {
  const auto block = trunnion::read_flash_block(calibration_block, sizeof(trunnion::FlashBlock));
  if (!block.ok() || block.value()->has_counts != 1) {
    board::print("no calibration\n");  // erased, damaged, of another version: do not fly
    return 1;
  }
  const trunnion::UnitCorrection<float> correction(block.value()->unit);
  trunnion::TwoSpeedNavigator<float> navigator(kStart, kPeriod, 20);  // the Earth every 0.1 s

  board::systick(4) = 25000000 / 400 - 1;
  board::systick(8) = 0;
  board::systick(0) = 7;  // on, with its interrupt
  unsigned refused = 0;
  trunnion::Increment<float> last;
  for (int samples = 0; samples < 2000;) {
    firmware::Sample raw;
    if (!ring.pop(raw)) {
      __asm__ volatile("wfi");
      continue;
    }
    const auto& c = raw.counts;
    trunnion::InertialSample<float> reading;
    for (int i = 0; i < 3; ++i) {
      reading.w(i) = static_cast<float>(c[static_cast<std::size_t>(i)]);
      reading.f(i) = static_cast<float>(c[static_cast<std::size_t>(i) + 3]);
    }
    const auto input = correction.checked(reading, static_cast<float>(raw.temperature) * (1.0F / 256.0F));
    if (input.ok()) last = trunnion::increment_of(input.value(), kPeriod);  // else the last one again: time goes on
    if (navigator.add(last) != trunnion::Status::kOk || !input.ok()) ++refused;
    ++samples;
  }
  board::print("bare metal: 2000 samples, refused ");
  board::print(refused);
  board::print(", lost ");
  board::print(ring.lost());
  board::print("\n");
  return refused == 0 && ring.lost() == 0 ? 0 : 1;
}
