// What a robot loses when its power is cut at any change of the disk: over lives in which it finds
// itself in its stored maps, or not, or wrongly.

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "platform/daemon/map_keeper.h"
#include "slam/fleet/align.h"
#include "tests/support/faulty_folder.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"

namespace zenith {
namespace {

constexpr Duration kInterval = {5'000'000'000};
constexpr double kStep_s = 0.5;
constexpr double kLife_s = 70.0;

using Key = std::uint32_t;  // of a landmark, whatever map it is in: the signs of its look

Key key_of(const LandmarkRecord& r) {
  Key key = 0;
  for (const std::int8_t v : r.appearances[0].descriptor) key = key << 1u | (v > 0 ? 1u : 0u);
  return key;
}

Time at_time(double seconds) {
  return Time{} + Duration::from_seconds(1000.0 + seconds);
}

// A building of landmarks so far apart that no two are taken for one, and a robot that is switched
// on anywhere in it.
class PowerCuts : public testing::Test {
 protected:
  // One life, in which the power is cut before the change `at`; false when it was not.
  bool live(storage::FaultyFolder& disk, int at);
  void check_disk(storage::FaultyFolder& disk, const char* when);

  void see_a_landmark(MapKeeper& keeper, double time_s) {
    LandmarkRecord r = storage::random_map(1, random_).landmarks[0];
    r.id = next_id_++;
    r.appearance_count = 1;
    for (auto& v : r.appearances[0].descriptor) v = random_.uniform() < 0.5 ? -60 : 60;
    const Eigen::Vector2d in_world(random_.uniform() * 800.0 - 400.0,
                                   random_.uniform() * 800.0 - 400.0);
    world_[key_of(r)] = in_world;
    const Eigen::Vector2d own = T_world_own_.inverse() * in_world;
    r.x_m = static_cast<float>(own.x());
    r.y_m = static_cast<float>(own.y());
    keeper.note(r);
    seen_.emplace_back(time_s, key_of(r));
  }
  // Where the frame of a map is, by its landmarks; all of them must agree.
  Pose2 T_world_map(std::span<const LandmarkRecord> map) {
    std::vector<PointPair> pairs;
    for (const LandmarkRecord& r : map) {
      PointPair pair;
      pair.a = world_.at(key_of(r));
      pair.b = {r.x_m, r.y_m};
      pairs.push_back(pair);
    }
    const Pose2 T = pairs.size() < 2 ? Pose2{} : fit_rigid(pairs);
    if (pairs.size() < 2) return T;
    for (const PointPair& p : pairs) EXPECT_LT((p.a - T * p.b).norm(), 0.1);
    return T;
  }
  void keep_until(double time_s) {
    for (const auto& [time, key] : seen_) {
      if (time <= time_s) kept_.insert(key);
    }
  }
  double uniform(double low, double high) { return low + (high - low) * random_.uniform(); }

  const TestSeed seed_;
  Random random_{seed_.value(), 1};
  std::map<Key, Eigen::Vector2d> world_;
  Pose2 T_world_own_;
  std::uint32_t next_id_ = 1;
  std::vector<std::pair<double, Key>> seen_;  // in this life, when
  std::set<Key> kept_;                        // must be on the disk
  std::size_t written_ = 0;
};

// What is on the disk holds all of `kept_`; it becomes what must be there from now on.
void PowerCuts::check_disk(storage::FaultyFolder& disk, const char* when) {
  MapShelf shelf(disk, {});
  std::set<Key> found;
  for (const PastMap& past : shelf.load(true)) {
    T_world_map(past.landmarks);
    for (const LandmarkRecord& r : past.landmarks) found.insert(key_of(r));
  }
  for (const std::string& name : disk.names()) {
    EXPECT_EQ(name.find(".damaged"), std::string::npos) << name << " " << when;
  }
  const auto lost =
      std::count_if(kept_.begin(), kept_.end(), [&](Key key) { return found.count(key) == 0; });
  EXPECT_EQ(lost, 0) << when << ", of " << kept_.size();
  kept_ = std::move(found);
}

bool PowerCuts::live(storage::FaultyFolder& disk, int at) {
  MapKeeper keeper(disk, storage::random_map(0, random_).head, kInterval);
  T_world_own_ = {uniform(-50, 50), uniform(-50, 50), uniform(-3, 3)};
  next_id_ = 1;
  seen_.clear();
  const auto past = keeper.load();
  std::vector<PeerReport> peers;
  for (const PastMap& map : past) {
    if (map.landmarks.size() < 3) continue;  // nobody finds himself in that
    PeerReport report;
    report.peer = map.slot;
    report.T_own_peer = T_world_own_.inverse() * T_world_map(map.landmarks);
    report.variance = {1e-4, 1e-4, 1e-8};
    peers.push_back(report);
  }
  // Where too many sessions lie one would give way.
  const bool crowded = past.size() == static_cast<std::size_t>(MapShelf::kPlaces);
  disk.cut_after(at);
  for (double now = 0.0; now < kLife_s && !disk.is_cut(); now += kStep_s) {
    if (random_.uniform() < 0.7) see_a_landmark(keeper, now);
    for (PeerReport& peer : peers) {
      if (crowded || random_.uniform() < 0.02) {
        peer.state = AlignmentState::kMerged;
      } else if (random_.uniform() < 0.02) {
        peer.state = AlignmentState::kWithdrawn;
      }
    }
    keeper.turn_once(at_time(now), peers);
    if (disk.is_cut()) keep_until(now - kInterval.seconds());
  }
  const bool in_the_end = !disk.is_cut();
  if (in_the_end) keeper.finish(at_time(kLife_s), peers);
  const bool cut = disk.is_cut();
  if (in_the_end) keep_until(cut ? kLife_s - kInterval.seconds() : kLife_s);
  MapStatus status;
  keeper.read(status);
  written_ += status.written;
  return cut;
}

TEST_F(PowerCuts, CostAtMostFiveSecondsOfMapping) {
  int cuts = 0;
  for (int at = 0;; ++at) {
    storage::FaultyFolder disk(seed_.value() + static_cast<std::uint64_t>(at));
    kept_.clear();
    bool cut = false;
    for (int life = 0; life < 4; ++life) {
      cut = live(disk, at);
      cuts += cut ? 1 : 0;
      disk.power_on();
      check_disk(disk, cut ? "after a cut" : "after the end");
      ASSERT_FALSE(HasFailure()) << "life " << life << ", cut before change " << at;
    }
    if (!cut) break;
  }
  EXPECT_GE(cuts, 200);
  print_figure(
      "stored maps: %d power cuts over %zu checkpoints while the robot found itself, or "
      "not: nothing older than 5 s lost",
      cuts, written_);
}

}  // namespace
}  // namespace zenith
