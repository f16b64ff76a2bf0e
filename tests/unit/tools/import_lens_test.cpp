// What becomes of a lens that was read: its formula is the source's, its size is settled, what
// contradicts itself is refused.

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "slam/image/lens_projection.h"
#include "tests/support/figure.h"
#include "tests/support/real_data.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/calibrate/import/foreign_lens.h"
#include "tools/calibrate/import/lens_picture.h"
#include "tools/calibrate/import/native_lens.h"
#include "tools/picture_file.h"

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// --- The sources' own formulas ------------------------------------------------------------------

using Formula = std::function<Eigen::Vector2d(const Eigen::Vector3d&)>;

Formula opencv(double fu, double fv, double cu, double cv, std::vector<double> d) {
  return [=](const Eigen::Vector3d& ray) {
    std::vector<cv::Point2d> seen;
    cv::projectPoints(std::vector<cv::Point3d>{{ray.x(), ray.y(), ray.z()}}, cv::Vec3d(),
                      cv::Vec3d(), cv::Matx33d(fu, 0, cu, 0, fv, cv, 0, 0, 1), d, seen);
    return Eigen::Vector2d(seen[0].x, seen[0].y);
  };
}

// cv::fisheye divides by z, and so ends at 90 degrees; Kalibr and Basalt do not.
Formula fisheye(double fu, double fv, double cu, double cv, std::vector<double> k) {
  return [=](const Eigen::Vector3d& ray) {
    const double r = ray.head<2>().norm();
    const double t = std::atan2(r, ray.z());
    double td = t;
    for (std::size_t i = 0; i < 4; ++i)
      td += k[i] * std::pow(t, 3.0 + 2.0 * static_cast<double>(i));
    return Eigen::Vector2d(fu * td * ray.x() / r + cu, fv * td * ray.y() / r + cv);
  };
}

Formula double_sphere(double fu, double fv, double cu, double cv, double xi, double alpha) {
  return [=](const Eigen::Vector3d& p) {
    const double d1 = p.norm();
    const double z = xi * d1 + p.z();
    const double d2 = std::sqrt(p.head<2>().squaredNorm() + z * z);
    const double below = alpha * d2 + (1.0 - alpha) * z;
    return Eigen::Vector2d(fu * p.x() / below + cu, fv * p.y() / below + cv);
  };
}

Formula eucm(double fu, double fv, double cu, double cv, double alpha, double beta) {
  return [=](const Eigen::Vector3d& p) {
    const double d = std::sqrt(beta * p.head<2>().squaredNorm() + p.z() * p.z());
    const double below = alpha * d + (1.0 - alpha) * p.z();
    return Eigen::Vector2d(fu * p.x() / below + cu, fv * p.y() / below + cv);
  };
}

Formula mei(double fu, double fv, double cu, double cv, double xi, std::vector<double> d) {
  return [=](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d s = ray.normalized();
    return opencv(fu, fv, cu, cv, d)({s.x(), s.y(), s.z() + xi});
  };
}

Formula fov(double fu, double fv, double cu, double cv, double w) {
  return [=](const Eigen::Vector3d& ray) {
    const double r = ray.head<2>().norm() / ray.z();
    const double rd = std::atan(2.0 * r * std::tan(0.5 * w)) / w;
    return Eigen::Vector2d(fu * rd / r * ray.x() / ray.z() + cu,
                           fv * rd / r * ray.y() / ray.z() + cv);
  };
}

// OCamCalib's world2cam(): x downwards, z backwards.
Formula world2cam(std::vector<double> inverse, double row, double column, double c, double d,
                  double e) {
  return [=](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d p(ray.y(), ray.x(), -ray.z());
    const double norm = p.head<2>().norm();
    const double theta = std::atan(p.z() / norm);
    double rho = 0.0;
    double power = 1.0;
    for (const double b : inverse) {
      rho += b * power;
      power *= theta;
    }
    const double x = p.x() / norm * rho;
    const double y = p.y() / norm * rho;
    return Eigen::Vector2d(x * e + y + column, x * c + y * d + row);
  };
}

