// What `zenith view`, `zenith telemetry` and `zenith metrics` say to other programs, over real
// sockets: HTTP, Foxglove's WebSocket, lines, files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/patience.h"
#include "tests/system/page_client.h"
#include "tests/system/sim_daemon.h"
#include "tests/system/view_server.h"

namespace zenith {

std::string short_timeline() {
  std::string text = R"({"timeline":1,"robots":["anna","bert"]})"
                     "\n";
  const auto put = [&](double t_s, int robot, const nlohmann::json& line) {
    text += nlohmann::json({{"t_s", t_s}, {"robot", robot}, {"line", line}}).dump() + "\n";
  };
  for (int robot = 0; robot < 2; ++robot) {
    put(0.0, robot,
        {{"type", "hello"}, {"robot", robot == 0 ? "anna" : "bert"}, {"started_ns", 1}});
  }
  for (int i = 0; i <= 40; ++i) {
    const double t_s = 0.1 * i;
    for (int robot = 0; robot < 2; ++robot) {
      put(t_s, robot,
          {{"type", "pose"},
           {"stamp_ns", t_s * 1e9},
           {"pose", {t_s, 0, 0}},
           {"covariance", {1e-6, 0, 0, 1e-6, 0, 1e-6}},
           {"step_ms", 5.0},
           {"period_ms", 100},
           {"inliers", 3},
           {"candidates", 5}});
      if (i % 10 != 0) continue;
      nlohmann::json marks = {
          {"type", "landmarks"}, {"peer", -1}, {"name", ""}, {"gone", nlohmann::json::array()}};
      for (const double n : {i + 1.0, t_s, 1.0, 2.5, 1e-4, 0.0, 4e-4, 1e-3, 5.0}) {
        marks["rows"].push_back(n);
      }
      put(t_s, robot, marks);
    }
    if (i % 10 == 0) {
      put(t_s, 0,
          {{"type", "alignment"},
           {"stamp_ns", t_s * 1e9},
           {"peer", 0},
           {"name", "bert"},
           {"state", i < 30 ? "candidate" : "merged"},
           {"pose", {0, 2, 0}},
           {"confidence", 0.25 * i / 10},
           {"correspondences", i}});
    }
  }
  return text;
}

namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kLimit_s = kPatience_s;

class ViewWireTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_.path() / "out");
    tools::write_text(folder_.path() / "out" / "timeline.jsonl", short_timeline());
    ASSERT_TRUE(view_.start({(folder_.path() / "out").string()}, kLimit_s)) << view_.log();
  }
  std::string get(const std::string& path, const std::string& headers) {
    PageClient client(view_.port());
    client.send("GET " + path + "?token=" + view_.token() + " HTTP/1.1\r\n" + headers +
                "Connection: close\r\n\r\n");
    return client.rest();
  }
  // As the page's slider does.
  void view_control(const json& control) {
    PageClient page(view_.port(), view_.token());
    ASSERT_THAT(page.upgrade("/live", ""), HasSubstr("101"));
    page.say({{"control", control}});
    EXPECT_TRUE(json::parse(page.hear().bytes)["reset"].get<bool>());
  }
  tools::TemporaryFolder folder_;
  ViewServer view_{folder_.path()};
};

