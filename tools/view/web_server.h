#pragma once
// The page of `zenith view`: HTTP and WebSocket by civetweb, a small server in C that Debian ships
// and maintains, linked with the C library alone.
//
//   /                 the page; its files are part of the program (web/)
//   /live             a WebSocket: each text is a request, each answer a state (docs/view.md)
//   /metrics          for Prometheus (metrics.h)
//   / as a WebSocket  Foxglove's protocol (foxglove_server.h)
//
// civetweb answers in threads of its own. Pages of other web sites are turned away: a request that
// tells another origin, and, on this computer's own address, another host.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "platform/base/result.h"
#include "tools/view/fleet_state.h"

struct mg_connection;
struct mg_context;

namespace zenith::tools {

class FoxgloveServer;

struct WebOptions {
  std::string bind = "127.0.0.1";
  int port = 8765;                   // 0: any that is free
  std::vector<std::string> origins;  // of other pages that may read: "https://example.org"
};

class WebServer {
 public:
  // What a page that says `request` gets (docs/view.md); called in any thread.
  using Answer = std::function<nlohmann::json(const nlohmann::json& request)>;

  // `state` must outlive it: metrics and Foxglove's protocol are made of it.
  static Result<std::unique_ptr<WebServer>> start(const WebOptions& options, FleetState& state,
                                                  Answer answer);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const { return port_; }

 private:
  WebServer(const WebOptions& options, FleetState& state, Answer answer);
  bool welcome(const mg_connection* connection) const;
  int serve(mg_connection* connection) const;
  bool reply(mg_connection* connection, const std::string& request) const;

  static int on_request(mg_connection* connection, void* self);
  static int on_connect(const mg_connection* connection, void* self);
  static int on_data(mg_connection* connection, int bits, char* data, std::size_t size, void* self);

  WebOptions options_;
  FleetState& state_;
  Answer answer_;
  std::unique_ptr<FoxgloveServer> foxglove_;
  mg_context* context_ = nullptr;
  int port_ = 0;
};

}  // namespace zenith::tools
