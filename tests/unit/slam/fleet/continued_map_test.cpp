// Past and present map as one: common landmarks are fused, all others go on.

#include "slam/fleet/continued_map.h"

#include <chrono>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

LandmarkRecord landmark(std::uint32_t id, double x, double y, Random& random) {
  LandmarkRecord r;
  r.id = id;
  r.x_m = static_cast<float>(x);
  r.y_m = static_cast<float>(y);
  r.z_m = 2.5F;
  r.covariance_m2 = {4e-4F, 0.0F, 0.0F, 4e-4F, 0.0F, 4e-4F};
  r.observations = 10;
  r.appearance_count = 1;
  for (auto& v : r.appearances[0].descriptor) {
    v = static_cast<std::int8_t>(random.uniform() * 200.0 - 100.0);
  }
  return r;
}

// How `r`, of the past map, is seen in the frame of the present one.
LandmarkRecord seen_now(LandmarkRecord r, std::uint32_t id, const Pose2& T_past_own) {
  const Eigen::Vector2d at = T_past_own.inverse() * Eigen::Vector2d(r.x_m, r.y_m);
  r.id = id;
  r.x_m = static_cast<float>(at.x());
  r.y_m = static_cast<float>(at.y());
  r.appearances[0].direction_rad -= static_cast<float>(T_past_own.theta_rad);
  return r;
}

TEST(ContinuedMap, CommonLandmarksAreOneAndKeepTheirPlaceAndId) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const Pose2 T_past_own{3.0, -2.0, 1.1};
  std::vector<LandmarkRecord> past;
  std::vector<LandmarkRecord> own;
  for (std::uint32_t i = 0; i < 30; ++i) {
    past.push_back(landmark(100 + i, 0.7 * (i % 6), 0.7 * (i / 6), random));
    if (i < 20) own.push_back(seen_now(past.back(), 1 + i, T_past_own));
  }
  for (std::uint32_t i = 0; i < 5; ++i) own.push_back(landmark(50 + i, 40.0 + i, 40.0, random));
  std::vector<LandmarkRecord> out(kMaxLandmarks);
  const Eigen::Matrix3d certain = 1e-8 * Eigen::Matrix3d::Identity();
  out.resize(continue_map(past, own, T_past_own, certain, out));
  ASSERT_EQ(out.size(), 35u);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(out[i].id, past[i].id);
    EXPECT_NEAR(out[i].x_m, past[i].x_m, 1e-4);
    EXPECT_NEAR(out[i].y_m, past[i].y_m, 1e-4);
    EXPECT_NEAR(out[i].covariance_m2[0], 2e-4, 1e-5) << "two sights tell twice as much";
    EXPECT_EQ(out[i].observations, 20);
    EXPECT_EQ(out[i].appearance_count, 2);
    EXPECT_NEAR(out[i].appearances[0].direction_rad, past[i].appearances[0].direction_rad, 1e-5);
  }
  for (std::size_t i = 20; i < 25; ++i) EXPECT_GT(out[i].id, 129u) << "ids of their own";
  for (std::size_t i = 25; i < 35; ++i) EXPECT_EQ(out[i].id, past[i - 5].id);
}

TEST(ContinuedMap, NearOnesThatLookDifferentStayTwo) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const std::vector<LandmarkRecord> past = {landmark(1, 0.0, 0.0, random)};
  const std::vector<LandmarkRecord> own = {landmark(1, 0.08, 0.0, random)};
  std::vector<LandmarkRecord> out(kMaxLandmarks);
  EXPECT_EQ(continue_map(past, own, {}, Eigen::Matrix3d::Zero(), out), 2u);
}

TEST(ContinuedMap, OfTwoFullMapsEveryCommonLandmarkIsFound) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  std::vector<LandmarkRecord> past;
  for (std::uint32_t i = 0; i < kMaxLandmarks; ++i) {
    past.push_back(landmark(i + 1, 0.5 * (i % 64), 0.5 * (i / 64), random));
    LandmarkRecord& r = past.back();
    for (; r.appearance_count < kPublishedAppearances; ++r.appearance_count) {
      r.appearances[r.appearance_count] = r.appearances[0];
    }
  }
  const Pose2 T_past_own{3.0, -2.0, 0.0};
  std::vector<LandmarkRecord> own;
  for (std::size_t i = 0; i < past.size(); ++i) {
    own.push_back(seen_now(past[i], past[i].id, T_past_own));
    own.back().x_m += static_cast<float>(0.06 * (random.uniform() - 0.5));
    own.back().y_m += static_cast<float>(0.06 * (random.uniform() - 0.5));
  }
  std::vector<LandmarkRecord> out(kMaxLandmarks);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(continue_map(past, own, T_past_own, Eigen::Matrix3d::Zero(), out), past.size());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i].id, past[i].id);
  print_figure(
      "continued map: %d landmarks with %d looks and as many seen again, as one in %.1f ms",
      kMaxLandmarks, kPublishedAppearances, took.count() * 1e3);
}

TEST(ContinuedMap, AFullMapLeavesPastOnesOut) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  std::vector<LandmarkRecord> past;
  std::vector<LandmarkRecord> own;
  for (std::uint32_t i = 0; i < 8; ++i) {
    past.push_back(landmark(i + 1, i, 0.0, random));
    own.push_back(landmark(i + 1, i, 50.0, random));
  }
  std::vector<LandmarkRecord> out(10);
  ASSERT_EQ(continue_map(past, own, {}, Eigen::Matrix3d::Zero(), out), 10u);
  EXPECT_EQ(out[7].y_m, 50.0F);
  EXPECT_EQ(out[8].y_m, 0.0F);
}

}  // namespace
}  // namespace zenith
