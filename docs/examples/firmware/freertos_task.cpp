// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// FreeRTOS, Cortex-M4F: the interrupt queues samples, a task of high priority runs the chain, one of low priority
// splits complete turns. Nothing is allocated. The tick hook stands in for the sensor's interrupt.

#include <FreeRTOS.h>
#include <queue.h>
#include <task.h>

#include "board/semihosting.hpp"
#include "golden.hpp"

namespace {

/// A queue whose memory is static.
template <class T, UBaseType_t Length>
struct Queue {
  std::array<std::uint8_t, Length * sizeof(T)> storage;
  StaticQueue_t control;
  QueueHandle_t handle = xQueueCreateStatic(Length, sizeof(T), storage.data(), &control);
};
template <std::uint32_t Words>
struct Task {
  std::array<StackType_t, Words> stack;
  StaticTask_t control;
};

Queue<firmware::Sample, 16> samples;
Queue<trunnion::TurnRecord, 2> turns;
Task<256> navigation_task;
Task<256> turn_task;
TaskHandle_t navigation_handle;
firmware::Turning sensor;
firmware::GoldenChain chain = firmware::golden_chain();
volatile std::uint32_t lost = 0;

void navigate(void*) {
  firmware::Sample sample;
  bool turned = false;
  for (int i = 0; i < 2000; ++i) {
    (void)xQueueReceive(samples.handle, &sample, portMAX_DELAY);
    (void)chain.add(sample, turned);
    if (turned) (void)xQueueSend(turns.handle, &chain.front().modulation().record(), 0);  // hand it over, do not wait
  }
  board::print("FreeRTOS: 2000 samples, lost ");
  board::print(lost);
  board::print(", stack left ");
  board::print(4U * static_cast<std::uint32_t>(uxTaskGetStackHighWaterMark(nullptr)));
  board::print("\n");
  board::exit(lost == 0 ? 0 : 1);
}

void split_turns(void*) {
  trunnion::TurnRecord record;
  for (;;) {
    (void)xQueueReceive(turns.handle, &record, portMAX_DELAY);
    const auto split = firmware::Modulation::split_as<float>(record);
    if (split.valid && !record.saturated) board::print(".");  // here an estimator would take split.unit
  }
}

}  // namespace

extern "C" void vApplicationTickHook() {
  const firmware::Sample sample = sensor.next();
  BaseType_t woken = pdFALSE;
  if (xQueueSendFromISR(samples.handle, &sample, &woken) != pdTRUE) lost = lost + 1;
}
extern "C" void vApplicationStackOverflowHook(TaskHandle_t, char*) { board::exit(71); }

int board::run() {
  navigation_handle = xTaskCreateStatic(navigate, "navigate", navigation_task.stack.size(), nullptr, 3,
                                        navigation_task.stack.data(), &navigation_task.control);
  (void)xTaskCreateStatic(split_turns, "turns", turn_task.stack.size(), nullptr, 1, turn_task.stack.data(),
                          &turn_task.control);
  vTaskStartScheduler();
  return 70;
}
