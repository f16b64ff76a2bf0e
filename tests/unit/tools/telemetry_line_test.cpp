// Whatever comes as telemetry is a line with the right types and sizes, or it is counted.

#include "tools/view/telemetry_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/told_line.h"
#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

struct Hostile {
  std::string text;
  LineFault fault;
};

std::string repeated(const std::string& piece, std::size_t times) {
  std::string text;
  for (std::size_t i = 0; i < times; ++i) text += piece;
  return text;
}

std::vector<Hostile> hostile_lines() {
  using enum LineFault;
  std::string numbers = "1";
  for (int i = 0; i < 70'000; ++i) numbers += ",1";
  return {
      {"", kNotJson},
      {"null", kNotJson},
      {"[1]", kNotJson},
      {"{\"type\":\"pose\"", kNotJson},
      {"{\"type\":\"hello\",\"robot\":\"\xff\xfe\"}", kNotJson},
      {R"({"type":"pose","pose":[NaN,0,0]})", kNotJson},
      {R"({"type":"pose","pose":[1e999,0,0]})", kNotJson},
      {R"({})", kNoType},
      {R"({"type":5})", kNoType},
      {R"({"type":null})", kNoType},
      {R"({"type":""})", kNoType},
      {R"({"type":["pose"]})", kNoType},
      {repeated("[", 100'000), kTooDeep},
      {R"({"type":"radio","a":)" + repeated("[", 1000) + repeated("]", 1000) + "}", kTooDeep},
      {R"({"type":"radio","a":[)" + numbers + "]}", kTooMany},
      {std::string(kLongestLine + 1, ' '), kTooLong},
      {R"({"type":"pose"})", kWrongField},
      {R"({"type":"pose","pose":"here"})", kWrongField},
      {R"({"type":"pose","pose":[1,2]})", kWrongField},
      {R"({"type":"pose","pose":[1,2,3,4]})", kWrongField},
      {R"({"type":"pose","pose":[1,2,"3"]})", kWrongField},
      {R"({"type":"pose","pose":[1,2,null]})", kWrongField},
      {R"({"type":"pose","pose":[1e300,0,0]})", kWrongField},
      {R"({"type":"pose","pose":[0,0,0],"covariance":[1]})", kWrongField},
      {R"({"type":"pose","pose":[0,0,0],"stamp_ns":"now"})", kWrongField},
      {R"({"type":"pose","pose":[0,0,0],"stamp_ns":-1})", kWrongField},
      {R"({"type":"pose","pose":[0,0,0],"stamp_ns":18446744073709551615})", kWrongField},
      {R"({"type":"pose","pose":[0,0,0],"odometry":[]})", kWrongField},
      {R"({"type":"hello"})", kWrongField},
      {R"({"type":"hello","robot":7})", kWrongField},
      {R"({"type":"hello","robot":""})", kWrongField},
      {R"({"type":"hello","robot":"a\u001b[2J"})", kWrongField},
      {R"({"type":"hello","robot":"a\u009b2J"})", kWrongField},
      {R"({"type":"hello","robot":"a\nb"})", kWrongField},
      {R"({"type":"hello","robot":")" + std::string(1000, 'a') + "\"}", kWrongField},
      {R"({"type":"health","state":{}})", kWrongField},
      {R"({"type":"health","state":"mapping","camera":"up"})", kWrongField},
      {R"({"type":"health","camera":{"up":"yes"}})", kWrongField},
      {R"({"type":"health","reason":")" + std::string(10'000, 'a') + "\"}", kWrongField},
      {R"({"type":"alignment"})", kWrongField},
      {R"({"type":"alignment","name":"b","state":7})", kWrongField},
      {R"({"type":"alignment","name":"b","pose":{}})", kWrongField},
      {R"({"type":"alignment","name":"b","peer":100000})", kWrongField},
      {R"({"type":"peer","name":null})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":{},"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":[1,2],"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":1e9,"rows":[],"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":[-4,0,0,0,0,0,0,0,0],"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":[1.5,0,0,0,0,0,0,0,0],"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":[1,0,0,0,0,0,0,0,9e9],"gone":[]})", kWrongField},
      {R"({"type":"landmarks","peer":-1,"rows":[],"gone":["x"]})", kWrongField},
      {R"({"type":"landmarks","peer":-1})", kWrongField},
      {R"({"type":"forgotten"})", kWrongField},
      {R"({"type":"picture","width":1000000000,"height":2})", kWrongField},
      {R"({"type":"picture","width":8,"height":8,"jpeg":7})", kWrongField},
      {R"({"type":"picture","width":8,"height":8,"jpeg":"?"})", kWrongField},
      {R"({"type":"picture","width":8,"height":8,"corners":["x"]})", kWrongField},
      {R"({"type":"strip","first_row":-1,"grey":"AAAA"})", kWrongField},
      {R"({"type":"strip","first_row":0})", kWrongField},
      {R"({"type":"unknown","x":"a\u0007"})", kWrongField},
      {R"({"type":"unknown","\u001b":1})", kWrongField},
  };
}

TEST(TelemetryLine, WhatIsNoneIsToldApart) {
  for (const Hostile& hostile : hostile_lines()) {
    const DecodedLine decoded = decode_telemetry(hostile.text);
    EXPECT_FALSE(decoded.line) << hostile.text.substr(0, 80);
    EXPECT_STREQ(fault_name(decoded.fault), fault_name(hostile.fault))
        << hostile.text.substr(0, 80) << " " << decoded.field;
  }
}

TEST(TelemetryLine, EveryHostileLineIsCountedAndChangesNothing) {
  FleetState state;
  state.add("anna");
  hear(state, 0, R"({"type":"hello","robot":"anna","started_ns":1})");
  const std::vector<Hostile> all = hostile_lines();
  for (const Hostile& hostile : all) hear(state, 0, hostile.text);
  state.read([&](const std::vector<RobotState>& robots) {
    std::uint64_t counted = 0;
    for (const std::uint64_t n : robots[0].limits().refused) counted += n;
    EXPECT_EQ(counted, all.size());
    EXPECT_EQ(robots[0].name(), "anna");
    EXPECT_EQ(robots[0].lines().size(), 2u) << "hello, and what was counted";
  });
}

TEST(TelemetryLine, HasWhatADaemonTells) {
  const TelemetryLine pose = told({{"type", "pose"},
                                   {"stamp_ns", 5},
                                   {"pose", {1.0, 2.0, 0.5}},
                                   {"covariance", {1, 2, 3, 4, 5, nullptr}},
                                   {"step_ms", 4.5},
                                   {"new_key", {{"flag", true}}}});
  ASSERT_NE(pose.as<PoseLine>(), nullptr);
  EXPECT_EQ(pose.stamp_ns(), 5);
  EXPECT_EQ(pose.as<PoseLine>()->pose[1], 2.0);
  EXPECT_FALSE(pose.as<PoseLine>()->covariance) << "null is no number";
  EXPECT_EQ(pose.number("/new_key/flag"), 1.0);
  EXPECT_EQ(pose.number("/pose/2"), 0.5);
  EXPECT_FALSE(pose.number("/pose/3"));
  EXPECT_FALSE(pose.number("/pose/x/y"));
  EXPECT_EQ(pose.text("/step_ms"), "4.5");
  EXPECT_EQ(pose.text("/none"), "");
  const TelemetryLine marks = told({{"type", "landmarks"},
                                    {"peer", 2},
                                    {"rows", {4294967295u, 1, 2, 3, 0, 0, 0, 0, 9}},
                                    {"gone", {7}}});
  ASSERT_NE(marks.as<LandmarksLine>(), nullptr);
  EXPECT_EQ(marks.as<LandmarksLine>()->rows.size(), 1u);
  EXPECT_EQ(marks.as<LandmarksLine>()->gone, std::vector<std::uint32_t>{7});
  EXPECT_FALSE(marks.shown().contains("rows"));
  EXPECT_NE(told({{"type", "of the future"}}).as<UnknownLine>(), nullptr);
}

TEST(BoundedJson, KeepsItsLimits) {
  const JsonLimits limits = {20, 2, 4};
  EXPECT_EQ(parse_bounded("[[1,2]]", limits).fault, JsonFault::kNone);
  EXPECT_EQ(parse_bounded("[[[]]]", limits).fault, JsonFault::kTooDeep);
  EXPECT_EQ(parse_bounded("[1,2,3,4,5]", limits).fault, JsonFault::kTooMany);
  EXPECT_EQ(parse_bounded(std::string(21, ' '), limits).fault, JsonFault::kTooLong);
  EXPECT_EQ(parse_bounded("[", limits).fault, JsonFault::kNotJson);
  EXPECT_EQ(parse_bounded(R"("[[[[\"[[[")", limits).fault, JsonFault::kNone) << "in a string";
}

}  // namespace
}  // namespace zenith::tools
