// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 2: truth as functions of time, and its corruption.

#pragma once

#include "trunnion/simulation/analytic_path.hpp"
#include "trunnion/simulation/attitude_path.hpp"
#include "trunnion/simulation/axis_motion.hpp"
#include "trunnion/simulation/flicker.hpp"
#include "trunnion/simulation/gaussian.hpp"
#include "trunnion/simulation/gnss_array.hpp"
#include "trunnion/simulation/rotating_platform.hpp"
#include "trunnion/simulation/table_run.hpp"
#include "trunnion/simulation/table_sequence.hpp"