// camodocal's spaceToPlane().
Formula space_to_plane(std::vector<double> inverse, double cx, double cy, double C, double D,
                       double E) {
  return [=](const Eigen::Vector3d& p) {
    const double norm = p.head<2>().norm();
    const double theta = std::atan2(-p.z(), norm);
    double rho = 0.0;
    double power = 1.0;
    for (const double b : inverse) {
      rho += b * power;
      power *= theta;
    }
    const double x = p.x() / norm * rho;
    const double y = p.y() / norm * rho;
    return Eigen::Vector2d(x * C + y * D + cx, x * E + y + cy);
  };
}

// The pixels of a grid over the whole image: their rays, by the source's formula, come back to
// them. Also at least `share` of the image must have rays.
double worst_px(const Lens& lens, const Formula& source, double share) {
  const LensProjection projection(lens);
  double worst = 0.0;
  int seen = 0;
  int all = 0;
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d uv((lens.width_px - 1.0) * i / kSteps,
                               (lens.height_px - 1.0) * j / kSteps);
      ++all;
      const auto ray = projection.unproject(uv);
      if (!ray || ray->head<2>().norm() < 1e-9) continue;
      ++seen;
      const auto again = projection.project(*ray);
      EXPECT_TRUE(again.has_value());
      worst = std::max(worst, (source(*ray) - uv).norm());
      if (again) worst = std::max(worst, (*again - source(*ray)).norm());
    }
  }
  EXPECT_GE(seen, share * all);
  return worst;
}

constexpr double kExact_px = 1e-6;

NativeLens native(const ForeignLens& foreign, const SizeWish& wish = {}) {
  auto lens = native_lens(foreign, wish);
  if (lens) return *lens;
  ADD_FAILURE() << lens.error().message;
  return {};
}

ForeignLens read_one(const std::string& text, ForeignModel model = ForeignModel::kAsTheFileSays) {
  auto lenses = parse_foreign_lenses(text, "file", model);
  if (lenses) return lenses->front();
  ADD_FAILURE() << lenses.error().message;
  return {};
}

std::string kalibr(const std::string& model, const std::string& intrinsics,
                   const std::string& distortion, const std::string& coefficients) {
  return "cam0: {camera_model: " + model + ", intrinsics: " + intrinsics +
         ", distortion_model: " + distortion + ", distortion_coeffs: " + coefficients +
         ", resolution: [640, 480]}\n";
}

TEST(ImportedLens, ShowsRaysWhereItsSourceShowsThem) {
  const auto check = [](const std::string& text, const Formula& source, double share) {
    SCOPED_TRACE(text);
    EXPECT_LT(worst_px(native(read_one(text)).lens, source, share), kExact_px);
  };
  check(kalibr("pinhole", "[300, 301, 322, 238]", "radtan", "[-0.2, 0.05, 0.001, -0.002]"),
        opencv(300, 301, 322, 238, {-0.2, 0.05, 0.001, -0.002}), 0.9);
  check(kalibr("pinhole", "[300, 301, 322, 238]", "none", "[]"),
        opencv(300, 301, 322, 238, {0, 0, 0, 0}), 1.0);
  check(kalibr("pinhole", "[190, 191, 322, 238]", "equidistant", "[0.01, -0.002, 0.001, -0.0001]"),
        fisheye(190, 191, 322, 238, {0.01, -0.002, 0.001, -0.0001}), 0.99);
  check(kalibr("ds", "[-0.2, 0.6, 158, 159, 322, 238]", "none", "[]"),
        double_sphere(158, 159, 322, 238, -0.2, 0.6), 0.7);
  check(kalibr("eucm", "[0.6, 1.1, 190, 191, 322, 238]", "none", "[]"),
        eucm(190, 191, 322, 238, 0.6, 1.1), 0.7);
  check(kalibr("omni", "[1.5, 600, 601, 322, 238]", "radtan", "[-0.2, 0.1, 0.001, -0.002]"),
        mei(600, 601, 322, 238, 1.5, {-0.2, 0.1, 0.001, -0.002}), 0.9);
  check(kalibr("pinhole", "[300, 301, 322, 238]", "fov", "[0.9]"), fov(300, 301, 322, 238, 0.9),
        0.9);
  check(
      "image_width: 640\nimage_height: 480\ndistortion_model: rational_polynomial\n"
      "camera_matrix: {data: [400, 0, 322, 0, 401, 238, 0, 0, 1]}\n"
      "distortion_coefficients: {data: [0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02]}\n",
      opencv(400, 401, 322, 238, {0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02}), 0.99);
}

