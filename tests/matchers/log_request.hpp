// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "trunnion/io/log_format.hpp"

namespace trunnion::io {

inline LogRequest log_request(const std::string& path, const LogChannels& channels, bool need_encoder,
                              Sha256* digest = nullptr) {
  LogRequest request;
  request.path = path;
  request.channels = channels;
  request.need_encoder = need_encoder;
  request.digest = digest;
  return request;
}

}  // namespace trunnion::io
