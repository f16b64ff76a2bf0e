#include "tools/view/web_server.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "drivers/leds/led_pattern.h"
#include "platform/daemon/health.h"
#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/log.h"
#include "tools/view/metrics.h"
#include "tools/view/web_asset.h"
#include "tools/view/web_sessions.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr int kBacklog = 64;
constexpr std::size_t kReadBytes = 16384;
constexpr int kWait_ms = 50;

const char* type_of(std::string_view path) {
  const std::string_view end = path.substr(std::min(path.rfind('.'), path.size()));
  if (end == ".html") return "text/html; charset=utf-8";
  if (end == ".css") return "text/css; charset=utf-8";
  if (end == ".js") return "text/javascript; charset=utf-8";
  if (end == ".svg") return "image/svg+xml";
  return "application/octet-stream";
}

// The rhythm that the lights have in each state, a step of 0.1 s each: "#..." of each LED.
std::string lights_json() {
  json lights;
  constexpr int kSteps = 20;
  for (const RobotLight light : {RobotLight::kStarting, RobotLight::kMapping, RobotLight::kMerged,
                                 RobotLight::kDegraded, RobotLight::kFault, RobotLight::kStopped}) {
    for (int led = 0; led < kLedCount; ++led) {
      std::string rhythm;
      for (int step = 0; step < kSteps; ++step) {
        const LedMask lit = led_pattern(light, Duration{step * kLedStep.ns});
        rhythm += (lit >> led & 1) != 0 ? '#' : '.';
      }
      lights[light_name(light)].push_back(rhythm);
    }
  }
  return lights.dump();
}

WebReply refusal(int status, std::string why) {
  WebReply reply;
  reply.status = status;
  reply.content = std::move(why) + "\n";
  return reply;
}

WebReply content(const char* type, std::string_view text) {
  WebReply reply;
  reply.type = type;
  reply.content = text;
  return reply;
}

// 127.0.0.1, or of IPv6 the first 64 bits: who has one address there has all of that network.
std::string address_of(const sockaddr_storage& from) {
  std::array<char, INET6_ADDRSTRLEN> text = {};
  if (from.ss_family == AF_INET) {
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(from);
    (void)::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
    return text.data();
  }
  in6_addr v6 = reinterpret_cast<const sockaddr_in6&>(from).sin6_addr;
  if (!IN6_IS_ADDR_V4MAPPED(&v6)) std::memset(v6.s6_addr + 8, 0, 8);
  (void)::inet_ntop(AF_INET6, &v6, text.data(), text.size());
  return text.data();
}

Duration thread_time() {
  timespec used = {};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return {std::int64_t{used.tv_sec} * 1'000'000'000 + used.tv_nsec};
}

Error cannot_listen(const WebOptions& options, const std::string& why) {
  return Error{"http://" + options.bind + ":" + std::to_string(options.port) +
               ": cannot listen there: " + why +
               "; is another `zenith view` running? --port takes another port, 0 any"};
}

}  // namespace

WebServer::WebServer(FleetState& state, Answer answer)
    : state_(state),
      answer_(std::move(answer)),
      router_([this](const HttpHead& head) { return route(head); }) {}

WebServer::~WebServer() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

Result<std::unique_ptr<WebServer>> WebServer::start(const WebOptions& options, FleetState& state,
                                                    Answer answer) {
  std::unique_ptr<WebServer> server(new WebServer(state, std::move(answer)));
  if (!options.no_token) {
    auto token = options.token_file.empty() ? new_token() : token_of_file(options.token_file);
    if (!token) return token.error();
    server->rules_.token = std::move(*token);
  }
  server->rules_.hosts = options.hosts;
  server->rules_.origins = options.origins;
  if (const Status listens = server->listen(options); !listens) return listens.error();
  server->thread_ = std::thread([raw = server.get()] { raw->run(); });
  return server;
}

Status WebServer::listen(const WebOptions& options) {
  std::string bind = options.bind == "localhost" ? "127.0.0.1" : options.bind;
  if (bind.size() > 2 && bind.front() == '[' && bind.back() == ']') {
    bind = bind.substr(1, bind.size() - 2);
  }
  rules_.loopback = is_this_computer(bind);
  addrinfo hints = {};
  hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(options.port);
  if (::getaddrinfo(bind.c_str(), port.c_str(), &hints, &found) != 0) {
    return Error{"--bind: expected an address such as 127.0.0.1, 0.0.0.0 or ::1, found '" +
                 options.bind + "'"};
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> address(found, ::freeaddrinfo);
  listener_ = UniqueFd(
      ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP));
  const int yes = 1;
  const int no = 0;
  (void)::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  // "::" is for both.
  (void)::setsockopt(listener_.get(), IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no);
  if (!listener_.is_open() || ::bind(listener_.get(), address->ai_addr, address->ai_addrlen) != 0 ||
      ::listen(listener_.get(), kBacklog) != 0) {
    return cannot_listen(options, errno_text(errno));
  }
  sockaddr_storage own = {};
  socklen_t size = sizeof own;
  (void)::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&own), &size);
  port_ = ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(own).sin6_port
                                          : reinterpret_cast<sockaddr_in&>(own).sin_port);
  return {};
}

