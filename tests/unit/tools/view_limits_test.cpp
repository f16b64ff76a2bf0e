// However much is told or asked, what is kept of it is bounded, and what was left out is told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/hostile_files.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tests/unit/tools/told_line.h"
#include "tools/view/foxglove_session.h"
#include "tools/view/look_back.h"
#include "tools/view/metrics.h"
#include "tools/view/timeline.h"

namespace zenith::tools {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json landmarks(int owner, std::uint32_t first, std::uint32_t count, bool gone = false) {
  json line = {
      {"type", "landmarks"}, {"peer", owner}, {"rows", json::array()}, {"gone", json::array()}};
  for (std::uint32_t id = first; id < first + count; ++id) {
    if (gone) {
      line["gone"].push_back(id);
      continue;
    }
    for (const double n : {id * 1.0, 1.0, 2.0, 2.5, 1e-4, 0.0, 2e-4, 3e-4, 7.0}) {
      line["rows"].push_back(n);
    }
  }
  return line;
}

json alignment(const std::string& name) {
  return {{"type", "alignment"}, {"name", name},      {"peer", 0},
          {"state", "merged"},   {"confidence", 0.5}, {"pose", {0, 0, 0}}};
}

class ViewLimits : public testing::Test {
 protected:
  ViewLimits() { state_.add("anna"); }
  void say(const json& line) { state_.apply(0, told(line)); }
  std::size_t page_marks() {
    const json maps = state_.answer(json::object())["robots"][0]["maps"];
    std::size_t count = 0;
    for (const auto& [owner, map] : maps.items()) {
      if (map.contains("rows")) count += map["rows"].size();
    }
    return count;
  }
  RobotState::Limits limits() {
    RobotState::Limits found;
    state_.read([&](const auto& robots) { found = robots[0].limits(); });
    return found;
  }
  FleetState state_;
};

TEST_F(ViewLimits, LandmarksOfEndlessOwnersAndIdsHaveARoom) {
  constexpr std::uint32_t kLine = 1000;
  std::uint32_t told_of = 0;
  for (int owner = -1; owner < kMostSlots - 1; ++owner) {
    say(landmarks(owner, 1'000'000U * static_cast<std::uint32_t>(owner + 2), kLine));
    told_of += kLine;
  }
  EXPECT_EQ(page_marks(), RobotState::kMostMarks);
  EXPECT_EQ(limits().landmarks_refused, told_of - RobotState::kMostMarks);
  EXPECT_THAT(metrics_text(state_),
              HasSubstr("zenith_view_landmarks_refused_total{robot=\"anna\"} " +
                        std::to_string(limits().landmarks_refused)));
  const json shown = state_.answer(json::object())["robots"][0]["set"]["view"];
  EXPECT_EQ(shown["full"]["landmarks_refused"], limits().landmarks_refused);
}

// Ids that come and go do not fill it, and a page that saw the older ones is told.
TEST_F(ViewLimits, LandmarksThatAreGoneMakeRoom) {
  constexpr std::uint32_t kLine = 1000;
  say(landmarks(-1, 0, 10));
  json seen = state_.answer(json::object());
  for (std::uint32_t i = 1; i <= 2 * RobotState::kMostMarks / kLine; ++i) {
    say(landmarks(-1, i * kLine, kLine));
    say(landmarks(-1, i * kLine, kLine, true));
  }
  EXPECT_EQ(limits().landmarks_refused, 0u);
  EXPECT_EQ(page_marks(), 10u);
  const json later =
      state_.answer({{"epoch", seen["epoch"]}, {"seen", seen["seen"]}})["robots"][0]["maps"]["-1"];
  EXPECT_EQ(later["clear"], true);
  EXPECT_EQ(later["rows"].size(), 10u);
}

TEST_F(ViewLimits, OfEverNewNamesTheLongestSilentGo) {
  constexpr int kNames = 2000;
  say({{"type", "health"}, {"state", "mapping"}});
  say(alignment("old"));
  json seen = state_.answer(json::object());
  bool dropped = false;
  for (int i = 0; i < kNames; ++i) {
    say(alignment("robot " + std::to_string(i)));
    say({{"type", "peer"}, {"name", "robot " + std::to_string(i)}, {"peer", 1}});
    say(alignment("steady"));
    if (i % 50 != 0) continue;
    seen = state_.answer({{"epoch", seen["epoch"]}, {"seen", seen["seen"]}});
    dropped = dropped || seen["reset"] == true;
    for (const json& key : seen["robots"][0].value("drop", json::array())) {
      dropped = dropped || key == "confidence/old";
    }
  }
  EXPECT_TRUE(dropped) << "a page forgets it, too";
  EXPECT_EQ(limits().peers_evicted, kNames + 2 - RobotState::kMostPeers);
  const json all = state_.answer(json::object())["robots"][0];
  EXPECT_LE(all["set"].size(), 2 * RobotState::kMostPeers + 4);
  EXPECT_LE(all["confidence"].size(), RobotState::kMostPeers);
  EXPECT_TRUE(all["set"].contains("alignment/steady")) << "who speaks stays";
  EXPECT_LE(all.value("drop", json::array()).size(), RobotState::kMostDropped + 4);
  EXPECT_THAT(metrics_text(state_), HasSubstr("zenith_view_peers_evicted_total{robot=\"anna\"} " +
                                              std::to_string(limits().peers_evicted)));
}

TEST_F(ViewLimits, AViewersChannelHasOneSubscription) {
  say({{"type", "hello"}, {"robot", "anna"}, {"started_ns", 1}});
  say(landmarks(-1, 0, 100));
  FoxgloveSession session;
  const auto turn = [&](std::int64_t now_ns) {
    std::vector<FoxgloveMessage> messages;
    state_.read([&](const auto& robots) { messages = session.turn(now_ns, robots); });
    return messages;
  };
  (void)turn(1);
  json wishes = json::array();
  for (int id = 0; id < 256; ++id) wishes.push_back({{"id", id}, {"channelId", 10}});
  session.receive(json{{"op", "subscribe"}, {"subscriptions", wishes}}.dump());
  const auto messages = turn(2'000'000'000);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(static_cast<unsigned char>(messages[0].bytes[1]), 255) << "the latest";
  // And no more often for being subscribed again and again.
  std::size_t scenes = 0;
  for (int i = 1; i <= 20; ++i) {
    session.receive(json{{"op", "unsubscribe"}, {"subscriptionIds", {255}}}.dump());
    session.receive(R"({"op":"subscribe","subscriptions":[{"id":255,"channelId":10}]})");
    scenes += turn(2'000'000'000 + i * 100'000'000LL).size();
  }
  EXPECT_EQ(scenes, 2u);
}

TEST_F(ViewLimits, PicturesOfAllRobotsComeInTurns) {
  FleetState state;
  FoxgloveSession session;
  constexpr std::size_t kRobots = 20;
  std::string jpeg = "/9j" + std::string(700'001, 'A');
  for (std::size_t i = 0; i < kRobots; ++i) {
    state.apply(state.add("r"),
                told({{"type", "picture"}, {"width", 8}, {"height", 8}, {"jpeg", jpeg}}));
    const json wish = {{"id", i}, {"channelId", 10 * (i + 1) + 1}};
    session.receive(json{{"op", "subscribe"}, {"subscriptions", json::array({wish})}}.dump());
  }
  std::set<char> sent;
  for (int k = 1; k <= 4; ++k) {
    std::size_t bytes = 0;
    state.read([&](const auto& robots) {
      for (const FoxgloveMessage& message : session.turn(k * 100'000'000LL, robots)) {
        bytes += message.bytes.size();
        sent.insert(message.bytes[1]);
      }
    });
    EXPECT_LT(bytes, FoxgloveSession::kMostBytes + 1'000'000);
  }
  EXPECT_EQ(sent.size(), kRobots) << "each has had its turn";
}

TEST_F(ViewLimits, LookingBackAgainAtOnceReadsNoHistory) {
  History history;
  history.add("anna");
  LookBack look_back(state_, history);
  const auto tell = [&](double x, double at_s) {
    const json line = {{"type", "pose"}, {"pose", {x, 0, 0}}};
    say(line);
    state_.read([&](const auto& robots) {
      history.note(0, robots[0], told(line), line.dump(), Time{} + Duration::from_seconds(at_s));
    });
  };
  tell(1, 0);
  const json request = {{"past", true}, {"control", {{"look_back", 10}}}};
  const json first = look_back.answer(request);
  tell(2, 5);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(look_back.answer(request)["epoch"], first["epoch"]);
  look_back.turn(LookBack::kAnewAfter);
  const json anew = look_back.answer(request);
  EXPECT_NE(anew["epoch"], first["epoch"]);
  EXPECT_EQ(anew["robots"][0]["set"]["pose"]["pose"][0], 2);
}

TEST_F(ViewLimits, RequestsOfAnyShapeGetAnAnswer) {
  History history;
  history.add("anna");
  LookBack look_back(state_, history);
  for (const char* text :
       {R"({"epoch":"x"})", R"({"epoch":-1,"seen":1e300})", R"({"picture":{}})",
        R"({"picture":18446744073709551615,"picture_seen":[]})", R"({"past":7,"control":[]})",
        R"({"control":{"look_back":"x","seek":{},"play":1,"speed":null}})",
        R"({"past":true,"control":{"look_back":1e300}})", R"({"control":{"look_back":-5}})"}) {
    EXPECT_EQ(look_back.answer(json::parse(text))["robots"].size(), 1u) << text;
  }
}

TEST_F(ViewLimits, AStoredTimelineIsReadWithinBounds) {
  TemporaryFolder folder;
  const auto file = folder.path() / kTimelineFile;
  const std::string head = "{\"timeline\":1,\"robots\":[\"a\"]}\n";
  write_text(file, head + "{\"t_s\":0,\"robot\":0,\"line\":{\"type\":5}}\n" +
                       "{\"t_s\":1,\"robot\":0,\"line\":{\"type\":\"pose\",\"pose\":[1,2,3]}}\n");
  const auto timeline = read_timeline(file);
  ASSERT_TRUE(timeline.ok()) << timeline.error().message;
  EXPECT_EQ(timeline->refused, 1u);
  EXPECT_EQ(timeline->entries.size(), 1u);
  const auto said = [&](const std::string& text) {
    write_text(file, text);
    const auto read = read_timeline(file);
    return read.ok() ? std::string("nothing") : read.error().message;
  };
  EXPECT_THAT(said(head + std::string(3'000'000, '[') + "\n"), HasSubstr(":2: expected a JSON"));
  EXPECT_THAT(said(head + "{\"t_s\":\"x\",\"robot\":0,\"line\":{}}\n"), HasSubstr("keys t_s"));
  EXPECT_THAT(said(head + "{\"t_s\":0,\"robot\":1e300,\"line\":{}}\n"), HasSubstr("keys t_s"));
  EXPECT_THAT(said("{\"timeline\":\"1\",\"robots\":[]}\n"), HasSubstr("version 1"));
  EXPECT_THAT(said("{\"timeline\":1,\"robots\":[\"\\u001b\"]}\n"), HasSubstr("names of 1 to 64"));
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_THAT(read_timeline(file).error().message, HasSubstr("missing"));
}

// Decoded, all its lines would take ten times the memory of the file.
TEST(Timelines, TakeLittleMoreMemoryThanTheirFile) {
  TemporaryFolder folder;
  const auto file = folder.path() / kTimelineFile;
  std::string text = "{\"timeline\":1,\"robots\":[\"a\"]}\n";
  for (int i = 0; i < 60'000; ++i) {
    text += "{\"t_s\":" + std::to_string(i) +
            ",\"robot\":0,\"line\":{\"type\":\"pose\",\"stamp_ns\":" + std::to_string(i) +
            ",\"pose\":[1.25,2.5,0.125],\"covariance\":[1,0,0,1,0,1]}}\n";
  }
  write_text(file, text);
  const std::size_t size = text.size();
  text = {};
  std::size_t entries = 0;
  const auto growth = peak_growth_bytes([&] {
    const auto timeline = read_timeline(file);
    if (timeline.ok()) entries = timeline->entries.size();
  });
  EXPECT_EQ(entries, 60'000u);
  if (!growth) GTEST_SKIP() << "SKIPPED: this kernel does not say how much memory was taken";
  print_figure("a timeline of %.1f MB takes %.1f MB", static_cast<double>(size) * 1e-6,
               static_cast<double>(*growth) * 1e-6);
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(*growth, 3 * size);
#endif
}

}  // namespace
}  // namespace zenith::tools
