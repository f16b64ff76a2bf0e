#pragma once
// The cooperation thread: own news out to peers, peers' news in to perception. It stands between
// the queues and the network, so that neither waits for the other.

#include <atomic>
#include <cstdint>

#include "drivers/leds/led_pattern.h"
#include "platform/base/time.h"
#include "platform/daemon/exchange.h"
#include "platform/daemon/link_status.h"
#include "platform/link/fleet_key.h"
#include "platform/linux/snapshot.h"

namespace zenith {

class MapKeeper;
class RadioLink;

struct CooperationCounters {
  std::uint64_t sent = 0;      // own records handed to the exchange
  std::uint64_t unheard = 0;   // own records without a radio, or that cannot be told
  std::uint64_t received = 0;  // peers' records handed to perception
};

class Cooperation {
 public:
  // `link` may be nullptr: a robot that works alone; `keeper` when no map is kept.
  // All must outlive it.
  Cooperation(Exchange& exchange, RadioLink* link, MapKeeper* keeper = nullptr)
      : exchange_(exchange), link_(link), keeper_(keeper) {}
  ~Cooperation() { delete new_keys_.load(); }
  Cooperation(const Cooperation&) = delete;
  Cooperation& operator=(const Cooperation&) = delete;

  // The thread's body. At its end peers hear that this robot leaves.
  void run(const std::atomic<bool>& stop);
  // Moves what is there, both ways; does not wait.
  void turn_once(Time now);
  // After run(), by one thread: what perception handed over last goes into the kept map alone.
  void keep_last();

  bool has_link() const { return link_ != nullptr; }

  // --- any thread
  CooperationCounters counters() const;
  // How the robot is, for peers to know.
  void set_light(RobotLight light) { light_.store(light, std::memory_order_relaxed); }
  // The next turn takes them. Without a link they have no use.
  void set_keys(const FleetKeys& keys) { delete new_keys_.exchange(new FleetKeys(keys)); }
  // False as long as there is nothing to tell.
  bool read(LinkStatus& out) const { return status_.read(out); }

 private:
  void send_own();
  void take_keys();

  Exchange& exchange_;
  RadioLink* link_;
  MapKeeper* keeper_;
  Time next_status_;
  LinkStatus told_;
  Snapshot<LinkStatus> status_;
  std::atomic<RobotLight> light_ = RobotLight::kStarting;
  std::atomic<FleetKeys*> new_keys_ = nullptr;  // owned by whoever takes it out
  std::atomic<std::uint64_t> sent_ = 0;
  std::atomic<std::uint64_t> unheard_ = 0;
  std::atomic<std::uint64_t> received_ = 0;
};

}  // namespace zenith