// --- Connections ---------------------------------------------------------------------------------

void WebServer::run() {
  std::vector<pollfd> entries;
  while (!stop_) {
    Time now = monotonic_now();
    entries.assign(1, {listener_.get(), POLLIN, 0});
    bool work = false;
    for (const Client& client : clients_) {
      const WebConnection& c = *client.connection;
      const int events = (c.wants_more(now) ? POLLIN : 0) | (c.out().empty() ? 0 : POLLOUT);
      entries.push_back({client.fd.get(), static_cast<short>(events), 0});
      work = work || c.has_work(now);
    }
    (void)::poll(entries.data(), entries.size(), work ? 0 : kWait_ms);
    now = monotonic_now();
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      serve(clients_[i], (entries[i + 1].revents & (POLLIN | POLLHUP | POLLERR)) != 0, now);
    }
    remove_ended();
    if ((entries[0].revents & POLLIN) != 0) welcome(now);
  }
}

void WebServer::serve(Client& client, bool readable, Time now) {
  WebConnection& c = *client.connection;
  if (readable && c.state() == WebConnection::State::kHead && !may_ask(client)) {
    count(Told::kRefused);
    return c.abandon();
  }
  std::array<char, kReadBytes> bytes;
  if (readable) {
    const ssize_t size = ::recv(client.fd.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size > 0) {
      c.receive({bytes.data(), static_cast<std::size_t>(size)}, now);
    } else if (size == 0) {
      c.end_of_input();
    } else if (errno != EAGAIN && errno != EINTR) {
      c.abandon();
    }
  }
  c.turn(now, thread_time);
  if (c.out().empty()) return;
  const ssize_t sent =
      ::send(client.fd.get(), c.out().data(), c.out().size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent > 0) {
    c.sent(static_cast<std::size_t>(sent), now);
    if (c.state() == WebConnection::State::kLingering) ::shutdown(client.fd.get(), SHUT_WR);
  } else if (errno != EAGAIN && errno != EINTR) {
    c.abandon();
  }
}

void WebServer::remove_ended() {
  for (const Client& client : clients_) {
    if (client.connection->state() != WebConnection::State::kDone) continue;
    switch (client.connection->fault()) {
      case WebConnection::Fault::kSlow:
        count(Told::kSlow);
        break;
      case WebConnection::Fault::kTooLong:
        count(Told::kTooLong);
        break;
      case WebConnection::Fault::kProtocol:
        count(Told::kMalformed);
        break;
      case WebConnection::Fault::kNone:
      case WebConnection::Fault::kIdle:
        break;
    }
  }
  std::erase_if(clients_, [](const Client& client) {
    return client.connection->state() == WebConnection::State::kDone;
  });
}

void WebServer::welcome(Time now) {
  // Those that came together; others have their turn first.
  for (int i = 0; i < kBacklog; ++i) {
    sockaddr_storage from = {};
    socklen_t size = sizeof from;
    UniqueFd fd(::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&from), &size,
                          SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!fd.is_open()) {
      // Without descriptors it would be tried again at once.
      if (errno == EMFILE || errno == ENFILE) sleep_until(now + Duration{kWait_ms * 1'000'000});
      return;
    }
    make_room();
    clients_.push_back(
        {std::move(fd), address_of(from), std::make_unique<WebConnection>(router_, now)});
    // What it asks is mostly there already, and then it is no candidate for the next one's room.
    serve(clients_.back(), true, now);
  }
}

bool WebServer::waits(const Client& client) {
  const auto state = client.connection->state();
  return state == WebConnection::State::kHead || state == WebConnection::State::kLingering;
}

// When there are too many that wait the oldest one of the address with most of them goes.
void WebServer::make_room() {
  std::map<std::string_view, std::size_t> waiting;
  std::size_t most = 0;
  std::size_t all = 0;
  for (const Client& client : clients_) {
    if (!waits(client)) continue;
    most = std::max(most, ++waiting[client.address]);
    ++all;
  }
  if (all < kWaiting) return;
  const auto oldest = std::find_if(clients_.begin(), clients_.end(), [&](const Client& client) {
    return waits(client) && waiting[client.address] == most;
  });
  clients_.erase(oldest);
  count(Told::kEvicted);
}