TEST(ImportedLens, CvFisheyeIsTheEquidistantModel) {
  const Lens lens = native(read_one(kalibr("pinhole", "[300, 301, 322, 238]", "equidistant",
                                           "[0.01, 0.02, -0.01, 0.001]")))
                        .lens;
  std::vector<cv::Point2d> seen;
  cv::fisheye::projectPoints(std::vector<cv::Point3d>{{0.5, -0.4, 1.0}}, seen, cv::Vec3d(),
                             cv::Vec3d(), cv::Matx33d(300, 0, 322, 0, 301, 238, 0, 0, 1),
                             cv::Vec4d(0.01, 0.02, -0.01, 0.001));
  const auto uv = LensProjection(lens).project({0.5, -0.4, 1.0});
  ASSERT_TRUE(uv);
  EXPECT_NEAR(uv->x(), seen[0].x, 1e-9);
  EXPECT_NEAR(uv->y(), seen[0].y, 1e-9);
}

const std::vector<double> kPolynomial = {-230.0, 0.0, 1.4e-3, 1.0e-7};
// rho = 230 (theta + pi / 2) about: 361.28 + 230 theta + ..
const std::vector<double> kInverse = {361.28, 230.0, 4.0, 2.0};

std::string joined(const std::vector<double>& values) {
  std::string text = std::to_string(values.size());
  for (const double v : values) text += " " + std::to_string(v);
  return text;
}

TEST(ImportedLens, OCamCalibsWorld2Cam) {
  const Lens lens =
      native(read_one("#polynomial coefficients\n" + joined(kPolynomial) + "\n" + joined(kInverse) +
                      "\n240.5 318.25\n1.01 -0.03 0.02\n480 640\n"))
          .lens;
  EXPECT_LT(worst_px(lens, world2cam(kInverse, 240.5, 318.25, 1.01, -0.03, 0.02), 0.7), kExact_px);
}

TEST(ImportedLens, CamodocalsScaramuzza) {
  std::string text =
      "%YAML:1.0\nmodel_type: scaramuzza\ncamera_name: a\nimage_width: 640\nimage_height: 480\n"
      "poly_parameters:\n   p0: -230\n   p1: 0\n   p2: 1.4e-3\n   p3: 1e-7\n   p4: 0\n"
      "inv_poly_parameters:\n";
  for (std::size_t i = 0; i < kInverse.size(); ++i) {
    text += "   p" + std::to_string(i) + ": " + std::to_string(kInverse[i]) + "\n";
  }
  text +=
      "affine_parameters:\n   ac: 1.01\n   ad: -0.03\n   ae: 0.02\n   cx: 318.25\n   cy: 240.5\n";
  const Lens lens = native(read_one(text)).lens;
  EXPECT_LT(worst_px(lens, space_to_plane(kInverse, 318.25, 240.5, 1.01, -0.03, 0.02), 0.7),
            kExact_px);
  // Without the inverse polynomial it is solved for: the same ray's tan(theta) = rho / -f(rho).
  const std::size_t begin = text.find("inv_poly");
  const ForeignLens direct = read_one(text.substr(0, begin) + text.substr(text.find("affine")));
  const auto ray = LensProjection(native(direct).lens).unproject({318.25 + 1.01 * 100.0, 242.5});
  ASSERT_TRUE(ray);
  EXPECT_NEAR(std::atan2(ray->head<2>().norm(), ray->z()), std::atan2(100.0, 230.0 - 14.0 - 0.1),
              1e-9);
}

// --- Real files ---------------------------------------------------------------------------------

// The numbers behind the first `key` after `start`, found without a parser.
std::vector<double> numbers_behind(const std::string& text, const std::string& start,
                                   const std::string& key, std::size_t count) {
  std::size_t at = text.find(key, text.find(start)) + key.size();
  std::vector<double> numbers;
  while (numbers.size() < count && at < text.size()) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str() + at, &end);
    const std::size_t used = static_cast<std::size_t>(end - (text.c_str() + at));
    if (used > 0) numbers.push_back(value);
    at += std::max<std::size_t>(used, 1);
  }
  return numbers;
}

