#include "drivers/leds/led_name.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/leds/gpio_chip.h"
#include "drivers/leds/led_output.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

void expect_name(const std::string& text, LedKind kind, const std::string& inner, unsigned offset) {
  SCOPED_TRACE(text);
  const Result<LedName> name = parse_led_name(text);
  ASSERT_TRUE(name.ok()) << name.error().message;
  EXPECT_EQ(name->kind, kind);
  EXPECT_EQ(name->text, inner);
  EXPECT_EQ(name->offset, offset);
}

TEST(LedName, ReadsEveryKind) {
  expect_name("", LedKind::kNone, "", 0);
  expect_name("gpio:STATUS LED", LedKind::kLineName, "STATUS LED", 0);
  expect_name("gpiochip-label:pinctrl-bcm2711:17", LedKind::kChipLabel, "pinctrl-bcm2711", 17);
  expect_name("gpiochip-label:9030000.pl061:x:0", LedKind::kChipLabel, "9030000.pl061:x", 0);
  expect_name("gpiochip:/dev/gpiochip3:4", LedKind::kChipPath, "/dev/gpiochip3", 4);
  expect_name("led:green:status", LedKind::kLedClass, "green:status", 0);
}

TEST(LedName, RefusesWhatNamesNothing) {
  for (const char* text :
       {"STATUS", "gpio:", "led:", "led:../../../etc", "led:a/b", "gpiochip-label:x",
        "gpiochip-label::3", "gpiochip-label:x:", "gpiochip-label:x:-1", "gpiochip-label:x:3a",
        "gpiochip-label:x:99999999999", "gpiochip:0:3", "GPIO:STATUS", " "}) {
    SCOPED_TRACE(text);
    const Result<LedName> name = parse_led_name(text);
    ASSERT_FALSE(name.ok());
    EXPECT_THAT(name.error().message, AllOf(HasSubstr("\"" + std::string(text) + "\""),
                                            HasSubstr("gpiochip-label:LABEL:OFFSET")));
  }
}

std::vector<GpioChipInfo> board() {
  return {{"/dev/gpiochip0", "gpiochip0", "soc", {{"A", "", false}, {}, {"TWICE", "", false}}},
          {"/dev/gpiochip1", "gpiochip1", "expander", {{"TWICE", "", false}, {"B", "", false}}},
          {"/dev/gpiochip2", "gpiochip2", "expander", {{}, {}, {}}}};
}

void expect_place(const std::string& text, const std::string& path, unsigned offset) {
  SCOPED_TRACE(text);
  const Result<GpioPlace> place = find_gpio_line(*parse_led_name(text), board());
  ASSERT_TRUE(place.ok()) << place.error().message;
  EXPECT_EQ(place->chip_path, path);
  EXPECT_EQ(place->offset, offset);
}

TEST(FindGpioLine, ByNameLabelOrPath) {
  expect_place("gpio:B", "/dev/gpiochip1", 1);
  expect_place("gpiochip-label:soc:2", "/dev/gpiochip0", 2);
  expect_place("gpiochip:/dev/gpiochip1:0", "/dev/gpiochip1", 0);
  // Two expanders, but only one has so many lines.
  expect_place("gpiochip-label:expander:2", "/dev/gpiochip2", 2);
}

std::string error_of(const std::string& text) {
  const Result<GpioPlace> place = find_gpio_line(*parse_led_name(text), board());
  return place.ok() ? "no error" : place.error().message;
}

TEST(FindGpioLine, WhatIsNotThereIsToldWithWhatIs) {
  const auto lists_chips =
      AllOf(HasSubstr("no such line"), HasSubstr("/dev/gpiochip0 (soc, 3 lines)"),
            HasSubstr("(expander, 2 lines)"));
  EXPECT_THAT(error_of("gpio:C"), lists_chips);
  EXPECT_THAT(error_of("gpiochip-label:soc:3"), lists_chips);
  EXPECT_THAT(error_of("gpiochip-label:nothing:0"), lists_chips);
  EXPECT_THAT(error_of("gpiochip:/dev/gpiochip9:0"), lists_chips);
}

TEST(FindGpioLine, SeveralAreNotGuessedAmong) {
  EXPECT_THAT(error_of("gpio:TWICE"),
              AllOf(HasSubstr("/dev/gpiochip0:2, /dev/gpiochip1:0"),
                    HasSubstr("name one of them as gpiochip:/dev/gpiochip0:2")));
  EXPECT_THAT(error_of("gpiochip-label:expander:1"), HasSubstr("found several"));
}

LedSettings settings(const char* status, const char* peer, const char* fault) {
  LedSettings made;
  made.leds[0].name = status;
  made.leds[1].name = peer;
  made.leds[2].name = fault;
  return made;
}

TEST(MakeLedOutput, WithoutNamesThereAreNoLeds) {
  auto output = make_led_output({});
  ASSERT_TRUE(output.ok());
  EXPECT_EQ((*output)->description(), "no LEDs");
  EXPECT_TRUE((*output)->open().ok());
  EXPECT_TRUE((*output)->set(kStatusLed).ok());
}

TEST(MakeLedOutput, MixesKinds) {
  LedSettings mixed = settings("led:ACT", "", "gpio:FAULT");
  mixed.leds[2].active_low = true;
  const auto output = make_led_output(mixed);
  ASSERT_TRUE(output.ok());
  EXPECT_EQ((*output)->description(), "status LED ACT, fault GPIO line FAULT, active low");
  EXPECT_FALSE((*output)->is_open());
}

TEST(MakeLedOutput, TellsAllMistakesAtOnce) {
  LedSettings wrong = settings("led:ACT", "wrong", "led:ACT");
  wrong.leds[0].active_low = true;
  const auto output = make_led_output(wrong);
  ASSERT_FALSE(output.ok());
  EXPECT_THAT(output.error().message,
              AllOf(HasSubstr("leave active_low out\n"), HasSubstr("\"wrong\" names no LED"),
                    HasSubstr("\n\"led:ACT\" is named for two LEDs")));
}

TEST(MakeLedOutput, AMissingLineIsAnErrorOfOpenOnly) {
  auto output = make_led_output(settings("gpio:no line has this name", "", ""));
  ASSERT_TRUE(output.ok());
  const Status opened = (*output)->open();
  ASSERT_FALSE(opened.ok());
  EXPECT_THAT(opened.error().message, HasSubstr("no line has this name"));
  EXPECT_FALSE((*output)->is_open());
  EXPECT_TRUE((*output)->set(kStatusLed).ok()) << "without effect while closed";
}

}  // namespace
}  // namespace zenith
