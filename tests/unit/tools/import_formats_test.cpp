// A small file of each kind that people have, with made-up numbers: that it is read as what it is.
// What is no lens, or none here, is refused with a reason.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/calibrate/import/foreign_lens.h"

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using Lenses = std::vector<ForeignLens>;

Lenses read(const std::string& text, ForeignModel model = ForeignModel::kAsTheFileSays) {
  auto lenses = parse_foreign_lenses(text, "file", model);
  if (lenses) return *lenses;
  ADD_FAILURE() << lenses.error().message << "\n" << text;
  return Lenses(1);
}

std::string error_of(const std::string& text) {
  const auto lenses = parse_foreign_lenses(text, "file");
  return lenses.ok() ? "was read" : lenses.error().message;
}

std::string refusal_of(const std::string& text) {
  return read(text).front().refused;
}

Lens equidistant(double fu, double fv, double cu, double cv, std::vector<double> k) {
  Lens lens;
  lens.fu_px = fu;
  lens.fv_px = fv;
  lens.cu_px = cu;
  lens.cv_px = cv;
  std::copy(k.begin(), k.end(), lens.k.begin());
  return lens;
}

// k1 k2 p1 p2 k3 [k4 k5 k6]
Lens pinhole(double fu, double fv, double cu, double cv, std::vector<double> d) {
  Lens lens = equidistant(fu, fv, cu, cv, {d[0], d[1]});
  lens.model = d.size() > 5 ? LensModel::kRational : LensModel::kRadtan;
  lens.p = {d[2], d[3]};
  std::copy(d.begin() + 4, d.end(), lens.k.begin() + 2);
  return lens;
}

Lens with_size(Lens lens, int width, int height) {
  lens.width_px = width;
  lens.height_px = height;
  return lens;
}

void expect_lens(const ForeignLens& read, const Lens& expected) {
  EXPECT_THAT(read.refused, IsEmpty());
  const Lens& lens = read.lens;
  EXPECT_EQ(lens.model, expected.model);
  EXPECT_EQ(lens.width_px, expected.width_px);
  EXPECT_EQ(lens.height_px, expected.height_px);
  EXPECT_EQ(lens.fu_px, expected.fu_px);
  EXPECT_EQ(lens.fv_px, expected.fv_px);
  EXPECT_EQ(lens.cu_px, expected.cu_px);
  EXPECT_EQ(lens.cv_px, expected.cv_px);
  EXPECT_EQ(lens.k, expected.k);
  EXPECT_EQ(lens.p, expected.p);
  EXPECT_EQ(lens, expected);
}

const Lens kFisheye = equidistant(201.5, 202.5, 310.25, 240.75, {0.01, -0.02, 0.003, -0.0004});
const Lens kPlumbBob = pinhole(420.5, 421.5, 322.0, 238.0, {-0.28, 0.07, 0.0002, -0.0001, 0.01});
const Lens kRational =
    pinhole(420.5, 421.5, 322.0, 238.0, {0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02});

// --- Kalibr and its kin -------------------------------------------------------------------------

const std::string kKalibr =
    "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
    "  distortion_coeffs: [0.01, -0.02,\n    0.003, -0.0004]\n"
    "  intrinsics: [201.5, 202.5, 310.25, 240.75]\n  resolution: [640, 480]\n"
    "  rostopic: /cam0/image_raw\n";

TEST(ImportFormats, KalibrsCamchainAsPeopleHaveIt) {
  const std::string crlf = [] {
    std::string text = kKalibr;
    for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += 2) {
      text.insert(at, 1, '\r');
    }
    return text;
  }();
  std::string cr = kKalibr;
  std::replace(cr.begin(), cr.end(), '\n', '\r');
  std::string tabs = kKalibr;
  for (std::size_t at = 0; (at = tabs.find("\n  ", at)) != tabs.npos; ++at) {
    tabs.replace(at, 3, "\n\t");
  }
  std::string no_spaces = kKalibr;
  for (const char* key : {"model: ", "coeffs: ", "intrinsics: ", "resolution: ", "topic: "}) {
    for (std::size_t at = 0; (at = no_spaces.find(key, at)) != no_spaces.npos;) {
      no_spaces.erase(at + std::string(key).size() - 1, 1);
    }
  }
  for (const std::string& text :
       {kKalibr, "%YAML:1.0\n" + kKalibr, "%YAML:1.0 # must be there\n\n" + kKalibr,
        "%YAML 1.2\n---\n" + kKalibr, "%YAML:1.0\n---\n---\n" + kKalibr, "# a comment\n" + kKalibr,
        kKalibr + "...\n", kKalibr + "---\n", crlf, "%YAML:1.0\r\n" + crlf, cr, tabs, no_spaces}) {
    SCOPED_TRACE(text);
    const Lenses lenses = read(text);
    ASSERT_EQ(lenses.size(), 1u);
    EXPECT_EQ(lenses[0].format, "Kalibr");
    EXPECT_EQ(lenses[0].camera, "cam0");
    expect_lens(lenses[0], kFisheye);
  }
}

std::string kalibr(const std::string& model, const std::string& intrinsics,
                   const std::string& distortion, const std::string& coefficients) {
  return "cam0: {camera_model: " + model + ", intrinsics: " + intrinsics +
         ", distortion_model: " + distortion + ", distortion_coeffs: " + coefficients +
         ", resolution: [640, 480]}\n";
}

TEST(ImportFormats, KalibrsModels) {
  Lens lens = with_size(kPlumbBob, 640, 480);
  lens.k[2] = 0.0;
  const std::string f = "420.5, 421.5, 322, 238]";
  expect_lens(read(kalibr("pinhole", "[" + f, "radtan", "[-0.28, 0.07, 0.0002, -0.0001]"))[0],
              lens);
  lens.model = LensModel::kOmni;
  lens.xi = 1.5;
  expect_lens(read(kalibr("omni", "[1.5, " + f, "radtan", "[-0.28, 0.07, 0.0002, -0.0001]"))[0],
              lens);
  lens.k = {};
  lens.p = {};
  expect_lens(read(kalibr("omni", "[1.5, " + f, "none", "[]"))[0], lens);
  lens.model = LensModel::kDoubleSphere;
  lens.xi = -0.2;
  lens.alpha = 0.6;
  expect_lens(read(kalibr("ds", "[-0.2, 0.6, " + f, "none", "[]"))[0], lens);
  lens.model = LensModel::kEucm;
  lens.xi = 0.0;
  lens.beta = 1.1;
  expect_lens(read(kalibr("eucm", "[0.6, 1.1, " + f, "none", "[]"))[0], lens);
  Lens fov = with_size(pinhole(420.5, 421.5, 322, 238, {0, 0, 0, 0, 0}), 640, 480);
  expect_lens(read(kalibr("pinhole", "[" + f, "none", "[]"))[0], fov);
  fov.model = LensModel::kFov;
  fov.w = 0.9;
  expect_lens(read(kalibr("pinhole", "[" + f, "fov", "[0.9]"))[0], fov);
}

