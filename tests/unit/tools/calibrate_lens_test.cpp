#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "slam/image/lens_projection.h"
#include "tests/support/figure.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/calibrate/lens_calibration.h"
#include "tools/calibrate/lens_pictures.h"
#include "tools/calibrate/sample.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

cv::Mat as_mat(std::vector<std::uint8_t>& pixels) {
  return {480, 640, CV_8UC1, pixels.data()};
}

std::vector<SeenBoard> sample_boards(const Target& target, std::uint64_t seed, int views) {
  SampleCamera camera(sample_lens(seed), target, seed);
  std::vector<SeenBoard> boards;
  for (int i = 0; i < views; ++i) {
    auto pixels = camera.image(camera.held(i, views));
    boards.push_back({"view " + std::to_string(i), detect_target(as_mat(pixels), target)});
  }
  return boards;
}

// What a user of the lens feels: by how much rays go wrong, out to 65 degrees, once the camera is
// turned so that they fit best; that turn is the mount's, not the lens's.
double worst_ray_deg(const Lens& found_lens, const Lens& true_lens) {
  double worst = 0.0;
  const LensProjection found(found_lens);
  const LensProjection truth(true_lens);
  const Eigen::Vector3d axis = found.unproject(truth.project({0.0, 0.0, 1.0}).value()).value();
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(axis, Eigen::Vector3d::UnitZ());
  for (double theta = 0.0; theta < 65.0 * std::numbers::pi / 180.0; theta += 0.05) {
    for (double azimuth = 0.0; azimuth < 6.2; azimuth += 0.4) {
      const Eigen::Vector3d ray(std::sin(theta) * std::cos(azimuth),
                                std::sin(theta) * std::sin(azimuth), std::cos(theta));
      const Eigen::Vector3d back = turn * found.unproject(truth.project(ray).value()).value();
      worst = std::max(worst, std::acos(std::min(1.0, ray.dot(back))));
    }
  }
  return worst * 180.0 / std::numbers::pi;
}

TEST(CalibrateLens, FindsTheLensOfRenderedCheckerboards) {
  double centre = 0.0;
  double focal = 0.0;
  double ray = 0.0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const Target target;
    const auto c = calibrate_lens(sample_boards(target, seed, 24), target, 640, 480);
    ASSERT_TRUE(c.ok()) << c.error().message;
    const Lens truth = sample_lens(seed);
    const Lens& lens = c->fit.lens;
    centre =
        std::max({centre, std::abs(lens.cu_px - truth.cu_px), std::abs(lens.cv_px - truth.cv_px)});
    focal = std::max({focal, std::abs(lens.fu_px / truth.fu_px - 1.0),
                      std::abs(lens.fv_px / truth.fv_px - 1.0)});
    ray = std::max(ray, worst_ray_deg(lens, truth));
    EXPECT_NE(c->judgement.worth, Worth::kAgain) << lens_report(*c);
    // The standard deviations are those of errors that are this large: neither idle nor boasting.
    EXPECT_LT(std::abs(lens.cu_px - truth.cu_px), 5.0 * c->centre_sigma_px());
    EXPECT_LT(c->centre_sigma_px(), 0.3);
  }
  print_figure(
      "lens from 24 checkerboards, worst of 4 seeds: centre %.3f px, focal length %.3f %%, "
      "a ray within 65 degrees %.3f degrees",
      centre, 100.0 * focal, ray);
  EXPECT_LT(centre, 1.0);
  EXPECT_LT(focal, 0.003);
  EXPECT_LT(ray, 0.15);
}

TEST(CalibrateLens, FindsTheLensOfRenderedMarkerBoards) {
  const auto target = parse_target("charuco", "6x4", 60.0);
  ASSERT_TRUE(target.ok());
  const auto c = calibrate_lens(sample_boards(*target, 5, 30), *target, 640, 480);
  ASSERT_TRUE(c.ok()) << c.error().message;
  const Lens truth = sample_lens(5);
  const double centre = std::max(std::abs(c->fit.lens.cu_px - truth.cu_px),
                                 std::abs(c->fit.lens.cv_px - truth.cv_px));
  const double focal = std::abs(c->fit.lens.fu_px / truth.fu_px - 1.0);
  print_figure("lens from %zu of 30 ChArUco boards: centre %.3f px, focal length %.3f %%",
               c->views.size(), centre, 100.0 * focal);
  EXPECT_GE(c->views.size(), 15u);
  EXPECT_LT(centre, 1.0);
  EXPECT_LT(focal, 0.01);
}

