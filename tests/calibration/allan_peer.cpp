// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// allan_peer FILE PERIOD: doubles as they lie in memory; prints tau and deviation, then the seconds it took.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "trunnion/calibration/allan_deviation.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::ifstream file(argv[1], std::ios::binary | std::ios::ate);
  const std::streamoff bytes = file.tellg();
  if (bytes <= 0) return 3;
  std::vector<double> readings(static_cast<std::size_t>(bytes) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(readings.data()), bytes);
  const auto start = std::chrono::steady_clock::now();
  const std::vector<trunnion::calibration::AllanPoint> curve =
      trunnion::calibration::allan_deviation(std::move(readings), std::atof(argv[2]));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const trunnion::calibration::AllanPoint& point : curve) std::printf("%.17g %.17g\n", point.tau, point.deviation);
  std::printf("seconds %.6f\n", seconds);
  return 0;
}