TEST(ImportFormats, KalibrsModelsThatAreNoneHere) {
  const std::string f = "420.5, 421.5, 322, 238]";
  EXPECT_THAT(refusal_of(kalibr("omni", "[1.5, " + f, "equidistant", "[0, 0, 0, 0]")),
              HasSubstr("omni with the distortion 'equidistant'"));
  EXPECT_THAT(refusal_of(kalibr("magic", "[" + f, "radtan", "[0, 0, 0, 0]")), HasSubstr("'magic'"));
  EXPECT_THAT(refusal_of(kalibr("ds", "[" + f, "none", "[]")), HasSubstr("6 intrinsics, found 4"));
  EXPECT_THAT(refusal_of(kalibr("pinhole", "[" + f, "equidistant", "[0.1, 0.2]")),
              HasSubstr("found 2 coefficients"));
  EXPECT_THAT(refusal_of(kalibr("pinhole", "[" + f, "equidistant", "[0.1, 0.2, 0, 0, 0.5]")),
              HasSubstr("found 5 coefficients"));
  EXPECT_THAT(refusal_of(kalibr("pinhole", "[" + f, "wavy", "[0.1, 0.2, 0, 0]")),
              HasSubstr("'wavy'"));
  EXPECT_THAT(refusal_of(kalibr("pinhole", "[" + f, "none", "[0.1, 0.2, 0, 0]")),
              HasSubstr("no distortion"));
  EXPECT_THAT(refusal_of(kalibr("pinhole", "[420,5, a, 3]", "none", "[]")), HasSubstr("'a'"));
}

TEST(ImportFormats, KalibrsResultsAsText) {
  const std::string text =
      "Calibration results \n====================\nCamera-system parameters:\n"
      "cam0 (/cam0/image_raw):\n"
      "    type: <class 'aslam_cv.libaslam_cv_python.EquidistantDistortedPinholeCameraGeometry'>\n"
      "    distortion: [ 0.01 -0.02  0.003 -0.0004] +- [0.1 0.1 0.1 0.1]\n"
      "    projection: [201.5 202.5 310.25 240.75] +- [1 1 1 1]\n"
      "    reprojection error: [0.0, 0.0] +- [0.2, 0.2]\n\n"
      "cam1 (/cam1/image_raw):\n"
      "    type: <class 'aslam_cv.libaslam_cv_python.DistortedPinholeCameraGeometry'>\n"
      "    distortion: [-0.28 0.07 0.0002 -0.0001] +- [0.1 0.1 0.1 0.1]\n"
      "    projection: [420.5 421.5 322. 238.] +- [1 1 1 1]\n\n"
      "baseline T_1_0:\n    q: [0 0 0 1] +- [0 0 0]\n";
  const Lenses lenses = read(text);
  ASSERT_EQ(lenses.size(), 2u);
  expect_lens(lenses[0], with_size(kFisheye, 0, 0));
  EXPECT_EQ(lenses[1].camera, "cam1");
  EXPECT_EQ(lenses[1].lens.model, LensModel::kRadtan);
  EXPECT_EQ(lenses[1].lens.p[1], -0.0001);
}

TEST(ImportFormats, FilesThatAreLikeKalibrs) {
  // EuRoC's sensor.yaml.
  Lens lens = with_size(kPlumbBob, 752, 480);
  lens.k[2] = 0.0;
  expect_lens(read("sensor_type: camera\nresolution: [752, 480]\ncamera_model: pinhole\n"
                   "intrinsics: [420.5, 421.5, 322, 238] #fu, fv, cu, cv\n"
                   "distortion_model: radial-tangential\n"
                   "distortion_coefficients: [-0.28, 0.07, 0.0002, -0.0001]\n")[0],
              lens);
  // Our own sensor.yaml has one model that Kalibr has not.
  const Lens ours = read(
                        "resolution: [640, 480]\ncamera_model: scaramuzza\n"
                        "intrinsics: [1.01, -0.03, 0.02, 1, 1, 318.25, 240.5]\n"
                        "distortion_model: none\npolynomial: [-230, 0, 1.4e-3]\n"
                        "inverse_polynomial: [361, 230]\n")[0]
                        .lens;
  EXPECT_EQ(ours.model, LensModel::kScaramuzza);
  EXPECT_EQ(ours.e, 0.02);
  EXPECT_EQ(ours.cv_px, 240.5);
  EXPECT_EQ(ours.inverse_polynomial[1], 230);
  // SVO and maplab.
  const Lenses svo = read(
      "cameras:\n- camera:\n    distortion:\n      parameters:\n        cols: 1\n        rows: 4\n"
      "        data: [-0.28, 0.07, 0.0002, -0.0001]\n      type: radial-tangential\n"
      "    image_height: 480\n    image_width: 752\n    intrinsics:\n      cols: 1\n      rows: 4\n"
      "      data: [420.5, 421.5, 322, 238]\n    label: left\n    type: pinhole\n"
      "label: rig\n");
  EXPECT_EQ(svo[0].camera, "left");
  expect_lens(svo[0], lens);
  // OKVIS.
  expect_lens(
      read("%YAML:1.0\ncameras:\n     - {T_SC:\n        [1, 0, 0, 0,\n         0, 1, 0, 0,\n"
           "         0, 0, 1, 0,\n         0, 0, 0, 1],\n"
           "        image_dimension: [752, 480],\n"
           "        distortion_coefficients: [-0.28, 0.07, 0.0002, -0.0001],\n"
           "        distortion_type: radialtangential,\n"
           "        focal_length: [420.5, 421.5],\n        principal_point: [322, 238]}\n")[0],
      lens);
}

