// Files that are no calibration, that lost a part, or that contradict themselves.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/import_files.h"
#include "tools/calibrate/import/native_lens.h"

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

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

// --- Files that lost something -------------------------------------------------------------------

const std::string kCalibration =
    "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [420.5, 0, 322, 0, 421.5, 238, 0, 0, 1]\ndistortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n"
    "  data: [-0.28, 0.07, 0.0002, -0.0001, 0.01]\n";

std::string with(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.substr(0, at) + to + text.substr(at + from.size());
}

TEST(ImportDamaged, MatricesHaveAsManyNumbersAsTheySay) {
  expect_lens(read(kCalibration)[0], kPlumbBob);
  EXPECT_THAT(refusal_of(with(kCalibration, "cols: 5", "cols: 8")),
              AllOf(HasSubstr("5 numbers"), HasSubstr("are 8")));
  EXPECT_THAT(refusal_of(with(kCalibration, "rows: 3", "rows: 2")), HasSubstr("9 numbers"));
  EXPECT_THAT(refusal_of(with(kCalibration, ", 0.01]", "]")), HasSubstr("4 numbers"));
  EXPECT_THAT(refusal_of("<?xml version=\"1.0\"?><opencv_storage><K><rows>3</rows><cols>3</cols>"
                         "<dt>d</dt><data>1 0 1 0 1 1 0 0</data></K><D><rows>1</rows>"
                         "<cols>4</cols><dt>d</dt><data>0 0 0 0</data></D></opencv_storage>"),
              HasSubstr("8 numbers"));
  // OpenCV's matrices may have several channels.
  const std::string channels = with(kCalibration, "cols: 5", "cols: 1\n  dt: \"5d\"");
  EXPECT_THAT(refusal_of(channels), IsEmpty());
}

TEST(ImportDamaged, ACameraMatrixEndsWithOne) {
  for (const char* end : {"0, 0, 0]", "0, 0, 2]", "0, 0, -1]"}) {
    EXPECT_THAT(refusal_of(with(kCalibration, "0, 0, 1]", end)), HasSubstr("expected 1")) << end;
  }
}

TEST(ImportDamaged, CoefficientsThatAProgramAlwaysWritesAreMissed) {
  const std::string size = "%YAML:1.0\nimage_width: 640\nimage_height: 480\n";
  const std::string vins =
      size +
      "model_type: PINHOLE\ncamera_name: a\ndistortion_parameters:\n   k1: -0.28\n"
      "   k2: 0.07\n   p1: 0.0002\n   p2: -0.0001\nprojection_parameters:\n   fx: 420.5\n"
      "   fy: 421.5\n   cx: 322\n   cy: 238\n";
  EXPECT_THAT(refusal_of(vins), IsEmpty());
  EXPECT_THAT(refusal_of(with(vins, "   p2: -0.0001\n", "")), HasSubstr("there is no p2"));
  EXPECT_THAT(refusal_of(with(vins, "distortion_parameters", "d")), HasSubstr("there is no k1"));
  const std::string mei =
      with(with(with(vins, "PINHOLE", "MEI\nmirror_parameters:\n   xi: 1.5"), "fx:", "gamma1:"),
           "   p1: 0.0002\n", "");
  EXPECT_THAT(refusal_of(mei), HasSubstr("there is no p1"));
  EXPECT_THAT(refusal_of("Camera.type: \"PinHole\"\nCamera.fx: 420\nCamera.fy: 420\n"
                         "Camera.cx: 320\nCamera.cy: 240\nCamera.k1: -0.2\n"),
              HasSubstr("there is no k2"));
  EXPECT_THAT(refusal_of("{\"value0\": {\"intrinsics\": [{\"camera_type\": \"pinhole-radtan8\", "
                         "\"intrinsics\": {\"fx\": 420, \"fy\": 420, \"cx\": 320, \"cy\": 240, "
                         "\"k1\": 0.1, \"k2\": 0, \"p1\": 0, \"p2\": 0}}]}}"),
              HasSubstr("there is no k3"));
  // Where anything may have written the file, what is taken for zero is said.
  EXPECT_THAT(read("fx: 420\nfy: 420\ncx: 320\ncy: 240\nk1: -0.2\nk2: 0.1\n")[0].notes,
              testing::ElementsAre(HasSubstr("no p1, p2")));
}

