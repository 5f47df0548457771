// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rung 4: what people read.

#pragma once

#include "trunnion/report/document.hpp"
#include "trunnion/report/picture.hpp"
