// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// One entry of a run file's `channels`: a name, or a map of name, preset or type, and fields
/// (docs/reference/files.md).

#pragma once

#include <memory>

#include "strict_yaml.hpp"
#include "trunnion/io/message_map.hpp"

namespace trunnion::io {

/// @throws Error (input) naming file, line and field, also for a field that the type does not have
ChannelChoice read_channel(const StrictYaml& node, bool is_imu, const std::shared_ptr<const LcmTypes>& types,
                           const SensorSheet& sheet);

}  // namespace trunnion::io