TEST(ImportedLens, RealCalibrationsAreTheirSources) {
  ZENITH_NEED_REAL_DATA("calibrations");
  const auto folder = real_data_folder() / "calibrations";
  struct RealFile {
    std::string name;
    std::string camera;
    std::function<Formula(const std::string&, const std::string&)> source;
  };
  using Text = const std::string&;
  const auto kalibr_radtan = [](Text t, Text cam) {
    const auto f = numbers_behind(t, cam + ":", "intrinsics: [", 4);
    return opencv(f[0], f[1], f[2], f[3], numbers_behind(t, cam + ":", "distortion_coeffs: [", 4));
  };
  const auto kalibr_equi = [](Text t, Text cam) {
    const auto f = numbers_behind(t, cam + ":", "intrinsics: [", 4);
    return fisheye(f[0], f[1], f[2], f[3], numbers_behind(t, cam + ":", "distortion_coeffs: [", 4));
  };
  // Where the matrix and the coefficients begin: a place in the text, and what stands before the
  // first number behind it.
  using Place = std::pair<std::string, std::string>;
  const auto matrix = [](bool is_fisheye, Place k_at, Place d_at, std::size_t count) {
    return [=](Text t, Text) {
      const auto k = numbers_behind(t, k_at.first, k_at.second, 9);
      const auto d = numbers_behind(t, d_at.first, d_at.second, count);
      return is_fisheye ? fisheye(k[0], k[4], k[2], k[5], d) : opencv(k[0], k[4], k[2], k[5], d);
    };
  };
  const Place ros_k = {"camera_matrix:", "data: ["};
  const Place ros_d = {"distortion_coefficients:", "data: ["};
  const auto basalt_ds = [](Text t, Text cam) {
    const std::string start = cam == "cam0" ? "\"intrinsics\"" : "157.91";
    const std::size_t at = cam == "cam0" ? t.find(start) : t.rfind("\"fx\"");
    const std::string part = t.substr(at);
    const auto one = [&part](const char* key) { return numbers_behind(part, "", key, 1)[0]; };
    return double_sphere(one("\"fx\":"), one("\"fy\":"), one("\"cx\":"), one("\"cy\":"),
                         one("\"xi\":"), one("\"alpha\":"));
  };
  const std::vector<RealFile> files = {
      {"basalt_tumvi_512_ds_calib.json", "cam0", basalt_ds},
      {"basalt_tumvi_512_ds_calib.json", "cam1", basalt_ds},
      {"camodocal_vins_black_box_config.yaml", "camera",
       [](Text t, Text) {
         const auto one = [&t](const char* key) { return numbers_behind(t, "", key, 1)[0]; };
         return mei(one("gamma1:"), one("gamma2:"), one("u0:"), one("v0:"), one("xi:"),
                    {one("k1:"), one("k2:"), one("p1:"), one("p2:")});
       }},
      {"camodocal_vins_tum_config.yaml", "camera",
       [](Text t, Text) {
         const auto one = [&t](const char* key) { return numbers_behind(t, "", key, 1)[0]; };
         return fisheye(one("mu:"), one("mv:"), one("u0:"), one("v0:"),
                        {one("k2:"), one("k3:"), one("k4:"), one("k5:")});
       }},
      {"kalibr_ds_tiscamera.yaml", "cam0",
       [](Text t, Text) {
         const auto f = numbers_behind(t, "cam0", "intrinsics: [", 6);
         return double_sphere(f[2], f[3], f[4], f[5], f[0], f[1]);
       }},
      {"kalibr_omni_752x480.yaml", "cam0",
       [](Text t, Text) {
         const auto f = numbers_behind(t, "cam0", "intrinsics: [", 5);
         return mei(f[1], f[2], f[3], f[4], f[0],
                    numbers_behind(t, "cam0", "distortion_coeffs: [", 4));
       }},
      {"kalibr_openvins_euroc_mav.yaml", "cam0", kalibr_radtan},
      {"kalibr_openvins_euroc_mav.yaml", "cam1", kalibr_radtan},
      {"kalibr_openvins_kaist.yaml", "cam0", kalibr_radtan},
      {"kalibr_openvins_kaist.yaml", "cam1", kalibr_radtan},
      {"kalibr_openvins_rpng_ironsides.yaml", "cam0", kalibr_equi},
      {"kalibr_openvins_rpng_ironsides.yaml", "cam1", kalibr_equi},
      {"kalibr_openvins_rs_d455.yaml", "cam0", kalibr_radtan},
      {"kalibr_openvins_rs_t265.yaml", "cam0", kalibr_equi},
      {"kalibr_openvins_rs_t265.yaml", "cam1", kalibr_equi},
      {"kalibr_openvins_tum_vi.yaml", "cam0", kalibr_equi},
      {"kalibr_openvins_tum_vi.yaml", "cam1", kalibr_equi},
      {"kalibr_openvins_uzhfpv_indoor.yaml", "cam0", kalibr_equi},
      {"kalibr_openvins_uzhfpv_indoor.yaml", "cam1", kalibr_equi},
      {"opencv_voxl_tracking.yml", "", matrix(true, {"M:", "data: ["}, {"D:", "data: ["}, 4)},
      {"ros2_oakd_camera_info_echo.yaml", "oakd_rgb_camera_optical_frame",
       matrix(false, {"", "\nk:\n"}, {"", "\nd:\n"}, 8)},
      {"ros_go2_front_fisheye.yaml", "go2_front_fisheye", matrix(true, ros_k, ros_d, 4)},
      {"ros_openmv_text.yaml", "", matrix(true, {"", "K: ["}, {"", "D: ["}, 4)},
      {"ros_raspicam_camerav1_1280x720.yaml", "camerav1_1280x720", matrix(false, ros_k, ros_d, 5)},
      {"ros_raspicam_camerav2_1280x720.yaml", "camerav2_1280x720", matrix(false, ros_k, ros_d, 5)},
  };
  double worst = 0.0;
  for (const RealFile& file : files) {
    SCOPED_TRACE(file.name + " " + file.camera);
    const auto lenses = read_foreign_lenses(folder / file.name);
    ASSERT_TRUE(lenses.ok()) << lenses.error().message;
    const ForeignLens* chosen = nullptr;
    for (const ForeignLens& lens : *lenses) {
      if (lens.camera == file.camera) chosen = &lens;
    }
    ASSERT_NE(chosen, nullptr);
    const NativeLens lens = native(*chosen);
    const double off =
        worst_px(lens.lens, file.source(read_text(folder / file.name), file.camera), 0.8);
    EXPECT_LT(off, kExact_px);
    worst = std::max(worst, off);
  }
  print_figure("%zu cameras of 18 real calibrations: %.1e px from their sources' formulas at worst",
               files.size(), worst);
}

