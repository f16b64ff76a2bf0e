// The core under hostile input, compiled as the release is, without assertions, and with the
// sanitizers for addresses and undefined behaviour: thousands of steps with wheels, stamps, frames,
// peers' records and calls as no device and no robot would send them. All that it gives out is
// finite, its counters add up, and it maps again once the input is good.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "platform/base/random.h"
#include "slam/slam.h"
#include "tests/support/hall.h"
#include "tests/support/seeds.h"

#ifndef NDEBUG
#error "compiled as the release is"
#endif

namespace zenith {
namespace {

constexpr std::int64_t kPeriod_ns = 100'000'000;
constexpr double kStep_m = 0.05;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::array kNumbers = {kNan, kInfinite, -kInfinite, 1e300, -1e300, 1e9,     1e5,
                                 -1e4, 8400.0,    1e-310,     0.0,   -0.0,   1.7e308, 1e20};
constexpr std::array<std::int64_t, 8> kStamps = {std::numeric_limits<std::int64_t>::max(),
                                                 std::numeric_limits<std::int64_t>::min(),
                                                 std::int64_t{1} << 61,
                                                 -(std::int64_t{1} << 61),
                                                 std::int64_t{40} * 365 * 86400 * 1'000'000'000,
                                                 0,
                                                 -1,
                                                 1};

RobotConfig hostile_robot() {
  RobotConfig robot = small_robot();
  robot.mount.x_m = 0.05;
  return robot;
}

Parameters few_particles() {
  Parameters parameters;
  parameters.particles = 24;
  return parameters;
}

// How many calls of each kind were made: what the counters are held against.
struct Calls {
  std::uint64_t steps = 0;
  std::uint64_t bad_samples = 0;  // beyond the bounds, whatever their stamp
  std::uint64_t bad_records = 0;
  std::uint64_t bad_calls = 0;
};

class HostileDrive {
 public:
  explicit HostileDrive(std::uint64_t seed)
      : random_(seed),
        memory_(Slam::memory_needed(few_particles())),
        slam_(hostile_robot(), few_particles(), seed, memory_.span()),
        hall_(hostile_robot().lens) {}

  // The robot drives on along its curve, and everything says so.
  void good_step() {
    advance();
    const WheelSample sample = {stamp(), left_m_, right_m_};
    step({stamp(), hall_.seen_from(truth_ * Pose2{0.05, 0.0, 0.0}), {&sample, 1}, kMaxCorners});
  }
  void hostile_step();

  const Slam& slam() const { return slam_; }
  const Calls& calls() const { return calls_; }
  const Pose2& truth() const { return truth_; }

  void expect_finite();
  void expect_counters_to_add_up();

 private:
  Time stamp() const { return {time_ns_}; }
  void advance() {
    time_ns_ += kPeriod_ns;
    const double half = 0.5 * turn_ * hostile_robot().wheels.track_width_m;
    left_m_ += kStep_m - half;
    right_m_ += kStep_m + half;
    truth_ = truth_ * wheel_motion(hostile_robot().wheels, {kStep_m - half, kStep_m + half});
    if (++steps_of_curve_ == 40) {
      steps_of_curve_ = 0;
      turn_ = -turn_;
    }
  }
  void step(const StepInput& input) {
    ++calls_.steps;
    slam_.step(input);
    told_.resize(256);
    told_.resize(slam_.publish(told_));
  }

  std::size_t pick(std::size_t count) {
    return std::min(static_cast<std::size_t>(random_.uniform() * static_cast<double>(count)),
                    count - 1);
  }
  double number() { return kNumbers[pick(kNumbers.size())]; }
  bool chance(double share) { return random_.uniform() < share; }
  std::vector<WheelSample> hostile_wheels();
  StepInput hostile_frame();
  LandmarkRecord hostile_record();
  void hostile_calls();

