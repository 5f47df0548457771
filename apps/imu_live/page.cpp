// SPDX-FileCopyrightText: 2026 the trunnion authors
// SPDX-License-Identifier: BSD-3-Clause

#include "page.hpp"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "page_html.hpp"
#include "trunnion/core/error.hpp"

namespace trunnion::app {
namespace {

constexpr auto kBetweenEvents = std::chrono::milliseconds(200);
constexpr int kMostBrowsers = 6;  // each holds a thread

/// A page of another site may not read or click here: its requests carry its own host or origin.
bool from_here(const httplib::Request& request) {
  const std::string authority = request.get_header_value("Host");
  const std::string host = authority.substr(0, authority.find(':'));
  if (host != "127.0.0.1" && host != "localhost") return false;
  const std::string origin = request.get_header_value("Origin");
  return origin.empty() || origin == "http://" + authority;
}

}  // namespace

struct Page::Implementation {
  httplib::Server server;
  std::thread thread;
  std::atomic<bool> end{false};
  std::atomic<int> browsers{0};
  std::atomic<std::uint64_t> sent{0};
  const SharedState* state = nullptr;
  std::string url;
};

Page::Page(int port, const SharedState& state, std::function<void()> next)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.state = &state;
  httplib::Server& server = self.server;
  server.new_task_queue = [] { return new httplib::ThreadPool(kMostBrowsers + 2); };
  server.set_socket_options([](socket_t socket) {  // not the library's: two programs could share a port
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
    if (from_here(request)) return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/", [](const httplib::Request&, httplib::Response& response) {
    response.set_header(
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'");
    response.set_content(kPageHtml, "text/html; charset=utf-8");
  });
  server.Get("/state", [&state](const httplib::Request&, httplib::Response& response) {
    response.set_content(state.json(), "application/json");
  });
  server.Post("/next", [&state, next = std::move(next)](const httplib::Request& request, httplib::Response& response) {
    // a click belongs to what its page showed: a second one, or one of an old page, is none
    const LiveState now = state.copy();
    const std::string shown = request.get_param_value("phase") + request.get_param_value("recording");
    response.status = shown == name_of(now.phase) + std::to_string(now.recording) ? 204 : 409;
    if (response.status == 204) next();
  });
  server.Get("/events", [&self](const httplib::Request&, httplib::Response& response) {
    if (++self.browsers > kMostBrowsers) {
      --self.browsers;
      response.status = 503;
      return;
    }
    response.set_header("Cache-Control", "no-store");
    response.set_chunked_content_provider(
        "text/event-stream",
        [&self, seen = std::uint64_t{0}, first = true](std::size_t, httplib::DataSink& sink) mutable {
          const std::uint64_t version = self.state->version();
          if (first || version != seen) {
            const std::string event = "data: " + self.state->json() + "\n\n";
            if (!sink.write(event.data(), event.size())) return false;
            seen = version;
            first = false;
            self.sent = version;
          } else if (self.end) {
            sink.done();
            return true;
          }
          std::this_thread::sleep_for(kBetweenEvents);
          return true;
        },
        [&self](bool) { --self.browsers; });
  });
  const int bound = port == 0                                ? server.bind_to_any_port("127.0.0.1")
                    : server.bind_to_port("127.0.0.1", port) ? port
                                                             : -1;
  if (bound < 0)
    throw Error(ExitCode::kTransport,
                "port " + std::to_string(port) +
                    " is in use: choose another with --port, any free one with --port 0, or --no-page");
  self.url = "http://127.0.0.1:" + std::to_string(bound) + "/";
  self.thread = std::thread([&self] { self.server.listen_after_bind(); });
  while (!self.server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // stop() needs it to be
}

Page::~Page() {
  implementation_->end = true;
  implementation_->server.stop();
  implementation_->thread.join();
}

const std::string& Page::url() const { return implementation_->url; }

void Page::flush() {
  for (int i = 0; i < 10 && implementation_->browsers > 0 && implementation_->sent < implementation_->state->version();
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

}  // namespace trunnion::app
