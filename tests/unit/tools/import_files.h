#pragma once
// Small calibration files as texts, and the lenses that they are.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/calibrate/import/foreign_lens.h"

namespace zenith::tools {

using Lenses = std::vector<ForeignLens>;

inline Lenses read(const std::string& text, ForeignModel model = ForeignModel::kAsTheFileSays) {
  auto lenses = parse_foreign_lenses(text, "file", model);
  if (lenses) return *lenses;
  ADD_FAILURE() << lenses.error().message << "\n" << text;
  return Lenses(1);
}

inline std::string error_of(const std::string& text) {
  const auto lenses = parse_foreign_lenses(text, "file");
  return lenses.ok() ? "was read" : lenses.error().message;
}

inline std::string refusal_of(const std::string& text) {
  return read(text).front().refused;
}

inline Lens equidistant(double fu, double fv, double cu, double cv, std::vector<double> k) {
  Lens lens;
  lens.fu_px = fu;
  lens.fv_px = fv;
  lens.cu_px = cu;
  lens.cv_px = cv;
  std::copy(k.begin(), k.end(), lens.k.begin());
  return lens;
}

// k1 k2 p1 p2 k3 [k4 k5 k6]
inline Lens pinhole(double fu, double fv, double cu, double cv, std::vector<double> d) {
  Lens lens = equidistant(fu, fv, cu, cv, {d[0], d[1]});
  lens.model = d.size() > 5 ? LensModel::kRational : LensModel::kRadtan;
  lens.p = {d[2], d[3]};
  std::copy(d.begin() + 4, d.end(), lens.k.begin() + 2);
  return lens;
}

inline Lens with_size(Lens lens, int width, int height) {
  lens.width_px = width;
  lens.height_px = height;
  return lens;
}

inline void expect_lens(const ForeignLens& read, const Lens& expected) {
  EXPECT_THAT(read.refused, testing::IsEmpty());
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

inline const Lens kFisheye =
    equidistant(201.5, 202.5, 310.25, 240.75, {0.01, -0.02, 0.003, -0.0004});
inline const Lens kPlumbBob =
    pinhole(420.5, 421.5, 322.0, 238.0, {-0.28, 0.07, 0.0002, -0.0001, 0.01});
inline const Lens kRational =
    pinhole(420.5, 421.5, 322.0, 238.0, {0.5, 0.1, 0.001, -0.002, 0.01, 0.85, 0.25, 0.02});

inline const std::string kKalibr =
    "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
    "  distortion_coeffs: [0.01, -0.02,\n    0.003, -0.0004]\n"
    "  intrinsics: [201.5, 202.5, 310.25, 240.75]\n  resolution: [640, 480]\n"
    "  rostopic: /cam0/image_raw\n";

inline std::string kalibr(const std::string& model, const std::string& intrinsics,
                          const std::string& distortion, const std::string& coefficients) {
  return "cam0: {camera_model: " + model + ", intrinsics: " + intrinsics +
         ", distortion_model: " + distortion + ", distortion_coeffs: " + coefficients +
         ", resolution: [640, 480]}\n";
}

}  // namespace zenith::tools