// --- ROS ----------------------------------------------------------------------------------------

std::string ros(const std::string& model, const std::string& coefficients) {
  return "image_width: 640\nimage_height: 480\ncamera_name: narrow\n"
         "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [420.5, 0, 322, 0, 421.5, 238, 0, 0, 1]\n" +
         (model.empty() ? "" : "distortion_model: " + model + "\n") +
         "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [" + coefficients +
         "]\n"
         "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "projection_matrix:\n  rows: 3\n  cols: 4\n"
         "  data: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n";
}

TEST(ImportFormats, RosCameraInfoAsAFile) {
  const std::string plumb = "-0.28, 0.07, 0.0002, -0.0001, 0.01";
  const std::string rational = "0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02";
  for (const std::string& text :
       {ros("plumb_bob", plumb), ros("", plumb), ros("plumb_bob", plumb + ", 0, 0, 0"),
        ros("rational_polynomial", plumb), "%YAML:1.0\n" + ros("plumb_bob", plumb)}) {
    SCOPED_TRACE(text);
    const Lenses lenses = read(text);
    ASSERT_EQ(lenses.size(), 1u);
    EXPECT_EQ(lenses[0].format, "ROS camera_info");
    EXPECT_EQ(lenses[0].camera, "narrow");
    EXPECT_THAT(lenses[0].notes, IsEmpty());
    expect_lens(lenses[0], kPlumbBob);
  }
  expect_lens(read(ros("rational_polynomial", rational))[0], kRational);
  expect_lens(read(ros("rational_polynomial", rational + ", 0, 0, 0, 0, 0, 0"))[0], kRational);
  // The name is wrong, the numbers are what OpenCV computes with.
  const Lenses named_plumb_bob = read(ros("plumb_bob", rational));
  expect_lens(named_plumb_bob[0], kRational);
  ASSERT_EQ(named_plumb_bob[0].notes.size(), 1u);
  EXPECT_THAT(named_plumb_bob[0].notes[0], HasSubstr("rational polynomial"));
  for (const char* word : {"equidistant", "fisheye", "kannala_brandt"}) {
    const Lens lens = read(ros(word, "0.01, -0.02, 0.003, -0.0004"))[0].lens;
    EXPECT_EQ(lens.model, LensModel::kEquidistant);
    EXPECT_EQ(lens.k[3], -0.0004);
  }
}

TEST(ImportFormats, RosWhatNoLensHas) {
  const std::string eight = "0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02";
  EXPECT_THAT(refusal_of(ros("rational_polynomial", eight + ", 0.1, 0, 0, 0")),
              HasSubstr("thin prism"));
  EXPECT_THAT(refusal_of(ros("rational_polynomial", eight + ", 0, 0, 0, 0, 0.1, 0")),
              HasSubstr("tilt"));
  EXPECT_THAT(refusal_of(ros("plumb_bob", "0.1, 0.2, 0, 0, 0, 0.5")), HasSubstr("6 coefficients"));
  EXPECT_THAT(refusal_of(ros("plumb_bob", "0.1, 0.2, 0")), HasSubstr("3 coefficients"));
  EXPECT_THAT(refusal_of(ros("equidistant", "0.1, 0.2, 0, 0, 0.3")), HasSubstr("5 coefficients"));
  std::string skewed = ros("plumb_bob", "0, 0, 0, 0, 0");
  skewed.replace(skewed.find("420.5, 0, 322"), 13, "420.5, 4.2, 322");
  EXPECT_THAT(refusal_of(skewed), AllOf(HasSubstr("skew of 4.2 px"), HasSubstr("FIX_SKEW")));
  std::string uncalibrated = ros("plumb_bob", "0, 0, 0, 0, 0");
  uncalibrated.replace(uncalibrated.find("420.5, 0, 322, 0, 421.5, 238, 0, 0, 1"), 37,
                       "0, 0, 0, 0, 0, 0, 0, 0, 0");
  EXPECT_THAT(refusal_of(uncalibrated), HasSubstr("not calibrated"));
  std::string transposed = ros("plumb_bob", "0, 0, 0, 0, 0");
  transposed.replace(transposed.find("420.5, 0, 322, 0, 421.5, 238, 0, 0, 1"), 37,
                     "420.5, 0, 0, 0, 421.5, 0, 322, 238, 1");
  EXPECT_THAT(refusal_of(transposed), HasSubstr("column by column"));
}

TEST(ImportFormats, RosMessagesAsTopicEchoPrintsThem) {
  const std::string list =
      "k:\n- 420.5\n- 0.0\n- 322.0\n- 0.0\n- 421.5\n- 238.0\n- 0.0\n- 0.0\n- 1.0\n";
  const std::string message =
      "header:\n  stamp:\n    sec: 17\n    nanosec: 5\n  frame_id: cam\nheight: 480\nwidth: 640\n"
      "distortion_model: plumb_bob\nd:\n- -0.28\n- 0.07\n- 0.0002\n- -0.0001\n- 0.01\n" +
      list +
      "binning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n"
      "  width: 0\n  do_rectify: false\n---\n";
  const std::string lost = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n";
  for (const std::string& text : {message, message + message, message + message.substr(0, 120),
                                  lost + message, message + lost + message}) {
    const Lenses lenses = read(text);
    ASSERT_GE(lenses.size(), 1u);
    EXPECT_EQ(lenses[0].camera, "cam");
    expect_lens(lenses[0], kPlumbBob);
    EXPECT_EQ(lenses.size(), 1u);
  }
  // ROS 1.
  expect_lens(read("header: \n  seq: 5\n  stamp: \n    secs: 1\n    nsecs: 2\n  frame_id: \"cam\"\n"
                   "height: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n"
                   "D: [-0.28, 0.07, 0.0002, -0.0001, 0.01]\n"
                   "K: [420.5, 0.0, 322.0, 0.0, 421.5, 238.0, 0.0, 0.0, 1.0]\n"
                   "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\nbinning_x: 0\n---\n")[0],
              kPlumbBob);
  // A region of the sensor, binned: what arrives is smaller.
  std::string part = message;
  part.replace(part.find("binning_x: 0"), 12, "binning_x: 2");
  part.replace(part.find("binning_y: 0"), 12, "binning_y: 2");
  part.replace(part.find("x_offset: 0"), 11, "x_offset: 100");
  part.replace(part.find("  height: 0"), 11, "  height: 480");
  part.replace(part.find("  width: 0"), 10, "  width: 400");
  const ForeignLens lens = read(part)[0];
  EXPECT_EQ(lens.lens.width_px, 200);
  EXPECT_EQ(lens.lens.height_px, 240);
  EXPECT_EQ(lens.lens.fu_px, 210.25);
  EXPECT_EQ(lens.lens.cu_px, 222.5 / 2.0 - 0.5);
  EXPECT_EQ(lens.notes.size(), 2u);
}

