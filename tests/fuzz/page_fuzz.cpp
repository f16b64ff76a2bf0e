// What a client may send to the page of `zenith view`. The first byte chooses:
//
//   0  a connection: the rest is what comes over the socket, in pieces as long as the second byte
//   1  the same, after the handshake of the page's WebSocket
//   2  the same, after that of a viewer of Foxglove's
//   3  a text of the page, as if it had come whole
//   4  a text of a viewer
//
// Nothing crashes, no exception comes out, and what is kept of it is bounded.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "tests/fuzz/require.h"
#include "tools/view/history.h"
#include "tools/view/look_back.h"
#include "tools/view/web_access.h"
#include "tools/view/web_sessions.h"

using namespace zenith;         // NOLINT(google-build-using-namespace)
using namespace zenith::tools;  // NOLINT(google-build-using-namespace)

namespace {

using nlohmann::json;

constexpr std::string_view kHandshake =
    " HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";

// Two robots of which something was told, made once.
struct Page {
  Page() {
    for (const char* name : {"anna", "bert"}) {
      const std::size_t robot = state.add(name);
      history.add(name);
      for (const std::string& text :
           {std::string(R"({"type":"hello","robot":")") + name + R"(","started_ns":1})",
            std::string(R"({"type":"pose","pose":[1,2,3]})"),
            std::string(R"({"type":"alignment","name":"bert","state":"merged","pose":[0,0,1]})")}) {
        const DecodedLine decoded = decode_telemetry(text);
        require(decoded.line.has_value());
        state.apply(robot, *decoded.line);
        state.read([&](const auto& robots) {
          history.note(robot, robots[robot], *decoded.line, text, Time{1'000'000'000});
        });
      }
    }
  }
  FleetState state;
  History history{100'000};
  LookBack look_back{state, history};
  std::size_t open = 0;
  const PageSession::Answer answer = [this](const json& asked) { return look_back.answer(asked); };
};

WebReply route(Page& page, const HttpHead& head) {
  WebReply reply;
  AccessRules rules;
  rules.token = head.path == "/metrics" ? "0123456789abcdef" : "";
  if (judge_access(rules, head, true) != Access::kAllowed) {
    reply.status = 403;
  } else if (head.lists("upgrade", "websocket") && head.path == "/live") {
    reply.session = std::make_unique<PageSession>(page.answer, page.open);
  } else if (head.lists("upgrade", "websocket")) {
    reply.session = std::make_unique<ViewerSession>(page.state, page.open);
  }
  return reply;
}

void talk(Page& page, std::string_view opening, std::string_view bytes, std::size_t piece) {
  const WebRouter router = [&](const HttpHead& head) { return route(page, head); };
  Time now{1'000'000'000};
  WebConnection connection(router, now);
  connection.receive(opening, now);
  const auto turn = [&] {
    connection.turn(now, [] { return Duration{}; });
    require(connection.out().size() < std::size_t{1} << 20U);
    connection.sent(connection.out().size(), now);
    now = now + Duration{1'000'000};
  };
  turn();
  while (!bytes.empty() && connection.state() != WebConnection::State::kDone) {
    const std::string_view part = bytes.substr(0, std::max<std::size_t>(piece, 1));
    bytes.remove_prefix(part.size());
    if (connection.wants_more(now)) connection.receive(part, now);
    turn();
    for (int i = 0; i < 64 && connection.has_work(now); ++i) turn();
  }
  connection.end_of_input();
  for (int i = 0; i < 64; ++i) turn();
  now = now + Duration{60'000'000'000};
  turn();
  turn();
  require(connection.state() == WebConnection::State::kDone);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Page page;
  if (size < 2) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 2, size - 2);
  std::vector<WebMessage> out;
  switch (data[0] % 5) {
    case 0:
      talk(page, "", rest, data[1]);
      break;
    case 1:
      talk(page, "GET /live" + std::string(kHandshake), rest, data[1]);
      break;
    case 2:
      talk(page, "GET /" + std::string(kHandshake), rest, data[1]);
      break;
    case 3: {
      PageSession session(page.answer, page.open);
      const bool good = session.hear(rest, out);
      require(good == !out.empty());
      if (good) require(json::parse(out[0].bytes).at("robots").size() == 2);
      break;
    }
    default: {
      ViewerSession session(page.state, page.open);
      require(session.hear(rest, out) && out.empty());
      session.turn(out);
      require(!out.empty());
      break;
    }
  }
  page.look_back.turn(Duration{100'000'000});
  require(page.open == 0);
  return 0;
}
