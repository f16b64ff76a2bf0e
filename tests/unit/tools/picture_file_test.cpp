#include "tools/picture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/hostile_files.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

class PictureFileTest : public testing::Test {
 protected:
  std::string error_of(const std::string& bytes) {
    write_text(path_, bytes);
    std::string message;
    growth_ = peak_growth_bytes([&] {
      const auto picture = read_grey_picture(path_);
      message = picture.ok() ? "" : picture.error().message;
    });
    return message;
  }
  static std::string little_endian(std::uint32_t value) {
    std::string bytes;
    for (const unsigned shift : {0U, 8U, 16U, 24U}) bytes += static_cast<char>(value >> shift);
    return bytes;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "picture";
  std::optional<std::uint64_t> growth_;
};

TEST_F(PictureFileTest, EachFormatIsReadAndItsSizeKnownBefore) {
  const cv::Mat image(24, 32, CV_8U, cv::Scalar(77));
  for (const char* ending : {".png", ".jpg", ".bmp", ".pgm", ".ppm"}) {
    const std::filesystem::path path = folder_.path() / (std::string("a") + ending);
    cv::Mat written = image;
    if (std::string(ending) == ".ppm") cv::merge(std::vector<cv::Mat>(3, image), written);
    ASSERT_TRUE(cv::imwrite(path.string(), written));
    EXPECT_TRUE(is_picture(path)) << ending;
    EXPECT_EQ(picture_size(read_text(path)), std::pair(std::uint64_t{32}, std::uint64_t{24}))
        << ending;
    const auto read = read_grey_picture(path);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->cols, 32);
    EXPECT_EQ(read->rows, 24);
    EXPECT_NEAR(read->at<std::uint8_t>(3, 3), 77, 1);
  }
}

TEST_F(PictureFileTest, PicturesThatSayTheyAreHugeTakeNoMemory) {
  const std::string bmp = "BM" + std::string(16, '\0') + little_endian(40'000) +
                          little_endian(~std::uint32_t{39'999}) + std::string(100, '\1');
  for (const std::string& bytes :
       {PngBytes(40'000, 40'000).pixels("").end(), std::string("P5\n# large\n40000 40000 255\n"),
        std::string("P5 99999999999999999999 1 255\n"), bmp,
        std::string("\xff\xd8\xff\xe0\0\4ab\xff\xc0\0\x11\x08\xff\xff\xff\xff\1\1\x11\0", 21)}) {
    EXPECT_THAT(error_of(bytes), HasSubstr("expected"));
    if (growth_) {
      EXPECT_LT(*growth_, std::uint64_t{20} << 20U);
    }
  }
}

TEST_F(PictureFileTest, WhatIsNoneIsTold) {
  EXPECT_THAT(error_of("GIF89a"), HasSubstr("expected a picture"));
  EXPECT_THAT(error_of(""), HasSubstr("expected a picture"));
  EXPECT_THAT(error_of("P5 x"), HasSubstr("expected a picture"));
  EXPECT_THAT(error_of(PngBytes(10, 10).end()), HasSubstr("damaged"));
  std::filesystem::remove(path_);
  for (const Trap& trap : traps()) {
    trap.lay(path_);
    EXPECT_FALSE(is_picture(path_));
    EXPECT_THAT(read_grey_picture(path_).error().message, HasSubstr(trap.told));
    std::filesystem::remove(path_);
  }
  EXPECT_THAT(read_grey_picture(path_).error().message, HasSubstr("missing"));
}

}  // namespace
}  // namespace zenith::tools
