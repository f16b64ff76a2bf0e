// Somebody hostile against `zenith view` on the loopback interface: as a robot that tells nonsense,
// and as a client of its page. All of it is bounded.

#include <arpa/inet.h>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/page_client.h"
#include "tests/system/ros2/told_daemon.h"
#include "tests/system/view_server.h"

namespace zenith {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kLimit_s = kPatience_s;

class HostileView : public testing::Test {
 protected:
  // A robot that says what the test says, and a page of it.
  bool start(std::vector<std::string> words = {}) {
    words.push_back(robot_.path());
    return view_.start(std::move(words), kLimit_s) && robot_.wait_for_reader(kLimit_s);
  }
  std::string get(const std::string& path, std::string headers = "", bool with_token = true) {
    PageClient client(view_.port());
    if (headers.find("Host:") == std::string::npos) headers += "Host: 127.0.0.1\r\n";
    client.send("GET " + path + (with_token ? "?token=" + view_.token() : "") + " HTTP/1.1\r\n" +
                headers + "\r\n");
    return client.rest();
  }
  bool metrics_have(const std::string& text) {
    return wait_until(kLimit_s, [&] { return get("/metrics").find(text) != std::string::npos; });
  }
  bool lives() { return metrics_have("zenith_up"); }

  tools::TemporaryFolder folder_;
  ViewServer view_{folder_.path()};
  ToldDaemon robot_{(folder_.path() / "r1.sock").string()};
};

const std::vector<std::string>& nonsense() {
  static const std::vector<std::string> kLines = {
      "",
      "x",
      "{\"type\":5}",
      "{\"type\":\"hello\",\"robot\":[]}",
      "{\"type\":\"pose\",\"pose\":\"here\"}",
      "{\"type\":\"pose\",\"pose\":[\"a\",\"b\",\"c\"]}",
      "{\"type\":\"pose\",\"pose\":[1e300,0,0]}",
      "{\"type\":\"alignment\",\"name\":\"b\",\"state\":\"merged\",\"pose\":\"there\"}",
      "{\"type\":\"alignment\",\"name\":\"b\",\"state\":\"merged\",\"pose\":[null,{},[]]}",
      "{\"type\":\"alignment\",\"name\":7,\"state\":7,\"peer\":\"x\"}",
      "{\"type\":\"health\",\"state\":7,\"camera\":7}",
      "{\"type\":\"landmarks\",\"peer\":\"x\",\"rows\":7,\"gone\":7}",
      "{\"type\":\"landmarks\",\"peer\":-1,\"rows\":[\"a\",1,1,1,1,1,1,1,1],\"gone\":[]}",
      "{\"type\":\"picture\",\"width\":-1,\"height\":1e9}",
      "{\"type\":\"hello\",\"robot\":\"\xff\xfe\"}",
      "{\"type\":\"radio\",\"rejected\":7,\"a\":" + std::string(5000, '[') + "}"};
  return kLines;
}

TEST_F(HostileView, NonsenseOfARobotIsCountedWhileAViewerWatches) {
  ASSERT_TRUE(start()) << view_.log();
  robot_.say({{"type", "hello"}, {"robot", "anna"}, {"started_ns", 1}});
  robot_.say({{"type", "pose"}, {"stamp_ns", 1}, {"pose", {1, 2, 0.5}}});
  PageClient viewer(view_.port(), view_.token());
  ASSERT_THAT(viewer.upgrade("/", "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"),
              HasSubstr("101"));
  EXPECT_EQ(json::parse(viewer.hear().bytes)["op"], "serverInfo");
  viewer.say({{"op", "subscribe"},
              {"subscriptions",
               {{{"id", 1}, {"channelId", 1}},
                {{"id", 2}, {"channelId", 10}},
                {{"id", 3}, {"channelId", 11}}}}});
  for (const std::string& line : nonsense()) {
    robot_.say_text(line);
    robot_.say({{"type", "pose"}, {"stamp_ns", 2}, {"pose", {1, 2, 0.5}}});
  }
  ASSERT_TRUE(
      metrics_have("zenith_view_refused_lines_total{robot=\"anna\",reason=\"wrong_field\"} 11"))
      << get("/metrics") << view_.log();
  EXPECT_TRUE(metrics_have("reason=\"too_deep\"} 1"));
  EXPECT_TRUE(metrics_have("reason=\"no_type\"} 1"));
  EXPECT_TRUE(metrics_have("zenith_pose_x_metres{robot=\"anna\"} 1\n"));
  // The viewer goes on getting what is right.
  bool frame = false;
  for (int i = 0; i < 50 && !frame; ++i) {
    const PageClient::Message message = viewer.hear();
    ASSERT_NE(message.opcode, 0);
    frame = message.opcode == 2 && message.bytes[1] == 1;
  }
  EXPECT_TRUE(frame);
  EXPECT_TRUE(wait_until(kLimit_s, [&] {
    return view_.log().find("a line of its telemetry was skipped: wrong_field") !=
           std::string::npos;
  }));
  EXPECT_EQ(view_.stop(), 0);
}

// What others connect until it asks are as many as a storm brings in the time that a busy browser
// takes.
TEST_F(HostileView, WhoAsksLateIsAnsweredAmongManyThatAskForNothing) {
  ASSERT_TRUE(start()) << view_.log();
  PageClient late(view_.port());
  late.send("GET / HTTP/1.1\r\n");
  std::vector<std::unique_ptr<PageClient>> storm;
  for (int i = 0; i < 200; ++i) storm.push_back(std::make_unique<PageClient>(view_.port()));
  EXPECT_TRUE(lives()) << "by now it has seen them all";
  late.send("Host: 127.0.0.1\r\n\r\n");
  EXPECT_THAT(late.head(), StartsWith("HTTP/1.1 401"));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(HostileView, IdleWebSocketsAndIdleRequestsKeepNobodyOut) {
  ASSERT_TRUE(start()) << view_.log();
  // Without the token none opens at all.
  EXPECT_THAT(PageClient(view_.port()).upgrade("/live", ""), StartsWith("HTTP/1.1 401"));
  std::vector<std::unique_ptr<PageClient>> idle;
  std::string head;
  for (int i = 0; i < 200 && head.find("503") == std::string::npos; ++i) {
    idle.push_back(std::make_unique<PageClient>(view_.port(), view_.token()));
    head = idle.back()->upgrade("/live", "");
  }
  EXPECT_THAT(head, StartsWith("HTTP/1.1 503")) << "there are as many as may be";
  EXPECT_GE(idle.size(), 17u);
  EXPECT_TRUE(lives());
  // Sockets that ask for nothing, and halves of requests.
  std::vector<std::unique_ptr<PageClient>> half;
  const auto evicts = [&] {
    const std::string metrics = get("/metrics");
    EXPECT_THAT(metrics, HasSubstr("zenith_up"));
    return metrics.find("reason=\"evicted\"} 0\n") == std::string::npos;
  };
  for (int i = 0; i < 2000 && !(i % 40 == 0 && evicts()); ++i) {
    half.push_back(std::make_unique<PageClient>(view_.port()));
    if (i % 2 == 0) half.back()->send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n");
  }
  EXPECT_TRUE(evicts()) << "who asks for nothing makes room";
  EXPECT_THAT(get("/"), HasSubstr("<title>Zenith</title>"));
  EXPECT_THAT(get("/metrics"), Not(HasSubstr("reason=\"refused\"} 0\n")));
  // A page that is closed makes room.
  idle.clear();
  EXPECT_TRUE(wait_until(kLimit_s, [&] {
    return PageClient(view_.port(), view_.token()).upgrade("/live", "").find("101") !=
           std::string::npos;
  }));
  EXPECT_EQ(view_.stop(), 0);
}

// The most memory that a child which has ended held, in kB.
long children_peak_kb() {
  rusage used = {};
  return ::getrusage(RUSAGE_CHILDREN, &used) == 0 ? used.ru_maxrss : -1;
}

TEST_F(HostileView, AHugeMessageIsRefusedBeforeItIsKept) {
  ASSERT_TRUE(start()) << view_.log();
  ASSERT_TRUE(lives());
  for (const char* path : {"/live", "/"}) {
    PageClient client(view_.port(), view_.token());
    ASSERT_THAT(client.upgrade(path, "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"),
                HasSubstr("101"));
    if (std::string(path) == "/") (void)client.hear();
    client.say_text(std::string(std::size_t{24} << 20U, '['));
    PageClient::Message message;
    for (int i = 0; i < 20 && message.opcode != 8; ++i) message = client.hear();
    // The server hangs up on what is still being sent, which may overtake its close.
    if (message.opcode == 8) {
      EXPECT_EQ(message.bytes, std::string("\x03\xf1", 2)) << "1009";
    }
  }
  // Deep, and within the size: refused without being parsed.
  PageClient deep(view_.port(), view_.token());
  ASSERT_THAT(deep.upgrade("/live", ""), HasSubstr("101"));
  deep.say_text(std::string(4000, '['));
  EXPECT_EQ(deep.hear().opcode, 8);
  EXPECT_TRUE(metrics_have("zenith_view_turned_away_total{reason=\"too_long\"} 2"));
  EXPECT_EQ(view_.stop(), 0);
  // Parsed without a limit these messages would take some gigabytes.
  EXPECT_LT(children_peak_kb(), 512 * 1024);
}

TEST_F(HostileView, AnotherUserOfThisComputerSeesNothing) {
  ASSERT_TRUE(start()) << view_.log();
  for (const char* path : {"/", "/metrics", "/?token=0123456789abcdef0123456789abcdef"}) {
    EXPECT_THAT(get(path, "", false), StartsWith("HTTP/1.1 401")) << path;
  }
  EXPECT_THAT(get("/main.js", "", false), StartsWith("HTTP/1.1 200")) << "no secret";
  for (const char* path : {"/live", "/"}) {
    EXPECT_THAT(
        PageClient(view_.port()).upgrade(path, "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"),
        Not(HasSubstr("101")));
  }
  EXPECT_THAT(get("/metrics", "Authorization: Bearer " + view_.token() + "\r\n", false),
              HasSubstr("zenith_up"));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(HostileView, OnTheNetworkOnlyAddressesAndGivenNamesAreAnswered) {
  ASSERT_TRUE(start({"--bind", "0.0.0.0", "--allow-host", "desk.local"})) << view_.log();
  for (const char* host : {"127.0.0.1", "192.168.7.7:8765", "[::1]:1", "desk.local:8765"}) {
    EXPECT_THAT(get("/metrics", "Host: " + std::string(host) + "\r\n"), HasSubstr("zenith_up"))
        << host;
  }
  EXPECT_THAT(get("/metrics", "Host: evil.example\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/metrics", "Host: desk.local\r\nOrigin: http://evil.example\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/metrics", "", false), StartsWith("HTTP/1.1 401"));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(HostileView, WithoutATokenItIsSaid) {
  ASSERT_TRUE(start({"--no-token"})) << view_.log();
  EXPECT_EQ(view_.token(), "");
  EXPECT_THAT(view_.said(), HasSubstr("every user of this computer"));
  EXPECT_THAT(get("/metrics", "", false), HasSubstr("zenith_up"));
  EXPECT_THAT(get("/metrics", "Host: evil.example\r\n", false), StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(HostileView, ATokenFileKeepsTheAddressOverStarts) {
  const std::string file = (folder_.path() / "token").string();
  ASSERT_TRUE(start({"--token-file", file})) << view_.log();
  EXPECT_EQ(tools::read_text(file), view_.token() + "\n");
  EXPECT_EQ(view_.stop(), 0);
}

// On IPv6's own address, where this computer has it.
TEST_F(HostileView, ListensOnIPv6) {
  const UniqueFd probe(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in6 address = {};
  address.sin6_family = AF_INET6;
  address.sin6_addr = in6addr_loopback;
  if (!probe.is_open() ||
      ::bind(probe.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    GTEST_SKIP() << "SKIPPED: there is no IPv6 here";
  }
  ASSERT_TRUE(start({"--bind", "::1"})) << view_.log();
  EXPECT_THAT(view_.address(), StartsWith("http://[::1]:"));
  const UniqueFd client(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  address.sin6_port = htons(static_cast<std::uint16_t>(view_.port()));
  ASSERT_EQ(::connect(client.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string request =
      "GET /metrics?token=" + view_.token() + " HTTP/1.1\r\nHost: [::1]\r\n\r\n";
  ASSERT_GT(::send(client.get(), request.data(), request.size(), MSG_NOSIGNAL), 0);
  std::string text(64, '\0');
  ASSERT_GT(::recv(client.get(), text.data(), text.size(), 0), 0);
  EXPECT_THAT(text, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_EQ(view_.stop(), 0);
}

}  // namespace
}  // namespace zenith
