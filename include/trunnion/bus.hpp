// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 3: live LCM.

#pragma once

#include "trunnion/bus/connection.hpp"
#include "trunnion/bus/replay.hpp"