TEST(ImportFormats, RosOst) {
  const std::string text =
      "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n"
      "[narrow_stereo]\n\ncamera matrix\n420.5 0.000000 322.000000\n0.000000 421.5 238.000000\n"
      "0.000000 0.000000 1.000000\n\ndistortion\n-0.28 0.07 0.0002 -0.0001 0.01\n\n"
      "rectification\n1 0 0\n0 1 0\n0 0 1\n\nprojection\n400 0 320 0\n0 400 240 0\n0 0 1 0\n";
  const ForeignLens lens = read(text)[0];
  EXPECT_EQ(lens.camera, "narrow_stereo");
  expect_lens(lens, kPlumbBob);
}

// --- OpenCV -------------------------------------------------------------------------------------

std::string opencv(const std::string& matrix, const std::string& distortion,
                   const std::string& coefficients, const std::string& more) {
  return "%YAML:1.0\n---\n" + more + matrix +
         ": !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
         "   data: [ 420.5, 0., 322., 0.,\n       421.5, 238., 0., 0., 1. ]\n" +
         distortion + ": !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ " +
         coefficients + " ]\n";
}

TEST(ImportFormats, OpenCvsNames) {
  const std::string five = "-0.28, 0.07, 0.0002, -0.0001, 0.01";
  const std::vector<std::pair<std::string, std::string>> names = {
      {"camera_matrix", "distortion_coefficients"},
      {"Camera_Matrix", "Distortion_Coefficients"},
      {"cameraMatrix", "distCoeffs"},
      {"K", "D"},
      {"M", "D"},
      {"camera_matrix", "dist_coeffs"},
      {"intrinsic_matrix", "distortion_coeffs"},
      {"mtx", "dist"}};
  const std::vector<std::string> sizes = {
      "image_width: 640\nimage_height: 480\n", "image_Width: 640\nimage_Height: 480\n",
      "width: 640\nheight: 480\n", "image_size: [ 640, 480 ]\n", "imageSize: [ 640, 480 ]\n"};
  for (const auto& [matrix, distortion] : names) {
    for (const std::string& size : sizes) {
      SCOPED_TRACE(matrix + size);
      const Lenses lenses = read(opencv(matrix, distortion, five, size));
      ASSERT_EQ(lenses.size(), 1u);
      expect_lens(lenses[0], kPlumbBob);
    }
  }
}

TEST(ImportFormats, FourCoefficientsAreAPinholesUnlessSomebodySaysOtherwise) {
  const std::string size = "image_width: 640\nimage_height: 480\n";
  const std::string four = "0.01, -0.02, 0.003, -0.0004";
  const std::string text = opencv("camera_matrix", "distortion_coefficients", four, size);
  const ForeignLens taken = read(text)[0];
  EXPECT_EQ(taken.lens.model, LensModel::kRadtan);
  EXPECT_EQ(taken.lens.p[1], -0.0004);
  ASSERT_EQ(taken.notes.size(), 1u);
  EXPECT_THAT(taken.notes[0], AllOf(HasSubstr("k1 k2 p1 p2"), HasSubstr("--model fisheye")));
  const ForeignLens asked = read(text, ForeignModel::kFisheye)[0];
  EXPECT_EQ(asked.lens.model, LensModel::kEquidistant);
  EXPECT_EQ(asked.lens.k[3], -0.0004);
  EXPECT_THAT(asked.notes, IsEmpty());
  for (const char* word : {"fisheye_model: 1\n", "distortion_model: fisheye\n",
                           "model: \"equidistant\"\n", "fisheye: true\n"}) {
    const ForeignLens lens = read(opencv("K", "D", four, size + word))[0];
    EXPECT_EQ(lens.lens.model, LensModel::kEquidistant) << word;
  }
  const ForeignLens not_fisheye = read(opencv("K", "D", four, size + "fisheye_model: 0\n"))[0];
  EXPECT_EQ(not_fisheye.lens.model, LensModel::kRadtan);
  EXPECT_THAT(not_fisheye.notes, IsEmpty());
  const ForeignLens overruled =
      read(opencv("K", "D", four, size + "fisheye_model: 0\n"), ForeignModel::kFisheye)[0];
  EXPECT_EQ(overruled.lens.model, LensModel::kEquidistant);
  EXPECT_EQ(overruled.notes.size(), 1u);
}

