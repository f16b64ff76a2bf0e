// A peer's map is state: any order of arrival, any loss but of the last, any duplication give the
// same map.

#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith {
namespace {

TEST(PeerMapProperty, LastRevisionWinsInAnyOrderOfArrival) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<LandmarkRecord> sent;
    std::map<std::uint32_t, LandmarkRecord> last;
    for (std::uint32_t id = 1; id <= 25; ++id) {
      const std::uint32_t revisions = 1 + random.below(6);
      for (std::uint32_t revision = 1; revision <= revisions; ++revision) {
        LandmarkRecord r;
        r.id = id * 40503U;
        r.revision = revision;
        r.removed = random.below(5) == 0;
        r.x_m = static_cast<float>(random.uniform(-5.0, 5.0));
        r.covariance_m2 = {1.0F, 0.0F, 0.0F, 1.0F, 0.0F, 1.0F};
        last[r.id] = r;
        const bool lost = revision < revisions && random.below(3) == 0;
        const int copies = lost ? 0 : 1 + static_cast<int>(random.below(3));
        for (int k = 0; k < copies; ++k) sent.push_back(r);
      }
    }
    for (std::size_t i = sent.size() - 1; i > 0; --i) {
      std::swap(sent[i], sent[random.below(static_cast<std::uint32_t>(i) + 1)]);
    }
    point_world::PeerRig rig;
    for (const LandmarkRecord& r : sent) ASSERT_TRUE(rig.map.apply(r));
    ASSERT_EQ(static_cast<std::size_t>(rig.map.size()), last.size());
    for (int slot = 0; slot < rig.map.size(); ++slot) {
      const PeerLandmark& l = rig.map[slot];
      const LandmarkRecord& expected = last.at(l.id);
      ASSERT_EQ(l.revision, expected.revision) << "trial " << trial;
      ASSERT_EQ(l.present, !expected.removed) << "trial " << trial;
      ASSERT_EQ(l.x_m, expected.x_m) << "trial " << trial;
    }
  }
}

}  // namespace
}  // namespace zenith
