// Recordings of people who mean harm: each file of the folder, as a trap and as a bomb.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/odometry/dbc.h"
#include "platform/recording/layout.h"
#include "platform/recording/png.h"
#include "platform/recording/recording.h"
#include "platform/recording/sensor_file.h"
#include "tests/support/hostile_files.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20U;

class HostileRecording : public testing::Test {
 protected:
  void SetUp() override { write_small_recording(folder_); }

  // Opens and reads to the end; the message of the first error, or "".
  std::string read_all() {
    auto recording = Recording::open(folder_, {});
    if (!recording.ok()) return recording.error().message;
    SourceFrame frame;
    for (;;) {
      const auto more = (*recording)->next(frame);
      if (!more.ok()) return more.error().message;
      if (!*more) return "";
    }
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "ada";
};

TEST_F(HostileRecording, PipesDevicesAndEndlessFilesAreRefused) {
  const fs::path frame = layout::frames(folder_) / (std::to_string(small_stamp(3).ns) + ".png");
  ASSERT_EQ(read_all(), "");
  for (const fs::path& path :
       {layout::robot(folder_), layout::sensor(folder_), layout::frame_list(folder_), frame,
        layout::can_log(folder_, "can0"), layout::ground_truth(folder_)}) {
    const std::string text = read_text(path);
    for (const Trap& trap : traps()) {
      SCOPED_TRACE(path.string() + ": " + trap.kind);
      fs::remove(path);
      trap.lay(path);
      const bool missing = path == frame && std::string(trap.told) != "expected at most";
      EXPECT_THAT(read_all(),
                  AllOf(HasSubstr(path.string()), HasSubstr(missing ? "is missing" : trap.told)));
    }
    fs::remove(path);
    write_text(path, text);
  }
  EXPECT_EQ(read_all(), "");
}

TEST_F(HostileRecording, ADbcFileThatIsNoneIsRefused) {
  const fs::path path = temporary_.path() / "base.dbc";
  for (const Trap& trap : traps()) {
    trap.lay(path);
    EXPECT_THAT(load_dbc(path.string()).error().message,
                AllOf(HasSubstr(path.string()), HasSubstr(trap.told)));
    fs::remove(path);
  }
}

TEST_F(HostileRecording, ALineWithoutEndIsNoLine) {
  for (const fs::path& path : {layout::frame_list(folder_), layout::can_log(folder_, "can0"),
                               layout::ground_truth(folder_)}) {
    const std::string text = read_text(path);
    write_text(path, text + std::string(100'000, '7'));
    EXPECT_THAT(read_all(), AllOf(HasSubstr(path.string()), HasSubstr("at most 4096 bytes")));
    write_text(path, text);
  }
}

TEST_F(HostileRecording, TheRobotsNameIsPrintable) {
  const fs::path evil = temporary_.path() / "ada\x1b]0;owned\x07";
  fs::rename(folder_, evil);
  const auto recording = Recording::open(evil, {});
  ASSERT_FALSE(recording.ok());
  EXPECT_THAT(recording.error().message, HasSubstr("expected a folder's name"));
}

TEST_F(HostileRecording, IdentifiersThatNobodyKnowsAreCountedInBoundedMemory) {
  std::string log = read_text(layout::can_log(folder_, "can0"));
  const std::string stamp = log.substr(0, log.find(' '));
  char line[64];
  constexpr unsigned kFrames = 300'000;
  for (unsigned id = 0; id < kFrames; ++id) {
    std::snprintf(line, sizeof line, "%s can0 %08X#00\n", stamp.c_str(), id + 0x10000U);
    log += line;
  }
  write_text(layout::can_log(folder_, "can0"), log);
  auto recording = Recording::open(folder_, {});
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const auto warnings = (*recording)->warnings();
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("300000 frames with identifiers")));
}

// --- pictures -----------------------------------------------------------------------------------

class HostilePng : public testing::Test {
 protected:
  std::string read(const std::string& png) {
    std::vector<std::uint8_t> pixels;
    Status status;
    growth_ = peak_growth_bytes(
        [&] { status = parse_grey_png(png, "frame.png", kWidth, kHeight, pixels); });
    return status ? "" : status.error().message;
  }
  // Grey rows that begin with the filter "none".
  static std::string rows() {
    std::string all;
    for (int v = 0; v < kHeight; ++v) all += '\0' + std::string(kWidth, static_cast<char>(v));
    return all;
  }
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;
  std::optional<std::uint64_t> growth_;
};

TEST_F(HostilePng, OneLargeChunkOfPixelsIsRead) {
  EXPECT_EQ(read(PngBytes(kWidth, kHeight).pixels(rows()).end()), "");
  const std::string text = "Comment" + std::string(1, '\0') + "taken by hand";
  EXPECT_EQ(read(PngBytes(kWidth, kHeight).chunk("tEXt", text).pixels(rows()).end()), "");
}

TEST_F(HostilePng, TextsThatUnpackToMuchMoreTakeNoMemory) {
  const std::string keyword = "Comment" + std::string(2, '\0');
  for (const std::size_t packed : {std::size_t{900'000}, std::size_t{3'000'000}}) {
    const std::string bomb = keyword + PngBytes::zlib_bomb(packed);
    // Before and after the pixels.
    EXPECT_THAT(read(PngBytes(kWidth, kHeight).chunk("zTXt", bomb).pixels(rows()).end()),
                HasSubstr("beside the picture"));
    if (growth_) {
      EXPECT_LT(*growth_, 40 * kMegabyte) << packed;
    }
    EXPECT_THAT(read(PngBytes(kWidth, kHeight).pixels(rows()).chunk("zTXt", bomb).end()),
                testing::AnyOf("", HasSubstr("beside the picture")));
    if (growth_) {
      EXPECT_LT(*growth_, 40 * kMegabyte) << packed;
    }
  }
}

TEST_F(HostilePng, ManySmallTextsTakeNoMemoryEither) {
  PngBytes png(kWidth, kHeight);
  const std::string bomb = "Comment" + std::string(2, '\0') + PngBytes::zlib_bomb(5'000);
  for (int i = 0; i < 190; ++i) png.chunk("zTXt", bomb);  // 0.8 MB each when unpacked
  EXPECT_THAT(read(png.pixels(rows()).end()), HasSubstr("beside the picture"));
  if (growth_) {
    EXPECT_LT(*growth_, 40 * kMegabyte);
  }
}

TEST_F(HostilePng, OtherKindsAreToldByName) {
  const std::string palette(3 * 256, 'p');
  EXPECT_THAT(read(PngBytes(kWidth, kHeight, 16).end()), HasSubstr("found 16-bit grey"));
  EXPECT_THAT(read(PngBytes(kWidth, kHeight, 1).end()), HasSubstr("found 1-bit grey"));
  EXPECT_THAT(read(PngBytes(kWidth, kHeight, 8, 2).end()), HasSubstr("found 8-bit colour"));
  EXPECT_THAT(read(PngBytes(kWidth, kHeight, 8, 3).chunk("PLTE", palette).end()),
              HasSubstr("found 8-bit a palette"));
  EXPECT_THAT(read(PngBytes(kWidth, kHeight, 8, 0, 1).pixels(rows()).end()),
              HasSubstr("found 8-bit grey, interlaced"));
  EXPECT_THAT(read(PngBytes(0x7fffffff, 0x7fffffff).end()), HasSubstr("sensor.yaml says"));
}

TEST_F(HostilePng, EveryTruncationIsTold) {
  const std::string png = PngBytes(kWidth, kHeight).pixels(rows()).end();
  for (std::size_t size = 0; size < png.size() - 12; size += 1 + size / 10) {
    ASSERT_NE(read(png.substr(0, size)), "") << size;
  }
}

// --- sensor.yaml --------------------------------------------------------------------------------

TEST(HostileSensorFile, BombsOfYamlTakeNoMemory) {
  std::string aliases = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (char c = 'b'; c <= 'i'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    aliases += std::string(1, c) + ": &" + c + " [*" + before;
    for (int i = 0; i < 8; ++i) aliases += ", *" + before;
    aliases += "]\n";
  }
  aliases += "intrinsics: *i\n";
  for (const std::string& text :
       {aliases, std::string(kMaxSensorFileBytes, '['), std::string(kMaxSensorFileBytes, '{'),
        std::string(kMaxSensorFileBytes, '-'), "a: " + std::string(kMaxSensorFileBytes, '!')}) {
    std::string message;
    const auto growth = peak_growth_bytes([&] {
      const auto read = parse_sensor_file(text, "sensor.yaml");
      message = read.ok() ? "" : read.error().message;
    });
    EXPECT_THAT(message, HasSubstr("sensor.yaml"));
    EXPECT_LT(message.size(), 10'000u);
    if (growth) {
      EXPECT_LT(*growth, 100 * kMegabyte) << text.substr(0, 20);
    }
  }
}

TEST(HostileSensorFile, LongOnesAreNotRead) {
  TemporaryFolder folder;
  write_text(folder.path() / "sensor.yaml", std::string(3'000'000, '['));
  EXPECT_THAT(read_sensor_file(folder.path() / "sensor.yaml").error().message,
              HasSubstr("expected at most 64 kB, found 2.8 MB"));
}

}  // namespace
}  // namespace zenith::tools
