#pragma once
// The radio and the exchange over it: the cooperation thread's work when there is a key.
//
//   datagrams -> sessions, synchroniser -> peers' records for perception
//   own records and state of perception -> synchroniser -> datagrams
//
// One thread at a time, without deadlines.

#include <array>
#include <string>

#include "drivers/radio/udp_radio.h"
#include "platform/daemon/config.h"
#include "platform/daemon/device_keeper.h"
#include "platform/daemon/exchange.h"
#include "platform/daemon/link_status.h"
#include "platform/link/peer_exchange.h"
#include "slam/exchange/budget.h"

namespace zenith {

class RadioLink final : private exchange::RecordSink {
 public:
  // The longest wait: own landmarks are sent this late at most.
  static constexpr Duration kSlice = {20'000'000};

  // `exchange` must outlive it. `boot` and `map` are random, new at each start.
  RadioLink(const RadioConfig& config, const SessionSettings& sessions, std::uint32_t map,
            Exchange& exchange);

  // A landmark of this robot. False when it cannot be told.
  bool send_own(const LandmarkRecord& record) { return peers_.synchroniser().set_own(record); }
  // Other keys from now on; see Sessions::set_keys().
  void set_keys(const FleetKeys& keys) { peers_.sessions().set_keys(keys); }
  // All that is due; does not wait.
  void turn(Time now, exchange::Health health);
  // Until there is something to do, at most kSlice.
  void wait(Time now);
  // BYE. Nothing after it.
  void finish(Time now);

  void write_status(LinkStatus& out, Time now) const;
  std::uint64_t records_received() const { return records_received_; }

 private:
  std::size_t room(int slot) override;
  void take(int slot, const LandmarkRecord& record) override;
  void forget(int slot) override;
  void tell_forgotten();

  void keep_open(Time now);
  void receive(Time now);
  void send(Time now);
  void tell_state(Time now, exchange::Health health);
  void offer_alignments(Time now);
  void note_names();
  void log_news(Time now);

  Exchange& exchange_;
  UdpRadio radio_;
  PeerExchange peers_;
  Reopener tries_{"radio"};
  std::array<bool, kMaxPeers> forgotten_ = {};  // perception does not know it yet
  std::array<RobotName, kMaxPeers> names_;
  std::string told_joined_;
  exchange::Budget log_budget_;  // lines
  std::uint64_t not_logged_ = 0;
  std::uint64_t records_received_ = 0;
  Time next_refresh_;
  Time next_second_;
  Time next_state_;
};

}  // namespace zenith
