// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// format_reader <log>...: how long a whole log takes to be read, the best of several times: "path seconds samples".

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>

#include "trunnion/io/log_format.hpp"

namespace {

class Sum final : public trunnion::SampleSink {
 public:
  void imu(std::int64_t, const trunnion::InertialSample<double>& s) override {
    ++samples;
    sum += s.w.x() + s.f.z();
  }
  void encoder(std::int64_t, double, double) override {}
  long long samples = 0;
  double sum = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) {
      double best = 1e9;
      long long samples = 0;
      for (int repeat = 0; repeat < 5; ++repeat) {
        trunnion::io::LogRequest request;
        request.path = argv[i];
        Sum sum;
        const auto begin = std::chrono::steady_clock::now();
        trunnion::io::read_log(request, sum);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        samples = sum.samples;
      }
      std::printf("%s %.6f %lld\n", argv[i], best, samples);
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
