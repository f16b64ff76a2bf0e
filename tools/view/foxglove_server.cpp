#include "tools/view/foxglove_server.h"

#include <civetweb.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "platform/linux/clock.h"
#include "tools/view/foxglove_session.h"

namespace zenith::tools {
namespace {

constexpr Duration kPeriod = {100'000'000};

// Viewers show it as a date.
std::int64_t wall_clock_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

bool send(mg_connection* connection, const FoxgloveMessage& message) {
  const int opcode = message.binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
  return mg_websocket_write(connection, opcode, message.bytes.data(), message.bytes.size()) > 0;
}

}  // namespace

struct FoxgloveServer::Viewer {
  std::mutex mutex;
  FoxgloveSession session;
  std::atomic<bool> stop = false;
  std::thread thread;
};

FoxgloveServer::FoxgloveServer(FleetState& state) : state_(state) {}

FoxgloveServer::~FoxgloveServer() {
  stop();
}

void FoxgloveServer::listen(mg_context* context,
                            std::function<bool(const mg_connection*)> welcome) {
  welcome_ = std::move(welcome);
  static const char* names[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
  static mg_websocket_subprotocols protocols = {2, names};
  mg_set_websocket_handler_with_subprotocols(context, "/$", &protocols, &on_connect, &on_ready,
                                             &on_data, &on_close, this);
}

void FoxgloveServer::stop() {
  std::map<const mg_connection*, std::shared_ptr<Viewer>> viewers;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    viewers.swap(viewers_);
  }
  for (auto& [connection, viewer] : viewers) viewer->stop = true;
  for (auto& [connection, viewer] : viewers) viewer->thread.join();
}

int FoxgloveServer::on_connect(const mg_connection* connection, void* self) {
  auto& server = *static_cast<FoxgloveServer*>(self);
  const std::lock_guard lock(server.mutex_);
  return server.viewers_.size() < kViewers && server.welcome_(connection) ? 0 : 1;
}

void FoxgloveServer::on_ready(mg_connection* connection, void* self) {
  auto& server = *static_cast<FoxgloveServer*>(self);
  const auto viewer = std::make_shared<Viewer>();
  const std::lock_guard lock(server.mutex_);
  if (server.stopped_) return;
  server.viewers_[connection] = viewer;
  viewer->thread = std::thread([&server, viewer, connection] { server.tell(*viewer, connection); });
}

int FoxgloveServer::on_data(mg_connection* connection, int bits, char* data, std::size_t size,
                            void* self) {
  auto& server = *static_cast<FoxgloveServer*>(self);
  const int opcode = bits & 0xf;
  if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) return 0;
  if (opcode != MG_WEBSOCKET_OPCODE_TEXT) return 1;
  std::shared_ptr<Viewer> viewer;
  {
    const std::lock_guard lock(server.mutex_);
    const auto found = server.viewers_.find(connection);
    if (found == server.viewers_.end()) return 0;
    viewer = found->second;
  }
  const std::lock_guard lock(viewer->mutex);
  viewer->session.receive({data, size});
  return 1;
}

// Its thread must have ended before the connection does.
void FoxgloveServer::on_close(const mg_connection* connection, void* self) {
  auto& server = *static_cast<FoxgloveServer*>(self);
  std::shared_ptr<Viewer> viewer;
  {
    const std::lock_guard lock(server.mutex_);
    const auto found = server.viewers_.find(connection);
    if (found == server.viewers_.end()) return;
    viewer = found->second;
    server.viewers_.erase(found);
  }
  viewer->stop = true;
  viewer->thread.join();
}

void FoxgloveServer::tell(Viewer& viewer, mg_connection* connection) {
  if (!send(connection, FoxgloveSession::server_info())) return;
  while (!viewer.stop) {
    std::vector<FoxgloveMessage> messages;
    state_.read([&](const std::vector<RobotState>& robots) {
      const std::lock_guard lock(viewer.mutex);
      messages = viewer.session.turn(wall_clock_ns(), robots);
      for (std::size_t i = 0; i < robots.size(); ++i) {
        if (viewer.session.wants_picture(i)) state_.wish(i);
      }
    });
    for (const FoxgloveMessage& message : messages) {
      if (viewer.stop || !send(connection, message)) return;
    }
    sleep_until(monotonic_now() + kPeriod);
  }
}

}  // namespace zenith::tools
