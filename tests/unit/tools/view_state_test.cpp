// Telemetry's lines become the state of robots, and that becomes what a page is told.

#include "tools/view/fleet_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/base/base64.h"
#include "tests/unit/tools/told_line.h"
#include "tools/view/jpeg.h"
#include "tools/view/placement.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

json hello(const char* robot, int started) {
  return {{"type", "hello"}, {"robot", robot}, {"version", "1"}, {"started_ns", started}};
}
json pose(double x, double y, double theta, double t_s = 1.0) {
  return {{"type", "pose"},
          {"stamp_ns", t_s * 1e9},
          {"pose", {x, y, theta}},
          {"step_ms", 4.5},
          {"period_ms", 100}};
}
json health() {
  return {{"type", "health"}, {"state", "mapping"}, {"reason", ""}};
}
json alignment(const char* name, const char* state, double confidence) {
  return {{"type", "alignment"},
          {"stamp_ns", 2e9},
          {"peer", 0},
          {"name", name},
          {"state", state},
          {"pose", {1.0, 2.0, 0.5}},
          {"confidence", confidence}};
}
json landmarks(int owner, std::vector<int> ids, std::vector<int> gone = {}) {
  json line = {{"type", "landmarks"},
               {"peer", owner},
               {"name", ""},
               {"rows", json::array()},
               {"gone", gone}};
  for (const int id : ids) {
    for (const double n : {id * 1.0, 1.0, 2.0, 2.5, 1e-4, 0.0, 2e-4, 3e-4, 7.0}) {
      line["rows"].push_back(n);
    }
  }
  return line;
}

class ViewState : public testing::Test {
 protected:
  ViewState() { state_.add("/tmp/a.sock"); }
  void apply(const json& line) { state_.apply(0, told(line)); }
  // What is new since the last call.
  json news() {
    json answer = state_.answer(request_);
    request_["epoch"] = answer["epoch"];
    request_["seen"] = answer["seen"];
    reset_ = answer["reset"];
    return answer["robots"][0];
  }
  FleetState state_{1, write_jpeg};
  json request_ = json::object();
  bool reset_ = false;
};

TEST_F(ViewState, TellsAllAtFirstThenWhatIsNew) {
  EXPECT_EQ(news()["name"], "/tmp/a.sock");
  EXPECT_TRUE(reset_);
  apply(hello("anna", 1));
  apply(pose(1, 0, 0));
  apply(landmarks(-1, {3, 4}));
  json told = news();
  EXPECT_FALSE(reset_);
  EXPECT_EQ(told["name"], "anna");
  EXPECT_EQ(told["set"]["pose"]["pose"], json({1, 0, 0}));
  EXPECT_EQ(told["maps"]["-1"]["rows"].size(), 2u);
  EXPECT_EQ(told["path"], json({{"from", 0}, {"points", {{1.0, 0.0, 0.0}}}}));
  EXPECT_EQ(told["steps"]["points"], json({{1.0, 4.5}}));
  told = news();
  EXPECT_EQ(told, json({{"name", "anna"}})) << "nothing is new";
  apply(landmarks(-1, {5}, {3}));
  apply(pose(2, 0, 0));
  told = news();
  EXPECT_EQ(told["maps"]["-1"]["rows"][0][0], 5);
  EXPECT_EQ(told["maps"]["-1"]["gone"], json({3}));
  EXPECT_EQ(told["path"]["from"], 1);
  // Another page sees the whole.
  const json all = state_.answer(json::object())["robots"][0];
  EXPECT_EQ(all["path"]["points"].size(), 2u);
  EXPECT_EQ(all["maps"]["-1"]["rows"].size(), 2u);
}

TEST_F(ViewState, TakesOneOfManyPosesIntoThePath) {
  for (int i = 0; i < 100; ++i) apply(pose(0.001 * i, 0, 0));
  EXPECT_LT(news()["path"]["points"].size(), 5u);
}

