#include "sim/world_file.h"

#include "sim/floor_plan.h"
#include "sim/simulation.h"
#include "tests/unit/sim/test_world.h"

namespace zenith::sim {
namespace {

TEST(WorldFile, EveryWorldLoads) {
  const auto names = list_worlds();
  ASSERT_GE(names.size(), 8u);
  for (const std::string& name : names) {
    const auto world = load_world_file(find_world(name));
    ASSERT_TRUE(world.ok()) << world.error().message;
    EXPECT_EQ(world->name, name);
    EXPECT_TRUE(FloorPlan::build(*world).ok());
  }
}

TEST(WorldFile, UnknownKeyIsAnErrorWithItsLine) {
  const TestWorld world("seed = 1\nsped = 2\n" + exact_room().substr(10));
  const auto loaded = load_world_file(world.path());
  ASSERT_FALSE(loaded.ok());
  EXPECT_NE(loaded.error().message.find(":2: unknown key \"sped\""), std::string::npos)
      << loaded.error().message;
}

TEST(WorldFile, AllErrorsAtOnceInOrder) {
  const TestWorld world(R"(frame_rate_hz = 900
[[room]]
name = "a"
rect = [0, 0, 5]
ceiling = "clouds"
[[robot]]
name = 7
path = [[1, 1]]
)");
  const auto loaded = load_world_file(world.path());
  ASSERT_FALSE(loaded.ok());
  const std::string& text = loaded.error().message;
  std::size_t at = 0;
  for (const char* part :
       {":1: frame_rate_hz: expected 1 to 60, found 900",
        ":4: rect:", ":5: ceiling: expected one of tiles, plaster", ":7: name:", ":8: path:"}) {
    at = text.find(part, at);
    EXPECT_NE(at, std::string::npos) << part << " is missing or out of order in\n" << text;
    if (at == std::string::npos) at = 0;
  }
}

TEST(WorldFile, SyntaxErrorNamesItsLine) {
  const TestWorld world("seed = 1\nframe_rate_hz = = 3\n");
  const auto loaded = load_world_file(world.path());
  ASSERT_FALSE(loaded.ok());
  EXPECT_NE(loaded.error().message.find(".toml:2: "), std::string::npos);
}

TEST(WorldFile, WorldsThatFillTheMemoryAreRefused) {
  const auto told = [](const std::string& text) {
    const TestWorld world(text);
    const auto loaded = load_world_file(world.path());
    return loaded.ok() ? "" : loaded.error().message;
  };
  const std::string robot = "[[robot]]\nname = \"r1\"\npath = [[1, 1], [2, 1]]\n";
  const auto rooms = [](int count, int side_m) {
    std::string text;
    for (int i = 0; i < count; ++i) {
      const std::string x = std::to_string(i * side_m % 900);
      text += "[[room]]\nname = \"a\"\nrect = [" + x + ", 0, " + x + "." + "9, " +
              std::to_string(side_m) + "]\n";
    }
    return text;
  };
  const std::string large = "[[room]]\nname = \"a\"\nrect = [0, 0, 900, 900]\n";
  const std::string far = "[[room]]\nname = \"a\"\nrect = [0, 0, 1e12, 1]\n";
  EXPECT_EQ(told(rooms(1, 9) + robot), "");
  EXPECT_NE(told(large + robot).find("5000 m2"), std::string::npos);
  EXPECT_NE(told(far + robot).find("within 1000 m"), std::string::npos);
  EXPECT_NE(told(rooms(501, 1) + robot).find("at most 500 rooms"), std::string::npos);
  std::string many;
  for (int i = 0; i < 65; ++i) many += robot;
  EXPECT_NE(told(rooms(1, 9) + many).find("at most 64 robots"), std::string::npos);
}

TEST(WorldFile, ARobotsNameCanNameAFolder) {
  for (const char* name :
       {"../r1", "a/b", "..", "", "\\u001b[31m", "r1\\n", "0123456789012345678901234567890123"}) {
    const TestWorld world("[[robot]]\nname = \"" + std::string(name) +
                          "\"\npath = [[1, 1], [2, 1]]\n");
    const auto loaded = load_world_file(world.path());
    ASSERT_FALSE(loaded.ok());
    EXPECT_NE(loaded.error().message.find("can name a folder"), std::string::npos) << name;
  }
}

TEST(WorldFile, MissingFileIsAnError) {
  EXPECT_FALSE(load_world_file("/nowhere/none.toml").ok());
}

TEST(FloorPlan, RefusesOverlapsAndBoxesOutside) {
  WorldFile world;
  world.rooms.push_back({.name = "a", .rect = {0, 0, 5, 5}, .line = 3});
  world.rooms.push_back({.name = "b", .rect = {4, 4, 9, 9}, .line = 7});
  world.boxes.push_back({.rect = {20, 20, 21, 21}, .line = 9});
  const auto plan = FloorPlan::build(world);
  ASSERT_FALSE(plan.ok());
  EXPECT_NE(plan.error().message.find(":7: room \"b\" overlaps room \"a\""), std::string::npos);
  EXPECT_NE(plan.error().message.find(":9: this box lies in no room"), std::string::npos);
}

TEST(Simulation, RefusesAWayIntoAWall) {
  std::string text = exact_room();
  const std::string way = "[4.0, 2.6]";
  text.replace(text.find(way), way.size(), "[5.9, 2.6]");
  const TestWorld world(text);
  const auto simulation = Simulation::load(world.path(), {});
  ASSERT_FALSE(simulation.ok());
  EXPECT_NE(simulation.error().message.find("nearer than 0.25 m to a wall"), std::string::npos);
}

}  // namespace
}  // namespace zenith::sim
