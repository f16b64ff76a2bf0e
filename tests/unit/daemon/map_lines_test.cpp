// The maps and pictures that telemetry tells.

#include "platform/daemon/map_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "platform/daemon/picture_lines.h"

namespace zenith {
namespace {

using nlohmann::json;

class MapLinesTest : public testing::Test {
 protected:
  static MapNews landmark(int owner, std::uint32_t id, float x = 1.0F) {
    return {owner, MapNews::Kind::kLandmark, id, {x, 2.0F, 2.5F}, {1e-4F, 0.0F, 2e-4F, 3e-4F}, 7};
  }
  // All that is to be told to this reader.
  std::vector<json> told(MapPlace& reader) {
    std::vector<json> lines;
    MapBatch batch;
    do {
      maps_.next(
          reader, [](int) { return "bert"; }, batch);
      EXPECT_FALSE(batch.is_too_far_behind);
      for (const std::string& line : batch.lines) lines.push_back(json::parse(line));
      reader = batch.end;
    } while (!batch.lines.empty());
    return lines;
  }
  std::vector<json> told() { return told(reader_); }
  std::size_t landmarks_in(const std::vector<json>& lines) {
    std::size_t count = 0;
    for (const json& line : lines) {
      if (line.contains("rows")) count += line["rows"].size() / 9;
    }
    return count;
  }
  MapLines maps_;
  MapPlace reader_;
};

TEST_F(MapLinesTest, TellsWhatIsNewOnceAndAllToWhoComesLater) {
  for (std::uint32_t id = 1; id <= 300; ++id) maps_.note(landmark(MapNews::kOwn, id));
  maps_.note(landmark(3, 1));
  EXPECT_EQ(landmarks_in(told()), 301u);
  EXPECT_TRUE(told().empty());
  maps_.note(landmark(MapNews::kOwn, 17, 5.5F));
  const auto lines = told();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["peer"], -1);
  EXPECT_EQ(lines[0]["rows"], json({17, 5.5, 2, 2.5, 1e-4, 0, 2e-4, 3e-4, 7}));
  MapPlace later;
  EXPECT_EQ(landmarks_in(told(later)), 301u);
  EXPECT_TRUE(later == reader_) << "readers that are equally far share lines";
  EXPECT_TRUE(told().empty()) << "who comes does not cost the others anything";
}

TEST_F(MapLinesTest, TellsWhatIsGone) {
  maps_.note(landmark(2, 5));
  maps_.note(landmark(2, 6));
  maps_.note(landmark(MapNews::kOwn, 5));
  told();
  maps_.note({2, MapNews::Kind::kRemoved, 5});
  auto lines = told();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["name"], "bert");
  EXPECT_EQ(lines[0]["gone"], json({5}));
  maps_.note({2, MapNews::Kind::kForget});
  maps_.note(landmark(2, 9));  // of who takes the slot next
  lines = told();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], json::parse(R"({"type":"forgotten","peer":2})"));
  EXPECT_EQ(landmarks_in(lines), 1u);
  EXPECT_EQ(maps_.size(), 2u) << "the own one stays";
  MapPlace later;
  lines = told(later);
  EXPECT_EQ(landmarks_in(lines), 2u);
  for (const json& line : lines) EXPECT_EQ(line["type"], "landmarks") << "nothing was there before";
}

TEST_F(MapLinesTest, IsBoundedAndEveryLineFits) {
  for (std::uint32_t id = 1; id <= MapLines::kMostLandmarks + 10; ++id) {
    MapNews news = landmark(MapNews::kOwn, 4000000000U - id, -12345.678F);
    news.variance_m2 = {1.234567F, -1.234567F, 1.234567F, 1.234567F};
    maps_.note(news);
  }
  EXPECT_EQ(maps_.size(), MapLines::kMostLandmarks);
  EXPECT_EQ(landmarks_in(told()), MapLines::kMostLandmarks);
}

TEST_F(MapLinesTest, ManyOwnersChangesComeInFewLines) {
  for (std::uint32_t id = 1; id <= MapLines::kBatchLandmarks; ++id) {
    maps_.note(landmark(static_cast<int>(id % 8), id));
  }
  MapBatch batch;
  maps_.next(
      reader_, [](int) { return "bert"; }, batch);
  EXPECT_LE(batch.lines.size(), 13u);
  EXPECT_EQ(landmarks_in(told()), MapLines::kBatchLandmarks);
}

// One that does not read for hours, while landmarks come and go.
TEST_F(MapLinesTest, WhoIsTooFarBehindBeginsAnewAndOthersDoNot) {
  maps_.note(landmark(MapNews::kOwn, 1));
  MapPlace sleeper;
  told(sleeper);
  for (std::uint32_t id = 2; id < MapLines::kMostGone + 10; ++id) {
    maps_.note(landmark(MapNews::kOwn, id));
    told();
    maps_.note({MapNews::kOwn, MapNews::Kind::kRemoved, id});
    told();
  }
  MapBatch batch;
  maps_.next(
      sleeper, [](int) { return ""; }, batch);
  EXPECT_TRUE(batch.is_too_far_behind);
  EXPECT_TRUE(told().empty());
  MapPlace again;
  EXPECT_EQ(landmarks_in(told(again)), 1u);
}

TEST(PictureLines, HoldTheWholePictureWithTheMostCorners) {
  auto picture = std::make_unique<Picture>();
  picture->stamp = Time{123};
  picture->used = true;
  for (int i = 0; i < kMaxCorners; ++i) {
    picture->corners.push_back({123.44F, 319.9F, 4000000000U, i % 2 == 0, 100.04F, 319.96F});
  }
  for (std::size_t i = 0; i < picture->image.size(); ++i) {
    picture->image[i] = static_cast<std::uint8_t>(i * 7 + i / 320);
  }
  CornersLine line;
  write_corners(line, *picture);
  const json corners = json::parse(line.finish());
  ASSERT_EQ(corners["corners"].size(), 5u * kMaxCorners);
  EXPECT_EQ(corners["corners"][0], 123.4);
  EXPECT_EQ(corners["corners"][2], 2);
  EXPECT_EQ(corners["corners"][7], 1);
  std::vector<std::uint8_t> image;
  for (int row = 0; row < kRectifiedSize; row += kStripRows) {
    StripLine strip;
    write_strip(strip, *picture, row);
    const json read = json::parse(strip.finish());
    EXPECT_EQ(read["first_row"], row);
    const auto bytes = read_base64(read["grey"].get<std::string>());
    ASSERT_TRUE(bytes);
    image.insert(image.end(), bytes->begin(), bytes->end());
  }
  EXPECT_TRUE(std::equal(image.begin(), image.end(), picture->image.begin(), picture->image.end()));
}

}  // namespace
}  // namespace zenith
