#pragma once
// The page of `zenith view`: HTTP and WebSocket, answered by one thread.
//
//   /                 the page; its files are part of the program (web/)
//   /live             a WebSocket: each text is a request, each answer a state (docs/view.md)
//   /metrics          for Prometheus (metrics.h)
//   / as a WebSocket  Foxglove's protocol (foxglove_session.h)
//
// Who may read: web_access.h. What one connection may do: web_connection.h. Here: how many there
// may be. A new connection always gets its turn: when too many wait without having asked, the
// oldest one of the address that has most of them goes. There is room for so many of these that a
// storm of some thousand connects a second leaves a client 50 ms and more to ask.

#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"
#include "tools/view/fleet_state.h"
#include "tools/view/web_access.h"
#include "tools/view/web_connection.h"

namespace zenith::tools {

struct WebOptions {
  std::string bind = "127.0.0.1";    // an address of IPv4 or IPv6, also in brackets
  int port = 8765;                   // 0: any that is free
  std::vector<std::string> origins;  // of other pages that may read: "https://example.org"
  std::vector<std::string> hosts;    // names of this computer by which it may be asked
  std::string token_file;            // empty: a new token at each start
  bool no_token = false;
};

class WebServer {
 public:
  static constexpr std::size_t kWaiting = 256;      // that have not asked yet, or are answered
  static constexpr std::size_t kConnections = 64;   // others
  static constexpr std::size_t kOfOneAddress = 32;  // of these
  static constexpr std::size_t kPages = 16;         // WebSockets at /live
  static constexpr std::size_t kViewers = 8;        // of Foxglove's protocol

  // What a page that says `request` gets (docs/view.md); called in the server's thread.
  using Answer = std::function<nlohmann::json(const nlohmann::json& request)>;

  // `state` must outlive it: metrics and Foxglove's protocol are made of it.
  static Result<std::unique_ptr<WebServer>> start(const WebOptions& options, FleetState& state,
                                                  Answer answer);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const { return port_; }
  // Empty with --no-token.
  const std::string& token() const { return rules_.token; }

 private:
  enum class Told { kEvicted, kRefused, kSlow, kTooLong, kMalformed, kForeign };
  static constexpr std::size_t kTold = 6;

  struct Client {
    UniqueFd fd;
    std::string address;  // of IPv6 the network's half
    std::unique_ptr<WebConnection> connection;
  };

  WebServer(FleetState& state, Answer answer);
  Status listen(const WebOptions& options);
  void run();
  void welcome(Time now);
  static bool waits(const Client& client);  // it has not asked yet, or is answered
  void make_room();
  bool may_ask(const Client& client) const;
  void serve(Client& client, bool readable, Time now);
  void remove_ended();
  void count(Told what);
  std::string own_metrics() const;

  WebReply route(const HttpHead& head);
  WebReply get(const HttpHead& head) const;
  WebReply upgrade(const HttpHead& head);

  FleetState& state_;
  const Answer answer_;
  AccessRules rules_;
  UniqueFd listener_;
  int port_ = 0;
  const WebRouter router_;
  std::size_t pages_ = 0;  // open WebSockets
  std::size_t viewers_ = 0;
  std::vector<Client> clients_;
  std::array<std::uint64_t, kTold> told_ = {};
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace zenith::tools
