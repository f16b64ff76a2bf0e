#pragma once
// Foxglove's protocol over the page's server: a WebSocket at "/" with the subprotocol
// foxglove.websocket.v1 or foxglove.sdk.v1. Each viewer has a thread, which waits for it alone.

#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "tools/view/fleet_state.h"

struct mg_connection;
struct mg_context;

namespace zenith::tools {

class FoxgloveServer {
 public:
  static constexpr std::size_t kViewers = 8;

  explicit FoxgloveServer(FleetState& state);
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  // `welcome`: whether this connection may read.
  void listen(mg_context* context, std::function<bool(const mg_connection*)> welcome);
  // Nothing more is sent. Before the context ends.
  void stop();

 private:
  struct Viewer;

  static int on_connect(const mg_connection* connection, void* self);
  static void on_ready(mg_connection* connection, void* self);
  static int on_data(mg_connection* connection, int bits, char* data, std::size_t size, void* self);
  static void on_close(const mg_connection* connection, void* self);
  void tell(Viewer& viewer, mg_connection* connection);

  FleetState& state_;
  std::function<bool(const mg_connection*)> welcome_;
  std::mutex mutex_;
  bool stopped_ = false;
  std::map<const mg_connection*, std::shared_ptr<Viewer>> viewers_;
};

}  // namespace zenith::tools
