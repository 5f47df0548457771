// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Must not compile: 30 bits and 32000 samples a turn.

#include "trunnion/modulation/count_demodulator.hpp"

trunnion::CountDemodulator<30, 32000> demodulator;
