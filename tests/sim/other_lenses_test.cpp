// The same drive through cameras of other models than the simulator's own, narrow ones among them:
// rendered, rectified and mapped by the lens's own model, with the view fitted to it.

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "sim/simulation.h"
#include "slam/image/view.h"
#include "tests/support/figure.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/report/figures.h"
#include "tools/runner/simulated_source.h"
#include "tools/runner/team_run.h"

namespace zenith::tools {
namespace {

constexpr double kDuration_s = 30.0;

// The world of corridor-rooms, its camera with these keys besides.
std::string world_with(const std::string& camera) {
  std::ifstream in(sim::find_world("corridor-rooms"));
  std::stringstream text;
  text << in.rdbuf();
  std::string world = text.str();
  world.insert(world.find('\n', world.find("[camera]")) + 1, camera);
  return world;
}

struct Drive {
  double ate_m = 0.0;
  double odometry_ate_m = 0.0;
  View view;
};

Result<Drive> drive_through(const std::string& camera) {
  TemporaryFolder folder;
  const auto path = folder.path() / "world.toml";
  write_text(path, world_with(camera));
  auto team = simulate_team(path.string(), 3, kDuration_s, {});
  if (!team.ok()) return team.error();
  std::vector<std::unique_ptr<Source>> sources;
  sources.push_back(std::move(team->sources[0]));
  Drive drive;
  drive.view = view_of({}, sources[0]->config());
  const auto log = run_team(sources, {{}, 3, MapSharing::kNone}, {});
  if (!log.ok()) return log.error();
  const RobotFigures robot = judge(*log).robots[0];
  drive.ate_m = robot.ate_m.value_or(1e9);
  drive.odometry_ate_m = robot.odometry_ate_m.value_or(1e9);
  return drive;
}

struct Case {
  const char* name;
  const char* camera;
  double most_m;  // what a lens of this angle reaches, with a margin
};

// 70 degrees are 400 px from the centre to a corner at tan(35 degrees): 571 px.
constexpr Case kCases[] = {
    {"pinhole of 70 degrees, corner to corner",
     "model = \"radtan\"\nintrinsics_px = [571, 571, 322, 237]\ndistortion = [0, 0, 0, 0, 0]\n",
     0.05},
    {"radtan of 85 degrees",
     "model = \"radtan\"\nintrinsics_px = [400, 401, 322, 237]\n"
     "distortion = [-0.15, 0.03, 0.0004, -0.0003, 0]\n",
     0.05},
    {"double sphere of 180 degrees",
     "model = \"double_sphere\"\nintrinsics_px = [160, 160, 320, 240]\ndistortion = [-0.2, 0.57]\n",
     0.03},
    {"OCamCalib's of 180 degrees",
     "model = \"scaramuzza\"\nintrinsics_px = [1, 1, 320, 240]\ndistortion = [1.0002, 0.0007, "
     "-0.001]\npolynomial = [-150, 0, 1.2e-3, 6e-7, 1.5e-9]\n",
     0.03},
};

TEST(OtherLenses, MapAsWellAsTheirAngleLets) {
  for (const Case& c : kCases) {
    const auto drive = drive_through(c.camera);
    ASSERT_TRUE(drive.ok()) << c.name << ": " << drive.error().message;
    print_figure(
        "lens %s: view of %.1f degrees, %.0f %% of it in the image; ATE %.3f m in %.0f s, "
        "wheels alone %.3f m",
        c.name, drive->view.fov_deg, 100.0 * drive->view.inside_share, drive->ate_m, kDuration_s,
        drive->odometry_ate_m);
    EXPECT_LT(drive->ate_m, c.most_m) << c.name;
    EXPECT_LT(drive->ate_m, drive->odometry_ate_m) << c.name;
    EXPECT_GE(drive->view.inside_share, 0.5) << c.name;
  }
}

}  // namespace
}  // namespace zenith::tools