TEST(ImportDamaged, SizesThatAreNoneAreNamed) {
  for (const auto& [size, shown] :
       std::vector<std::pair<std::string, std::string>>{{"[0, 0]", "0 x 0"},
                                                        {"[640.5, 480]", "640.5 x 480"},
                                                        {"[-640, 480]", "-640 x 480"},
                                                        {"[640]", "1 number"},
                                                        {"wide", "wide"}}) {
    const ForeignLens lens = read(with(kKalibr, "[640, 480]", size))[0];
    EXPECT_EQ(lens.odd_size, shown);
    const auto native = native_lens(lens, {});
    ASSERT_FALSE(native.ok()) << size;
    EXPECT_THAT(native.error().message, AllOf(HasSubstr("'" + shown + "'"), HasSubstr("--size")));
    EXPECT_TRUE(native_lens(lens, {{{640, 480}}, {}}).ok()) << size;
  }
  expect_lens(read(with(kKalibr, "[640, 480]", "640x480"))[0], kFisheye);
}

TEST(ImportDamaged, WindowsOutsideOfTheImageAreRefused) {
  const std::string roi = kCalibration +
                          "rectification_matrix: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nroi: {x_offset: 300, "
                          "y_offset: 0, width: 340, height: 480}\n";
  EXPECT_EQ(read(roi)[0].lens.cu_px, 22);
  EXPECT_THAT(refusal_of(with(roi, "width: 340", "width: 640")), HasSubstr("region of interest"));
  EXPECT_THAT(refusal_of(with(roi, "x_offset: 300", "x_offset: -3")),
              HasSubstr("region of interest"));
  for (const char* binning : {"-2", "1.5", "1e9", "nan"}) {
    EXPECT_THAT(refusal_of(roi + "binning_x: " + binning + "\n"), HasSubstr("binning_x"))
        << binning;
  }
}

TEST(ImportDamaged, PolynomialsThatContradictEachOtherAreNamed) {
  const std::string text =
      "#polynomial coefficients\n5 -4.5e+02 0.0 7.0e-04 6.0e-08 1.4e-10\n3 750.5 530.25 108.0\n"
      "577.5 983.25\n1.0002 -0.058 0.0582\n1096 1948\n";
  EXPECT_THAT(read(text)[0].notes, testing::ElementsAre(HasSubstr("contradict each other")));
}

TEST(ImportDamaged, KeysAreMergedAsYamlMergesThem) {
  const Lenses lenses = read(with(kKalibr, "cam0:", "cam0: &first") +
                             "cam1:\n  <<: *first\n  intrinsics: [191.5, 192.5, 311, 241]\n");
  ASSERT_EQ(lenses.size(), 2u);
  expect_lens(lenses[0], kFisheye);
  EXPECT_EQ(lenses[1].camera, "cam1");
  EXPECT_EQ(lenses[1].lens.fu_px, 191.5);
  EXPECT_EQ(lenses[1].lens.k, kFisheye.k);
}

TEST(ImportDamaged, AModelThatColmapDoesNotHaveIsThatCamerasFault) {
  const Lenses lenses =
      read("1 OPENCV 640 480 420.5 421.5 322 238 -0.28 0.07 0.0002 -0.0001\n2 FOO 640 480 1 2 3\n");
  ASSERT_EQ(lenses.size(), 2u);
  EXPECT_THAT(lenses[0].refused, IsEmpty());
  EXPECT_THAT(lenses[1].refused, HasSubstr("FOO"));
}

TEST(ImportDamaged, OtherThingsThanCalibrationsAreNamed) {
  EXPECT_THAT(error_of("<!DOCTYPE html>\n<html><title>404</title>"), HasSubstr("web page"));
  EXPECT_THAT(error_of("version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 1\n"),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(error_of(std::string("\x01\0\0\0", 4)), HasSubstr("binary file"));
  EXPECT_THAT(error_of(with(kKalibr, "intrinsics", "intrinsic")), HasSubstr("cam0.intrinsic"));
}

}  // namespace
}  // namespace zenith::tools
