#include "platform/daemon/simulated/device_player.h"

#include <algorithm>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith {
namespace {

constexpr Duration kLook = {1'000'000};
constexpr Duration kStandingPeriod = {10'000'000};
// Less is made up for.
constexpr Duration kTolerated = {30'000'000};
// Between start() and the first frame, so that some are prepared by then.
constexpr Duration kLead = {150'000'000};

void pause() {
  sleep_until(monotonic_now() + kLook);
}

void start_or_tell(Thread& thread, const char* name, std::function<void()> body) {
  Report report;
  const Status started = thread.start({.name = name, .stack_bytes = std::size_t{2048} * 1024},
                                      std::move(body), report);
  if (!started) log_lines(LogLevel::kError, started.error().message);
}

}  // namespace

DevicePlayer::DevicePlayer(std::unique_ptr<MomentSource> source) : source_(std::move(source)) {
  for (std::size_t i = 0; i < kAhead; ++i) free_.push(i);
}

DevicePlayer::~DevicePlayer() {
  stop_.store(true, std::memory_order_relaxed);
  preparing_.join();
  playing_.join();
}

void DevicePlayer::connect(SimulatedCamera& camera, SimulatedCanBus& can) {
  camera_ = &camera;
  can_ = &can;
}

void DevicePlayer::start() {
  if (preparing_.running()) return;
  start_or_tell(preparing_, "player-prepare", [this] { prepare(); });
  start_or_tell(playing_, "player-play", [this] { play(); });
}

void DevicePlayer::prepare() {
  bool more = true;
  while (more && !stopping()) {
    std::size_t slot = 0;
    if (!free_.pop(slot)) {
      pause();
      continue;
    }
    more = source_->next(slots_[slot].moment);
    slots_[slot].last = !more;
    ready_.push(slot);
  }
}

void DevicePlayer::play() {
  std::size_t slot = 0;
  for (bool first = true; wait_for_slot(slot); first = false) {
    if (slots_[slot].last) return stand();
    follow_clock(slots_[slot].moment.begin(), first);
    play_moment(slots_[slot].moment);
    free_.push(slot);
  }
}

bool DevicePlayer::wait_for_slot(std::size_t& slot) {
  while (!stopping()) {
    if (ready_.pop(slot)) return true;
    pause();
  }
  return false;
}

// Prepared too late: what is played waits for its pictures.
void DevicePlayer::follow_clock(Time begin, bool first) {
  const Time now = monotonic_now();
  if (first) offset_ = now + kLead - begin;
  const Duration late = now - (begin + offset_);
  if (late > kTolerated) offset_ = offset_ + late;
}

void DevicePlayer::play_moment(const Moment& moment) {
  for (CanFrame frame : moment.can) {
    frame.stamp = frame.stamp + offset_;
    sleep_until(frame.stamp);
    if (stopping()) return;
    can_->send(frame);
  }
  if (moment.frame == MomentFrame::kNone) return;
  sleep_until(moment.stamp + offset_);
  if (stopping()) return;
  if (moment.frame == MomentFrame::kDamaged) return camera_->deliver_damaged();
  camera_->deliver(moment.stamp + offset_, moment.pixels);
  last_pixels_.assign(moment.pixels.begin(), moment.pixels.end());
}

// The last picture again and again, and wheels that do not turn.
void DevicePlayer::stand() {
  source_->ended();
  std::vector<CanFrame> standing = source_->standing();
  Time next_frame = monotonic_now() + source_->frame_period();
  for (Time next = monotonic_now() + kStandingPeriod; !stopping(); next = next + kStandingPeriod) {
    sleep_until(next);
    for (CanFrame& frame : standing) {
      frame.stamp = next;
      can_->send(frame);
    }
    if (next < next_frame || last_pixels_.empty()) continue;
    camera_->deliver(next_frame, last_pixels_);
    next_frame = next_frame + source_->frame_period();
  }
}

Devices make_played_devices(std::unique_ptr<MomentSource> source, const RobotConfig& robot,
                            const WheelDecoder& decoder, const std::string& description) {
  auto player = std::make_unique<DevicePlayer>(std::move(source));
  auto camera = std::make_unique<SimulatedCamera>(robot.lens.width_px, robot.lens.height_px,
                                                  description + ", GREY " +
                                                      std::to_string(robot.lens.width_px) + "x" +
                                                      std::to_string(robot.lens.height_px),
                                                  [world = player.get()] { world->start(); });
  camera->set_period(Duration::from_seconds(1.0 / robot.frame_rate_hz));
  auto can = std::make_unique<SimulatedCanBus>(decoder.ids());
  player->connect(*camera, *can);
  Devices devices;
  devices.robot = robot;
  devices.decoder = decoder;
  devices.description = description;
  devices.camera = std::move(camera);
  devices.can = std::move(can);
  devices.world = std::move(player);
  return devices;
}

}  // namespace zenith
