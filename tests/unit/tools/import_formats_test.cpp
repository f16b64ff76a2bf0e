// Formats that have a key for each number, and those that are neither YAML nor JSON nor XML, with
// made-up numbers.

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

}  // namespace
}  // namespace zenith::tools
