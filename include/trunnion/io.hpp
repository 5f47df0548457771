// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 3: run files, sheets, calibrations, logs of any format, exports. Rigs from URDF are in io/urdf.hpp, a component
/// of its own.

#pragma once

#include "trunnion/io/antenna_epoch.hpp"
#include "trunnion/io/calibration_file.hpp"
#include "trunnion/io/csv.hpp"
#include "trunnion/io/digest.hpp"
#include "trunnion/io/export_format.hpp"
#include "trunnion/io/fault.hpp"
#include "trunnion/io/lcm_log.hpp"
#include "trunnion/io/lcm_recording.hpp"
#include "trunnion/io/lcm_type.hpp"
#include "trunnion/io/log_format.hpp"
#include "trunnion/io/message_map.hpp"
#include "trunnion/io/observation_reader.hpp"
#include "trunnion/io/orbit_book.hpp"
#include "trunnion/io/run_file.hpp"
#include "trunnion/io/sample_intake.hpp"
#include "trunnion/io/sensor_sheet.hpp"
#include "trunnion/io/table_moves.hpp"
#include "trunnion/io/whole_file.hpp"
