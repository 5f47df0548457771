// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// latency <imu_correct> <calibration>: from publishing a message to having its correction back, beside a bare echo
/// that does nothing but publish what it gets, both in one run over the bus of LCM_DEFAULT_URL. Every other message
/// goes to either. To be run by tests/apps/isolated.

#include <lcm/lcm.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "trunnion/bus/connection.hpp"
#include "trunnion/io/lcm_recording.hpp"

namespace trunnion {
namespace {

using Clock = std::chrono::steady_clock;

/// The echo: LCM's own interface, nothing of ours.
void echo_message(const lcm_recv_buf_t* buffer, const char*, void* user) {
  lcm_publish(static_cast<lcm_t*>(user), "ECHO_BACK", buffer->data, buffer->data_size);
}

[[noreturn]] void echo() {
  lcm_t* lcm = lcm_create(nullptr);
  lcm_subscription_set_queue_capacity(lcm_subscribe(lcm, "ECHO", &echo_message, lcm), 10000);
  for (;;) lcm_handle(lcm);
}

pid_t start(const char* program, const char* calibration) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  if (program == nullptr) echo();
  ::execl(program, program, calibration, nullptr);
  std::_Exit(127);
}

/// s of processor that a process has used.
double processor_time(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  double ticks = 0.0;
  for (int i = 1; i <= 15 && stat >> word; ++i) {
    if (i >= 14) ticks += std::stod(word);
  }
  return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

struct Side {
  explicit Side(std::size_t messages) : sent(messages) {}
  void back() {
    if (latency.size() < sent.size())
      latency.push_back(std::chrono::duration<double, std::micro>(Clock::now() - sent[latency.size()]).count());
  }
  [[nodiscard]] double quantile(double q) {
    if (latency.empty()) return 0.0;
    const auto at = latency.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(latency.size() - 1));
    std::nth_element(latency.begin(), at, latency.end());
    return *at;
  }
  std::vector<Clock::time_point> sent;
  std::vector<double> latency;  // us, in order: nothing overtakes on one machine
};

void measure(bus::Connection& bus, const char* name, double rate, int batch, double seconds, pid_t correct,
             Side*& echo_side, Side*& correct_side) {
  const auto messages = static_cast<std::size_t>(rate / batch * seconds);
  Side echoed(messages);
  Side corrected(messages);
  echo_side = &echoed;
  correct_side = &corrected;
  std::string message;
  const InertialSample<double> sample{Vec3<double>(0.1, 0.2, 0.3), Vec3<double>(1, 2, 9.8)};
  const std::vector<InertialSample<double>> samples(static_cast<std::size_t>(batch), sample);
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(batch / rate));
  const double used = processor_time(correct);
  const auto begin = Clock::now();
  for (std::size_t k = 0; k < 2 * messages; ++k) {
    const auto due = begin + static_cast<int>(k) * period / 2;
    while (Clock::now() < due) bus.handle(0);
    if (batch == 1) {
      io::encode_imu(static_cast<std::int64_t>(1e6 * static_cast<double>(k) / rate), static_cast<std::int64_t>(k / 2),
                     sample, message);
    } else {
      const std::vector<std::int64_t> stamps(static_cast<std::size_t>(batch), static_cast<std::int64_t>(k));
      io::encode_imu_batch(static_cast<std::int64_t>(k / 2) * batch, stamps, samples, message);
    }
    (k % 2 == 0 ? echoed : corrected).sent[k / 2] = Clock::now();
    bus.publish(k % 2 == 0 ? "ECHO" : "IMU", message);
  }
  const double took = std::chrono::duration<double>(Clock::now() - begin).count();
  const double processor = (processor_time(correct) - used) / took;
  while (bus.handle(300)) continue;
  echo_side = correct_side = nullptr;
  const double e50 = echoed.quantile(0.5);
  const double e99 = echoed.quantile(0.99);
  const double c50 = corrected.quantile(0.5);
  const double c99 = corrected.quantile(0.99);
  std::printf(
      "%-26s echo p50 %6.1f us, p99 %6.1f us; corrected p50 %6.1f us, p99 %6.1f us: %.2f and %.2f times; %zu and %zu "
      "of %zu "
      "back; imu_correct %.1f %% of a core\n",
      name, e50, e99, c50, c99, c50 / e50, c99 / e99, echoed.latency.size(), corrected.latency.size(), messages,
      100.0 * processor);
}

int run(const char* program, const char* calibration) {
  const pid_t echo_process = start(nullptr, nullptr);
  const pid_t correct_process = start(program, calibration);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  bus::Connection bus;
  Side* echoed = nullptr;
  Side* corrected = nullptr;
  bus.subscribe("ECHO_BACK", [&](const io::LcmEvent&) {
    if (echoed != nullptr) echoed->back();
  });
  bus.subscribe("IMU_CORRECTED", [&](const io::LcmEvent&) {
    if (corrected != nullptr) corrected->back();
  });
  measure(bus, "400 Hz, single", 400.0, 1, 20.0, correct_process, echoed, corrected);
  measure(bus, "8 kHz, batches of 8", 8000.0, 8, 20.0, correct_process, echoed, corrected);
  for (const pid_t process : {echo_process, correct_process}) {
    ::kill(process, SIGTERM);
    ::waitpid(process, nullptr, 0);
  }
  return 0;
}

}  // namespace
}  // namespace trunnion

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "latency <imu_correct> <calibration>\n");
    return 2;
  }
  return trunnion::run(argv[1], argv[2]);
}
