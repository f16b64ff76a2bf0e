#include "drivers/leds/class_leds.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/leds/led_group.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

// A folder with LEDs as /sys/class/leds has them; its files keep what is written.
class ClassLedsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "zenith_leds_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    add("green", "255", "none [mmc0] timer heartbeat");
    add("red", "1", "[none] mmc0");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void add(const std::string& name, const std::string& max, const std::string& trigger) {
    fs::create_directories(folder_ / name);
    write(name + "/brightness", "7\n");
    write(name + "/max_brightness", max + "\n");
    write(name + "/trigger", trigger + "\n");
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  // The real files take each write as a whole; these keep the rest of a longer text before it.
  std::string read(const std::string& file) const {
    std::ifstream in(folder_ / file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  // Forgets what brightness held, then lets `action` write it.
  template <typename Action>
  std::string written(const std::string& name, const Action& action) {
    write(name + "/brightness", "");
    action();
    return read(name + "/brightness");
  }

  fs::path folder_;
};

TEST_F(ClassLedsTest, TakesTheTriggerAwayAndGivesItBack) {
  ClassLed led("green", folder_.string());
  EXPECT_EQ(written("green", [&] { EXPECT_TRUE(led.open().ok()); }), "0");
  EXPECT_EQ(read("green/trigger").substr(0, 5), "none ");
  EXPECT_EQ(written("green", [&] { EXPECT_TRUE(led.set(true).ok()); }), "255");
  EXPECT_EQ(written("green", [&] { EXPECT_TRUE(led.set(false).ok()); }), "0");
  EXPECT_EQ(written("green", [&] { led.close(); }), "0");
  EXPECT_EQ(read("green/trigger").substr(0, 5), "mmc0 ");
}

TEST_F(ClassLedsTest, WithoutATriggerNothingIsRestored) {
  const std::string before = read("red/trigger");
  {
    ClassLed led("red", folder_.string());
    EXPECT_TRUE(led.open().ok());
    EXPECT_EQ(written("red", [&] { EXPECT_TRUE(led.set(true).ok()); }), "1");
    write("red/brightness", "");
  }
  EXPECT_EQ(read("red/brightness"), "0") << "the end of the object turns it off";
  EXPECT_EQ(read("red/trigger"), before);
}

TEST_F(ClassLedsTest, AMissingLedIsToldWithThoseThereAre) {
  ClassLed led("blue", folder_.string());
  const Status opened = led.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_THAT(opened.error().message,
              AllOf(HasSubstr("blue/brightness"), HasSubstr("LEDs of this kernel: green, red")));
  EXPECT_TRUE(led.set(true).ok()) << "without effect while closed";
}

TEST_F(ClassLedsTest, ALedThatComesLateIsFoundByTheNextOpen) {
  ClassLed led("blue", folder_.string());
  EXPECT_FALSE(led.open().ok());
  add("blue", "1", "[none]");
  EXPECT_TRUE(led.open().ok());
}

std::unique_ptr<LedGroup> group(const fs::path& folder, const char* status, const char* fault) {
  std::array<std::unique_ptr<Led>, kLedCount> leds;
  leds[0] = std::make_unique<ClassLed>(status, folder.string());
  leds[2] = std::make_unique<ClassLed>(fault, folder.string());
  return std::make_unique<LedGroup>(std::move(leds));
}

TEST_F(ClassLedsTest, AGroupLightsTheLedsOfTheMask) {
  const auto leds = group(folder_, "green", "red");
  ASSERT_TRUE(leds->open().ok());
  EXPECT_TRUE(leds->is_open());
  EXPECT_TRUE(leds->set(kFaultLed | kPeerLed).ok());
  EXPECT_EQ(read("green/brightness").substr(0, 1), "0");
  EXPECT_EQ(read("red/brightness").substr(0, 1), "1");
  EXPECT_EQ(written("red", [&] { EXPECT_TRUE(leds->set(kFaultLed | kStatusLed).ok()); }), "")
      << "what does not change is not written";
  EXPECT_EQ(read("green/brightness").substr(0, 3), "255");
  leds->close();
  EXPECT_FALSE(leds->is_open());
  EXPECT_EQ(read("red/brightness"), "0");
  EXPECT_EQ(leds->description(), "status LED green, fault LED red");
}

TEST_F(ClassLedsTest, AGroupOpensAllOrNone) {
  const auto leds = group(folder_, "green", "blue");
  EXPECT_FALSE(leds->open().ok());
  EXPECT_FALSE(leds->is_open());
  EXPECT_EQ(read("green/trigger").substr(0, 5), "mmc0 ") << "given back";
}

// An LED that fails when it is written.
class Broken : public Led {
 public:
  Status open() override { return {}; }
  void close() override {}
  Status set(bool) override { return Error{"unplugged"}; }
  std::string description() const override { return "broken"; }
};

TEST_F(ClassLedsTest, AFailureClosesTheGroupUntilTheNextOpen) {
  std::array<std::unique_ptr<Led>, kLedCount> leds;
  leds[0] = std::make_unique<ClassLed>("red", folder_.string());
  leds[1] = std::make_unique<Broken>();
  LedGroup both(std::move(leds));
  ASSERT_TRUE(both.open().ok());
  EXPECT_FALSE(both.set(kStatusLed | kPeerLed).ok());
  EXPECT_FALSE(both.is_open());
  EXPECT_EQ(read("red/brightness").substr(0, 1), "0") << "not left lit";
  EXPECT_TRUE(both.set(kPeerLed).ok()) << "without effect while closed";
  EXPECT_TRUE(both.open().ok());
}

}  // namespace
}  // namespace zenith