// --- Sizes --------------------------------------------------------------------------------------

ForeignLens sized(int width, int height, double f, double cu, double cv) {
  ForeignLens lens;
  lens.model = "fisheye";
  lens.lens.width_px = width;
  lens.lens.height_px = height;
  lens.lens.fu_px = f;
  lens.lens.fv_px = f;
  lens.lens.cu_px = cu;
  lens.lens.cv_px = cv;
  return lens;
}

std::string refusal(const ForeignLens& lens, const SizeWish& wish = {}) {
  const auto native = native_lens(lens, wish);
  return native.ok() ? "was taken" : native.error().message;
}

TEST(ImportedLens, ASizeThatIsNotSaidIsAskedFor) {
  const ForeignLens lens = sized(0, 0, 200, 320, 240);
  EXPECT_THAT(refusal(lens), HasSubstr("--size"));
  EXPECT_EQ(native(lens, {{{640, 480}}, {}}).lens.width_px, 640);
  EXPECT_THAT(refusal(lens, {{{2560, 1920}}, {}}), HasSubstr("--scale 4"));
}

TEST(ImportedLens, NumbersOfAnotherSizeAreRefusedWithTheFactor) {
  const ForeignLens binned = sized(2064, 1544, 299.5, 254.1, 183.9);
  EXPECT_THAT(refusal(binned), AllOf(HasSubstr("516 x 386"), HasSubstr("--scale 4"),
                                     HasSubstr("--size 516x386 --scale 1")));
  const Lens large = native(binned, {{}, 4.0}).lens;
  EXPECT_EQ(large.width_px, 2064);
  EXPECT_EQ(large.fu_px, 4 * 299.5);
  EXPECT_NEAR(large.cu_px, 4 * 254.6 - 0.5, 1e-9);
  const Lens small = native(binned, {{{516, 386}}, 1.0}).lens;
  EXPECT_EQ(small.width_px, 516);
  EXPECT_EQ(small.fu_px, 299.5);
  for (const auto& [cu, cv, factor] :
       std::vector<std::tuple<double, double, std::string>>{{160, 120, "--scale 2"},
                                                            {213, 160, "--scale 1.5"},
                                                            {640, 480, "--scale 0.5"},
                                                            {1280, 960, "--scale 0.25"},
                                                            {107, 80, "--scale 3"},
                                                            {960, 720, "--scale 0.3333"}}) {
    EXPECT_THAT(refusal(sized(640, 480, 200, cu, cv)), HasSubstr(factor)) << cu;
  }
}