TEST_F(ViewState, BoundsThePathAndTellsItAnew) {
  apply(pose(0, 0, 0));
  news();
  const int many = static_cast<int>(RobotState::kPathPoints) + 10;
  for (int i = 1; i <= many; ++i) apply(pose(i, 0, 0));
  const json path = news()["path"];
  EXPECT_EQ(path["from"], 0) << "thinned: what was told is no more";
  EXPECT_LT(path["points"].size(), RobotState::kPathPoints);
  EXPECT_EQ(path["points"].back()[0], many);
}

TEST_F(ViewState, ForgetsAlignmentsThatAreNoLongerTold) {
  apply(health());
  apply(alignment("bert", "candidate", 0.4));
  apply(health());
  apply(alignment("bert", "merged", 0.9));
  json told = news();
  EXPECT_EQ(told["set"]["alignment/bert"]["state"], "merged");
  EXPECT_EQ(told["confidence"]["bert"]["points"].size(), 2u);
  apply(health());
  EXPECT_FALSE(news().contains("drop")) << "its line of this second may still come";
  apply(health());
  EXPECT_EQ(news()["drop"], json({"alignment/bert"}));
}

TEST_F(ViewState, BeginsAnewWithTheDaemonAndOnlyThen) {
  apply(hello("anna", 1));
  apply(pose(1, 0, 0));
  apply(landmarks(-1, {3}));
  apply(landmarks(2, {3}));
  news();
  apply(hello("anna", 1));  // the same one: the line was lost
  json told = news();
  EXPECT_FALSE(told.contains("path"));
  EXPECT_EQ(told["maps"]["2"], json({{"clear", true}}));
  apply(hello("anna", 2));
  told = news();
  EXPECT_EQ(told["path"], json({{"from", 0}, {"points", json::array()}}));
  EXPECT_THAT(told["drop"].get<std::vector<std::string>>(), testing::Contains("pose"));
}

TEST_F(ViewState, ForgetsAPeersMap) {
  apply(landmarks(2, {3}));
  news();
  apply({{"type", "forgotten"}, {"peer", 2}});
  EXPECT_EQ(news()["maps"]["2"], json({{"clear", true}}));
}

TEST_F(ViewState, WaitsForAPeersName) {
  apply(hello("anna", 1));
  apply({{"type", "peer"}, {"name", ""}, {"peer", -1}});
  EXPECT_FALSE(news()["robots"][0]["set"].contains("peer/"));
}

TEST_F(ViewState, PassesOverWhatItDoesNotKnow) {
  apply(hello("anna", 1));
  news();
  for (const char* text :
       {R"({"type":"new"})", R"({"type":7})", R"([1])", R"({"type":"pose"})",
        R"({"type":"pose","pose":[1,"x",3]})", R"({"type":"landmarks","peer":"a"})",
        R"({"type":"picture","width":1000000000,"height":1000000000,"stamp_ns":1})",
        R"({"type":"strip","stamp_ns":1,"first_row":0,"grey":"AAAA"})"}) {
    hear(state_, 0, text);
  }
  json after = news();
  EXPECT_EQ(after["set"]["view"]["refused_lines"],
            json({{"no_type", 1}, {"not_json", 1}, {"wrong_field", 4}}));
  after.erase("set");
  EXPECT_EQ(after, json({{"name", "anna"}}));
}

