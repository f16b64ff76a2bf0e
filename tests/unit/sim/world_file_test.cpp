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