TEST(ImportFormats, OpenCvsXmlAndJson) {
  expect_lens(
      read("<?xml version=\"1.0\"?>\n<opencv_storage>\n"
           "<calibration_time>\"Tue 15 Jan\"</calibration_time>\n<image_Width>640</image_Width>\n"
           "<image_Height>480</image_Height>\n<!-- flags: +fix_aspectRatio -->\n"
           "<Camera_Matrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n"
           "  <dt>d</dt>\n  <data>\n    420.5 0. 322. 0.\n    421.5 238. 0. 0. 1.</data>"
           "</Camera_Matrix>\n<Distortion_Coefficients type_id=\"opencv-matrix\">\n"
           "  <rows>5</rows>\n  <cols>1</cols>\n  <dt>d</dt>\n  <data>\n    -2.8e-01 7e-02 2e-04\n"
           "    -1e-04 1e-02</data></Distortion_Coefficients>\n</opencv_storage>\n")[0],
      kPlumbBob);
  expect_lens(
      read("{\n  \"image_width\": 640, \"image_height\": 480,\n  \"camera_matrix\": {\n"
           "    \"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\",\n"
           "    \"data\": [ 420.5, 0.0, 322.0, 0.0, 421.5, 238.0, 0.0, 0.0, 1.0 ] },\n"
           "  \"distortion_coefficients\": { \"type_id\": \"opencv-matrix\", \"rows\": 1,\n"
           "    \"cols\": 5, \"dt\": \"d\", \"data\": [ -0.28, 0.07, 0.0002, -0.0001, 0.01 ] }\n}")
          [0],
      kPlumbBob);
  // As Python dumps its arrays.
  expect_lens(
      read("{\"mtx\": [[420.5, 0, 322], [0, 421.5, 238], [0, 0, 1]],\n"
           " \"dist\": [[-0.28, 0.07, 0.0002, -0.0001, 0.01]], \"image_size\": [640, 480]}")[0],
      kPlumbBob);
  expect_lens(
      read("camera_matrix:\n- [420.5, 0, 322]\n- [0, 421.5, 238]\n- [0, 0, 1]\n"
           "dist_coeff:\n- [-0.28, 0.07, 0.0002, -0.0001, 0.01]\nwidth: 640\nheight: 480\n")[0],
      kPlumbBob);
}

TEST(ImportFormats, OpenCvsStereoFilesHaveTwoCameras) {
  const std::string matrix =
      ": !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 420.5, 0., 322., 0., 421.5, 238., 0., 0., 1. ]\n";
  const std::string coefficients =
      ": !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [ -0.28, 0.07, 0.0002, -0.0001, 0.01 ]\n";
  const Lenses numbered = read("%YAML:1.0\n---\nM1" + matrix + "D1" + coefficients + "M2" + matrix +
                               "D2" + coefficients + "R" + matrix + "P1" + matrix);
  ASSERT_EQ(numbered.size(), 2u);
  EXPECT_EQ(numbered[0].camera, "1");
  EXPECT_EQ(numbered[1].camera, "2");
  expect_lens(numbered[1], with_size(kPlumbBob, 0, 0));
  const Lenses named = read("%YAML:1.0\n---\nleft_camera_matrix" + matrix +
                            "left_distortion_coefficients" + coefficients + "right_camera_matrix" +
                            matrix + "right_distortion_coefficients" + coefficients);
  ASSERT_EQ(named.size(), 2u);
  EXPECT_EQ(named[0].camera, "left");
  expect_lens(named[1], with_size(kPlumbBob, 0, 0));
}

TEST(ImportFormats, OpenCvsOmnidirectionalCamera) {
  const ForeignLens lens = read(
      "%YAML:1.0\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 420.5, 0., 322., 0., 421.5, 238., 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 4\n   dt: d\n"
      "   data: [ -0.28, 0.07, 0.0002, -0.0001 ]\nxi: 1.25\n"
      "image_width: 640\nimage_height: 480\n")[0];
  EXPECT_EQ(lens.lens.model, LensModel::kOmni);
  EXPECT_EQ(lens.lens.xi, 1.25);
  EXPECT_EQ(lens.lens.k[1], 0.07);
}

// --- Keys for each number -----------------------------------------------------------------------

std::string basalt(const std::string& type, const std::string& numbers) {
  return "{\n  \"value0\": {\n \"T_imu_cam\": [{\"px\": 0.1}],\n \"intrinsics\": [\n"
         "  {\"camera_type\": \"" +
         type + "\", \"intrinsics\": {\"fx\": 420.5, \"fy\": 421.5, \"cx\": 322, \"cy\": 238" +
         (numbers.empty() ? "" : ", " + numbers) +
         "}}],\n \"resolution\": [[640, 480]], \"vignette\": [], \"mocap_time_offset_ns\": 0}}\n";
}

TEST(ImportFormats, BasaltsCameraTypes) {
  Lens lens = with_size(pinhole(420.5, 421.5, 322, 238, {0, 0, 0, 0, 0}), 640, 480);
  expect_lens(read(basalt("pinhole", ""))[0], lens);
  expect_lens(read(basalt("pinhole-radtan8",
                          "\"k1\": 0.5, \"k2\": 0.1, \"p1\": 0.001, \"p2\": -0.002, \"k3\": 0.01, "
                          "\"k4\": 0.85, \"k5\": 0.25, \"k6\": 0.02, \"rpmax\": 2.5"))[0],
              kRational);
  lens.model = LensModel::kDoubleSphere;
  lens.xi = -0.2;
  lens.alpha = 0.6;
  expect_lens(read(basalt("ds", "\"xi\": -0.2, \"alpha\": 0.6"))[0], lens);
  lens.model = LensModel::kEucm;
  lens.xi = 0.0;
  expect_lens(read(basalt("ucm", "\"alpha\": 0.6"))[0], lens);
  lens.beta = 1.1;
  expect_lens(read(basalt("eucm", "\"alpha\": 0.6, \"beta\": 1.1"))[0], lens);
  lens = with_size(equidistant(420.5, 421.5, 322, 238, {0.1, 0.2, 0.3, 0.4}), 640, 480);
  expect_lens(read(basalt("kb4", "\"k1\": 0.1, \"k2\": 0.2, \"k3\": 0.3, \"k4\": 0.4"))[0], lens);
  lens.k = {};
  lens.model = LensModel::kFov;
  lens.w = 0.9;
  expect_lens(read(basalt("fov", "\"w\": 0.9"))[0], lens);
  EXPECT_THAT(refusal_of(basalt("magic", "")), HasSubstr("'magic'"));
  EXPECT_THAT(refusal_of(basalt("ds", "\"xi\": 0.1")), HasSubstr("no alpha"));
  std::string two = basalt("pinhole", "");
  two.replace(two.find("}}],"), 4,
              "}}, " + std::string("{\"camera_type\": \"bal\", \"intrinsics\": {\"f\": 1}}],"));
  const Lenses both = read(two);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].camera, "cam1");
  EXPECT_THAT(both[1].refused, HasSubstr("principal point"));
  EXPECT_THAT(both[0].refused, IsEmpty());
}