TEST_F(ViewState, PutsPicturesTogetherForWhoAsks) {
  EXPECT_FALSE(state_.take_wish(0));
  request_["picture"] = 0;
  EXPECT_FALSE(news().contains("picture"));
  EXPECT_TRUE(state_.take_wish(0));
  EXPECT_FALSE(state_.take_wish(0));
  apply({{"type", "picture"},
         {"stamp_ns", 5},
         {"width", 16},
         {"height", 4},
         {"used", true},
         {"corners", {1, 2, 2, 1, 2}}});
  std::string half(base64_size(32), ' ');
  write_base64(std::vector<std::uint8_t>(32, 200), half.data());
  const json strip = {{"type", "strip"}, {"stamp_ns", 5}, {"first_row", 0}, {"grey", half}};
  apply(strip);
  apply(strip);  // once more the same: not the rest
  EXPECT_FALSE(news().contains("picture"));
  apply({{"type", "strip"}, {"stamp_ns", 5}, {"first_row", 2}, {"grey", half}});
  const json picture = news()["picture"];
  EXPECT_THAT(picture["image"].get<std::string>(),
              testing::StartsWith("data:image/jpeg;base64,/9j"));
  EXPECT_EQ(picture["corners"].size(), 5u);
  request_["picture_seen"] = picture["serial"];
  EXPECT_FALSE(news().contains("picture"));
}

TEST_F(ViewState, SaysWhoIsSilent) {
  state_.set_link(0, true, "");
  EXPECT_EQ(news()["set"]["link"]["up"], true);
  state_.set_link(0, false, "the daemon has left");
  EXPECT_EQ(news()["set"]["link"]["why"], "the daemon has left");
}

TEST(PlaceStarts, FollowsMergesFromTheFirstRobot) {
  std::vector<RobotState> robots;
  std::uint64_t version = 0;
  for (const char* name : {"anna", "bert", "carl"}) {
    robots.emplace_back(name);
    robots.back().apply(told(hello(name, 1)), ++version);
  }
  robots[0].apply(told(alignment("bert", "candidate", 0.4)), ++version);
  EXPECT_EQ(place_starts(robots).size(), 1u);
  robots[1].apply(told(alignment("anna", "merged", 0.9)), ++version);
  robots[1].apply(told(alignment("dora", "merged", 0.9)), ++version);  // tells nothing herself
  const auto placed = place_starts(robots);
  ASSERT_EQ(placed.size(), 3u);
  const Pose2 T_bert_anna = {1.0, 2.0, 0.5};
  const Pose2 expected = T_bert_anna.inverse();
  EXPECT_NEAR(placed.at("bert").x_m, expected.x_m, 1e-12);
  EXPECT_NEAR((placed.at("bert").inverse() * placed.at("dora")).theta_rad, 0.5, 1e-12);
  const auto from_bert = place_starts(robots, 1);
  EXPECT_EQ(from_bert.at("bert").x_m, 0.0);
  EXPECT_NEAR(from_bert.at("anna").x_m, 1.0, 1e-12);
}

// Two robots that have found themselves in their stored maps have not found each other.
TEST(PlaceStarts, StoredMapsJoinNoRobots) {
  std::vector<RobotState> robots = {RobotState("anna"), RobotState("bert")};
  for (RobotState& robot : robots) {
    robot.apply(told(alignment("past self", "merged", 0.9)), 1);
    robot.apply(told(alignment("earlier session", "merged", 0.9)), 2);
  }
  const auto placed = place_starts(robots);
  EXPECT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed.count("bert"), 0u);
  EXPECT_EQ(placed.count("anna past self"), 1u);
}

TEST(RobotStateMaps, EachOwnersVersionRisesWithItsOwnChanges) {
  RobotState robot("anna");
  EXPECT_EQ(robot.landmarks_version(RobotState::kOwn), 0u);
  robot.apply(told(landmarks(RobotState::kOwn, {1, 2})), 1);
  robot.apply(told(landmarks(0, {1})), 2);
  EXPECT_EQ(robot.landmarks_version(RobotState::kOwn), 1u);
  EXPECT_EQ(robot.landmarks_version(0), 2u);
  robot.apply(told({{"type", "forgotten"}, {"peer", 0}}), 3);
  EXPECT_EQ(robot.landmarks_version(0), 3u);
  EXPECT_TRUE(robot.landmarks(0).empty());
  robot.apply(told(hello("anna", 2)), 4);
  EXPECT_EQ(robot.landmarks_version(RobotState::kOwn), 4u);
}

}  // namespace
}  // namespace zenith::tools
