// A robot finds itself in a stored map that went through the bytes of a file, and does not where it
// is not. The long form: zenith eval WORLD --relocalise, docs/measurements/relocalisation.md.

#include "tools/relocalisation.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/figure.h"

namespace zenith::tools {
namespace {

TEST(Relocalisation, WithinTwoMetresWhereTheMapIsAndNowhereElse) {
  RelocalisationPlan plan;
  plan.world = ZENITH_SOURCE_DIR "/tests/system/worlds/relocalisation.toml";
  plan.seed = 7;
  const auto run = relocalise(plan, {});
  ASSERT_TRUE(run.ok()) << run.error().message;
  ASSERT_EQ(run->starts.size(), 5u);
  int right = 0;
  double latest_m = 0.0;
  double worst_m = 0.0;
  for (const RelocalisationStart& start : run->starts) {
    if (start.robot == "r6") {
      EXPECT_FALSE(start.found) << "it drives where the map is not";
      continue;
    }
    EXPECT_TRUE(start.right) << start.robot << ": found " << start.found << ", " << start.error_m
                             << " m off";
    right += start.right ? 1 : 0;
    latest_m = std::max(latest_m, start.way_m);
    worst_m = std::max(worst_m, start.error_m);
  }
  print_figure(
      "relocalisation: %zu landmarks in %zu bytes, %d of 4 starts right after %.2f m at "
      "most, %.3f m off at most; beside the map not found",
      run->landmarks, run->map_bytes, right, latest_m, worst_m);
}

}  // namespace
}  // namespace zenith::tools