  Random random_;
  MemoryBlock memory_;
  Slam slam_;
  Hall hall_;
  Calls calls_;
  std::vector<std::uint8_t> noise_ = std::vector<std::uint8_t>(320 * 240);
  std::vector<LandmarkRecord> told_;
  std::int64_t time_ns_ = 1'000'000'000;
  double left_m_ = 3.0;
  double right_m_ = -2.0;
  double turn_ = 0.02;
  int steps_of_curve_ = 20;
  Pose2 truth_;
};

std::vector<WheelSample> HostileDrive::hostile_wheels() {
  std::vector<WheelSample> wheels;
  const std::size_t count = chance(0.05) ? 2 * kMaxWheelSamples : 1 + pick(4);
  for (std::size_t i = 0; i < count; ++i) {
    WheelSample sample = {{time_ns_ + static_cast<std::int64_t>(i)}, left_m_, right_m_};
    if (chance(0.1)) sample.stamp.ns += static_cast<std::int64_t>(1e12 * random_.normal());
    if (chance(0.3)) sample.stamp.ns = kStamps[pick(kStamps.size())];
    if (chance(0.3)) sample.left_m = number();
    if (chance(0.3)) sample.right_m = number();
    if (chance(0.1)) sample.left_m += 100.0 * random_.normal();
    const bool usable = std::abs(sample.left_m) <= 1e9 && std::abs(sample.right_m) <= 1e9;
    calls_.bad_samples += usable ? 0 : 1;
    wheels.push_back(sample);
  }
  return wheels;
}

StepInput HostileDrive::hostile_frame() {
  StepInput input;
  input.stamp = stamp();
  if (chance(0.1)) input.stamp.ns -= static_cast<std::int64_t>(pick(20)) * kPeriod_ns;
  if (chance(0.2)) input.stamp.ns = kStamps[pick(kStamps.size())];
  if (chance(0.1)) input.corners_max = chance(0.5) ? -1'000'000 : 1'000'000;
  const Pose2 elsewhere = {100.0 * random_.normal(), 100.0 * random_.normal(), random_.normal()};
  input.frame = hall_.seen_from(chance(0.2) ? elsewhere : truth_ * Pose2{0.05, 0.0, 0.0});
  switch (pick(12)) {
    case 0:
      input.frame.data = nullptr;
      break;
    case 1:
      input.frame.width += chance(0.5) ? 1 : -1;
      break;
    case 2:
      input.frame.height = chance(0.5) ? 0 : 1 << 20;
      break;
    case 3:
      input.frame.stride = chance(0.5) ? 0 : -input.frame.stride;
      break;
    case 4:
      std::fill(noise_.begin(), noise_.end(), static_cast<std::uint8_t>(chance(0.5) ? 255 : 0));
      input.frame.data = noise_.data();
      break;
    case 5:
      for (std::uint8_t& p : noise_) p = static_cast<std::uint8_t>(pick(256));
      input.frame.data = noise_.data();
      break;
    default:
      break;
  }
  return input;
}

// Half of them are the robot's own, with one field or two made absurd.
LandmarkRecord HostileDrive::hostile_record() {
  LandmarkRecord r;
  if (!told_.empty() && chance(0.5)) r = told_[pick(told_.size())];
  r.id = chance(0.9) ? static_cast<std::uint32_t>(pick(300)) : 0xFFFFFFFFU;
  r.revision = chance(0.9) ? static_cast<std::uint32_t>(pick(1000)) : 0xFFFFFFFFU;
  r.removed = chance(0.1);
  const auto absurd = [&](float& field) {
    if (chance(0.05)) field = static_cast<float>(std::clamp(number(), -3e38, 3e38));
    if (chance(0.01)) field = static_cast<float>(kNan);
    if (chance(0.01)) field = static_cast<float>(kInfinite);
  };
  absurd(r.x_m);
  absurd(r.y_m);
  absurd(r.z_m);
  for (float& c : r.covariance_m2) absurd(c);
  if (chance(0.3)) r.appearance_count = static_cast<std::uint8_t>(pick(256));
  for (AppearanceRecord& look : r.appearances) {
    absurd(look.direction_rad);
    if (chance(0.05)) look.descriptor.fill(static_cast<std::int8_t>(pick(256)));
  }
  bool usable = r.appearance_count <= kPublishedAppearances;
  for (const float x : {r.x_m, r.y_m, r.z_m}) usable = usable && std::abs(x) <= 1e5F;
  for (const float c : r.covariance_m2) usable = usable && std::abs(c) <= 1e5F;
  calls_.bad_records += usable ? 0 : 1;
  return r;
}

void HostileDrive::hostile_calls() {
  constexpr std::array kPeers = {-1, -2'000'000'000, kMaxPeers, 2'000'000'000, 0, 1,
                                 2,  kMaxPeers - 1};
  const int peer = kPeers[pick(kPeers.size())];
  const bool known = peer >= 0 && peer < kMaxPeers;
  std::vector<LandmarkRecord> records(pick(40));
  const std::uint64_t before = calls_.bad_records;
  for (LandmarkRecord& r : records) r = hostile_record();
  if (!known) calls_.bad_records = before;
  switch (pick(5)) {
    case 0:
      slam_.remember(peer, records);
      break;
    case 1:
    case 2:
      slam_.receive(peer, records);
      break;
    case 3: {
      calls_.bad_records = before;
      const Pose2 T = {number(), number(), number()};
      const auto within = [](double x, double most) { return std::abs(x) <= most; };
      const bool usable = within(T.x_m, 1e5) && within(T.y_m, 1e5) && within(T.theta_rad, 8.0);
      slam_.offer_alignment(peer, T);
      calls_.bad_calls += known && !usable ? 1 : 0;
      break;
    }
    default:
      calls_.bad_records = before;
      if (chance(0.1) || !known) {
        slam_.forget(peer);
      } else {
        return;
      }
  }
  calls_.bad_calls += known ? 0 : 1;
  static_cast<void>(slam_.correspondences(peer));
}

void HostileDrive::hostile_step() {
  advance();
  StepInput input = hostile_frame();
  const std::vector<WheelSample> wheels = hostile_wheels();
  input.wheels = wheels;
  step(input);
  hostile_calls();
}

void HostileDrive::expect_finite() {
  const StepOutput& o = slam_.output();
  const Odometry& odometry = o.odometry;
  for (const Pose2& p : {o.T_start_robot, odometry.T_odom_robot}) {
    ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.theta_rad));
  }
  for (const Eigen::Matrix3d& c :
       {o.pose_covariance, odometry.covariance, odometry.velocity_covariance}) {
    ASSERT_TRUE(c.allFinite());
    ASSERT_GE(c.diagonal().minCoeff(), 0.0);
  }
  ASSERT_TRUE(odometry.velocity.allFinite());
  ASSERT_TRUE(o.effective_sample_size >= 0.0 && o.effective_sample_size < 25.0);
  for (const Alignment& a : slam_.alignments()) {
    ASSERT_TRUE(std::isfinite(a.T_own_peer.x_m + a.T_own_peer.y_m + a.T_own_peer.theta_rad));
    ASSERT_TRUE(a.covariance.allFinite() && std::isfinite(a.confidence));
  }
  std::vector<LandmarkEstimate> landmarks(kMaxLandmarks);
  landmarks.resize(slam_.landmarks(landmarks));
  for (const LandmarkEstimate& l : landmarks) {
    ASSERT_TRUE(l.position_m.allFinite() && l.covariance_m2.allFinite()) << l.id;
  }
  for (const LandmarkRecord& r : told_) {
    ASSERT_TRUE(std::isfinite(r.x_m + r.y_m + r.z_m)) << r.id;
    for (const float c : r.covariance_m2) ASSERT_TRUE(std::isfinite(c)) << r.id;
  }
}

