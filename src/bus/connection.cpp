// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trunnion/bus/connection.hpp"

#include <arpa/inet.h>
#include <lcm/lcm.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <list>
#include <utility>

#include "trunnion/core/error.hpp"

namespace trunnion::bus {
namespace {

constexpr int kReceiveBuffer = 4 << 20;  // bytes

/// LCM takes channel names for regular expressions.
std::string literally(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    if (std::strchr("\\^$.[]|()?*+{}-", c) != nullptr) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

bool has_provider(const std::string& url, const char* provider) {
  return url.rfind(std::string(provider) + "://", 0) == 0;
}

/// LCM takes any host name for this machine: only addresses are let through.
void check_tcpq(const std::string& url) {
  const std::string host = url.substr(7, url.find_first_of(":?/", 7) - 7);
  in_addr address{};
  if (!host.empty() && ::inet_pton(AF_INET, host.c_str(), &address) != 1)
    throw Error(ExitCode::kTransport,
                url + ": '" + host + "' should be an address like 127.0.0.1: LCM does not look names up");
}

/// A burst waits in the kernel while this program is not scheduled: its own buffer of 200 kB is a moment's. The kernel
/// gives what it allows of it.
std::string with_buffer(const std::string& url) {
  if (!has_provider(url, "udpm") || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=" + std::to_string(kReceiveBuffer);
}

}  // namespace

struct Connection::Implementation {
  struct Subscription {
    Implementation* owner;
    Handler handler;
    std::int64_t number = 0;
  };

  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* user) noexcept {
    auto* const subscription = static_cast<Subscription*>(user);
    if (subscription->owner->thrown) return;
    try {
      io::LcmEvent event;
      event.number = subscription->number++;
      event.timestamp = buffer->recv_utime;
      event.channel = channel;
      event.data = {static_cast<const char*>(buffer->data), buffer->data_size};
      event.byte = -1;
      subscription->handler(event);
    } catch (...) {
      subscription->owner->thrown = std::current_exception();
    }
  }

  std::string url;
  lcm_t* lcm = nullptr;
  std::list<Subscription> subscriptions;
  std::exception_ptr thrown;
};

Connection::Connection(const std::string& url) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  const char* const by_default = std::getenv("LCM_DEFAULT_URL");
  self.url = !url.empty()                                   ? url
             : by_default != nullptr && *by_default != '\0' ? by_default
                                                            : "udpm://239.255.76.67:7667?ttl=0";
  if (has_provider(self.url, "tcpq")) check_tcpq(self.url);
  self.lcm = lcm_create(with_buffer(self.url).c_str());
  if (self.lcm == nullptr) {
    throw Error(ExitCode::kTransport,
                self.url + ": no connection" +
                    (has_provider(self.url, "udpm") || has_provider(self.url, "mpudpm")
                         ? "; is there a route for multicast? On one machine: ip route add 224.0.0.0/4 dev lo"
                         : ""));
  }
  // 1.3.1 says that all is well where no server is
  if (has_provider(self.url, "tcpq") && lcm_get_fileno(self.lcm) < 0) {
    lcm_destroy(std::exchange(self.lcm, nullptr));
    throw Error(ExitCode::kTransport, self.url + ": no server answers there");
  }
}

Connection::~Connection() {
  if (implementation_->lcm != nullptr) lcm_destroy(implementation_->lcm);
}

void Connection::subscribe(const std::string& channel, Handler handler, int queue) {
  Implementation& self = *implementation_;
  self.subscriptions.push_back({&self, std::move(handler)});
  lcm_subscription_t* const subscription =
      lcm_subscribe(self.lcm, literally(channel).c_str(), &Implementation::on_message, &self.subscriptions.back());
  if (subscription == nullptr || lcm_subscription_set_queue_capacity(subscription, queue) != 0) {
    throw Error(ExitCode::kTransport, self.url + ": cannot subscribe to channel '" + channel + "'");
  }
}

void Connection::publish(const std::string& channel, std::string_view data) {
  Implementation& self = *implementation_;
  if (lcm_publish(self.lcm, channel.c_str(), data.data(), static_cast<unsigned>(data.size())) != 0)
    throw Error(ExitCode::kTransport, self.url + ": cannot publish on channel '" + channel + "'");
}

bool Connection::handle(int milliseconds) {
  Implementation& self = *implementation_;
  if (lcm_get_fileno(self.lcm) < 0) throw Error(ExitCode::kTransport, self.url + ": the connection is lost");
  const int handled = lcm_handle_timeout(self.lcm, milliseconds);
  if (self.thrown) std::rethrow_exception(std::exchange(self.thrown, nullptr));
  if (handled < 0 && errno == EINTR) return false;
  if (handled < 0) throw Error(ExitCode::kTransport, self.url + ": the connection is lost");
  return handled > 0;
}

const std::string& Connection::url() const { return implementation_->url; }

bool Connection::lossless() const {
  return has_provider(implementation_->url, "tcpq") || has_provider(implementation_->url, "memq");
}

}  // namespace trunnion::bus
