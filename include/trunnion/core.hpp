// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 0: linear algebra of fixed size, rotations, units, the Earth, status.

#pragma once

#include "trunnion/core/binary_angle.hpp"
#include "trunnion/core/chi_square.hpp"
#include "trunnion/core/earth.hpp"
#include "trunnion/core/fixed.hpp"
#include "trunnion/core/gps_time.hpp"
#include "trunnion/core/linear.hpp"
#include "trunnion/core/rotation.hpp"
#include "trunnion/core/status.hpp"
#include "trunnion/core/units.hpp"