std::string vins(const std::string& type, const std::string& rest) {
  return "%YAML:1.0\n\nimu_topic: \"/imu0\"\nmodel_type: " + type +
         "\ncamera_name: camera\nimage_width: 640\nimage_height: 480\n" + rest +
         "extrinsicRotation: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
         "   data: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]\nmax_cnt: 150\n";
}

TEST(ImportFormats, CamodocalsModels) {
  const std::string d =
      "distortion_parameters:\n   k1: -0.28\n   k2: 0.07\n   p1: 0.0002\n"
      "   p2: -0.0001\n";
  Lens lens = kPlumbBob;
  lens.k[2] = 0.0;
  expect_lens(read(vins("PINHOLE", d + "projection_parameters:\n   fx: 420.5\n   fy: 421.5\n"
                                       "   cx: 322\n   cy: 238\n"))[0],
              lens);
  lens.model = LensModel::kOmni;
  lens.xi = 2.2;
  expect_lens(read(vins("MEI", "mirror_parameters:\n   xi: 2.2\n" + d +
                                   "projection_parameters:\n   gamma1: 420.5\n   gamma2: 421.5\n"
                                   "   u0: 322\n   v0: 238\n"))[0],
              lens);
  expect_lens(read(vins("KANNALA_BRANDT",
                        "projection_parameters:\n   k2: 0.01\n   k3: -0.02\n   k4: 0.003\n"
                        "   k5: -0.0004\n   mu: 201.5\n   mv: 202.5\n   u0: 310.25\n"
                        "   v0: 240.75\n"))[0],
              kFisheye);
  EXPECT_THAT(refusal_of(vins("GENERAL",
                              "projection_parameters:\n   fx: 1\n   fy: 1\n   cx: 1\n"
                              "   cy: 1\n")),
              HasSubstr("'GENERAL'"));
  // VINS-Fusion and OpenVINS name other files.
  EXPECT_THAT(error_of("%YAML:1.0\ncam0_calib: \"cam0_mei.yaml\"\nimage_width: 752\n"),
              AllOf(HasSubstr("cam0_mei.yaml"), HasSubstr("give that file")));
  EXPECT_THAT(error_of("%YAML:1.0\nrelative_config_imucam: \"kalibr_imucam_chain.yaml\"\n"),
              HasSubstr("kalibr_imucam_chain.yaml"));
}

TEST(ImportFormats, OrbSlamsKeys) {
  const std::string tail =
      "Camera.fps: 30\nORBextractor.nFeatures: 1000\nViewer.CameraSize: 0.08\n";
  for (const std::string& camera : {std::string("Camera"), std::string("Camera1")}) {
    const auto key = [&camera](const char* name, const char* value) {
      return camera + "." + name + ": " + value + "\n";
    };
    const std::string f =
        key("fx", "420.5") + key("fy", "421.5") + key("cx", "322.0") + key("cy", "238");
    const std::string size = "Camera.width: 640\nCamera.height: 480\n";
    const std::string d = key("k1", "-0.28") + key("k2", "0.07") + key("p1", "0.0002") +
                          key("p2", "-0.0001") + key("k3", "0.01");
    expect_lens(read("%YAML:1.0\n\n#-----\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n" + f +
                     d + size + tail)[0],
                kPlumbBob);
    const Lens fisheye =
        read("%YAML:1.0\nCamera.type: \"KannalaBrandt8\"\n" + f + key("k1", "0.1") +
             key("k2", "0.2") + key("k3", "0.3") + key("k4", "0.4") + size + tail)[0]
            .lens;
    EXPECT_EQ(fisheye.model, LensModel::kEquidistant);
    EXPECT_EQ(fisheye.k[3], 0.4);
    EXPECT_EQ(fisheye.width_px, 640);
    const ForeignLens rectified =
        read("%YAML:1.0\nCamera.type: \"Rectified\"\n" + f + size + tail)[0];
    EXPECT_THAT(rectified.refused, IsEmpty());
    EXPECT_EQ(rectified.lens.model, LensModel::kRadtan);
    EXPECT_EQ(rectified.notes.size(), 1u);
  }
  // ORB-SLAM2: no type, no size.
  expect_lens(read("%YAML:1.0\nCamera.fx: 420.5\nCamera.fy: 421.5\nCamera.cx: 322\nCamera.cy: 238\n"
                   "Camera.k1:-0.28\nCamera.k2:0.07\nCamera.p1: 0.0002\nCamera.p2: -0.0001\n"
                   "Camera.k3: 0.01\n" +
                   tail)[0],
              with_size(kPlumbBob, 0, 0));
  // Two cameras.
  const Lenses two = read(
      "%YAML:1.0\nCamera.type: \"KannalaBrandt8\"\nCamera1.fx: 1\nCamera1.fy: 1\nCamera1.cx: 1\n"
      "Camera1.cy: 1\nCamera1.k1: 0\nCamera1.k2: 0\nCamera1.k3: 0\nCamera1.k4: 0\n"
      "Camera2.fx: 1\nCamera2.fy: 1\nCamera2.cx: 1\nCamera2.cy: 1\nCamera2.k1: 0\nCamera2.k2: 0\n"
      "Camera2.k3: 0\nCamera2.k4: 0\nCamera.width: 512\nCamera.height: 512\n");
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].camera, "Camera2");
  EXPECT_EQ(two[1].lens.model, LensModel::kEquidistant);
  EXPECT_EQ(two[1].lens.width_px, 512);
}

