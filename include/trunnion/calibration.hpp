// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 2: samples to windows, the batch solve on a table and by hand, observability.

#pragma once

#include "trunnion/calibration/allan_deviation.hpp"
#include "trunnion/calibration/compress.hpp"
#include "trunnion/calibration/encoder_course.hpp"
#include "trunnion/calibration/kalman_36.hpp"
#include "trunnion/calibration/model_choice.hpp"
#include "trunnion/calibration/multi_position_solve.hpp"
#include "trunnion/calibration/noise_estimate.hpp"
#include "trunnion/calibration/observability.hpp"
#include "trunnion/calibration/parameters.hpp"
#include "trunnion/calibration/prediction.hpp"
#include "trunnion/calibration/rate_test.hpp"
#include "trunnion/calibration/rests_and_turns.hpp"
#include "trunnion/calibration/twelve_position_solve.hpp"
#include "trunnion/calibration/verification.hpp"
