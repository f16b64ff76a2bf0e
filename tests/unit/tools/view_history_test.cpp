// Live robots can be looked at as they were.

#include "tools/view/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/told_line.h"
#include "tools/view/live.h"
#include "tools/view/look_back.h"

namespace zenith::tools {
namespace {

using nlohmann::json;
using testing::SizeIs;

class HistoryTest : public testing::Test {
 protected:
  explicit HistoryTest(std::size_t bytes = History::kMostBytes) : history_(bytes) {
    live_.add("anna");
    history_.add("anna");
  }
  void tell(const json& line, double at_s) {
    live_.apply(0, told(line));
    live_.read([&](const auto& robots) {
      history_.note(0, robots[0], told(line), line.dump(), Time{} + Duration::from_seconds(at_s));
    });
  }
  void tell_pose(double x, double at_s) {
    tell({{"type", "pose"}, {"stamp_ns", at_s * 1e9}, {"pose", {x, 0.0, 0.0}}}, at_s);
  }
  static json landmarks(int id, double x) {
    return {{"type", "landmarks"},
            {"peer", -1},
            {"rows", {id, x, 1.0, 2.5, 1e-4, 0.0, 1e-4, 1e-4, 7}},
            {"gone", json::array()}};
  }
  // What a page sees that has seen nothing.
  static double x_of(const json& answer) { return answer["robots"][0]["set"]["pose"]["pose"][0]; }

  FleetState live_;
  History history_;
  LookBack look_back_{live_, history_};
};

TEST_F(HistoryTest, APageLooksBackAndOthersStayLive) {
  for (int i = 0; i <= 10; ++i) tell_pose(i, 100.0 + i);
  EXPECT_EQ(history_.duration_s(), 10.0);
  const json then = look_back_.answer({{"past", true}, {"control", {{"look_back", 3.5}}}});
  EXPECT_EQ(x_of(then), 3.0);
  EXPECT_EQ(then["clock"]["position_s"], 3.5);
  EXPECT_EQ(then["clock"]["duration_s"], 10.0);
  EXPECT_EQ(then["robots"][0]["path"]["points"].size(), 4u);
  EXPECT_FALSE(then["clock"].contains("live"));

  tell_pose(11, 111.0);
  look_back_.turn({});
  const json now = look_back_.answer(json::object());
  EXPECT_EQ(x_of(now), 11.0);
  EXPECT_EQ(now["clock"]["live"], true);
  EXPECT_EQ(now["clock"]["duration_s"], 11.0);
  EXPECT_NE(now["epoch"], then["epoch"]) << "a page that changes gets all anew";

  // It moves on in the past, by hand and by itself.
  EXPECT_EQ(x_of(look_back_.answer({{"past", true}, {"control", {{"seek", 7}}}})), 7.0);
  (void)look_back_.answer({{"past", true}, {"control", {{"play", true}}}});
  look_back_.turn(Duration::from_seconds(2.2));
  EXPECT_EQ(x_of(look_back_.answer({{"past", true}})), 9.0);
  // A second look begins with what was told meanwhile.
  EXPECT_EQ(x_of(look_back_.answer({{"past", true}, {"control", {{"look_back", 11}}}})), 11.0);
}

TEST_F(HistoryTest, WhoLooksBackBeforeAnythingWasToldSeesWhatIsNow) {
  look_back_.turn({});
  EXPECT_EQ(look_back_.answer({{"past", true}})["clock"]["live"], true);
  EXPECT_EQ(look_back_.answer({{"past", true}, {"control", {{"look_back", "x"}}}})["clock"]["live"],
            true);
}

TEST_F(HistoryTest, MarksMerges) {
  for (const char* state : {"candidate", "merged"}) {
    tell({{"type", "alignment"}, {"name", "bert"}, {"state", state}, {"pose", {0, 0, 0}}},
         state[0] == 'm' ? 4.0 : 1.0);
  }
  const Timeline timeline = history_.timeline();
  ASSERT_THAT(timeline.marks, SizeIs(1));
  EXPECT_EQ(timeline.marks[0].t_s, 3.0);
}

class ShortHistoryTest : public HistoryTest {
 protected:
  static constexpr std::size_t kBytes = 20'000;
  ShortHistoryTest() : HistoryTest(kBytes) {}
};

TEST_F(ShortHistoryTest, ForgetsTheOldestAndKeepsWholeMaps) {
  tell({{"type", "hello"}, {"robot", "anna"}, {"started_ns", 5}}, 0.0);
  tell(landmarks(7, 1.0), 0.1);
  tell(landmarks(8, 2.0), 0.2);
  tell({{"type", "landmarks"}, {"peer", -1}, {"rows", json::array()}, {"gone", {8}}}, 0.3);
  for (int i = 1; i <= 1000; ++i) {
    tell_pose(i, i);
    ASSERT_LE(history_.bytes(), kBytes);
  }
  EXPECT_LT(history_.duration_s(), 500.0);
  EXPECT_GT(history_.duration_s(), 50.0);
  const json oldest = look_back_.answer({{"past", true}, {"control", {{"look_back", 0}}}});
  EXPECT_EQ(oldest["robots"][0]["name"], "anna");
  EXPECT_THAT(oldest["robots"][0]["maps"]["-1"]["rows"], SizeIs(1)) << "and not the removed one";
  const auto& path = oldest["robots"][0]["path"]["points"];
  EXPECT_EQ(path[0][0], 1.0) << "the path begins where the robot did";
  EXPECT_EQ(path.back()[0], 1000.0 - history_.duration_s());
}

}  // namespace
}  // namespace zenith::tools
