// What others read of the state: Prometheus, Foxglove. And replays, and addresses of robots.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/unit/tools/temporary_folder.h"
#include "tests/unit/tools/told_line.h"
#include "tools/view/foxglove_session.h"
#include "tools/view/metrics.h"
#include "tools/view/player.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TelemetryLine line(const char* text) {
  return told(json::parse(text));
}

void fill(FleetState& state, std::size_t robot, const std::string& name) {
  state.apply(robot, told({{"type", "hello"}, {"robot", name}, {"started_ns", 1}}));
  state.apply(robot, line(R"({"type":"pose","stamp_ns":1,"pose":[1.5,-2,0.25],"step_ms":4.5,
                              "period_ms":100,"corners":90,"effective_sample_size":null})"));
  state.apply(robot, line(R"({"type":"health","state":"mapping","camera":{"up":true,"frames":7},
                              "page_faults":{"minor":3,"major":0}})"));
  state.apply(robot, line(R"({"type":"deadlines","met":10,"missed":1,"explained":1,
                              "step":{"count":11,"p50_ms":2,"p95_ms":3,"p999_ms":4,"max_ms":5}})"));
  state.apply(robot, line(R"({"type":"alignment","stamp_ns":1,"peer":0,"name":"be\"rt","state":
                              "merged","pose":[0,0,0],"confidence":0.75})"));
  state.apply(robot, line(R"({"type":"landmarks","peer":-1,"name":"",
                              "rows":[4,1,2,2.5,0.0004,0,0.0001,0.01,9],"gone":[]})"));
}

TEST(Metrics, AreTheValuesInBaseUnits) {
  FleetState state;
  state.add("a");
  fill(state, 0, "anna");
  const std::string text = metrics_text(state);
  for (const char* sample :
       {"zenith_pose_x_metres{robot=\"anna\"} 1.5\n",
        "zenith_step_seconds{robot=\"anna\"} 0.0045\n", "zenith_camera_up{robot=\"anna\"} 1\n",
        "zenith_camera_frames_total{robot=\"anna\"} 7\n",
        "zenith_state{robot=\"anna\",state=\"mapping\"} 1\n",
        "zenith_state{robot=\"anna\",state=\"fault\"} 0\n",
        "zenith_frame_duration_seconds{robot=\"anna\",what=\"step\",quantile=\"0.95\"} 0.003\n",
        "zenith_page_faults_total{robot=\"anna\",kind=\"minor\"} 3\n",
        "zenith_merged{robot=\"anna\",peer=\"be\\\"rt\"} 1\n", "zenith_up{robot=\"anna\"} 0\n"}) {
    EXPECT_THAT(text, HasSubstr(sample));
  }
  EXPECT_THAT(text, testing::Not(HasSubstr("zenith_effective_particles"))) << "null is no number";
}

// What a parser of the format wants: HELP and TYPE once, before the samples; names that say the
// unit; counters that end in _total.
TEST(Metrics, KeepTheFormat) {
  FleetState state;
  for (const char* name : {"anna", "bert"}) {
    const std::size_t robot = state.add(name);
    fill(state, robot, name);
  }
  std::istringstream lines(metrics_text(state));
  std::string text;
  std::string current;
  std::set<std::string> seen;
  const std::regex sample(R"re(([a-z0-9_]+)\{([a-z]+="([^"\\]|\\.)*",?)+\} -?[0-9.e+-]+)re");
  while (std::getline(lines, text)) {
    std::istringstream words(text);
    std::string hash, what, name, kind;
    words >> hash >> what >> name >> kind;
    if (what == "HELP") {
      EXPECT_TRUE(seen.insert(name).second) << name << " twice";
      current = name;
    } else if (what == "TYPE") {
      EXPECT_EQ(name, current);
      EXPECT_EQ(kind == "counter", name.size() > 6 && name.substr(name.size() - 6) == "_total");
    } else {
      std::smatch match;
      ASSERT_TRUE(std::regex_match(text, match, sample)) << text;
      EXPECT_EQ(match[1], current);
    }
  }
  EXPECT_GT(seen.size(), 10u);
}

TEST(Metrics, AreAllInTheReference) {
  const std::string page = read_text(ZENITH_SOURCE_DIR "/docs/metrics.md");
  for (const MetricText& metric : metric_texts()) {
    const std::string row = "| `" + metric.name + "` | " + metric.kind + " | " + metric.labels +
                            " | " + metric.help + " |\n";
    EXPECT_THAT(page, HasSubstr(row));
  }
}

class FoxgloveTest : public testing::Test {
 protected:
  FoxgloveTest() {
    for (const char* name : {"anna", "bert"}) fill(state_, state_.add(name), name);
  }
  std::vector<FoxgloveMessage> turn(std::int64_t now_ns) {
    std::vector<FoxgloveMessage> messages;
    state_.read([&](const auto& robots) { messages = session_.turn(now_ns, robots); });
    return messages;
  }
  static std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    }
    return value;
  }
  FleetState state_;
  FoxgloveSession session_;
};