TEST(ImportedLens, CroppedStreamsAreRefused) {
  const ForeignLens cropped = sized(640, 320, 200, 320, 240);
  EXPECT_THAT(refusal(cropped), AllOf(HasSubstr("cropped"), HasSubstr("--scale 1")));
  EXPECT_EQ(native(cropped, {{}, 1.0}).lens.cv_px, 240);
  EXPECT_THAT(refusal(sized(480, 640, 200, 320, 240)), HasSubstr("--size 640x480 --scale 1"));
  // Off by a little less than exchanged numbers of a 4:3 image make.
  EXPECT_THAT(refusal(sized(480, 640, 200, 310, 245)),
              AllOf(HasSubstr("exchanged"), HasSubstr("--size 640x480 --scale 1")));
  EXPECT_THAT(refusal(sized(640, 480, 200, 245, 310)), HasSubstr("exchanged"));
  EXPECT_EQ(native(sized(640, 480, 200, 245, 310), {{}, 1.0}).lens.cv_px, 310);
  // A little aside is said, not refused.
  EXPECT_THAT(native(sized(640, 480, 200, 320, 300)).notes,
              testing::ElementsAre(HasSubstr("optical axis")));
  EXPECT_THAT(native(sized(640, 480, 200, 310, 250)).notes, IsEmpty());
}

TEST(ImportedLens, NumbersThatAreNoPixelsAreRefused) {
  EXPECT_THAT(refusal(sized(640, 480, 0.4, 0.49, 0.51)), HasSubstr("shares of the image"));
  EXPECT_THAT(refusal(sized(640, 480, 2.1, 320, 240)), HasSubstr("millimetres"));
  EXPECT_THAT(refusal(sized(1920, 1080, 4.2, 960, 540)), HasSubstr("millimetres"));
  ForeignLens pinhole = sized(640, 480, 12.0, 320, 240);
  pinhole.lens.model = LensModel::kRadtan;
  EXPECT_THAT(refusal(pinhole), HasSubstr("millimetres"));
  // A circular fisheye in a large image, and a pinhole as wide as any.
  EXPECT_EQ(refusal(sized(1920, 1080, 120, 960, 540)), "was taken");
  pinhole.lens.fu_px = pinhole.lens.fv_px = 100;
  EXPECT_EQ(refusal(pinhole), "was taken");
}

TEST(ImportedLens, AnotherSizeRescalesOnlyWhenAsked) {
  const ForeignLens lens = sized(640, 480, 200, 320, 240);
  EXPECT_THAT(refusal(lens, {{{320, 240}}, {}}), HasSubstr("--scale 0.5"));
  EXPECT_THAT(refusal(lens, {{{640, 360}}, {}}), HasSubstr("other proportions"));
  EXPECT_EQ(native(lens, {{{640, 480}}, {}}).lens.fu_px, 200);
  for (const SizeWish& wish : {SizeWish{{{320, 240}}, 0.5}, SizeWish{{}, 0.5}}) {
    const Lens half = native(lens, wish).lens;
    EXPECT_EQ(half.width_px, 320);
    EXPECT_EQ(half.height_px, 240);
    EXPECT_EQ(half.fu_px, 100);
    EXPECT_EQ(half.cu_px, 159.75);
  }
}

