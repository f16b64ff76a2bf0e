#include "platform/daemon/perception.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "platform/daemon/device_keeper.h"
#include "tests/memory/heap_guard.h"
#include "tests/support/patience.h"
#include "tests/unit/daemon/fake_devices.h"

namespace zenith {
namespace {

Parameters few_particles() {
  Parameters parameters;
  parameters.particles = 32;
  return parameters;
}

// However slow the computer: a frame waits for its wheels, and no step is too long.
LiveSettings calm_settings() {
  LiveSettings live;
  live.patience = kPatience;
  live.load.busy_share = 1e6;
  return live;
}

// The perception thread with a keeper, as in the daemon.
class PerceptionRig {
 public:
  explicit PerceptionRig(const LiveSettings& live = calm_settings())
      : perception(robot.devices, few_particles(), 1, live, *exchange, &tap),
        keeper_(*robot.devices.camera, perception.camera_turn(), *robot.devices.can,
                perception.can_turn()) {
    warm_up(robot.devices.robot, few_particles());
  }
  ~PerceptionRig() { stop(); }

  void start() {
    keeping_ = std::thread([this] { keeper_.run(stop_); });
    perceiving_ = std::thread([this] {
      const HeapGuard guard;
      perception.run(stop_);
      heap_calls = guard.calls();
    });
    robot.drive();
  }
  void stop() {
    robot.stop();
    stop_.store(true);
    if (keeping_.joinable()) keeping_.join();
    if (perceiving_.joinable()) perceiving_.join();
  }

  PerceptionReport report() const {
    PerceptionReport report;
    perception.read(report);
    return report;
  }
  bool wait_for(const std::function<bool(const PerceptionReport&)>& holds) const {
    const Time limit = monotonic_now() + kPatience;
    while (!holds(report())) {
      if (monotonic_now() > limit) return false;
      sleep_until(monotonic_now() + Duration{10'000'000});
    }
    return true;
  }
  // Events are taken as they are looked for.
  bool saw(PerceptionEventKind kind) {
    PerceptionEvent event;
    while (perception.next_event(event)) seen_.push_back(event.kind);
    return std::find(seen_.begin(), seen_.end(), kind) != seen_.end();
  }

  FakeRobot robot;
  const std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
  tap::Tap tap{Lens{}.width_px, Lens{}.height_px, 4};
  Perception perception;
  std::uint64_t heap_calls = 0;  // of the perception thread, after stop()

 private:
  DeviceKeeper keeper_;
  std::atomic<bool> stop_ = false;
  std::vector<PerceptionEventKind> seen_;
  std::thread keeping_;
  std::thread perceiving_;
};

TEST(Perception, MakesPosesOfFramesAndWheels) {
  PerceptionRig rig;
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 30; }));
  rig.stop();
  const PerceptionReport report = rig.report();
  EXPECT_TRUE(report.has_pose);
  EXPECT_GT(report.corners, 10);
  EXPECT_GT(report.T_start_robot.x_m, 0.05);
  EXPECT_GT(report.wheels.samples, 100u);
  EXPECT_LT(report.steps.odometry_extrapolated, report.steps.frames / 2);
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kFirstPose));
  EXPECT_EQ(rig.perception.deadlines().step.count(), report.steps.frames);
  EXPECT_GT(rig.perception.deadlines().wake_up.count(), 0u);
}

TEST(Perception, LeavesAPictureForWhoAsksAndOnlyThen) {
  PerceptionRig rig;
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 10 && r.inliers > 0; }));
  EXPECT_EQ(rig.perception.next_picture(), nullptr);
  rig.perception.ask_picture();
  const Picture* picture = nullptr;
  ASSERT_TRUE(rig.wait_for([&](const auto&) {
    picture = rig.perception.next_picture();
    // On a busy computer the robot drives slowly, and a frame may show too little motion to be
    // used.
    if (picture != nullptr && !picture->used) rig.perception.ask_picture();
    return picture != nullptr && picture->used;
  }));
  rig.stop();
  EXPECT_GT(picture->corners.size(), 10u);
  const auto [dark, bright] = std::minmax_element(picture->image.begin(), picture->image.end());
  EXPECT_GT(*bright - *dark, 50);
  EXPECT_EQ(rig.perception.next_picture(), nullptr) << "one was asked for";
  EXPECT_EQ(rig.heap_calls, 0u);
  int inliers = 0;
  for (const SeenCorner& c : picture->corners) {
    if (!c.inlier) continue;
    ++inliers;
    EXPECT_GT(c.landmark, 0u);
    EXPECT_NEAR(c.predicted_u_px, c.u_px, 40.0F);
    EXPECT_NEAR(c.predicted_v_px, c.v_px, 40.0F);
  }
  EXPECT_GT(inliers, 0);
}

