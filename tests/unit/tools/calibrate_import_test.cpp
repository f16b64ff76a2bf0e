#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "slam/image/lens_projection.h"
#include "tests/support/real_data.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/calibrate/import.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

class ImportTest : public testing::Test {
 protected:
  Result<std::vector<ForeignLens>> read(const std::string& text) {
    write_text(folder_.path() / "file.yaml", text);
    return read_foreign_lenses(folder_.path() / "file.yaml");
  }
  TemporaryFolder folder_;
};

TEST_F(ImportTest, KalibrsCamchainIsTakenAsItIs) {
  const auto lenses = read(
      "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
      "  distortion_coeffs: [0.01, -0.02, 0.003, -0.0004]\n"
      "  intrinsics: [201.5, 202.5, 310.25, 240.75]\n  resolution: [640, 480]\n"
      "cam1:\n  camera_model: omni\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.2, 0.05, 0.0001, 0.0002]\n"
      "  intrinsics: [1.5, 500, 501, 320, 240]\n  resolution: [640, 480]\n");
  ASSERT_TRUE(lenses.ok()) << lenses.error().message;
  ASSERT_EQ(lenses->size(), 2u);
  const auto lens = import_lens((*lenses)[0]);
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  EXPECT_EQ(lens->lens.width_px, 640);
  EXPECT_EQ(lens->lens.fv_px, 202.5);
  EXPECT_EQ(lens->lens.k[3], -0.0004);
  EXPECT_EQ((*lenses)[1].model, "omni-radtan");
}

TEST_F(ImportTest, OpenCvsDialectIsRead) {
  const auto lenses = read(
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 150.5, 0., 321., 0., 151.5, 239., 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n"
      "   data: [ 0.01, 0.02, -0.003, 0.0004 ]\n");
  ASSERT_TRUE(lenses.ok()) << lenses.error().message;
  const auto lens = import_lens(lenses->front());
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  EXPECT_EQ(lens->lens.cv_px, 239.0);
  EXPECT_EQ(lens->lens.k[1], 0.02);
}

TEST_F(ImportTest, RosPlumbBobAndRationalAreTakenAsTheyAre) {
  const std::string head =
      "image_width: 640\nimage_height: 480\ncamera_name: narrow\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [420, 0, 322, 0, 421, 238, 0, 0, 1]\n";
  const std::vector<std::pair<std::string, std::vector<double>>> cases = {
      {"plumb_bob", {-0.28, 0.07, 0.0002, -0.0001, 0}},
      {"rational_polynomial", {0.45, -2.47, 0.0009, -0.0002, 1.43, 0.32, -2.3, 1.36}},
      {"rational_polynomial", {0.45, -2.47, 0.0009, -0.0002, 1.43, 0.32, -2.3, 1.36, 0, 0, 0, 0}},
  };
  for (const auto& [model, D] : cases) {
    std::string list;
    for (const double d : D) list += (list.empty() ? "" : ", ") + std::to_string(d);
    const auto lenses =
        read(head + "distortion_model: " + model +
             "\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [" + list + "]\n");
    ASSERT_TRUE(lenses.ok()) << lenses.error().message;
    const auto lens = import_lens(lenses->front());
    ASSERT_TRUE(lens.ok()) << lens.error().message;
    const LensProjection projection(lens->lens);
    const cv::Matx33d K(420, 0, 322, 0, 421, 238, 0, 0, 1);
    for (const double x : {-0.5, 0.0, 0.4}) {
      std::vector<cv::Point2d> seen;
      cv::projectPoints(std::vector<cv::Point3d>{{x, 0.3, 1.0}}, cv::Vec3d(), cv::Vec3d(), K, D,
                        seen);
      const auto uv = projection.project({x, 0.3, 1.0});
      ASSERT_TRUE(uv);
      EXPECT_LT(std::hypot(uv->x() - seen[0].x, uv->y() - seen[0].y), 1e-6) << model;
    }
  }
}

TEST_F(ImportTest, WhatIsNoLensIsRefusedWithReasons) {
  EXPECT_THAT(read("a: 1\n").error().message, HasSubstr("found none of their keys"));
  EXPECT_THAT(read("a: [1\n").error().message, HasSubstr("file.yaml: "));
  ForeignLens lens{"Kalibr", "cam0", "pinhole-magic", 640, 480, {1, 2, 3, 4}, {}};
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("'pinhole-magic'"));
  lens.model = "pinhole-equi";
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("found 0"));
  lens = {"ROS camera_info",
          "",
          "pinhole-rational",
          640,
          480,
          {420, 420, 320, 240},
          {0.1, 0, 0, 0, 0, 0, 0, 0, 0.01, 0, 0, 0}};
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("thin prism"));
  lens = {"ROS camera_info",   "", "pinhole-radtan", 640, 480, {-150, 300, 320, 240},
          {0.0, 0.0, 0.0, 0.0}};
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("fu_px is -150, expected 1 .."));
  lens.intrinsics = {300, 300, 320, 500};
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("cv_px lies outside of the frame"));
  lens.intrinsics = {300, 300, 320, 240};
  lens.distortion = {-3.0, 0.0, 0.0, 0.0};
  EXPECT_THAT(import_lens(lens).error().message, HasSubstr("fold the image over itself at 18."));
}

TEST_F(ImportTest, ARealCamerasCalibrationOfBasaltIsRead) {
  ZENITH_NEED_REAL_DATA("fisheye_calibration");
  const auto lenses =
      read_foreign_lenses(real_data_folder() / "fisheye_calibration" / "t265_kb4_calib.json");
  ASSERT_TRUE(lenses.ok()) << lenses.error().message;
  ASSERT_EQ(lenses->size(), 2u);
  const auto lens = import_lens((*lenses)[1]);
  ASSERT_TRUE(lens.ok()) << lens.error().message;
  EXPECT_NEAR(lens->lens.fu_px, 286.9496, 1e-3);
  EXPECT_NEAR(lens->lens.k[2], -0.04804, 1e-4);
}

TEST_F(ImportTest, ARealWideLensOfAnotherModelIsTakenAsItIs) {
  // The TUM-VI camera's EUCM numbers, 512 x 512 pixels.
  const ForeignLens lens{"Basalt",
                         "cam0",
                         "eucm-none",
                         512,
                         512,
                         {0.6283550447635853, 1.0458678747533083, 190.89618687183938,
                          190.87022285882367, 254.9375370481962, 256.86414483060787},
                         {}};
  const auto imported = import_lens(lens);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported->lens.model, LensModel::kEucm);
  EXPECT_EQ(imported->lens.alpha, 0.6283550447635853);
  EXPECT_EQ(imported->lens.fu_px, 190.89618687183938);
  EXPECT_GT(imported->widest_deg, 110.0);
}

}  // namespace
}  // namespace zenith::tools
