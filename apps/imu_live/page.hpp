// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The page of a live calibration, for a browser on the same machine: /, /state (JSON), /events (server-sent), and
/// POST /next?phase=waiting&recording=1, which does what Enter does while that is what goes on.

#pragma once

#include <functional>
#include <memory>
#include <string>

#include "state.hpp"

namespace trunnion::app {

class Page {
 public:
  /// Serves on 127.0.0.1 until destroyed. @param port 0: any that is free
  /// @throws Error (transport) when the port is in use
  Page(int port, const SharedState& state, std::function<void()> next);
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;
  ~Page();

  [[nodiscard]] const std::string& url() const;
  /// Waits until the browsers that are there have got the last state, a second at most.
  void flush();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace trunnion::app