bool WebServer::may_ask(const Client& client) const {
  std::size_t all = 0;
  std::size_t of_address = 0;
  for (const Client& other : clients_) {
    if (waits(other)) continue;
    ++all;
    if (other.address == client.address) ++of_address;
  }
  return all < kConnections && of_address < kOfOneAddress;
}

namespace {

struct Telling {
  const char* name;
  const char* text;
};
constexpr std::array<Telling, 6> kTellings = {{
    {"evicted", "a connection that asked for nothing was closed: there are too many"},
    {"refused", "a connection was refused: there are too many"},
    {"slow", "a reader was dropped: it did not take what it had asked for"},
    {"too_long", "a message of more than 64 kB, or a head of more than 8 kB, was refused"},
    {"malformed", "what a client sent was no HTTP or WebSocket"},
    {"forbidden", "a request without the token, or of another site, was refused"},
}};

}  // namespace

void WebServer::count(Told what) {
  const auto i = static_cast<std::size_t>(what);
  // Each power of two: what goes on is told again, and ever more rarely.
  if (const std::uint64_t n = ++told_[i]; (n & (n - 1)) == 0) {
    log_line(LogLevel::kWarning, "the page: %s (%llu)", kTellings[i].text,
             static_cast<unsigned long long>(n));
  }
}

std::string WebServer::own_metrics() const {
  std::string out =
      "# HELP zenith_view_turned_away_total connections of the page that were closed or refused, "
      "by reason\n# TYPE zenith_view_turned_away_total counter\n";
  for (std::size_t i = 0; i < kTold; ++i) {
    out += std::string("zenith_view_turned_away_total{reason=\"") + kTellings[i].name + "\"} " +
           std::to_string(told_[i]) + "\n";
  }
  return out;
}

// --- Requests ------------------------------------------------------------------------------------

WebReply WebServer::route(const HttpHead& head) {
  const bool is_asset =
      head.path == "/lights.json" ||
      std::any_of(web_assets().begin(), web_assets().end(), [&](const WebAsset& asset) {
        return asset.path == head.path && asset.path != "/index.html";
      });
  const bool upgrades = head.lists("upgrade", "websocket");
  const Access access = judge_access(rules_, head, upgrades || !is_asset);
  if (access != Access::kAllowed) count(Told::kForeign);
  switch (access) {
    case Access::kAllowed:
      break;
    case Access::kForeignHost:
      return refusal(403,
                     "This page answers to its address in digits: others are named with "
                     "--allow-host, see docs/view.md.");
    case Access::kForeignOrigin:
      return refusal(403, "This page answers no page of another site: see --allow-origin.");
    case Access::kNoToken:
      return refusal(401,
                     "Open the address that `zenith view` printed: it ends in ?token=... Programs "
                     "send it as Authorization: Bearer.");
  }
  if (head.method != "GET") return refusal(405, "GET");
  return upgrades ? upgrade(head) : get(head);
}

WebReply WebServer::get(const HttpHead& head) const {
  if (head.path == "/metrics") return content(kMetricsType, metrics_text(state_) + own_metrics());
  if (head.path == "/lights.json") return content("application/json", lights_json());
  const std::string_view path = head.path == "/" ? "/index.html" : std::string_view(head.path);
  for (const WebAsset& asset : web_assets()) {
    if (asset.path == path) return content(type_of(path), asset.content);
  }
  return refusal(404, "There is no such page.");
}

WebReply WebServer::upgrade(const HttpHead& head) {
  WebReply reply;
  if (head.path == "/live") {
    if (pages_ >= kPages) {
      count(Told::kRefused);
      return refusal(503, "There are too many pages: close one.");
    }
    reply.session = std::make_unique<PageSession>(answer_, pages_);
    return reply;
  }
  if (head.path != "/") return refusal(404, "There is no such WebSocket.");
  for (const char* protocol : {"foxglove.websocket.v1", "foxglove.sdk.v1"}) {
    if (head.lists("sec-websocket-protocol", protocol)) reply.protocol = protocol;
  }
  if (reply.protocol.empty()) {
    return refusal(400, "expected the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1");
  }
  if (viewers_ >= kViewers) {
    count(Told::kRefused);
    return refusal(503, "There are too many viewers: close one.");
  }
  reply.session = std::make_unique<ViewerSession>(state_, viewers_);
  return reply;
}

}  // namespace zenith::tools
