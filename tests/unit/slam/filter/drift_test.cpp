#include "slam/filter/drift.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

constexpr double kHeight_m = 2.2;
constexpr double kNoise = 4e-6;

// Drives along x; the landmarks in view are those of the anchors of the last two metres, one every
// 10 cm.
std::vector<PlacedDrift> drive(DriftEstimate& drift, double way_m) {
  std::vector<PlacedDrift> anchors = {PlacedDrift{}};
  for (double x = 0.1; x < way_m + 0.05; x += 0.1) {
    const Eigen::Vector2d camera(x, 0.0);
    drift.begin_frame(camera);
    for (const PlacedDrift& a : anchors) {
      if (x - static_cast<double>(a.x_m) > 2.0) continue;
      for (int k = 0; k < 4; ++k) drift.add(a, kHeight_m, kNoise);
    }
    drift.end_frame();
    anchors.push_back(drift.placed());
  }
  return anchors;
}

TEST(DriftEstimate, HeadingGrowsWithTheWayAndPlaceFaster) {
  DriftEstimate near;
  drive(near, 10.0);
  DriftEstimate far;
  drive(far, 20.0);
  const Eigen::Matrix3d& A = near.covariance();
  const Eigen::Matrix3d& B = far.covariance();
  EXPECT_NEAR(B(2, 2) / A(2, 2), 2.0, 0.2);  // a random walk
  EXPECT_NEAR(B(1, 1) / A(1, 1), 8.0, 2.0);  // its integral: the cube of the way
  EXPECT_LT(B(0, 0), 0.1 * B(1, 1));         // a wrong heading leads aside
  EXPECT_GT(B(1, 2), 0.0);
}

TEST(DriftEstimate, AnOldAnchorBringsItsSmallDriftBack) {
  DriftEstimate drift;
  const auto anchors = drive(drift, 20.0);
  const Eigen::Matrix3d before = drift.covariance();
  drift.begin_frame({0.5, 0.0});
  for (int k = 0; k < 20; ++k) drift.add(anchors.front(), kHeight_m, kNoise);
  drift.end_frame();
  EXPECT_LT(drift.covariance()(2, 2), 0.1 * before(2, 2));
  EXPECT_LT(drift.covariance()(1, 1), 0.01 * before(1, 1));
}

TEST(DriftEstimate, WithoutMatchesItIsCarriedAlong) {
  DriftEstimate drift;
  drive(drift, 10.0);
  const Eigen::Matrix3d before = drift.covariance();
  drift.begin_frame({20.0, 0.0});
  drift.end_frame();
  EXPECT_NEAR(drift.covariance()(2, 2), before(2, 2), 1e-9);
  EXPECT_GT(drift.covariance()(1, 1), before(1, 1));
}

TEST(PlacedDrift, MovesToAnotherFrame) {
  PlacedDrift drift;
  drift.set({1.0, 0.0}, Eigen::Vector3d(4.0, 1.0, 0.5).asDiagonal());
  const PlacedDrift moved = drift.moved({2.0, 3.0, std::numbers::pi / 2});
  EXPECT_NEAR(moved.x_m, 2.0, 1e-6);
  EXPECT_NEAR(moved.y_m, 4.0, 1e-6);
  EXPECT_NEAR(moved.matrix()(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(moved.matrix()(1, 1), 4.0, 1e-6);
  EXPECT_NEAR(moved.matrix()(2, 2), 0.5, 1e-6);
}

TEST(MapError, ScaleLiesAlongAndYawAcross) {
  const Eigen::Matrix2d P = map_error({0.01, 0.02}, {10.0, 0.0});
  EXPECT_NEAR(P(0, 0), 0.01, 1e-9);
  EXPECT_NEAR(P(1, 1), 0.04, 1e-9);
  EXPECT_NEAR(P(0, 1), 0.0, 1e-9);
}

}  // namespace
}  // namespace zenith
