// A stored map for other programs.

#include "tools/map_export.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

TEST(MapExport, WritesEachLandmarkOnce) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  storage::StoredMap map = storage::random_map(12, random);
  map.landmarks[3].id = 77;
  map.landmarks[3].x_m = -1.25F;
  map.landmarks[3].y_m = 2.5F;
  map.landmarks[3].z_m = 2.75F;
  map.landmarks[3].observations = 9;
  const std::string csv = map_as_csv(map);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
  EXPECT_NE(csv.find("\n77,-1.250,2.500,2.750,0.0001,2e-05,0.0002,0.0004,9\n"), std::string::npos)
      << csv;
  const std::string ply = map_as_ply(map);
  EXPECT_NE(ply.find("element vertex 12\n"), std::string::npos);
  EXPECT_NE(ply.find("\n-1.250 2.500 2.750 0.0100 0.0141 0.0200 9\n"), std::string::npos) << ply;
}

TEST(MapExport, ChoosesByTheEndingOfTheName) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const storage::StoredMap map = storage::random_map(12, random);
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "a.csv", "a.png"}) {
    EXPECT_TRUE(export_map(map, folder.path() / name).ok()) << name;
    EXPECT_FALSE(read_text(folder.path() / name).empty()) << name;
  }
  EXPECT_FALSE(export_map(map, folder.path() / "a.txt").ok());
  EXPECT_TRUE(export_map({}, folder.path() / "empty.png").ok());
}

}  // namespace
}  // namespace zenith::tools
