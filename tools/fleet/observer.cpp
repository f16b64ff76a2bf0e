#include "tools/fleet/observer.h"

#include <unistd.h>

#include <algorithm>

#include "platform/linux/clock.h"

namespace zenith::tools {
namespace {

PeerExchangeSettings observer_settings(const FleetKeys& keys) {
  PeerExchangeSettings settings;
  settings.sessions.keys = keys;
  // A name of its own for each program that listens.
  settings.sessions.name.assign("observer " + std::to_string(::getpid()));
  settings.sessions.boot = secret_number();
  settings.sessions.secret = SecretKey::random();
  settings.synchroniser.map = static_cast<std::uint32_t>(secret_number());
  settings.synchroniser.seed = settings.sessions.boot;
  return settings;
}

}  // namespace

FleetObserver::FleetObserver(const FleetKeys& keys, const RadioSettings& radio)
    : radio_(radio), exchange_(observer_settings(keys)) {
  exchange_.synchroniser().set_copies_to_everybody(std::max(radio_.copies_to_everybody(), 1));
}

void FleetObserver::run_for(Duration time) {
  constexpr Duration kSlice = {50'000'000};
  const Time end = monotonic_now() + time;
  for (Time now = monotonic_now(); now < end; now = monotonic_now()) {
    for (auto batch = radio_.receive(); !batch.empty(); batch = radio_.receive()) {
      for (const RadioDatagram& d : batch) exchange_.receive(now, d.from, d.bytes, *this);
    }
    send();
    radio_.wait(std::min(kSlice, exchange_.next_time(now) - now));
  }
  radio_.refresh();
  exchange_.forget_silent(monotonic_now());
}

void FleetObserver::send() {
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  while (true) {
    const Dispatch dispatch = exchange_.next(monotonic_now(), datagram);
    if (dispatch.size == 0) return;
    const auto bytes = std::span<const std::uint8_t>(datagram).first(dispatch.size);
    if (dispatch.to_everybody) {
      radio_.send_to_everybody(bytes);
    } else {
      radio_.send(dispatch.to, bytes);
    }
  }
}

void FleetObserver::leave() {
  exchange_.synchroniser().say_bye();
  send();
}

std::vector<ObservedRobot> FleetObserver::robots() const {
  std::vector<ObservedRobot> robots;
  for (int i = 0; i < kMaxSessions; ++i) {
    const Session* session = exchange_.sessions().session(i);
    if (session == nullptr || !session->is_peer() || session->name.empty()) continue;
    const int slot = exchange_.synchroniser().slot_of(i);
    if (slot < 0 || !exchange_.synchroniser().peer(slot).heard) continue;
    const exchange::PeerStatus& peer = exchange_.synchroniser().peer(slot);
    ObservedRobot robot = {
        std::string(session->name.view()), session->id.robot, peer.complete, peer.state, {}};
    if (const auto map = maps_.find(slot); map != maps_.end()) robot.landmarks = map->second;
    robots.push_back(std::move(robot));
  }
  std::sort(robots.begin(), robots.end(),
            [](const ObservedRobot& a, const ObservedRobot& b) { return a.name < b.name; });
  return robots;
}

std::size_t FleetObserver::room(int) {
  return 100'000;
}

void FleetObserver::take(int slot, const LandmarkRecord& record) {
  if (record.removed) {
    maps_[slot].erase(record.id);
  } else {
    maps_[slot][record.id] = record;
  }
}

void FleetObserver::forget(int slot) {
  maps_.erase(slot);
}

}  // namespace zenith::tools
