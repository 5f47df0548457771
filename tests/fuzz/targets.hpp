// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What reads bytes from elsewhere, each as a function of bytes: it returns, whatever they are. A fault aborts.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace trunnion::fuzz {

using Target = void (*)(const std::uint8_t* data, std::size_t size);

void csv(const std::uint8_t* data, std::size_t size);
void mcap(const std::uint8_t* data, std::size_t size);
void mip(const std::uint8_t* data, std::size_t size);
void ulog(const std::uint8_t* data, std::size_t size);
void lcm_log(const std::uint8_t* data, std::size_t size);
void lcm_message(const std::uint8_t* data, std::size_t size);
void lcm_type(const std::uint8_t* data, std::size_t size);
void run_file(const std::uint8_t* data, std::size_t size);
void calibration_file(const std::uint8_t* data, std::size_t size);
void sensor_sheet(const std::uint8_t* data, std::size_t size);
void table_moves(const std::uint8_t* data, std::size_t size);
void urdf(const std::uint8_t* data, std::size_t size);
void rinex_observations(const std::uint8_t* data, std::size_t size);
void rinex_orbits(const std::uint8_t* data, std::size_t size);
void gnss_message(const std::uint8_t* data, std::size_t size);
void flash_block(const std::uint8_t* data, std::size_t size);

struct NamedTarget {
  const char* name;
  Target run;
};

inline constexpr std::array<NamedTarget, 16> kTargets = {{{"csv", csv},
                                                          {"mcap", mcap},
                                                          {"mip", mip},
                                                          {"ulog", ulog},
                                                          {"lcm_log", lcm_log},
                                                          {"lcm_message", lcm_message},
                                                          {"lcm_type", lcm_type},
                                                          {"run_file", run_file},
                                                          {"calibration_file", calibration_file},
                                                          {"sensor_sheet", sensor_sheet},
                                                          {"table_moves", table_moves},
                                                          {"urdf", urdf},
                                                          {"rinex_observations", rinex_observations},
                                                          {"rinex_orbits", rinex_orbits},
                                                          {"gnss_message", gnss_message},
                                                          {"flash_block", flash_block}}};

}  // namespace trunnion::fuzz