TEST(Perception, TakesNothingFromTheHeap) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has the heap";
  {
    const HeapGuard guard;
    const auto taken = std::make_unique<int>(3);
    ASSERT_EQ(guard.calls(), 1u) << "the guard sees nothing";
  }
  PerceptionRig rig;
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 20; }));
  // What goes wrong needs no heap either.
  rig.robot.camera->set_plugged(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.camera_up; }));
  rig.robot.camera->set_plugged(true);
  rig.robot.can->set_up(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.camera.opened == 2 && !r.can_up; }));
  rig.robot.can->set_up(true);
  rig.perception.set_live(calm_settings());
  LandmarkRecord landmark;
  for (std::uint32_t i = 0; i < 300; ++i) {
    landmark.id = i;
    rig.exchange->peers.push({static_cast<int>(i % 3), PeerNews::Kind::kRecord, landmark});
  }
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.can_up && r.steps.frames >= 60; }));
  rig.stop();
  EXPECT_EQ(rig.heap_calls, 0u);
  EXPECT_EQ(rig.exchange->peers.size(), 0u);
}

// Somebody records: a copy of each frame, of the wheels' frames and of the poses is left in the
// tap, as long as there is room; with or without, the thread goes on.
TEST(Perception, LeavesCopiesInTheTapWithoutTheHeap) {
  PerceptionRig rig;
  rig.start();
  rig.tap.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 20; }));
  EXPECT_GT(rig.tap.drops().frames, 0u) << "nobody took them out";
  tap::TappedFrame frame;
  CanFrame can;
  tap::TappedPose pose;
  std::uint64_t frames = 0;
  Time last;
  const auto take_all = [&] {
    while (rig.tap.next(frame)) {
      EXPECT_GT(frame.head.stamp, last);
      last = frame.head.stamp;
      ++frames;
      rig.tap.give_back(frame);
    }
  };
  EXPECT_TRUE(rig.wait_for([&](const auto&) {
    take_all();
    return frames > 20;
  }));
  rig.stop();
  take_all();
  ASSERT_TRUE(rig.tap.next(can));
  EXPECT_EQ(can.id, agilex_v2::kOdometerId);
  ASSERT_TRUE(rig.tap.next(pose));
  EXPECT_GT(pose.stamp.ns, 0);
  if (HeapGuard::works()) {
    EXPECT_EQ(rig.heap_calls, 0u);
  }
}

TEST(Perception, LostDevicesComeBackAndTheMapStays) {
  PerceptionRig rig;
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 10; }));
  rig.robot.camera->set_plugged(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.camera_up; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kCameraLost));
  const std::uint64_t beat = rig.perception.heartbeat();
  const auto frames = rig.report().steps.frames;
  EXPECT_TRUE(rig.wait_for([&](const auto&) { return rig.perception.heartbeat() > beat + 10; }))
      << "the loop goes on without a camera";
  EXPECT_EQ(rig.report().steps.frames, frames);
  rig.robot.camera->set_plugged(true);
  ASSERT_TRUE(rig.wait_for([&](const auto& r) { return r.steps.frames > frames + 5; }));

  rig.robot.can->set_bus_off(true);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.bus_off; }));
  rig.robot.can->set_bus_off(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.bus_off && r.can_up; }));
  rig.robot.can->set_up(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.can_up; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kCanLost));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kBusOff));
  const auto without = rig.report().steps.frames;
  ASSERT_TRUE(rig.wait_for([&](const auto& r) { return r.steps.frames > without + 5; }))
      << "frames are used without wheels, too";
  rig.robot.can->set_up(true);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.can_up; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kBusBack));
  EXPECT_GT(rig.report().T_start_robot.x_m, 0.02);
}