TEST_F(ViewWireTest, ServesThePageItsFilesAndMetrics) {
  const std::string host = "Host: 127.0.0.1:" + std::to_string(view_.port()) + "\r\n";
  const std::string page = get("/", host);
  EXPECT_THAT(page, testing::StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'self'"));
  EXPECT_THAT(page, HasSubstr("<title>Zenith</title>"));
  EXPECT_THAT(get("/main.js", host), HasSubstr("Content-Type: text/javascript"));
  EXPECT_THAT(get("/lights.json", host), HasSubstr("\"merged\":["));
  EXPECT_THAT(get("/metrics", host), HasSubstr("zenith_up{robot=\"anna\"} 1"));
  EXPECT_THAT(get("/../../etc/passwd", host), testing::Not(HasSubstr("root:")));
  EXPECT_THAT(get("/none", host), testing::StartsWith("HTTP/1.1 404"));
  EXPECT_EQ(view_.stop(), 0);
}

TEST_F(ViewWireTest, AnswersNoPageOfAnotherSite) {
  EXPECT_THAT(get("/", "Host: evil.example\r\n"), testing::StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/metrics", "Host: localhost\r\nOrigin: https://evil.example\r\n"),
              testing::StartsWith("HTTP/1.1 403"));
  for (const char* path : {"/", "/live"}) {
    EXPECT_THAT(
        PageClient(view_.port(), view_.token()).upgrade(path, "Origin: https://evil.example\r\n"),
        testing::Not(HasSubstr("101")))
        << path;
  }
}

TEST_F(ViewWireTest, SpeaksFoxglovesProtocol) {
  for (const char* protocol : {"foxglove.websocket.v1", "foxglove.sdk.v1"}) {
    PageClient client(view_.port(), view_.token());
    const std::string head =
        client.upgrade("/", std::string("Sec-WebSocket-Protocol: ") + protocol + "\r\n");
    ASSERT_THAT(head, HasSubstr("101 Switching Protocols"));
    EXPECT_THAT(head, HasSubstr(protocol));
    const json info = json::parse(client.hear().bytes);
    EXPECT_EQ(info["op"], "serverInfo");
    view_control({{"seek", 3.5}});
    json channels = json::parse(client.hear().bytes)["channels"];
    std::map<std::string, int> by_topic;
    for (const json& channel : channels) by_topic[channel["topic"]] = channel["id"];
    ASSERT_EQ(by_topic.count("/anna/scene"), 1u) << channels;
    client.say({{"op", "subscribe"},
                {"subscriptions",
                 {{{"id", 5}, {"channelId", by_topic["/anna/scene"]}},
                  {{"id", 6}, {"channelId", by_topic["/tf"]}}}}});
    bool scene = false;
    std::set<std::string> frames;
    for (int i = 0; i < 50 && !(scene && frames.size() >= 4); ++i) {
      const PageClient::Message message = client.hear();
      ASSERT_EQ(message.opcode, 2);
      ASSERT_EQ(message.bytes[0], 1);
      const json data = json::parse(message.bytes.substr(13));
      if (message.bytes[1] == 5) scene = !data["entities"][0]["spheres"].empty();
      if (message.bytes[1] == 6) frames.insert(data["child_frame_id"]);
    }
    EXPECT_TRUE(scene);
    EXPECT_THAT(frames, testing::ElementsAre("anna/base_link", "anna/start", "bert/base_link",
                                             "bert/start"));
  }
}

// Lines from a daemon, and its metrics as a file.
TEST(TelemetryTools, PrintLinesAndWriteMetrics) {
  tools::TemporaryFolder folder;
  SimDaemon r1(folder.path(), "r1", "");
  ASSERT_TRUE(r1.start()) << r1.log();
  const std::string socket = (folder.path() / "r1.sock").string();
  const std::string lines = (folder.path() / "lines").string();
  {
    const Process telemetry({ZENITH_TOOL, "telemetry", socket}, lines, lines + ".log");
    EXPECT_TRUE(wait_until(kLimit_s, [&] {
      const std::string said = tools::read_text(lines);
      return said.find("\"type\":\"health\"") != std::string::npos &&
             said.find("\"type\":\"landmarks\"") != std::string::npos;
    })) << tools::read_text(lines + ".log");
  }
  EXPECT_THAT(tools::read_text(lines), testing::StartsWith("{\"type\":\"hello\",\"robot\":\"r1\""));
  const std::string file = (folder.path() / "zenith.prom").string();
  Process metrics({ZENITH_TOOL, "metrics", socket, "--textfile", file}, lines, lines + ".log");
  EXPECT_EQ(metrics.wait(kLimit_s), 0) << tools::read_text(lines + ".log");
  EXPECT_THAT(tools::read_text(file), HasSubstr("zenith_up{robot=\"r1\"} 1\n"));
  EXPECT_THAT(tools::read_text(file), HasSubstr("zenith_deadlines_met_total{robot=\"r1\"} "));
  r1.kill();
  Process none({ZENITH_TOOL, "telemetry", socket}, lines, lines + ".log");
  EXPECT_EQ(none.wait(kLimit_s), 1);
  EXPECT_THAT(tools::read_text(lines + ".log"), HasSubstr("is zenithd running?"));
}

}  // namespace
}  // namespace zenith