TEST_F(FoxgloveTest, AdvertisesChannelsWithSchemas) {
  const json info = json::parse(FoxgloveSession::server_info().bytes);
  EXPECT_EQ(info["op"], "serverInfo");
  const auto messages = turn(1'000'000'000);
  ASSERT_EQ(messages.size(), 1u);
  const json advertise = json::parse(messages[0].bytes);
  EXPECT_EQ(advertise["op"], "advertise");
  std::set<std::string> topics;
  std::set<int> ids;
  for (const json& channel : advertise["channels"]) {
    topics.insert(channel["topic"]);
    ids.insert(channel["id"].get<int>());
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(json::parse(channel["schema"].get<std::string>())["title"], channel["schemaName"]);
  }
  EXPECT_THAT(topics, testing::ElementsAre("/anna/image", "/anna/scene", "/bert/image",
                                           "/bert/scene", "/tf"));
  EXPECT_EQ(ids.size(), 5u);
  EXPECT_TRUE(turn(1'100'000'000).empty()) << "nobody subscribes";
}

TEST_F(FoxgloveTest, SendsWhatIsSubscribedAsBinaryMessages) {
  turn(1);
  session_.receive(R"({"op":"subscribe","subscriptions":[{"id":77,"channelId":10}]})");
  auto messages = turn(5'000'000'123);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(messages[0].binary);
  const std::string& bytes = messages[0].bytes;
  EXPECT_EQ(bytes[0], 1);
  EXPECT_EQ(number(bytes, 1, 4), 77u);
  EXPECT_EQ(number(bytes, 5, 8), 5'000'000'123u);
  const json scene = json::parse(bytes.substr(13));
  const json& marks = scene["entities"][0];
  EXPECT_EQ(marks["frame_id"], "anna/start");
  EXPECT_EQ(marks["timestamp"], json({{"sec", 5}, {"nsec", 123}}));
  ASSERT_EQ(marks["spheres"].size(), 1u);
  EXPECT_EQ(marks["spheres"][0]["pose"]["position"], json({{"x", 1}, {"y", 2}, {"z", 2.5}}));
  EXPECT_NEAR(marks["spheres"][0]["size"]["x"].get<double>(), 0.08, 1e-9) << "two sigma each way";
  EXPECT_TRUE(turn(5'100'000'000).empty()) << "a scene a second";
  EXPECT_EQ(turn(6'100'000'000).size(), 1u);
  session_.receive(R"({"op":"unsubscribe","subscriptionIds":[77]})");
  EXPECT_TRUE(turn(9'000'000'000).empty());
}

TEST_F(FoxgloveTest, SendsFramesOfThoseThatArePlaced) {
  turn(1);
  session_.receive(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})");
  std::set<std::string> children;
  for (const auto& message : turn(2)) {
    children.insert(json::parse(message.bytes.substr(13))["child_frame_id"].get<std::string>());
  }
  // Both say that they are joined with a third one.
  EXPECT_THAT(children, testing::ElementsAre("anna/base_link", "anna/start", "be\"rt/start",
                                             "bert/base_link", "bert/start"));
}

TEST_F(FoxgloveTest, PassesOverNonsense) {
  for (const char* text : {"", "{", "[]", "{\"op\":7}", R"({"op":"subscribe"})",
                           R"({"op":"subscribe","subscriptions":[{"id":"x"}]})"}) {
    session_.receive(text);
  }
  EXPECT_EQ(turn(1).size(), 1u);
}

class PlayerTest : public testing::Test {
 protected:
  PlayerTest() {
    write_text(folder_.path() / kTimelineFile,
               "{\"timeline\":1,\"robots\":[\"r1\",\"r2\"]}\n"
               "{\"t_s\":0,\"robot\":0,\"line\":{\"type\":\"pose\",\"pose\":[0,0,0]}}\n"
               "{\"t_s\":2,\"robot\":0,\"line\":{\"type\":\"pose\",\"pose\":[2,0,0]}}\n"
               "{\"t_s\":3,\"robot\":1,\"line\":{\"type\":\"alignment\",\"name\":\"r1\","
               "\"state\":\"merged\",\"pose\":[1,2,3],\"confidence\":0.9}}\n"
               "{\"t_s\":4,\"robot\":0,\"line\":{\"type\":\"pose\",\"pose\":[4,0,0]}}\n");
  }
  double x() {
    double value = -1.0;
    state_.read([&](const auto& robots) {
      value = robots[0].line("pose").number("/pose/0").value_or(-1.0);
    });
    return value;
  }
  TemporaryFolder folder_;
  FleetState state_;
};

TEST_F(PlayerTest, PlaysSeeksBothWaysAndPauses) {
  auto timeline = read_timeline(folder_.path() / kTimelineFile);
  ASSERT_TRUE(timeline.ok()) << timeline.error().message;
  EXPECT_EQ(timeline->duration_s, 4.0);
  ASSERT_EQ(timeline->marks.size(), 1u);
  EXPECT_EQ(timeline->marks[0].text, "r2 joins r1's map");
  Player player(state_, std::move(*timeline));
  player.control({{"speed", 2}});
  player.play(Duration::from_seconds(1.1));
  EXPECT_EQ(x(), 2.0);
  player.control({{"seek", 4.0}, {"play", false}});
  EXPECT_EQ(x(), 4.0);
  player.control({{"seek", 1.0}});
  EXPECT_EQ(x(), 0.0);
  state_.read([](const auto& robots) {
    EXPECT_TRUE(robots[1].lines().count("alignment/r1") == 0) << "not yet";
    EXPECT_EQ(robots[0].path().size(), 1u);
  });
  player.play(Duration::from_seconds(2));
  EXPECT_EQ(player.position_s(), 1.0) << "it pauses";
  player.control({{"play", true}});
  player.play(Duration::from_seconds(100));
  EXPECT_EQ(player.position_s(), 4.0);
  player.control({{"play", true}});
  EXPECT_EQ(player.position_s(), 0.0) << "from the start again";
  player.control({{"seek", "x"}, {"speed", -3}, {"play", 7}});
  player.control(json::array());
  EXPECT_EQ(player.position_s(), 0.0);
}

TEST_F(PlayerTest, OfManyPicturesTheLastOneIsShown) {
  std::string text = "{\"timeline\":1,\"robots\":[\"r1\",\"r2\"]}\n";
  for (int i = 0; i < 6; ++i) {
    text += "{\"t_s\":" + std::to_string(i) + ",\"robot\":" + std::to_string(i % 2) +
            ",\"line\":{\"type\":\"picture\",\"width\":8,\"height\":" + std::to_string(8 + i) +
            ",\"jpeg\":\"/9j/\"}}\n";
  }
  write_text(folder_.path() / kTimelineFile, text);
  auto timeline = read_timeline(folder_.path() / kTimelineFile);
  ASSERT_TRUE(timeline.ok()) << timeline.error().message;
  Player player(state_, std::move(*timeline));
  const auto heights = [&] {
    std::vector<int> all;
    state_.read([&](const auto& robots) {
      for (const RobotState& robot : robots) {
        all.push_back(robot.picture() ? robot.picture()->told["height"].template get<int>() : 0);
      }
    });
    return all;
  };
  for (const auto& [moment, expected] : std::vector<std::pair<double, std::vector<int>>>{
           {5.0, {12, 13}}, {0.0, {8, 0}}, {3.5, {10, 11}}, {4.0, {12, 11}}}) {
    player.control({{"seek", moment}, {"play", false}});
    EXPECT_EQ(heights(), expected) << moment;
  }
}

TEST_F(PlayerTest, SaysWhatIsWrongWithATimeline) {
  const auto said = [&](const char* text) {
    write_text(folder_.path() / "x", text);
    return read_timeline(folder_.path() / "x").error().message;
  };
  EXPECT_THAT(read_timeline(folder_.path() / "none").error().message, HasSubstr("zenith replay"));
  EXPECT_THAT(said(""), HasSubstr("names the robots"));
  EXPECT_THAT(said("{\"timeline\":2}\n"), HasSubstr("version 1"));
  EXPECT_THAT(said("{\"timeline\":1,\"robots\":[\"a\"]}\nx\n"), HasSubstr("x:2: expected a JSON"));
  EXPECT_THAT(said("{\"timeline\":1,\"robots\":[\"a\"]}\n{\"t_s\":1,\"robot\":1,\"line\":{}}\n"),
              HasSubstr("a robot of line 1"));
}

TEST(RobotAddress, IsASocketOrAnotherComputer) {
  EXPECT_EQ(parse_robot_address("/run/zenith/telemetry.sock")->paths.size(), 1u);
  EXPECT_GE(parse_robot_address("")->paths.size(), 1u) << "the usual places";
  const auto anna = parse_robot_address("ssh:me@anna");
  ASSERT_TRUE(anna.ok());
  EXPECT_EQ(anna->host, "me@anna");
  EXPECT_TRUE(anna->paths.empty());
  EXPECT_EQ(parse_robot_address("ssh:anna:/tmp/t.sock")->paths.at(0), "/tmp/t.sock");
  for (const char* wrong : {"ssh:", "ssh:-oProxyCommand=x", "ssh:anna:/tmp/a;reboot", "ssh::x"}) {
    EXPECT_FALSE(parse_robot_address(wrong).ok()) << wrong;
  }
}

}  // namespace
}  // namespace zenith::tools
