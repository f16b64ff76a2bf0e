#include "platform/daemon/cooperation.h"

#include <memory>

#include "platform/daemon/map_keeper.h"
#include "platform/daemon/radio_link.h"
#include "platform/linux/clock.h"

namespace zenith {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr Duration kStatusPeriod = {500'000'000};

exchange::Health health_of(RobotLight light) {
  switch (light) {
    case RobotLight::kMapping:
      return exchange::Health::kMapping;
    case RobotLight::kMerged:
      return exchange::Health::kMerged;
    case RobotLight::kDegraded:
      return exchange::Health::kDegraded;
    case RobotLight::kFault:
      return exchange::Health::kFault;
    default:
      return exchange::Health::kStarting;
  }
}

}  // namespace

void Cooperation::run(const std::atomic<bool>& stop) {
  while (!stop.load(kRelaxed)) {
    turn_once(monotonic_now());
    if (link_ != nullptr) {
      link_->wait(monotonic_now());
    } else {
      sleep_until(monotonic_now() + RadioLink::kSlice);
    }
  }
  if (link_ != nullptr) link_->finish(monotonic_now());
}

void Cooperation::turn_once(Time now) {
  send_own();
  if (link_ == nullptr) return;
  take_keys();
  link_->turn(now, health_of(light_.load(kRelaxed)));
  received_.store(link_->records_received(), kRelaxed);
  if (now < next_status_) return;
  next_status_ = now + kStatusPeriod;
  link_->write_status(told_, now);
  status_.write(told_);
}

void Cooperation::take_keys() {
  const std::unique_ptr<FleetKeys> keys(new_keys_.exchange(nullptr));
  if (keys != nullptr) link_->set_keys(*keys);
}

void Cooperation::send_own() {
  LandmarkRecord record;
  while (exchange_.own.pop(record)) {
    exchange_.shown.note(map_news(MapNews::kOwn, record));
    if (keeper_ != nullptr) keeper_->note(record);
    const bool told = link_ != nullptr && link_->send_own(record);
    (told ? sent_ : unheard_).fetch_add(1, kRelaxed);
  }
}

void Cooperation::keep_last() {
  LandmarkRecord record;
  while (exchange_.own.pop(record)) {
    if (keeper_ != nullptr) keeper_->note(record);
  }
}

CooperationCounters Cooperation::counters() const {
  return {sent_.load(kRelaxed), unheard_.load(kRelaxed), received_.load(kRelaxed)};
}

}  // namespace zenith
