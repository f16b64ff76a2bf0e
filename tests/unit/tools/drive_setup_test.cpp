// Drives through rendered pixels whose set-up is wrong in one way: the cause is named, and the
// change that mends it, whatever the world and the seed; of the right set-up nothing is.

#include "tools/calibrate/drive_setup.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slam/image/view.h"
#include "tools/bent/bends.h"
#include "tools/calibrate/drive_calibration.h"
#include "tools/calibrate/drive_tracks.h"
#include "tools/runner/simulated_source.h"

namespace zenith::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using enum SetupCode;

constexpr double kDegree = std::numbers::pi / 180.0;

struct World {
  const char* name;
  double duration_s;
  std::uint64_t seed;
};

Tape drive_in(const World& world) {
  Parameters wide;
  wide.rectified_fov_deg =
      kWidestFitted_deg + 14.0;  // a mount that is told wrongly looks elsewhere
  auto team = simulate_team(world.name, world.seed, world.duration_s, wide);
  EXPECT_TRUE(team.ok()) << team.error().message;
  auto tape = read_tape(*team->sources[0]);
  EXPECT_TRUE(tape.ok()) << tape.error().message;
  return std::move(*tape);
}

DriveData follow(const Tape& tape) {
  TapeSource source(tape);
  auto data = track_drive(source, [](double) {});
  EXPECT_TRUE(data.ok()) << data.error().message;
  return std::move(*data);
}

// What was seen does not depend on the wheels: the same frames beside other wheels.
DriveData with_wheels_of(const Tape& tape, const DriveData& seen) {
  DriveData data = seen;
  data.wheels = {};
  for (const WheelSample& w : tape.wheels) {
    data.wheels.add((w.stamp - tape.start()).seconds(), {w.left_m, w.right_m});
  }
  return data;
}

class DriveSetups : public testing::TestWithParam<World> {
 protected:
  DriveSetups() : tape_(drive_in(GetParam())), seen_(follow(tape_)) {}

  DriveSetup of_wheels(const std::function<void(Tape&)>& bend) const {
    Tape bent = tape_;
    bend(bent);
    return find_setup(with_wheels_of(bent, seen_));
  }
  DriveSetup of_pictures(const std::function<void(Tape&)>& bend) const {
    Tape bent = tape_;
    bend(bent);
    return find_setup(follow(bent));
  }

  void check_right_one() const;
  void check_wheels() const;
  void check_delays() const;
  void check_mirrored_picture() const;
  void check_turned_mount() const;

  const Tape tape_;
  const DriveData seen_;
};

// One case, for the drive is rendered once.
TEST_P(DriveSetups, EachCauseIsNamedAndTheRightOneIsNotAccused) {
  check_right_one();
  check_wheels();
  check_delays();
  check_mirrored_picture();
  check_turned_mount();
}

void DriveSetups::check_right_one() const {
  const DriveSetup setup = find_setup(seen_);
  EXPECT_TRUE(setup.judged);
  EXPECT_THAT(setup.causes, IsEmpty());
  EXPECT_EQ(setup.change, SetupChange{});
  EXPECT_THAT(setup_text(setup), IsEmpty());
}

void DriveSetups::check_wheels() const {
  const DriveSetup swapped = of_wheels(swap_wheels);
  EXPECT_THAT(swapped.causes, ElementsAre(kWheelsSwapped));
  EXPECT_EQ(swapped.change.wheels, (WheelOrder{true, false, false}));
  const DriveSetup left = of_wheels([](Tape& t) { reverse_wheels(t, WhichWheel::kLeft); });
  EXPECT_THAT(left.causes, ElementsAre(kLeftReversed));
  EXPECT_EQ(left.change.wheels, (WheelOrder{false, true, false}));
  const DriveSetup right = of_wheels([](Tape& t) { reverse_wheels(t, WhichWheel::kRight); });
  EXPECT_THAT(right.causes, ElementsAre(kRightReversed));
  EXPECT_EQ(right.change.wheels, (WheelOrder{false, false, true}));
  const DriveSetup both = of_wheels([](Tape& t) { reverse_wheels(t, WhichWheel::kBoth); });
  EXPECT_THAT(both.causes, ElementsAre(kWheelsReversed));
  EXPECT_EQ(both.change.wheels, (WheelOrder{false, true, true}));
  for (const DriveSetup& setup : {swapped, left, right, both}) {
    EXPECT_EQ(setup.change.picture, Mirrored::kNot);
    EXPECT_EQ(setup.change.yaw_rad, 0.0);
    EXPECT_THAT(setup_text(setup), testing::Contains(HasSubstr("change the lines below")));
  }
  // Two mistakes at once.
  const DriveSetup two = of_wheels([](Tape& t) {
    reverse_wheels(t, WhichWheel::kLeft);
    swap_wheels(t);
  });
  EXPECT_THAT(two.causes, ElementsAre(kWheelsSwapped, kLeftReversed));
}

void DriveSetups::check_delays() const {
  const double own_s = find_setup(seen_).fit.delay_s;  // a base's latency
  for (const double delay_s : {-1.0, -0.4, 0.15, 0.5, 1.0}) {
    SCOPED_TRACE(delay_s);
    const DriveSetup setup = of_wheels([&](Tape& t) { delay_wheels(t, delay_s); });
    EXPECT_THAT(setup.causes, ElementsAre(kStampsApart));
    EXPECT_NEAR(setup.delay_s, own_s + delay_s, 0.01);
    EXPECT_EQ(setup.change, SetupChange{});
  }
  const DriveSetup with = of_wheels([](Tape& t) {
    swap_wheels(t);
    delay_wheels(t, 0.7);
  });
  EXPECT_THAT(with.causes, ElementsAre(kWheelsSwapped, kStampsApart));
}

void DriveSetups::check_mirrored_picture() const {
  const DriveSetup setup = of_pictures(mirror_pictures);
  EXPECT_THAT(setup.causes, ElementsAre(kPictureMirrored));
  EXPECT_EQ(setup.change.picture, Mirrored::kColumns);
  EXPECT_EQ(setup.change.yaw_rad, 0.0);
  EXPECT_EQ(setup.change.wheels, WheelOrder{});
}

void DriveSetups::check_turned_mount() const {
  for (const double degrees : {90.0, -90.0, 180.0}) {
    SCOPED_TRACE(degrees);
    const DriveSetup setup = of_pictures([&](Tape& t) { turn_mount(t, degrees); });
    EXPECT_THAT(setup.causes, ElementsAre(kYawWrong));
    EXPECT_EQ(setup.change.wheels, WheelOrder{});
    EXPECT_EQ(setup.change.picture, Mirrored::kNot);
    EXPECT_NEAR(std::abs(wrap_angle(setup.change.yaw_rad + degrees * kDegree)), 0.0, 6.0 * kDegree);
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, DriveSetups,
                         testing::Values(World{"calibration", 30.0, 1},
                                         World{"calibration", 30.0, 2},
                                         World{"corridor-rooms", 36.0, 1},
                                         World{"corridor-rooms", 36.0, 3}),
                         [](const auto& world) {
                           std::string name = world.param.name;
                           std::erase(name, '-');
                           return name + std::to_string(world.param.seed);
                         });

}  // namespace
}  // namespace zenith::tools
