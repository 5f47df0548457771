// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A connection to an LCM bus: any provider (udpm, mpudpm, tcpq, memq, file), without LCM's own headers.
///
/// Nothing is thrown through LCM's frames: what a handler throws leaves handle(). Messages arrive as bytes, so that no
/// generated decoder sees one that nobody has checked.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "trunnion/io/lcm_log.hpp"

namespace trunnion::bus {

class Connection {
 public:
  /// Messages that wait for their handler. LCM's own default of 30 is 4 ms of an 8 kHz unit: it loses some silently.
  static constexpr int kQueue = 100000;

  using Handler = std::function<void(const io::LcmEvent&)>;

  /// @param url "udpm://239.255.76.67:7667?ttl=0", ...; empty: LCM_DEFAULT_URL, or LCM's default. Where udpm's
  /// recv_buf_size is not stated, 4 MB are asked for.
  /// @throws Error (transport) for an address that cannot be used
  explicit Connection(const std::string& url = "");
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  /// Calls @p handler for every message on @p channel, of this name exactly. The event has the time of arrival [us],
  /// its number on the channel from 0, and byte -1. Unsubscribed with the connection, never inside a handler.
  /// @throws Error (transport)
  void subscribe(const std::string& channel, Handler handler, int queue = kQueue);

  /// The same with a member function.
  template <class Object>
  void subscribe(const std::string& channel, void (Object::*method)(const io::LcmEvent&), Object& object,
                 int queue = kQueue) {
    subscribe(
        channel, [&object, method](const io::LcmEvent& event) { (object.*method)(event); }, queue);
  }

  /// @throws Error (transport) when the message cannot be sent
  void publish(const std::string& channel, std::string_view data);

  /// Waits for one message and handles it. @return false when none came within @p milliseconds
  /// @throws Error (transport) when the connection is lost, and what a handler throws
  bool handle(int milliseconds);

  /// The address, for messages.
  [[nodiscard]] const std::string& url() const;
  /// Whether what is published waits for slow subscribers instead of being dropped: tcpq, memq.
  [[nodiscard]] bool lossless() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace trunnion::bus
