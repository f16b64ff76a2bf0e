#include "tools/overrides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/config/words.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

TEST(Overrides, ChangeWhatTheyName) {
  const auto changed = apply_overrides({}, {"particles=400", "rectified_fov_deg=110.5"});
  ASSERT_TRUE(changed.ok());
  EXPECT_EQ(changed->particles, 400);
  EXPECT_EQ(changed->rectified_fov_deg, 110.5);
  EXPECT_EQ(changed->pixel_sigma_px, Parameters{}.pixel_sigma_px);
}

TEST(Overrides, TellEverythingThatIsWrongAtOnce) {
  const auto result =
      apply_overrides({}, {"particels=400", "particles=0", "particles=1.5", "particles=many",
                           "particles", "=3", "rectified_fov_deg=nan", "zzzzzzzzzzzz=1"});
  ASSERT_FALSE(result.ok());
  const std::string& message = result.error().message;
  EXPECT_THAT(message, HasSubstr("unknown parameter 'particels'; did you mean 'particles'"));
  EXPECT_THAT(message, HasSubstr("particles: 0 is outside 1 .. "));
  EXPECT_THAT(message, HasSubstr("particles: 1.5 is no whole number"));
  EXPECT_THAT(message, HasSubstr("particles: 'many' is no number"));
  EXPECT_THAT(message, HasSubstr("'particles' is no assignment"));
  EXPECT_THAT(message, HasSubstr("'=3' is no assignment"));
  EXPECT_THAT(message, HasSubstr("rectified_fov_deg: 'nan' is no number"));
  EXPECT_THAT(message, HasSubstr("unknown parameter 'zzzzzzzzzzzz'"));
}

TEST(Overrides, TheViewMayBeFittedToTheLens) {
  Parameters given;
  given.rectified_fov_deg = 90.0;
  const auto fitted = apply_overrides(given, {"rectified_fov_deg=auto"});
  ASSERT_TRUE(fitted.ok()) << fitted.error().message;
  EXPECT_EQ(fitted->rectified_fov_deg, kFittedView);
  EXPECT_FALSE(apply_overrides({}, {"rectified_fov_deg=0"}).ok());
  EXPECT_FALSE(apply_overrides({}, {"rectified_fov_deg=151"}).ok());
  EXPECT_FALSE(apply_overrides({}, {"gate_sigma=auto"}).ok());
}

TEST(Overrides, EveryParameterOfTheTableCanBeSetToItsEnds) {
  for (const ParameterInfo& info : parameter_table()) {
    for (const double value : {info.min, info.max}) {
      char text[128];
      std::snprintf(text, sizeof text, "%s=%.17g", std::string(info.key).c_str(), value);
      const auto set = apply_overrides({}, {text});
      EXPECT_TRUE(set.ok()) << text << ": " << (set.ok() ? "" : set.error().message);
    }
  }
}

TEST(NearestWords, AreNearAndFew) {
  const std::vector<std::string> known = {"corridor-rooms", "loop", "plain"};
  EXPECT_EQ(nearest_words("corridor_rooms", known), std::vector<std::string>{"corridor-rooms"});
  EXPECT_EQ(nearest_words("corridor", known), std::vector<std::string>{"corridor-rooms"});
  EXPECT_TRUE(nearest_words("xyzxyzxyz", known).empty());
}

}  // namespace
}  // namespace zenith::tools