TEST(CalibrateLens, BadImagesAreLeftOutAndNamed) {
  const Target target;
  auto boards = sample_boards(target, 1, 16);
  // A board that moved while rows were read: sheared.
  for (Eigen::Vector2d& uv : boards[3].found->corners_px) uv.x() += 0.06 * (uv.y() - 240.0);
  boards[5].found = Error{"the image is black"};
  const auto c = calibrate_lens(boards, target, 640, 480);
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_EQ(c->views.size(), 14u);
  EXPECT_THAT(c->images[3].refused, HasSubstr("off by"));
  EXPECT_EQ(c->images[5].refused, "the image is black");
  EXPECT_THAT(lens_report(*c), HasSubstr("view 3: refused: its corners are off by"));
  EXPECT_LT(std::abs(c->fit.lens.cu_px - sample_lens(1).cu_px), 1.0);
}

TEST(CalibrateLens, SaysWhereViewsAreMissing) {
  const Target target;
  auto boards = sample_boards(target, 1, 30);
  // Only the middle: the first views.
  boards.erase(boards.begin() + 10, boards.end());
  const auto c = calibrate_lens(boards, target, 640, 480);
  ASSERT_TRUE(c.ok()) << c.error().message;
  EXPECT_NE(c->judgement.worth, Worth::kGood);
  EXPECT_THAT(judgement_text(c->judgement), HasSubstr("at the rim"));
  TemporaryFolder folder;
  ASSERT_TRUE(draw_coverage(*c, folder.path() / "coverage.png").ok());
  ASSERT_TRUE(draw_residuals(*c, folder.path() / "residuals.png").ok());
  EXPECT_FALSE(cv::imread((folder.path() / "coverage.png").string()).empty());
}

TEST(CalibrateLens, TooFewImagesAreAnErrorThatTellsEach) {
  std::vector<SeenBoard> boards;
  boards.push_back({"a.png", Error{"the image is black"}});
  const auto c = calibrate_lens(boards, Target{}, 640, 480);
  ASSERT_FALSE(c.ok());
  EXPECT_THAT(c.error().message, HasSubstr("found 0 of 1"));
  EXPECT_THAT(c.error().message, HasSubstr("a.png: the image is black"));
}

TEST(CalibrateLens, DetectionSaysWhatIsWrong) {
  std::vector<std::uint8_t> black(640 * 480, 3);
  EXPECT_THAT(detect_target(as_mat(black), Target{}).error().message, HasSubstr("black"));
  std::vector<std::uint8_t> stripes(640 * 480);
  for (std::size_t i = 0; i < stripes.size(); ++i) stripes[i] = i % 640 % 40 < 20 ? 40 : 200;
  EXPECT_THAT(detect_target(as_mat(stripes), Target{}).error().message,
              HasSubstr("no whole checkerboard"));
}

Eigen::Vector2d project(const Lens& lens, const Eigen::Vector3d& p) {
  return LensProjection(lens).project(p).value();
}

TEST(Projection, DerivativesAgreeWithDifferences) {
  const Lens lens = sample_lens(3);
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.3, -0.2, 0.5), Eigen::Vector3d(0.4, 0.5, -0.05),
        Eigen::Vector3d(1e-3, 2e-3, 1.0)}) {
    const Projection at = project_with_derivatives(lens, p);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d numeric = (project(lens, p + d) - project(lens, p - d)) / (2.0 * kStep);
      EXPECT_LT((numeric - at.by_point.col(i)).norm(), 1e-4) << i;
    }
    for (int i = 0; i < kLensSize; ++i) {
      const LensVector d = kStep * LensVector::Unit(i);
      const LensVector v = lens_vector(lens);
      const Eigen::Vector2d numeric = (project(lens_of_vector(v + d, 640, 480), p) -
                                       project(lens_of_vector(v - d, 640, 480), p)) /
                                      (2.0 * kStep);
      EXPECT_LT((numeric - at.by_lens.col(i)).norm(), 1e-4) << i;
    }
  }
}

}  // namespace
}  // namespace zenith::tools