TEST(ImportFormats, PlainKeysOfOthers) {
  // stella_vslam.
  expect_lens(read("Camera:\n  name: a\n  setup: monocular\n  model: perspective\n  fx: 420.5\n"
                   "  fy: 421.5\n  cx: 322\n  cy: 238\n  k1: -0.28\n  k2: 0.07\n  p1: 0.0002\n"
                   "  p2: -0.0001\n  k3: 0.01\n  cols: 640\n  rows: 480\n")[0],
              kPlumbBob);
  // librealsense.
  expect_lens(read("{\"width\": 640, \"height\": 480, \"ppx\": 322, \"ppy\": 238, \"fx\": 420.5, "
                   "\"fy\": 421.5, \"model\": \"Brown Conrady\", "
                   "\"coeffs\": [-0.28, 0.07, 0.0002, -0.0001, 0.01]}")[0],
              kPlumbBob);
  EXPECT_THAT(refusal_of("{\"width\": 640, \"height\": 480, \"ppx\": 322, \"ppy\": 238, "
                         "\"fx\": 420.5, \"fy\": 421.5, \"model\": \"Inverse Brown Conrady\", "
                         "\"coeffs\": [-0.28, 0.07, 0.0002, -0.0001, 0.01]}"),
              HasSubstr("Inverse Brown Conrady"));
  // nerfstudio.
  const Lens lens = read(
                        "{\"camera_model\": \"OPENCV_FISHEYE\", \"fl_x\": 201.5, \"fl_y\": 202.5, "
                        "\"cx\": 310.25, \"cy\": 240.75, \"w\": 640, \"h\": 480, \"k1\": 0.01, "
                        "\"k2\": -0.02, \"k3\": 0.003, \"k4\": -0.0004, \"frames\": []}")[0]
                        .lens;
  EXPECT_EQ(lens, kFisheye);
  EXPECT_THAT(refusal_of("fx: 420\nfy: 420\ncx: 320\ncy: 240\nk1: 0.1\nk2: 0\nk3: 0\nk4: 0.1\n"),
              HasSubstr("--model"));
}

// --- Formats of their own -----------------------------------------------------------------------

TEST(ImportFormats, OCamCalibsResults) {
  const std::string text =
      "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These "
      "are used by cam2world\n\n5 -4.5e+02 0.0 7.0e-04 6.0e-08 1.4e-10 \n\n"
      "#polynomial coefficients for the inverse mapping function\n\n3 750.5 530.25 108.0 \n\n"
      "#center: \"row\" and \"column\", starting from 0 (C convention)\n\n577.5 983.25\n\n"
      "#affine parameters \"c\", \"d\", \"e\"\n\n1.0002 -0.058 0.0582\n\n"
      "#image size: \"height\" and \"width\"\n\n1096 1948\n\n";
  const ForeignLens lens = read(text)[0];
  EXPECT_THAT(lens.refused, IsEmpty());
  EXPECT_EQ(lens.lens.model, LensModel::kScaramuzza);
  EXPECT_EQ(lens.lens.width_px, 1948);
  EXPECT_EQ(lens.lens.cu_px, 983.25);
  EXPECT_EQ(lens.lens.cv_px, 577.5);
  EXPECT_EQ(lens.lens.polynomial[2], 7.0e-4);
  EXPECT_EQ(lens.lens.inverse_polynomial[1], 530.25);
  EXPECT_EQ(lens.lens.d, -0.058);
  EXPECT_THAT(error_of(text.substr(0, text.find("#affine"))), HasSubstr("five lines of numbers"));
  std::string wrong = text;
  wrong.replace(wrong.find("5 -4.5"), 1, "6");
  EXPECT_THAT(error_of(wrong), HasSubstr("five lines of numbers"));
}

TEST(ImportFormats, ColmapsCameras) {
  const std::string head =
      "# Camera list with one line of data per camera:\n"
      "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n# Number of cameras: 1\n";
  const auto centred = [](Lens lens) {
    lens.cu_px -= 0.5;
    lens.cv_px -= 0.5;
    return lens;
  };
  Lens lens = centred(kPlumbBob);
  lens.k[2] = 0.0;
  expect_lens(read(head + "1 OPENCV 640 480 420.5 421.5 322 238 -0.28 0.07 0.0002 -0.0001\n")[0],
              lens);
  expect_lens(
      read("1 OPENCV_FISHEYE 640 480 201.5 202.5 310.25 240.75 0.01 -0.02 0.003 -0.0004\n")[0],
      centred(kFisheye));
  expect_lens(read("1 FULL_OPENCV 640 480 420.5 421.5 322 238 0.5 0.1 0.001 -0.002 0.01 0.85 0.25 "
                   "0.02\n")[0],
              centred(kRational));
  const Lenses several =
      read(head +
           "1 SIMPLE_PINHOLE 640 480 400 320 240\n2 PINHOLE 640 480 400 401 320 240\n"
           "3 SIMPLE_RADIAL 640 480 400 320 240 -0.1\n4 RADIAL 640 480 400 320 240 -0.1 0.02\n"
           "5 FOV 640 480 400 401 320 240 0.9\n6 SIMPLE_RADIAL_FISHEYE 640 480 200 320 240 0.01\n"
           "7 THIN_PRISM_FISHEYE 640 480 1 1 1 1 1 1 1 1 1 1 1 1\n8 OPENCV 640 480 1 2 3\n");
  ASSERT_EQ(several.size(), 8u);
  EXPECT_EQ(several[0].lens.fv_px, 400);
  EXPECT_EQ(several[1].lens.fv_px, 401);
  EXPECT_EQ(several[2].lens.k[0], -0.1);
  EXPECT_EQ(several[3].lens.k[1], 0.02);
  EXPECT_EQ(several[3].lens.cv_px, 239.5);
  EXPECT_EQ(several[4].lens.w, 0.9);
  EXPECT_EQ(several[5].lens.model, LensModel::kEquidistant);
  EXPECT_THAT(several[6].refused, HasSubstr("THIN_PRISM_FISHEYE"));
  EXPECT_THAT(several[7].refused, HasSubstr("8 parameters"));
  EXPECT_EQ(several[7].camera, "8");
}

TEST(ImportFormats, MrptsIniFile) {
  const std::string text =
      "[CAMERA_PARAMS]\nresolution=[640 480]\ncx=322.0   // a comment\ncy=238.0\nfx=420.5\n"
      "fy=421.5\ndist=[-2.8e-01 7e-02 2e-04 -1e-04 1e-02 0 0 0]\nfocal_length=0\n"
      "camera_name=x\n";
  const ForeignLens lens = read(text)[0];
  EXPECT_EQ(lens.format, "MRPT");
  EXPECT_EQ(lens.camera, "CAMERA_PARAMS");
  expect_lens(lens, kPlumbBob);
}

