// One rule for all that join maps: what is taken for one landmark, and what is not.

#include "slam/map/same_landmark.h"

#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

CompactPatch look(Random& random) {
  std::array<std::int8_t, kCompactLength> values;
  for (auto& v : values) v = static_cast<std::int8_t>(random.uniform() * 200.0 - 100.0);
  return compact_from(values);
}

Eigen::Matrix2d known_to(double sigma_m) {
  return sigma_m * sigma_m * Eigen::Matrix2d::Identity();
}

// Whether a landmark at the origin and one at `at` are one when their looks are as similar.
TwinSearch search(const Eigen::Vector3d& at, float similarity, double sigma_m = 0.02) {
  TwinSearch search(Eigen::Vector3d::Zero(), known_to(sigma_m));
  if (search.is_near(static_cast<float>(at.x()), static_cast<float>(at.y()),
                     static_cast<float>(at.z()))) {
    search.offer(7, at, known_to(sigma_m), [&] { return similarity; });
  }
  return search;
}

TEST(SameLandmark, PlacesMustAgreeAsFarAsTheyAreKnown) {
  // Three sigma of 2 cm, 2 cm and 2.5 cm together: 11.3 cm.
  EXPECT_EQ(search({0.11, 0.0, 0.0}, 0.9F).alike(), 7);
  EXPECT_EQ(search({0.0, 0.117, 0.0}, 0.9F).alike(), -1);
  EXPECT_EQ(search({0.0, 0.117, 0.0}, 0.9F, 0.03).alike(), 7) << "less is known of these";
  EXPECT_EQ(search({0.41, 0.0, 0.0}, 0.9F, 1.0).alike(), -1) << "never so far";
  EXPECT_TRUE(search({0.2, 0.0, 0.0}, 0.9F).any_near());
  EXPECT_FALSE(search({0.4, 0.0, 0.0}, 0.9F).any_near());
}

TEST(SameLandmark, HeightsMustAgree) {
  EXPECT_EQ(search({0.05, 0.0, 0.29}, 0.9F).alike(), 7);
  EXPECT_EQ(search({0.05, 0.0, -0.31}, 0.9F).alike(), -1);
}

TEST(SameLandmark, LooksMustBeSimilarUnlessItIsOneCorner) {
  EXPECT_EQ(search({0.08, 0.0, 0.0}, 0.6F).twin(), -1);
  EXPECT_EQ(search({0.08, 0.0, 0.0}, 0.61F).twin(), 7);
  const TwinSearch corner = search({0.03, 0.03, 0.02}, 0.1F);
  EXPECT_EQ(corner.alike(), -1);
  EXPECT_EQ(corner.twin(), 7);
  EXPECT_EQ(search({0.03, 0.03, 0.03}, 0.1F).twin(), -1) << "5.2 cm apart";
}

TEST(SameLandmark, TheMostSimilarOneCountsNotTheNearest) {
  TwinSearch search(Eigen::Vector3d::Zero(), known_to(0.02));
  search.offer(1, {0.01, 0.0, 0.0}, known_to(0.02), [] { return 0.7F; });
  search.offer(2, {0.06, 0.0, 0.0}, known_to(0.02), [] { return 0.9F; });
  search.offer(3, {0.0, 0.0, 0.0}, known_to(0.02), [] { return 0.2F; });
  EXPECT_EQ(search.twin(), 2);
  EXPECT_EQ(search.one_corner(), 3);
}

TEST(SameLandmark, LooksAreComparedThatPointTheSameWay) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const CompactPatch a = look(random);
  const CompactPatch b = look(random);
  const std::vector<LookView> one = {{&a, 3.0F}, {&b, 0.0F}};
  const std::vector<LookView> same = {{&a, -2.9F}};
  EXPECT_NEAR(best_similarity(one, same, 0.0), 1.0, 0.01) << "0.38 rad apart, across the turn";
  EXPECT_LT(best_similarity(one, same, 1.0), 0.6);
  EXPECT_NEAR(best_similarity(one, same, -0.38 + 0.49), 1.0, 0.01);
  EXPECT_EQ(best_similarity(one, {}, 0.0), 0.0F);
}

}  // namespace
}  // namespace zenith