// A loop-back device whose writer died, a driver that hangs: old pictures under new stamps.
TEST(Perception, AFrozenPictureIsNotUsedAndItsCameraIsOpenedAgain) {
  PerceptionRig rig;
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 20; }));
  EXPECT_EQ(rig.report().frames_frozen, 0u);
  rig.robot.freezes.store(true);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.camera_frozen && r.camera.opened >= 2; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kPictureFrozen));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kCameraLost));
  EXPECT_FALSE(rig.saw(PerceptionEventKind::kPictureMoves));
  const PerceptionReport frozen = rig.report();
  // Opened again it gives the same picture still: none of these frames is used.
  ASSERT_TRUE(
      rig.wait_for([&](const auto& r) { return r.frames_frozen > frozen.frames_frozen + 10; }));
  EXPECT_EQ(rig.report().steps.frames, frozen.steps.frames);
  EXPECT_EQ(rig.report().last_frame, frozen.last_frame) << "health sees no frames";
  rig.robot.freezes.store(false);
  ASSERT_TRUE(rig.wait_for(
      [&](const auto& r) { return !r.camera_frozen && r.steps.frames > frozen.steps.frames + 5; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kPictureMoves));
  rig.stop();
  EXPECT_EQ(rig.heap_calls, 0u);
}

TEST(Perception, ARobotThatStandsBeforeAnEqualPictureHasAGoodCamera) {
  PerceptionRig rig;
  rig.robot.stands.store(true);
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 60; }));
  const PerceptionReport report = rig.report();
  EXPECT_EQ(report.frames_frozen, 0u);
  EXPECT_FALSE(report.camera_frozen);
  EXPECT_EQ(report.camera.opened, 1u);
}

// What a step may take follows the camera that is open, not the wish.
TEST(Perception, TheFramesPeriodIsTheCamerasOwn) {
  PerceptionRig rig;  // asked for 20 a second, and gets as many
  constexpr Duration kSlow = {5'000'000'000};
  constexpr Duration kSlower = {8'000'000'000};
  rig.robot.camera->set_period(kSlow);
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 1; }));
  EXPECT_EQ(rig.report().agreed_period, kSlow);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.measured_period.ns > 0; }));
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.period == r.measured_period; }));
  EXPECT_LT(rig.report().period, kSlow) << "the driver is wrong: the frames' stamps count";
  rig.robot.camera->set_period(kSlower);
  rig.robot.camera->set_plugged(false);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.camera_up; }));
  rig.robot.camera->set_plugged(true);
  ASSERT_TRUE(rig.wait_for([&](const auto& r) { return r.agreed_period == kSlower; }));
}

TEST(Perception, WaitsForWheelsButNotForEver) {
  LiveSettings live = calm_settings();
  live.patience = {20'000'000};
  PerceptionRig rig(live);
  rig.robot.wheels_on.store(false);
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 5; }));
  const PerceptionReport without = rig.report();
  EXPECT_EQ(without.wheels_late, without.steps.frames);
  rig.robot.wheels_on.store(true);
  rig.perception.set_live(calm_settings());
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.wheels.samples > 20; }));
  // A frame of before may still be under way.
  const auto begun = rig.report().steps.frames;
  ASSERT_TRUE(rig.wait_for([&](const auto& r) { return r.steps.frames >= begun + 2; }));
  const PerceptionReport before = rig.report();
  ASSERT_TRUE(
      rig.wait_for([&](const auto& r) { return r.steps.frames >= before.steps.frames + 10; }));
  EXPECT_EQ(rig.report().wheels_late, before.wheels_late);
}

TEST(Perception, ShedsCornersWhenStepsTakeTooLong) {
  LiveSettings slow = calm_settings();
  slow.load = {1e-6, 40, kMaxCorners};  // any step is too long
  PerceptionRig rig(slow);
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.corners_max == 40; }));
  EXPECT_TRUE(rig.saw(PerceptionEventKind::kShedding));
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.frames >= 20; }));
  EXPECT_LE(rig.report().corners, 40);
  EXPECT_GT(rig.report().frames_shed, 10u);
  LiveSettings patient = calm_settings();
  patient.load = {1e6, 40, 40};
  rig.perception.set_live(patient);
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return !r.sheds; }));
  EXPECT_EQ(rig.report().corners_max, 40);
}

TEST(Perception, PublishesNoMoreThanThereIsRoomFor) {
  PerceptionRig rig;
  while (rig.exchange->own.push({})) {
  }
  const auto rejected = rig.exchange->own.rejected();
  rig.start();
  ASSERT_TRUE(rig.wait_for([](const auto& r) { return r.steps.mapper.landmarks_promoted > 5; }));
  EXPECT_EQ(rig.exchange->own.rejected(), rejected) << "what found no room was taken from the map";
}

}  // namespace
}  // namespace zenith
