// The image stage beside OpenCV's, on rendered frames: the rectified image, and the corners; and
// the lenses' projection.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/image/corners.h"
#include "slam/image/lens_projection.h"
#include "slam/image/rectify.h"
#include "tests/support/arena_block.h"
#include "tests/support/figure.h"
#include "tests/support/lenses.h"
#include "tools/runner/simulated_source.h"

namespace zenith {
namespace {

constexpr int kN = kRectifiedSize;

// Frames of robot r1 of corridor-rooms, rectified by us and by cv::remap.
class ImageBesideOpenCv : public testing::Test {
 protected:
  static constexpr int kFrames = 20;
  static constexpr int kEvery = 8;

  ImageBesideOpenCv()
      : block_([this](Arena& arena) {
          rectifier_.layout(arena);
          detector_.layout(arena);
          pixels_ = arena.take<std::uint8_t>(kN * kN);
        }) {}

  // Calls look(ours, fisheye) for each frame.
  template <typename Look>
  void for_each_frame(const Look& look) {
    const auto team =
        tools::simulate_team("corridor-rooms", 1, kFrames * kEvery / 15.0, Parameters{});
    ASSERT_TRUE(team.ok()) << team.error().message;
    Source& source = *team->sources.front();
    robot_ = source.config();
    rectifier_.build(robot_.lens, robot_.mount, pinhole_);
    SourceFrame frame;
    for (int i = 0;; ++i) {
      const Result<bool> more = source.next(frame);
      if (!more.ok() || !*more) break;
      if (i % kEvery != 0) continue;
      const Lens& lens = robot_.lens;
      rectifier_.apply({frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px},
                       {pixels_.data(), kN, kN, kN});
      look(cv::Mat(kN, kN, CV_8U, pixels_.data()),
           cv::Mat(lens.height_px, lens.width_px, CV_8U, frame.pixels.data()));
    }
  }

