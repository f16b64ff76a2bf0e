#pragma once
// Matching of two images' features, and the similarity transform on which most matches agree: an
// oracle for tests that ask whether two images show the same ceiling.

#include <vector>

#include <Eigen/Core>

#include "platform/base/random.h"
#include "slam/image/image.h"
#include "slam/image/patch.h"

namespace zenith {

struct DescribedCorner {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // pixels or tangents, the caller's choice
  double orientation_rad = 0.0;
  Patch patch;
};

// Corners and patches of an image of kRectifiedSize x kRectifiedSize, in pixels.
std::vector<DescribedCorner> describe_image(const ImageView& image);

struct MatchSettings {
  double ncc_min = 0.7;
  double lead = 0.0;    // by which the best must exceed the second best
  double radius = 0.0;  // between the places; 0: anywhere
};

struct IndexPair {
  int a = 0;
  int b = 0;
};

// Pairs that are each other's best.
std::vector<IndexPair> match_corners(const std::vector<DescribedCorner>& a,
                                     const std::vector<DescribedCorner>& b,
                                     const MatchSettings& settings);

struct SimilarityFit {
  double scale = 1.0;
  double theta_rad = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();
  std::vector<IndexPair> inliers;
  double rms = 0.0;  // of the inliers

  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const;
};

struct SimilaritySettings {
  double tolerance = 3.0;
  bool with_scale = true;
  double max_scale = 3.0;  // and the least is its inverse
  // Where the patches' directions must turn as the transform does; 0: no such test.
  double max_turn_rad = 0.0;
  int trials = 2000;
};

SimilarityFit find_similarity(const std::vector<DescribedCorner>& a,
                              const std::vector<DescribedCorner>& b,
                              const std::vector<IndexPair>& pairs,
                              const SimilaritySettings& settings, Random& random);

}  // namespace zenith
