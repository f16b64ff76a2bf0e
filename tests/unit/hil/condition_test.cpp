#include "tests/hil/programs/condition.h"

#include <gtest/gtest.h>

#include "tests/hil/programs/play_folder.h"

namespace zenith::hil {
namespace {

bool met(const std::string& condition, const char* line) {
  const auto parsed = Condition::parse(condition);
  EXPECT_TRUE(parsed) << condition;
  return parsed && parsed->met_by(nlohmann::json::parse(line));
}

TEST(Condition, ComparesWhatALineSays) {
  const char* line =
      R"({"type":"health","state":"mapping","camera":{"up":true,"lost":3},"x":null})";
  EXPECT_TRUE(met("health.state=mapping", line));
  EXPECT_FALSE(met("health.state!=mapping", line));
  EXPECT_TRUE(met("health.camera.up=true", line));
  EXPECT_FALSE(met("health.camera.up=false", line));
  EXPECT_TRUE(met("health.camera.lost>=3", line));
  EXPECT_FALSE(met("health.camera.lost>3", line));
  EXPECT_TRUE(met("health.camera.lost<=3", line));
  EXPECT_FALSE(met("health.camera.lost<3", line));
  EXPECT_TRUE(met("health.camera.lost=3", line));
}

TEST(Condition, WhatIsNotThereMeetsNothing) {
  const char* line = R"({"type":"health","x":null,"state":"mapping"})";
  EXPECT_FALSE(met("health.y<1", line));
  EXPECT_FALSE(met("health.y!=1", line));
  EXPECT_FALSE(met("health.x!=1", line));
  EXPECT_FALSE(met("health.state>=1", line));
}

TEST(Condition, RefusesWhatIsNone) {
  for (const char* text : {"", "health", "health.state", "state=1", "health.=1", ".state=1",
                           "health.state=", "health.x!1", "health.x>=many"}) {
    EXPECT_FALSE(Condition::parse(text)) << text;
  }
}

TEST(PlayFolder, TruthLiesBetweenItsPoses) {
  const std::vector<TruePose> poses = {{0, {0, 0, 3.0}}, {1000, {1, 2, -3.0}}};
  EXPECT_DOUBLE_EQ(truth_at(poses, -5).x_m, 0.0);
  EXPECT_DOUBLE_EQ(truth_at(poses, 500).x_m, 0.5);
  EXPECT_DOUBLE_EQ(truth_at(poses, 500).y_m, 1.0);
  EXPECT_NEAR(std::abs(truth_at(poses, 500).theta_rad), 3.14159, 1e-4);  // the short way round
  EXPECT_DOUBLE_EQ(truth_at(poses, 2000).y_m, 2.0);
}

}  // namespace
}  // namespace zenith::hil