void HostileDrive::expect_counters_to_add_up() {
  const StepCounters c = slam_.counters();
  EXPECT_EQ(c.frames + c.frames_refused, calls_.steps);
  EXPECT_EQ(c.calls_refused, calls_.bad_calls);
  EXPECT_GE(c.odometry_rejected, calls_.bad_samples);
  EXPECT_GE(c.records_refused, calls_.bad_records);
  EXPECT_EQ(c.parameters_limited, 0u);
  const MapperCounters& m = c.mapper;
  EXPECT_LE(m.landmarks_promoted + m.repairs.landmarks_dropped, 2 * (m.landmarks_created + 1));
}

TEST(HostileSteps, AllThatComesOutIsFiniteAndItMapsOnAfterwardsOrSaysThatItIsLost) {
  const TestSeed seed;
  HostileDrive drive(seed.value());
  for (int i = 0; i < 40; ++i) drive.good_step();
  EXPECT_EQ(drive.slam().counters().mapper.repairs.total(), 0u);
  EXPECT_GT(drive.slam().counters().mapper.landmarks_promoted, 20u);
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    if (i % 3 == 0) {
      drive.good_step();
    } else {
      drive.hostile_step();
    }
    drive.expect_finite();
    if (testing::Test::HasFatalFailure()) return;
  }
  drive.expect_counters_to_add_up();
  const StepCounters c = drive.slam().counters();
  EXPECT_GT(c.frames, 500u);
  EXPECT_GT(c.frames_refused, 100u);
  EXPECT_GT(c.odometry_jumps, 10u);
  EXPECT_GT(c.records_refused, 100u);
  // Clocks are followed after a while, and the last strange frames leave the view.
  for (int i = 0; i < 60; ++i) drive.good_step();
  const auto pose = [&] { return drive.slam().output().T_start_robot; };
  const Pose2 estimate_before = pose();
  const Pose2 truth_before = drive.truth();
  const auto refused = drive.slam().counters().frames_refused;
  for (int i = 0; i < 40; ++i) drive.good_step();
  drive.expect_finite();
  EXPECT_EQ(drive.slam().counters().frames_refused, refused);
  const Pose2 moved = estimate_before.inverse() * pose();
  const Pose2 truly = truth_before.inverse() * drive.truth();
  EXPECT_LT((moved.position() - truly.position()).norm(), 0.08);
  EXPECT_LT(std::abs(wrap_angle(moved.theta_rad - truly.theta_rad)), 0.04);
  // Where the strange input has carried it off its map, it says so and goes by its wheels.
  const StepOutput& output = drive.slam().output();
  EXPECT_TRUE(output.inliers > 10 || output.tracking == TrackingState::kLost)
      << state_name(output.tracking);
}