TEST(ImportFormats, OtherIniFiles) {
  const Lenses lenses = read(
      "[LEFT_CAM_HD]\nfx=420.5\nfy=421.5\ncx=322\ncy=238\nk1=-0.28\nk2=0.07\np1=0.0002\n"
      "p2=-0.0001\nk3=0.01\n\n[RIGHT_CAM_HD]\nfx=1\nfy=1\ncx=1\ncy=1\nk1=0\nk2=0\np1=0\np2=0\n"
      "[STEREO]\nBaseline=63\n");
  ASSERT_EQ(lenses.size(), 2u);
  EXPECT_EQ(lenses[1].camera, "RIGHT_CAM_HD");
  expect_lens(lenses[0], with_size(kPlumbBob, 0, 0));
}

TEST(ImportFormats, KeysInMapsOfTheirOwn) {
  expect_lens(read("resolution_width: 640\nresolution_height: 480\ndistortion_model: radtan\n"
                   "intrinsics:\n   fx: 420.5\n   fy: 421.5\n   cx: 322\n   cy: 238\n"
                   "distortion_coeffs:\n   k1: -0.28\n   k2: 0.07\n   p1: 0.0002\n   p2: -0.0001\n"
                   "   k3: 0.01\n")[0],
              kPlumbBob);
  expect_lens(read("{\"cameras\": [{\"focalLengthX\": 201.5, \"focalLengthY\": 202.5, "
                   "\"principalPointX\": 310.25, \"principalPointY\": 240.75, "
                   "\"model\": \"kannala-brandt4\", \"imageWidth\": 640, \"imageHeight\": 480, "
                   "\"distortionCoefficients\": [0.01, -0.02, 0.003, -0.0004]}]}")[0],
              kFisheye);
  // PhotonVision.
  expect_lens(read("{\"resolution\": {\"width\": 640, \"height\": 480}, \"cameraIntrinsics\": "
                   "{\"rows\": 3, \"cols\": 3, \"type\": 6, "
                   "\"data\": [420.5, 0, 322, 0, 421.5, 238, 0, 0, 1]}, \"distCoeffs\": "
                   "{\"rows\": 1, \"cols\": 5, \"type\": 6, "
                   "\"data\": [-0.28, 0.07, 0.0002, -0.0001, 0.01]}}")[0],
              kPlumbBob);
}

TEST(ImportFormats, KeysThatStandTwiceAreRefusedWhenTheyDiffer) {
  const std::string twice = "  resolution: [640, 480]\n";
  EXPECT_THAT(refusal_of(kKalibr + twice), IsEmpty());
  EXPECT_THAT(refusal_of(kKalibr + "  resolution: [752, 480]\n"),
              AllOf(HasSubstr("resolution"), HasSubstr("twice")));
  EXPECT_THAT(refusal_of("Camera.fx: 420\nCamera.fx: 421\nCamera.fy: 420\nCamera.cx: 320\n"
                         "Camera.cy: 240\n"),
              HasSubstr("fx stands twice"));
}

TEST(ImportFormats, DsosCameraFile) {
  Lens lens = kPlumbBob;
  lens.k[2] = 0.0;
  expect_lens(
      read("RadTan 420.5 421.5 322 238 -0.28 0.07 0.0002 -0.0001\n640 480\ncrop\n640 480\n")[0],
      lens);
  expect_lens(read("EquiDistant 201.5 202.5 310.25 240.75 0.01 -0.02 0.003 -0.0004\n640 480\n")[0],
              kFisheye);
  const Lens fov = read("0.5 0.75 0.5 0.5 0.9\n1280 1024\ncrop\n640 480\n")[0].lens;
  EXPECT_EQ(fov.model, LensModel::kFov);
  EXPECT_EQ(fov.fu_px, 640);
  EXPECT_EQ(fov.cv_px, 511.5);
}

// --- What is no calibration ---------------------------------------------------------------------

TEST(ImportFormats, WhatIsNoCalibrationIsRefused) {
  for (const char* text : {"", "\n", "a: 1\n", "[1, 2, 3]", "{}", "<a></a>", "hello", "- a\n- b\n",
                           "{\"value0\": {}}", "[section]\nkey = 1\n", "1 2 3\n4 5 6\n"}) {
    EXPECT_THAT(error_of(text), AllOf(StartsWith("file: "), HasSubstr("found none of their keys")))
        << text;
  }
  EXPECT_THAT(error_of("a: [1\n"), StartsWith("file: line "));
  EXPECT_THAT(error_of("{\"a\": 1"), HasSubstr("parse error"));
  EXPECT_THAT(error_of("<a><b></a>"), HasSubstr("closes nothing"));
  EXPECT_THAT(error_of("<a><b>"), HasSubstr("never closed"));
}

TEST(ImportFormats, DeepAndEndlessFilesAreRefused) {
  for (const std::string& piece :
       {std::string("["), std::string("{"), std::string("- "), std::string("{\"a\":"),
        std::string("[1,"), std::string("<a>"), std::string("a: {"), std::string("!")}) {
    std::string text;
    while (text.size() < 100'000) text += piece;
    EXPECT_NE(error_of(text), "was read") << piece;
    EXPECT_LT(error_of(text).size(), 1000u);
  }
  std::string bomb = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (char c = 'b'; c <= 'i'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    bomb += std::string(1, c) + ": &" + c + " [*" + before;
    for (int i = 0; i < 8; ++i) bomb += ", *" + before;
    bomb += "]\n";
  }
  EXPECT_THAT(error_of(bomb), HasSubstr("no calibration is like that"));
}

TEST(ImportFormats, NumbersThatAreNoneAreRefused) {
  for (const char* number : {".nan", "nan", "NaN", ".inf", "-.inf", "1e999"}) {
    const ForeignLens lens = read(kalibr(
        "pinhole", "[" + std::string(number) + ", 421.5, 322, 238]", "radtan", "[0, 0, 0, 0]"))[0];
    EXPECT_FALSE(std::isfinite(lens.lens.fu_px)) << number;  // native_lens() refuses it
  }
  for (const char* number : {"abc", "1,5", "0x10", "1.2.3", "--1"}) {
    EXPECT_THAT(refusal_of(kalibr("pinhole", "[" + std::string(number) + ", 421.5, 322, 238]",
                                  "radtan", "[0, 0, 0, 0]")),
                testing::Not(IsEmpty()))
        << number;
  }
}

}  // namespace
}  // namespace zenith::tools
