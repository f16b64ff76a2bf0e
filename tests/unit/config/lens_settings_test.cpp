#include "platform/config/lens_settings.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/lenses.h"

namespace zenith {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string refusal(const Lens& lens) {
  const Status good = check_lens(lens);
  return good ? "" : good.error().message;
}

TEST(LensSettings, LensesThatExistPass) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    EXPECT_EQ(refusal(lens), "") << name;
  }
}

TEST(LensSettings, EveryNumberOfAModelHasItsKeyAndRange) {
  for (int i = 0; i < kLensModels; ++i) {
    const auto model = static_cast<LensModel>(i);
    EXPECT_EQ(find_lens_model(lens_model_name(model)), model);
    for (const LensNumber& number : lens_numbers(model)) {
      EXPECT_TRUE(lens_model_has(model, number.key)) << number.key;
      Lens lens;
      int settings = 0;
      for (const Setting& setting : lens_settings(lens)) {
        settings += setting.key == "lens." + std::string(number.key);
      }
      EXPECT_EQ(settings, 1) << number.key;
    }
  }
  EXPECT_FALSE(find_lens_model("fisheye"));
}

TEST(LensSettings, NumbersThatNoCameraHasAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [name, good, whole] : lenses_of_all_models()) {
    for (const double bad : {nan, -150.0, 0.0, 1e9}) {
      Lens lens = good;
      lens.fu_px = bad;
      EXPECT_THAT(refusal(lens), HasSubstr("fu_px")) << name << ' ' << bad;
    }
    for (const double bad : {nan, -1.0, 5000.0, 1e300}) {
      Lens lens = good;
      lens.cv_px = bad;
      EXPECT_THAT(refusal(lens), HasSubstr("cv_px")) << name << ' ' << bad;
    }
    for (const LensNumber& number : lens_numbers(good.model)) {
      for (const double bad : {nan, 1e6, -1e6}) {
        Lens lens = good;
        number.at(lens) = bad;
        EXPECT_THAT(refusal(lens), HasSubstr(std::string(number.key) + " is ")) << name;
      }
    }
    Lens lens = good;
    lens.width_px = 0;
    EXPECT_THAT(refusal(lens), HasSubstr("width_px is 0, expected 16 .. 8192")) << name;
  }
}

TEST(LensSettings, NumbersOfOtherModelsAreRefused) {
  Lens lens;
  lens.xi = 0.5;
  EXPECT_THAT(refusal(lens),
              HasSubstr("xi is not a number of the model equidistant, which has k1"));
  lens = lens_of(LensModel::kDoubleSphere, 640, 480, 300.0);
  lens.k[1] = 0.1;
  EXPECT_THAT(refusal(lens), HasSubstr("k2 is not a number of the model double_sphere"));
  lens = Lens{};
  lens.polynomial[0] = -100.0;
  EXPECT_THAT(refusal(lens), HasSubstr("polynomial is the model scaramuzza's alone"));
  lens = Lens{};
  lens.model = LensModel::kScaramuzza;
  EXPECT_THAT(refusal(lens), HasSubstr("polynomial is missing"));
  EXPECT_THAT(refusal(lens), HasSubstr("fu_px and fv_px are expected to be 1"));
  lens.polynomial[0] = 120.0;
  EXPECT_THAT(refusal(lens), HasSubstr("begins with 120, expected a number below zero"));
  lens = lens_of(LensModel::kFov, 640, 480, 300.0);
  EXPECT_THAT(refusal(lens), HasSubstr("w is 0, expected an angle"));
}

// A fold is judged where the image is.
TEST(LensSettings, AFoldOutsideOfTheImageIsNone) {
  Lens lens = lens_of(LensModel::kRadtan, 640, 480, 300.0);
  lens.k[0] = -0.3;  // folds at 46.5 degrees, where the image's radius is 300 * 2 / 3 / 0.95 px
  EXPECT_EQ(refusal(lens), "");
  EXPECT_THAT(lens_note(lens), HasSubstr("folds back at 46.5 degrees from its axis, inside"));
  lens.fu_px = lens.fv_px = 700.0;
  EXPECT_EQ(refusal(lens), "");
  EXPECT_EQ(lens_note(lens), "");
  lens.fu_px = lens.fv_px = 300.0;
  lens.k[0] = -2.0;
  EXPECT_THAT(refusal(lens), HasSubstr("k1 and the other numbers (k1 k2 p1 p2 k3) fold the image "
                                       "over itself at 22.2 degrees"));
  // An equidistant curve that folds at 60 degrees, which a narrow image never shows.
  lens = lens_of(LensModel::kEquidistant, 640, 480, 700.0);
  lens.k[0] = -0.3;
  EXPECT_EQ(refusal(lens), "");
  EXPECT_EQ(lens_note(lens), "");
  // A fisheye whose image circle ends in the image is an ordinary one.
  lens = lens_of(LensModel::kDoubleSphere, 800, 800, 250.0);
  lens.xi = 0.2;
  lens.alpha = 0.62;
  EXPECT_EQ(lens_note(lens), "");
}

TEST(LensSettings, ALensThatShowsNextToNothingIsRefused) {
  Lens lens = lens_of(LensModel::kRadtan, 640, 480, 90000.0);
  EXPECT_THAT(refusal(lens), HasSubstr("show the world up to 0.3 degrees"));
  lens = lens_of(LensModel::kEquidistant, 640, 480, 1500.0);
  lens.k[0] = 900.0;
  EXPECT_THAT(refusal(lens), HasSubstr("show the world up to"));
}

TEST(LensSettings, TheTextHoldsAllNumbersOfTheModelAndNoOthers) {
  Lens lens = lens_of(LensModel::kEucm, 512, 400, 190.25);
  lens.fv_px = 191.0;
  lens.cu_px = 250.5;
  lens.cv_px = 201.0;
  lens.alpha = 0.625;
  EXPECT_EQ(lens_text(lens),
            "eucm, 512 x 400 px, fu 190.25 fv 191 cu 250.5 cv 201, alpha 0.625, beta 1");
  EXPECT_THAT(lens_text(Lens{}), Not(HasSubstr("alpha")));
}

}  // namespace
}  // namespace zenith
