// Formats that list their numbers, with made-up ones: Kalibr and its kin, ROS, OpenCV.

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/import_files.h"

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// --- Kalibr and its kin -------------------------------------------------------------------------

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
  const auto cols = 1 + std::count(coefficients.begin(), coefficients.end(), ',');
  return "image_width: 640\nimage_height: 480\ncamera_name: narrow\n"
         "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [420.5, 0, 322, 0, 421.5, 238, 0, 0, 1]\n" +
         (model.empty() ? "" : "distortion_model: " + model + "\n") +
         "distortion_coefficients:\n  rows: 1\n  cols: " + std::to_string(cols) + "\n  data: [" +
         coefficients +
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

TEST(ImportFormats, RosWindowsAndBinningChangeAllNumbers) {
  const ForeignLens lens =
      read(ros("plumb_bob", "-0.28, 0.07, 0.0002, -0.0001, 0.01") +
           "binning_x: 2\nbinning_y: 4\nroi: {x_offset: 40, y_offset: 20, width: 560, "
           "height: 440}\n")[0];
  Lens expected = with_size(kPlumbBob, 280, 110);
  expected.fu_px = 420.5 / 2.0;
  expected.fv_px = 421.5 / 4.0;
  expected.cu_px = (322.0 - 40.0 + 0.5) / 2.0 - 0.5;
  expected.cv_px = (238.0 - 20.0 + 0.5) / 4.0 - 0.5;
  expect_lens(lens, expected);
  EXPECT_EQ(lens.notes.size(), 2u);
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
  const auto rows = 1 + std::count(coefficients.begin(), coefficients.end(), ',');
  return "%YAML:1.0\n---\n" + more + matrix +
         ": !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
         "   data: [ 420.5, 0., 322., 0.,\n       421.5, 238., 0., 0., 1. ]\n" +
         distortion + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: 1\n   dt: d\n   data: [ " + coefficients + " ]\n";
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

}  // namespace
}  // namespace zenith::tools
