#include "platform/daemon/simulated/simulated_robot.h"

#include <algorithm>
#include <utility>

#include "drivers/odometry/agilex_v2.h"
#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith {
namespace {

constexpr Duration kLook = {1'000'000};
constexpr Duration kCanPeriod = {10'000'000};
// Less is made up for.
constexpr Duration kTolerated = {30'000'000};
// Between start() and the first frame, so that some are rendered by then.
constexpr Duration kLead = {150'000'000};

void pause() {
  sleep_until(monotonic_now() + kLook);
}

void start_or_tell(Thread& thread, const char* name, std::function<void()> body) {
  Report report;
  const Status started = thread.start({.name = name, .stack_bytes = std::size_t{2048} * 1024},
                                      std::move(body), report);
  if (!started) log_line(LogLevel::kError, "%s", started.error().message.c_str());
}

}  // namespace

SimulatedRobot::SimulatedRobot(sim::Simulation simulation, std::size_t robot)
    : simulation_(std::move(simulation)), drive_(simulation_.drive(robot)) {
  for (std::size_t i = 0; i < kAhead; ++i) free_.push(i);
}

SimulatedRobot::~SimulatedRobot() {
  stop_.store(true, std::memory_order_relaxed);
  renderer_.join();
  player_.join();
}

void SimulatedRobot::connect(SimulatedCamera& camera, SimulatedCanBus& can) {
  camera_ = &camera;
  can_ = &can;
}

void SimulatedRobot::start() {
  if (renderer_.running()) return;
  start_or_tell(renderer_, "sim-renderer", [this] { render(); });
  start_or_tell(player_, "sim-player", [this] { play(); });
}

void SimulatedRobot::render() {
  bool more = true;
  while (more && !stopping()) {
    std::size_t slot = 0;
    if (!free_.pop(slot)) {
      pause();
      continue;
    }
    Moment& moment = moments_[slot];
    more = drive_.next(moment.frame, moment.can);
    moment.last = !more;
    ready_.push(slot);
  }
}

void SimulatedRobot::play() {
  std::size_t slot = 0;
  bool first = true;
  while (wait_for_moment(slot)) {
    const Moment& moment = moments_[slot];
    if (moment.last) return stand();
    const Time begin = moment.can.empty() ? moment.frame.stamp : moment.can.front().stamp;
    const Time now = monotonic_now();
    if (first) offset_ = now + kLead - begin;
    first = false;
    // Rendered too late: the world waits for its pictures.
    const Duration late = now - (begin + offset_);
    if (late > kTolerated) {
      offset_ = offset_ + late;
      behind_ns_.fetch_add(late.ns, std::memory_order_relaxed);
    }
    play_moment(moment);
    free_.push(slot);
  }
}

bool SimulatedRobot::wait_for_moment(std::size_t& slot) {
  while (!stopping()) {
    if (ready_.pop(slot)) return true;
    pause();
  }
  return false;
}

void SimulatedRobot::play_moment(const Moment& moment) {
  for (const CanFrame& frame : moment.can) {
    sleep_until(frame.stamp + offset_);
    if (stopping()) return;
    CanFrame sent = frame;
    sent.stamp = frame.stamp + offset_;
    send(sent);
    last_can_[frame.id == agilex_v2::kOdometerId ? 0 : 1] = sent;
  }
  camera_->deliver(moment.frame.stamp + offset_, moment.frame.pixels);
}

// The last picture again and again, and wheels that do not turn.
void SimulatedRobot::stand() {
  const auto period = Duration::from_seconds(1.0 / drive_.config().frame_rate_hz);
  // The slots hold all frames but the oldest; any of them is the last picture but for its noise.
  const std::vector<std::uint8_t> pixels = moments_[0].frame.pixels;
  last_can_[1].data = {};
  Time next_frame = monotonic_now() + period;
  for (Time next = monotonic_now() + kCanPeriod; !stopping(); next = next + kCanPeriod) {
    sleep_until(next);
    for (CanFrame& frame : last_can_) {
      frame.stamp = next;
      send(frame);
    }
    if (next < next_frame) continue;
    camera_->deliver(next_frame, pixels);
    next_frame = next_frame + period;
  }
}

void SimulatedRobot::send(CanFrame frame) {
  can_->send(frame);
}

}  // namespace zenith
