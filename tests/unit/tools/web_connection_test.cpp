// One connection of the page's server: what it takes, how much, and how long it waits. No socket
// and no clock.

#include "tools/view/web_connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace zenith::tools {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using State = WebConnection::State;
using Fault = WebConnection::Fault;

constexpr Duration kSecond = {1'000'000'000};

class Echo final : public WebSession {
 public:
  bool hear(std::string_view text, std::vector<WebMessage>& out) override {
    out.push_back({false, std::string(text)});
    return text != "nonsense";
  }
  void turn(std::vector<WebMessage>& out) override { (void)out; }
};

// A frame as clients send it, masked with zeros.
std::string frame(unsigned first, std::string_view payload, bool masked = true) {
  std::string out(1, static_cast<char>(first));
  const unsigned mask = masked ? 0x80U : 0U;
  if (payload.size() < 126) {
    out += static_cast<char>(mask | payload.size());
  } else {
    out += static_cast<char>(mask | 127U);
    for (unsigned shift = 64; shift > 0; shift -= 8) {
      out += static_cast<char>(payload.size() >> (shift - 8));
    }
  }
  return out + std::string(masked ? 4 : 0, '\0') + std::string(payload);
}

class Connection : public testing::Test {
 protected:
  WebReply route(const HttpHead& head) {
    WebReply reply;
    if (head.lists("upgrade", "websocket")) {
      reply.session = std::make_unique<Echo>();
    } else {
      reply.content = head.path;
    }
    return reply;
  }
  void hear(std::string_view bytes) {
    connection_.receive(bytes, now_);
    turn();
  }
  void turn() {
    connection_.turn(now_, [this] { return used_; });
  }
  void wait(Duration time) {
    now_ = now_ + time;
    turn();
  }
  std::string taken() {
    std::string out = connection_.out();
    connection_.sent(out.size(), now_);
    return out;
  }
  void upgrade() {
    hear(
        "GET /live HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    EXPECT_THAT(taken(), HasSubstr("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"))
        << "RFC 6455's example";
  }
  // All frames, one turn each.
  std::string say(const std::string& bytes) {
    hear(bytes);
    std::string out = taken();
    for (int i = 0; i < 100 && connection_.has_work(now_); ++i) {
      turn();
      out += taken();
    }
    return out;
  }

  Time now_ = Time{} + kSecond;
  Duration used_;
  const WebRouter router_ = [this](const HttpHead& head) { return route(head); };
  WebConnection connection_{router_, now_};
};

TEST_F(Connection, AnswersARequestThatComesInPieces) {
  for (const char c : std::string("GET /a?b=1 HTTP/1.1\r\nHost: x\r\n\r")) hear({&c, 1});
  EXPECT_EQ(connection_.state(), State::kHead);
  hear("\n");
  const std::string out = taken();
  EXPECT_THAT(out, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(out, HasSubstr("Content-Length: 2\r\n"));
  EXPECT_THAT(out, testing::EndsWith("\r\n\r\n/a"));
  EXPECT_EQ(connection_.state(), State::kLingering);
  wait(WebConnection::kLingerLimit + kSecond);
  EXPECT_EQ(connection_.state(), State::kDone);
}

TEST_F(Connection, AHeadThatDoesNotComeWholeEndsIt) {
  hear("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 9; ++i) {
    hear("X: ");  // a byte now and then does not help
    wait(kSecond);
  }
  EXPECT_EQ(connection_.state(), State::kHead);
  wait({2 * kSecond.ns});
  EXPECT_EQ(connection_.state(), State::kDone);
  EXPECT_EQ(connection_.fault(), Fault::kIdle);
}

TEST_F(Connection, AHeadWithoutEndIsRefused) {
  hear("GET / HTTP/1.1\r\nX: " + std::string(HttpHead::kMostBytes, 'a'));
  EXPECT_THAT(taken(), StartsWith("HTTP/1.1 431 "));
  EXPECT_EQ(connection_.fault(), Fault::kTooLong);
}

TEST(HttpHead, IsReadStrictly) {
  const auto fault = [](const std::string& text) { return parse_http_head(text).fault; };
  EXPECT_EQ(fault("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), HeadFault::kNone);
  EXPECT_EQ(fault("GET / HTTP/1.1\r\n\r\n"), HeadFault::kNone);
  for (const std::string head :
       {"\r\n\r\n", "GET\r\n\r\n", "GET  HTTP/1.1\r\n\r\n", "GET / HTTP/9\r\n\r\n",
        "GET x HTTP/1.1\r\n\r\n", "GET /\x01 HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\nHost\r\n\r\n",
        "GET / HTTP/1.1\r\n: x\r\n\r\n", "GET / HTTP/1.1\r\nHost : x\r\n\r\n",
        "GET / HTTP/1.1\r\n folded\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
        "GET / HTTP/1.1\r\nX: a\nb\r\n\r\n", "G\x80T / HTTP/1.1\r\n\r\n"}) {
    EXPECT_EQ(fault(head), HeadFault::kMalformed) << head;
  }
  std::string many = "GET / HTTP/1.1\r\n";
  for (std::size_t i = 0; i <= HttpHead::kMostHeaders; ++i) many += "X: y\r\n";
  EXPECT_EQ(fault(many + "\r\n"), HeadFault::kMalformed);
  const HttpHead head =
      parse_http_head("GET /a?x=1&token=abc&y HTTP/1.1\r\nConnection: keep-alive, Upgrade\r\n\r\n")
          .head;
  EXPECT_EQ(head.path, "/a");
  EXPECT_EQ(head.parameter("token"), "abc");
  EXPECT_EQ(head.parameter("y"), "");
  EXPECT_EQ(head.parameter("oken"), "");
  EXPECT_TRUE(head.lists("connection", "upgrade"));
  EXPECT_FALSE(head.lists("connection", "up"));
}

TEST_F(Connection, PutsFragmentsTogetherAndAnswersPings) {
  upgrade();
  EXPECT_EQ(say(frame(0x01, "ab")), "");
  EXPECT_EQ(say(frame(0x89, "x")), websocket_frame(WebOpcode::kPong, "x")) << "in between";
  EXPECT_EQ(say(frame(0x80, "c")), websocket_frame(WebOpcode::kText, "abc"));
  EXPECT_EQ(say(frame(0x81, "d") + frame(0x81, "e")),
            websocket_frame(WebOpcode::kText, "d") + websocket_frame(WebOpcode::kText, "e"));
  EXPECT_EQ(say(frame(0x88, "")), websocket_close(kCloseNormal));
  EXPECT_EQ(connection_.state(), State::kLingering);
}

TEST_F(Connection, AMessageBeyondTheLimitIsRefusedBeforeItComes) {
  upgrade();
  std::string head = "\x81\xff";
  const std::uint64_t size = std::uint64_t{200} << 20U;
  for (unsigned shift = 64; shift > 0; shift -= 8) head += static_cast<char>(size >> (shift - 8));
  head += std::string(4, '\0');
  EXPECT_EQ(say(head), websocket_close(kCloseTooLong)) << "its length alone";
  EXPECT_EQ(connection_.fault(), Fault::kTooLong);
}

TEST_F(Connection, FragmentsTogetherKeepTheLimit) {
  upgrade();
  const std::string part(30'000, '[');
  EXPECT_EQ(say(frame(0x01, part)), "");
  EXPECT_EQ(say(frame(0x00, part)), "");
  EXPECT_EQ(say(frame(0x00, part)), websocket_close(kCloseTooLong));
}

TEST_F(Connection, WhatIsNoWebSocketIsClosed) {
  for (const std::string& bytes :
       {frame(0x81, "not masked", false), frame(0xc1, "reserved bit"), frame(0x83, "opcode"),
        frame(0x80, "continues nothing"), frame(0x09, "a ping in pieces"),
        frame(0x89, std::string(126, 'x'))}) {
    WebConnection fresh(router_, now_);
    fresh.receive(
        "GET / HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
        "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n" +
            bytes,
        now_);
    for (int i = 0; i < 3; ++i) {
      fresh.turn(now_, [] { return Duration{}; });
      if (i < 2) fresh.sent(fresh.out().size(), now_);
      if (fresh.state() == State::kFlushing || fresh.state() == State::kLingering) break;
    }
    EXPECT_EQ(fresh.fault(), Fault::kProtocol);
  }
  upgrade();
  EXPECT_THAT(say(frame(0x81, "nonsense")), HasSubstr(websocket_close(kCloseRefused)));
}

TEST_F(Connection, AnIdleWebSocketIsAskedAndThenCutOff) {
  upgrade();
  wait(WebConnection::kPingAfter + kSecond);
  EXPECT_EQ(taken(), websocket_frame(WebOpcode::kPing, ""));
  hear(frame(0x8a, ""));
  wait(WebConnection::kPingAfter + kSecond);
  EXPECT_EQ(taken(), websocket_frame(WebOpcode::kPing, "")) << "who answers stays";
  wait(WebConnection::kPingAfter + kSecond);
  EXPECT_EQ(connection_.state(), State::kDone);
  EXPECT_EQ(connection_.fault(), Fault::kIdle);
}

TEST_F(Connection, OneAnswerWaitsAtATimeAndASlowReaderIsDropped) {
  upgrade();
  hear(frame(0x81, "a") + frame(0x81, "b"));
  EXPECT_EQ(connection_.out(), websocket_frame(WebOpcode::kText, "a"));
  for (int i = 0; i < 5; ++i) {
    turn();
    EXPECT_EQ(connection_.out(), websocket_frame(WebOpcode::kText, "a"));
    EXPECT_FALSE(connection_.wants_more(now_)) << "nothing more is read of it";
  }
  wait(WebConnection::kIdleLimit + kSecond);
  EXPECT_EQ(connection_.state(), State::kDone);
  EXPECT_EQ(connection_.fault(), Fault::kSlow);
}

// The processor's time, as the loop measures it.
TEST_F(Connection, WhoAsksForMuchWaits) {
  upgrade();
  const Duration cost = {10'000'000};
  int calls = 0;
  connection_.receive(frame(0x81, "a") + frame(0x81, "b"), now_);
  connection_.turn(now_, [&] { return Duration{calls++ * cost.ns}; });
  EXPECT_EQ(taken(), websocket_frame(WebOpcode::kText, "a"));
  EXPECT_FALSE(connection_.has_work(now_));
  EXPECT_FALSE(connection_.has_work(now_ + Duration{cost.ns * WebConnection::kPauseFactor - 1}));
  EXPECT_TRUE(connection_.has_work(now_ + Duration{cost.ns * WebConnection::kPauseFactor}));
}

// The loop looks again and again whether there is something to say.
TEST_F(Connection, WhoAsksForNothingIsHeardAtOnce) {
  upgrade();
  std::int64_t used_ns = 0;
  for (int i = 0; i < 100; ++i) {
    connection_.turn(now_, [&] { return Duration{used_ns += 1'000'000}; });
    EXPECT_TRUE(connection_.wants_more(now_));
    now_ = now_ + Duration{1000};
  }
  EXPECT_EQ(say(frame(0x81, "a")), websocket_frame(WebOpcode::kText, "a"));
}

}  // namespace
}  // namespace zenith::tools
