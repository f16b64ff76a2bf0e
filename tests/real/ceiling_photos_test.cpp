// Corners, patches and NCC on photographs of three real ceilings: two photographs of one ceiling
// have many matches that one similarity transform explains, two of different ceilings have not.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "slam/capacity.h"
#include "tests/support/figure.h"
#include "tests/support/grey_image.h"
#include "tests/support/image_matching.h"
#include "tests/support/real_data.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr const char* kNames[] = {"room_a_0", "room_a_1", "room_a_2", "room_b_0",
                                  "room_b_1", "room_c_0", "room_c_1"};
constexpr int kPhotos = 7;

// A photograph scaled to 427 x 320, described in two overlapping squares; of corners that both
// squares see one is kept.
std::vector<DescribedCorner> describe_photo(const cv::Mat& photo) {
  cv::Mat small;
  const double scale = static_cast<double>(kRectifiedSize) / photo.rows;
  cv::resize(photo, small, {}, scale, scale, cv::INTER_AREA);
  std::vector<DescribedCorner> all;
  for (const int left : {0, small.cols - kRectifiedSize}) {
    const cv::Mat square = small(cv::Rect(left, 0, kRectifiedSize, kRectifiedSize)).clone();
    for (DescribedCorner corner : describe_image(view_of(square))) {
      corner.place.x() += left;
      const auto is_same = [&corner](const DescribedCorner& other) {
        return (other.place - corner.place).norm() < 3.0;
      };
      if (std::none_of(all.begin(), all.end(), is_same)) all.push_back(corner);
    }
  }
  return all;
}

bool same_room(int i, int j) {
  return kNames[i][5] == kNames[j][5];
}

// The pairs a1-a2 and c0-c1 are alike enough for a similarity transform, 22 and 28 matches agreed
// when this was written; at most 3 did between different rooms. The other pairs of one room were
// taken from so different sides that a similarity does not explain them: they are printed, and must
// only not be mistaken for another room.
TEST(RealCeilingPhotos, TheSameCeilingIsFoundAndOthersAreNot) {
  ZENITH_NEED_REAL_DATA("ceiling_photos");
  std::vector<std::vector<DescribedCorner>> photos;
  for (const char* name : kNames) {
    const cv::Mat photo =
        read_grey(real_data_folder() / "ceiling_photos" / (name + std::string(".jpg")));
    ASSERT_FALSE(photo.empty()) << name;
    photos.push_back(describe_photo(photo));
    EXPECT_GT(photos.back().size(), 100u) << name;
  }

  const TestSeed seed;
  Random random(seed.value());
  MatchSettings matching;
  matching.ncc_min = 0.75;
  SimilaritySettings similarity;
  similarity.tolerance = 4.0;
  similarity.max_turn_rad = 0.4;
  similarity.trials = 5000;
  std::size_t most_between_rooms = 0;
  for (int i = 0; i < kPhotos; ++i) {
    for (int j = i + 1; j < kPhotos; ++j) {
      const auto& a = photos[static_cast<std::size_t>(i)];
      const auto& b = photos[static_cast<std::size_t>(j)];
      const std::vector<IndexPair> pairs = match_corners(a, b, matching);
      const SimilarityFit fit = find_similarity(a, b, pairs, similarity, random);
      const std::size_t inliers = fit.inliers.size();
      const std::string names = std::string(kNames[i]) + " and " + kNames[j];
      if (!same_room(i, j)) {
        most_between_rooms = std::max(most_between_rooms, inliers);
        EXPECT_LE(inliers, 6u) << names << ": different rooms";
        continue;
      }
      print_figure("ceiling photos %s: %zu of %zu matches agree", names.c_str(), inliers,
                   pairs.size());
      const bool alike = (i == 1 && j == 2) || (i == 5 && j == 6);
      if (alike) {
        EXPECT_GE(inliers, 12u) << names << ": the same room";
      }
    }
  }
  print_figure("ceiling photos of different rooms: at most %zu matches agree", most_between_rooms);
}

}  // namespace
}  // namespace zenith
