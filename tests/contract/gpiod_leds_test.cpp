// LEDs on real GPIO lines, emulated by the kernel's gpio-sim in a guest (tests/hil), where the
// level of a line can be read back from outside.
//
//   ZENITH_TEST_GPIO        label of a chip of gpio-sim with at least three lines
//   ZENITH_TEST_GPIO_SYSFS  the folder with its files sim_gpio<offset>/value

#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/led_output.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class GpiodLedsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* label = std::getenv("ZENITH_TEST_GPIO");
    const char* sysfs = std::getenv("ZENITH_TEST_GPIO_SYSFS");
    if (label == nullptr || sysfs == nullptr) {
      GTEST_SKIP()
          << "no emulated GPIO chip: ZENITH_TEST_GPIO and ZENITH_TEST_GPIO_SYSFS are not set";
    }
    label_ = label;
    sysfs_ = sysfs;
    for (const GpioChipInfo& chip : list_gpio_chips()) {
      if (chip.label == label_) chip_ = chip;
    }
    ASSERT_GE(chip_.lines.size(), 3u) << "no chip with the label " << label_ << " and three lines";
  }

  LedSetting by_label(int offset, bool active_low = false) const {
    return {"gpiochip-label:" + label_ + ":" + std::to_string(offset), active_low};
  }
  // Status and fault LED on lines 0 and 2; the latter is lit when low.
  std::unique_ptr<LedOutput> make() const {
    auto output = make_led_output({{by_label(0), {}, by_label(2, true)}});
    EXPECT_TRUE(output.ok());
    return std::move(*output);
  }
  int level(int offset) const {
    std::ifstream file(sysfs_ + "/sim_gpio" + std::to_string(offset) + "/value");
    int value = -1;
    file >> value;
    return value;
  }
  GpioLineInfo line(unsigned offset) const {
    const Result<GpioChipInfo> chip = read_gpio_chip(chip_.path);
    return chip.ok() ? chip->lines.at(offset) : GpioLineInfo();
  }

  std::string label_;
  std::string sysfs_;
  GpioChipInfo chip_;
};

TEST_F(GpiodLedsTest, LevelsFollowTheMask) {
  const auto leds = make();
  const Status opened = leds->open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ(level(0), 0);
  EXPECT_EQ(level(2), 1) << "active low: dark is high";
  ASSERT_TRUE(leds->set(kStatusLed).ok());
  EXPECT_EQ(level(0), 1);
  EXPECT_EQ(level(2), 1);
  ASSERT_TRUE(leds->set(kStatusLed | kFaultLed).ok());
  EXPECT_EQ(level(0), 1);
  EXPECT_EQ(level(2), 0);
  ASSERT_TRUE(leds->set(0).ok());
  EXPECT_EQ(level(0), 0);
  EXPECT_EQ(level(2), 1);
}

TEST_F(GpiodLedsTest, LinesAreOursWhileOpenAndDarkAndFreeAfterwards) {
  const auto leds = make();
  ASSERT_TRUE(leds->open().ok());
  EXPECT_TRUE(line(0).used);
  EXPECT_EQ(line(0).consumer, "zenith");
  EXPECT_FALSE(line(1).used);
  ASSERT_TRUE(leds->set(kStatusLed | kFaultLed).ok());
  leds->close();
  EXPECT_FALSE(line(0).used);
  EXPECT_FALSE(line(2).used);
  EXPECT_EQ(level(0), 0);
  ASSERT_TRUE(leds->open().ok()) << "again";
  EXPECT_TRUE(line(2).used);
}

TEST_F(GpiodLedsTest, AHeldLineIsToldAndTakenWhenItIsFree) {
  const auto first = make();
  const auto second = make();
  ASSERT_TRUE(first->open().ok());
  const Status opened = second->open();
  ASSERT_FALSE(opened.ok());
  EXPECT_THAT(opened.error().message, AllOf(HasSubstr("EBUSY"), HasSubstr("gpioinfo")));
  first->close();
  EXPECT_TRUE(second->open().ok());
}

TEST_F(GpiodLedsTest, LinesAreFoundByTheirNames) {
  const std::string name = chip_.lines[0].name;
  if (name.empty()) GTEST_SKIP() << "line 0 of the chip " << label_ << " has no name";
  auto leds = make_led_output({{LedSetting{"gpio:" + name, false}, {}, {}}});
  ASSERT_TRUE(leds.ok());
  const Status opened = (*leds)->open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  ASSERT_TRUE((*leds)->set(kStatusLed).ok());
  EXPECT_EQ(level(0), 1);
  EXPECT_THAT((*leds)->description(), AllOf(HasSubstr(name), HasSubstr(chip_.path + ":0")));
}

TEST_F(GpiodLedsTest, LinesAreFoundByThePathOfTheChip) {
  auto leds = make_led_output({{LedSetting{"gpiochip:" + chip_.path + ":1", false}, {}, {}}});
  ASSERT_TRUE(leds.ok());
  ASSERT_TRUE((*leds)->open().ok());
  ASSERT_TRUE((*leds)->set(kStatusLed).ok());
  EXPECT_EQ(level(1), 1);
}

}  // namespace
}  // namespace zenith