TEST(ImportedLens, AScaledLensShowsTheSamePictureSmaller) {
  ForeignLens lens = read_one("#polynomial coefficients\n" + joined(kPolynomial) + "\n" +
                              joined(kInverse) + "\n240.5 318.25\n1.01 -0.03 0.02\n480 640\n");
  for (const bool solved : {false, true}) {
    if (solved) lens.lens.inverse_polynomial = {};
    const LensProjection whole(lens.lens);
    const LensProjection half(native(lens, {{}, 0.5}).lens);
    for (const double x : {-1.0, 0.1, 0.7}) {
      const auto a = whole.project({x, 0.4, 1.0});
      const auto b = half.project({x, 0.4, 1.0});
      ASSERT_TRUE(a && b);
      EXPECT_NEAR(b->x() + 0.5, 0.5 * (a->x() + 0.5), 1e-6);
      EXPECT_NEAR(b->y() + 0.5, 0.5 * (a->y() + 0.5), 1e-6);
    }
  }
}

TEST(ImportedLens, WhatTheConfigurationRefusesIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double f : {-150.0, 0.0, 1e9, nan, inf}) {
    EXPECT_THAT(refusal(sized(640, 480, f, 320, 240)), HasSubstr("fu_px")) << f;
  }
  for (const double c : {nan, inf}) {
    EXPECT_THAT(refusal(sized(640, 480, 200, c, 240)), HasSubstr("cu_px")) << c;
  }
  EXPECT_NE(refusal(sized(640, 480, 200, -3, 240)), "was taken");
  EXPECT_NE(refusal(sized(640, 480, 200, 641, 240), {{}, 1.0}), "was taken");
  EXPECT_NE(refusal(sized(8, 6, 3, 4, 3)), "was taken");
  ForeignLens lens = sized(640, 480, 200, 320, 240);
  lens.lens.k[1] = nan;
  EXPECT_THAT(refusal(lens), HasSubstr("k2"));
  lens = sized(640, 480, 200, 320, 240);
  lens.refused = "a reason";
  EXPECT_EQ(refusal(lens), "a reason");
}

// --- What is shown ------------------------------------------------------------------------------

TEST(ImportedLens, AngleOfView) {
  const AngleOfView fisheye = angle_of_view(sized(641, 481, 200, 320, 240).lens);
  constexpr double kDeg = 180.0 / 3.14159265358979;
  EXPECT_NEAR(*fisheye.horizontal_deg, 2.0 * 320.0 / 200.0 * kDeg, 1e-3);
  EXPECT_NEAR(*fisheye.vertical_deg, 2.0 * 240.0 / 200.0 * kDeg, 1e-3);
  EXPECT_NEAR(*fisheye.diagonal_deg, 2.0 * 400.0 / 200.0 * kDeg, 1e-3);
  EXPECT_FALSE(angle_of_view(sized(641, 481, 60, 320, 240).lens).horizontal_deg.has_value());
}

TEST(ImportedLens, ThePictureIsDrawn) {
  TemporaryFolder folder;
  const Lens lens = sized(640, 480, 200, 320, 240).lens;
  ASSERT_TRUE(draw_lens(lens, {}, folder.path() / "lens.png").ok());
  const auto picture = read_grey_picture(folder.path() / "lens.png");
  ASSERT_TRUE(picture.ok());
  EXPECT_GT(picture->cols, 1000);
  EXPECT_LT(cv::mean(*picture)[0], 250.0) << "an empty page";
  // With an image, which must have the lens's size.
  EXPECT_THAT(draw_lens(lens, folder.path() / "lens.png", folder.path() / "b.png").error().message,
              HasSubstr("640 x 480"));
  EXPECT_FALSE(draw_lens(lens, folder.path() / "none.png", folder.path() / "b.png").ok());
}

}  // namespace
}  // namespace zenith::tools
