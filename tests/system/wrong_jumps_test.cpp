// Old landmarks move a robot only with evidence: rounds under a ceiling that repeats exactly.

#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tools/report/figures.h"
#include "tools/report/pose_jumps.h"
#include "tools/runner/simulated_source.h"
#include "tools/runner/team_run.h"

namespace zenith::tools {
namespace {

constexpr const char* kRing = ZENITH_SOURCE_DIR "/tests/system/worlds/repeating-ring.toml";

TEST(WrongJumps, NoneUnderACeilingThatRepeatsItself) {
  const TestSeed seed(1);
  for (std::uint64_t run = 0; run < 2; ++run) {
    RunOptions options;
    options.seed = seed.value() + run;
    auto team = simulate_team(kRing, options.seed, 0.0, options.parameters);
    ASSERT_TRUE(team.ok()) << team.error().message;
    const auto log = run_team(team->sources, options, {});
    ASSERT_TRUE(log.ok()) << log.error().message;
    const RobotLog& robot = log->robots[0];
    for (const PoseJump& jump : find_jumps(robot.frames)) {
      EXPECT_FALSE(jump.wrong) << "world seed " << options.seed << ", frame " << jump.frame << ": "
                               << jump.position_m << " m, " << jump.angle_rad << " rad";
    }
    EXPECT_GT(robot.counters.mapper.loops_closed, 0U) << "world seed " << options.seed;
    const RobotFigures figures = judge(*log).robots[0];
    print_figure("repeating ring, seed %llu: ATE %.3f m, %d jumps, %d wrong",
                 static_cast<unsigned long long>(options.seed), figures.ate_m.value_or(-1.0),
                 figures.jumps.value_or(-1), figures.wrong_jumps.value_or(-1));
  }
}

}  // namespace
}  // namespace zenith::tools
