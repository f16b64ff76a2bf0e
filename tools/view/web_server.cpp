#include "tools/view/web_server.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <civetweb.h>

#include "drivers/leds/led_pattern.h"
#include "platform/daemon/health.h"
#include "tools/view/foxglove_server.h"
#include "tools/view/metrics.h"
#include "tools/view/web_asset.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

// The page loads nothing from elsewhere, and nobody may put it into a frame.
constexpr const char* kGuards =
    "Content-Security-Policy: default-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self' ws: wss:; frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCache-Control: "
    "no-cache\r\n";

const char* type_of(std::string_view path) {
  const std::string_view end = path.substr(std::min(path.rfind('.'), path.size()));
  if (end == ".html") return "text/html; charset=utf-8";
  if (end == ".css") return "text/css; charset=utf-8";
  if (end == ".js") return "text/javascript; charset=utf-8";
  if (end == ".svg") return "image/svg+xml";
  return "application/octet-stream";
}

int send(mg_connection* connection, int status, const char* reason, const char* type,
         std::string_view content) {
  mg_printf(connection,
            "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\nConnection: "
            "close\r\n%s\r\n",
            status, reason, type, content.size(), kGuards);
  mg_write(connection, content.data(), content.size());
  return status;
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

std::string host_of(std::string_view address) {
  const std::size_t scheme = address.find("://");
  if (scheme != std::string_view::npos) address.remove_prefix(scheme + 3);
  const std::size_t end = address.find(']');
  const std::size_t colon = address.find(':', end == std::string_view::npos ? 0 : end);
  return std::string(address.substr(0, colon));
}

bool is_this_computer(const std::string& host) {
  return host == "localhost" || host == "127.0.0.1" || host == "[::1]" || host == "::1";
}

}  // namespace

WebServer::WebServer(const WebOptions& options, FleetState& state, Answer answer)
    : options_(options),
      state_(state),
      answer_(std::move(answer)),
      foxglove_(std::make_unique<FoxgloveServer>(state)) {}

WebServer::~WebServer() {
  foxglove_->stop();
  if (context_ != nullptr) mg_stop(context_);
}

Result<std::unique_ptr<WebServer>> WebServer::start(const WebOptions& options, FleetState& state,
                                                    Answer answer) {
  std::unique_ptr<WebServer> server(new WebServer(options, state, std::move(answer)));
  const std::string port = options.bind + ":" + std::to_string(options.port);
  // A page and Foxglove each keep a thread.
  const char* settings[] = {"listening_ports",
                            port.c_str(),
                            "num_threads",
                            "24",
                            "request_timeout_ms",
                            "10000",
                            "websocket_timeout_ms",
                            "3600000",
                            "enable_directory_listing",
                            "no",
                            nullptr};
  std::string said;
  mg_callbacks callbacks = {};
  callbacks.log_message = [](const mg_connection* connection, const char* message) {
    auto* text = static_cast<std::string*>(mg_get_user_data(mg_get_context(connection)));
    if (text != nullptr && text->empty()) *text = message;
    return 1;
  };
  server->context_ = mg_start(&callbacks, &said, settings);
  if (server->context_ == nullptr) {
    return Error{"http://" + port + ": cannot listen there" + (said.empty() ? "" : ": " + said) +
                 "; is another `zenith view` running? --port takes another port, 0 any"};
  }
  mg_server_port ports = {};
  if (mg_get_server_ports(server->context_, 1, &ports) == 1) server->port_ = ports.port;
  mg_set_request_handler(server->context_, "/", &WebServer::on_request, server.get());
  mg_set_websocket_handler(server->context_, "/live$", &WebServer::on_connect, nullptr,
                           &WebServer::on_data, nullptr, server.get());
  server->foxglove_->listen(
      server->context_, [raw = server.get()](const mg_connection* c) { return raw->welcome(c); });
  return server;
}

bool WebServer::welcome(const mg_connection* connection) const {
  const char* host = mg_get_header(connection, "Host");
  const bool own_address = is_this_computer(options_.bind);
  // A name of somebody else's that leads to this computer (DNS rebinding).
  if (own_address && (host == nullptr || !is_this_computer(host_of(host)))) return false;
  const char* origin = mg_get_header(connection, "Origin");
  if (origin == nullptr) return true;
  const std::string from = host_of(origin);
  const auto& allowed = options_.origins;
  return std::string_view(origin) == "file://" || is_this_computer(from) ||
         (host != nullptr && from == host_of(host)) ||
         std::find(allowed.begin(), allowed.end(), origin) != allowed.end();
}

int WebServer::on_request(mg_connection* connection, void* self) {
  return static_cast<const WebServer*>(self)->serve(connection);
}

int WebServer::serve(mg_connection* connection) const {
  const mg_request_info* info = mg_get_request_info(connection);
  const std::string_view method = info->request_method;
  std::string_view path = info->local_uri;
  if (!welcome(connection)) {
    return send(connection, 403, "Forbidden", "text/plain",
                "This page answers this computer alone: see --bind and --allow-origin.\n");
  }
  if (method != "GET") return send(connection, 405, "Method Not Allowed", "text/plain", "GET\n");
  if (path == "/metrics") {
    return send(connection, 200, "OK", kMetricsType, metrics_text(state_));
  }
  if (path == "/lights.json") {
    return send(connection, 200, "OK", "application/json", lights_json());
  }
  if (path == "/") path = "/index.html";
  for (const WebAsset& asset : web_assets()) {
    if (asset.path == path) {
      return send(connection, 200, "OK", type_of(path), asset.content);
    }
  }
  return send(connection, 404, "Not Found", "text/plain", "There is no such page.\n");
}

int WebServer::on_connect(const mg_connection* connection, void* self) {
  return static_cast<const WebServer*>(self)->welcome(connection) ? 0 : 1;
}

int WebServer::on_data(mg_connection* connection, int bits, char* data, std::size_t size,
                       void* self) {
  const int opcode = bits & 0xf;
  if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) return 0;
  if (opcode != MG_WEBSOCKET_OPCODE_TEXT) return 1;
  return static_cast<WebServer*>(self)->reply(connection, std::string(data, size)) ? 1 : 0;
}

bool WebServer::reply(mg_connection* connection, const std::string& request) const {
  const json asked = json::parse(request, nullptr, false);
  if (!asked.is_object()) return false;
  std::string text;
  try {
    text = answer_(asked).dump(-1, ' ', false, json::error_handler_t::replace);
  } catch (const json::exception&) {
    return false;  // a key has another type
  }
  return mg_websocket_write(connection, MG_WEBSOCKET_OPCODE_TEXT, text.data(), text.size()) > 0;
}

}  // namespace zenith::tools