  RobotConfig robot_;
  const Pinhole pinhole_ = Pinhole::from_fov(2.0944);
  Rectifier rectifier_;
  CornerDetector detector_;
  std::span<std::uint8_t> pixels_;
  ArenaBlock block_;
};

// Without any rounding of places.
double bilinear(const cv::Mat& image, double u, double v) {
  const int iu = static_cast<int>(std::floor(u));
  const int iv = static_cast<int>(std::floor(v));
  const double du = u - iu;
  const double dv = v - iv;
  const auto at = [&image](int y, int x) {
    return static_cast<double>(image.at<std::uint8_t>(y, x));
  };
  return (1.0 - dv) * ((1.0 - du) * at(iv, iu) + du * at(iv, iu + 1)) +
         dv * ((1.0 - du) * at(iv + 1, iu) + du * at(iv + 1, iu + 1));
}

// cv::remap rounds places to 1/32 of a pixel and is further off than one grey level now and then.
TEST_F(ImageBesideOpenCv, RectifiedPixelsAreWithinOneGreyLevel) {
  int compared = 0;
  int far_from_opencv = 0;
  double worst = 0.0;
  double opencv_worst = 0.0;
  cv::Mat map_u(kN, kN, CV_32F);
  cv::Mat map_v(kN, kN, CV_32F);
  for_each_frame([&](const cv::Mat& ours, const cv::Mat& fisheye) {
    const Eigen::Matrix3d R = mount_rotation(robot_.mount).transpose();
    const LensProjection projection(robot_.lens);
    for (int v = 0; v < kN; ++v) {
      for (int u = 0; u < kN; ++u) {
        const Eigen::Vector2d m = pinhole_.normalise(u, v);
        const Eigen::Vector2d at =
            projection.project(R * Eigen::Vector3d(m.x(), m.y(), 1.0)).value();
        map_u.at<float>(v, u) = static_cast<float>(at.x());
        map_v.at<float>(v, u) = static_cast<float>(at.y());
      }
    }
    cv::Mat theirs;
    cv::remap(fisheye, theirs, map_u, map_v, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    for (int v = 0; v < kN; ++v) {
      for (int u = 0; u < kN; ++u) {
        if (!rectifier_.sees(u, v, 0)) continue;
        const int grey = ours.at<std::uint8_t>(v, u);
        const int opencv = theirs.at<std::uint8_t>(v, u);
        const double exact = bilinear(fisheye, static_cast<double>(map_u.at<float>(v, u)),
                                      static_cast<double>(map_v.at<float>(v, u)));
        ++compared;
        far_from_opencv += std::abs(grey - opencv) > 1 ? 1 : 0;
        worst = std::max(worst, std::abs(grey - exact));
        opencv_worst = std::max(opencv_worst, std::abs(opencv - exact));
      }
    }
  });
  print_figure(
      "rectified pixels within one grey level of cv::remap: %.3f %%; from exact, in grey levels: "
      "%.2f at worst, cv::remap %.2f",
      100.0 * (1.0 - static_cast<double>(far_from_opencv) / compared), worst, opencv_worst);
  EXPECT_GT(compared, 1000000);
  EXPECT_LT(worst, 1.5);
  EXPECT_LT(far_from_opencv, compared / 1000);
}

// The corners that goodFeaturesToTrack finds by default, with Harris' measure.
TEST_F(ImageBesideOpenCv, CornersAreTheSame) {
  int theirs_count = 0;
  int same = 0;
  for_each_frame([&](const cv::Mat& ours, const cv::Mat&) {
    CornerSettings settings;
    settings.per_cell = kMaxCorners;  // as they come, without our spread
    Corners corners;
    detector_.detect({ours.data, kN, kN, kN}, settings, corners);
    std::vector<cv::Point2f> theirs;
    cv::goodFeaturesToTrack(ours, theirs, kMaxCorners, 0.01, settings.min_distance_px,
                            cv::noArray(), 3, true, 0.04);
    const auto border = static_cast<float>(settings.border_px);
    for (const cv::Point2f& p : theirs) {
      if (std::min(p.x, p.y) < border || std::max(p.x, p.y) > kN - 1 - border) continue;
      ++theirs_count;
      same += std::any_of(corners.begin(), corners.end(), [&p](const Corner& c) {
        return std::hypot(c.u_px - p.x, c.v_px - p.y) <= 1.0F;
      });
    }
  });
  print_figure("corners of goodFeaturesToTrack that are ours within 1 px: %.1f %% of %d",
               100.0 * same / theirs_count, theirs_count);
  EXPECT_GT(theirs_count, 300);
  EXPECT_GE(same, 0.95 * theirs_count);
}

// All that OpenCV itself can project, over the whole image.
TEST(LensesBesideOpenCv, PixelsAreTheSame) {
  double worst = 0.0;
  int compared = 0;
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const bool fisheye = lens.model == LensModel::kEquidistant;
    if (!fisheye && lens.model != LensModel::kRadtan && lens.model != LensModel::kRational) {
      continue;
    }
    const LensProjection projection(lens);
    const cv::Matx33d K(lens.fu_px, 0, lens.cu_px, 0, lens.fv_px, lens.cv_px, 0, 0, 1);
    std::vector<cv::Point3d> points;
    std::vector<Eigen::Vector2d> pixels;
    for (int v = 0; v < lens.height_px; v += 13) {
      for (int u = 0; u < lens.width_px; u += 13) {
        const auto ray = projection.unproject(Eigen::Vector2d(u, v));
        // OpenCV's fisheye ends at 90 degrees.
        if (!ray || ray->z() < 0.02) continue;
        const auto pixel = projection.project(*ray);
        if (!pixel) continue;
        points.emplace_back(ray->x(), ray->y(), ray->z());
        pixels.push_back(*pixel);
      }
    }
    std::vector<cv::Point2d> theirs;
    const cv::Vec3d none;
    if (fisheye) {
      cv::fisheye::projectPoints(points, theirs, none, none, K,
                                 cv::Vec4d(lens.k[0], lens.k[1], lens.k[2], lens.k[3]));
    } else {
      const std::vector<double> D = {lens.k[0], lens.k[1], lens.p[0], lens.p[1],
                                     lens.k[2], lens.k[3], lens.k[4], lens.k[5]};
      cv::projectPoints(points, none, none, K, D, theirs);
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double off = std::hypot(theirs[i].x - pixels[i].x(), theirs[i].y - pixels[i].y());
      EXPECT_LT(off, 1e-6) << name << ' ' << pixels[i].transpose();
      worst = std::max(worst, off);
    }
    compared += static_cast<int>(pixels.size());
  }
  EXPECT_GT(compared, 10'000);
  print_figure("lenses beside OpenCV's projectPoints, %d pixels: %.1e px at worst", compared,
               worst);
}

}  // namespace
}  // namespace zenith
