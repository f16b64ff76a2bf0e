#include "platform/daemon/device_keeper.h"

#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith {

void Reopener::note(const Status& opened, Time now) {
  next_try_ = now + kRetry;
  if (opened) {
    last_error_.clear();
    return;
  }
  const std::string& error = opened.error().message;
  if (error == last_error_ && now - told_ < kRepeat) return;
  last_error_ = error;
  told_ = now;
  LogFields fields("device-missing");
  fields.text("ZENITH_DEVICE", what_);
  log_line(LogLevel::kWarning, fields, "%s: %s; trying again", what_, error.c_str());
}

void DeviceKeeper::run(const std::atomic<bool>& stop) {
  constexpr Duration kLook = {20'000'000};
  while (!stop.load(std::memory_order_relaxed)) {
    tend(monotonic_now());
    sleep_until(monotonic_now() + kLook);
  }
}

void DeviceKeeper::tend(Time now) {
  tend_can(now);  // first: it is quick, and a frame without wheels is worth little
  tend_camera(now);
}

void DeviceKeeper::tend_camera(Time now) {
  if (camera_turn_.is_perceptions() || !camera_tries_.due(now)) return;
  const Status opened = camera_.open();
  camera_tries_.note(opened, monotonic_now());
  if (!opened) return;
  log_line(LogLevel::kNotice, LogFields("camera-opened"), "camera: %s",
           camera_.description().c_str());
  log_lines(LogLevel::kWarning, "camera", camera_.warnings());
  camera_turn_.give_to_perception();
}

void DeviceKeeper::tend_can(Time now) {
  if (can_turn_.is_perceptions() || !can_tries_.due(now)) return;
  const Status opened = can_.open();
  can_tries_.note(opened, monotonic_now());
  if (!opened) return;
  log_line(LogLevel::kNotice, LogFields("can-opened"), "CAN bus: %s", can_.description().c_str());
  can_turn_.give_to_perception();
}

}  // namespace zenith
