// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 1: the unit, the rig, the positions and the plain records. Header-only, any scalar, no heap.

#pragma once

#include "trunnion/alignment/coarse.hpp"
#include "trunnion/alignment/fine.hpp"
#include "trunnion/alignment/gyrocompass.hpp"
#include "trunnion/alignment/swinging.hpp"
#include "trunnion/core.hpp"
#include "trunnion/error_model/inertial_unit.hpp"
#include "trunnion/error_model/noise.hpp"
#include "trunnion/error_model/triad.hpp"
#include "trunnion/modulation/demodulator.hpp"
#include "trunnion/modulation/flip.hpp"
#include "trunnion/modulation/index_demodulator.hpp"
#include "trunnion/modulation/residual.hpp"
#include "trunnion/modulation/revolution_average.hpp"
#include "trunnion/modulation/schedule.hpp"
#include "trunnion/modulation/slow_states.hpp"
#include "trunnion/modulation/turn_errors.hpp"
#include "trunnion/positions/calibration_record.hpp"
#include "trunnion/positions/channel_clock.hpp"
#include "trunnion/positions/entry.hpp"
#include "trunnion/positions/observation.hpp"
#include "trunnion/positions/sample_sink.hpp"
#include "trunnion/positions/twelve.hpp"
#include "trunnion/strapdown/body_motion.hpp"
#include "trunnion/strapdown/dead_reckoning.hpp"
#include "trunnion/strapdown/error_dynamics.hpp"
#include "trunnion/strapdown/increment.hpp"
#include "trunnion/strapdown/navigator.hpp"
#include "trunnion/turntable/encoder.hpp"
#include "trunnion/turntable/rig.hpp"
#include "trunnion/turntable/two_axis.hpp"