// Parameters of every kind of absurdity, one at a time and all at once: taken within their limits.
TEST(HostileSteps, ParametersBeyondTheirLimitsAreLimited) {
  const TestSeed seed;
  Random random(seed.value());
  Hall hall(hostile_robot().lens);
  for (int trial = 0; trial < 30; ++trial) {
    Parameters p = few_particles();
    for (const ParameterInfo& info : parameter_table()) {
      if (random.uniform() < 0.7) continue;
      const double value =
          random.uniform() < 0.5
              ? (random.uniform() < 0.5 ? info.min : info.max)
              : kNumbers[static_cast<std::size_t>(random.uniform() * kNumbers.size())];
      std::visit(
          [&](auto field) {
            using Number = std::remove_reference_t<decltype(p.*field)>;
            if constexpr (std::is_same_v<Number, int>) {
              p.*field = static_cast<int>(std::clamp(std::isnan(value) ? 0.0 : value, -2e9, 2e9));
            } else {
              p.*field = value;
            }
          },
          info.field);
    }
    p.particles = std::min(p.particles, 64);  // for the time that it takes
    const MemoryBlock memory(Slam::memory_needed(p));
    Slam slam(hostile_robot(), p, seed.value(), memory.span());
    int limited = 0;
    within_limits(p, &limited);
    EXPECT_EQ(slam.counters().parameters_limited, static_cast<std::uint64_t>(limited));
    for (int i = 0; i < 15; ++i) {
      const Time stamp = {std::int64_t{i + 1} * kPeriod_ns};
      const WheelSample sample = {stamp, kStep_m * i, kStep_m * i};
      const StepOutput& o =
          slam.step({stamp, hall.seen_from({kStep_m * i, 0.0, 0.0}), {&sample, 1}, kMaxCorners});
      ASSERT_TRUE(o.accepted);
      ASSERT_TRUE(std::isfinite(o.T_start_robot.x_m + o.T_start_robot.y_m)) << trial;
      ASSERT_TRUE(o.pose_covariance.allFinite()) << trial;
    }
  }
}

// A robot whose wheels or lens are described by no numbers maps nothing, and says so.
TEST(HostileSteps, ARobotThatIsNoNumberDoesNoHarm) {
  Hall hall(hostile_robot().lens);
  for (const double bad : {kNan, kInfinite, 0.0, 1e300, -1e300}) {
    for (int field = 0; field < 6; ++field) {
      RobotConfig robot = hostile_robot();
      double* const fields[] = {
          &robot.wheels.track_width_m, &robot.wheels.left_scale, &robot.lens.k[0],
          &robot.lens.fu_px,           &robot.mount.z_m,         &robot.mount.x_m};
      *fields[field] = bad;
      const MemoryBlock memory(Slam::memory_needed(few_particles()));
      Slam slam(robot, few_particles(), 1, memory.span());
      for (int i = 0; i < 6; ++i) {
        const Time stamp = {std::int64_t{i + 1} * kPeriod_ns};
        const WheelSample sample = {stamp, kStep_m * i, kStep_m * i};
        const StepOutput& o =
            slam.step({stamp, hall.seen_from({kStep_m * i, 0.0, 0.0}), {&sample, 1}, kMaxCorners});
        ASSERT_TRUE(std::isfinite(o.T_start_robot.x_m + o.T_start_robot.theta_rad)) << field;
        ASSERT_TRUE(o.pose_covariance.allFinite()) << field << ' ' << bad;
        ASSERT_TRUE(o.odometry.covariance.allFinite()) << field << ' ' << bad;
      }
    }
  }
}

}  // namespace
}  // namespace zenith
