#pragma once
// The cooperation thread: own news out to peers, peers' news in to perception. It stands between
// the queues and the network, so that neither waits for the other.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "platform/base/time.h"
#include "platform/daemon/exchange.h"

namespace zenith {

// The way to the peers: a radio. One thread calls; no call waits.
class PeerLink {
 public:
  PeerLink() = default;
  PeerLink(const PeerLink&) = delete;
  PeerLink& operator=(const PeerLink&) = delete;
  virtual ~PeerLink() = default;

  // Own landmarks that changed. The link keeps what peers may ask for again.
  virtual void send(std::span<const LandmarkRecord> records) = 0;
  // This robot holds its map and the peer's as one; called again as long as it does.
  virtual void send_merge(const MergeNews& merge) = 0;
  // What has come, oldest first; false when there is nothing more. A peer has one slot as long as
  // it is known.
  virtual bool receive(PeerRecord& out) = 0;
  virtual bool receive_merge(MergeNews& out) = 0;
};

struct CooperationCounters {
  std::uint64_t sent = 0;      // own records handed to the link
  std::uint64_t unheard = 0;   // own records without a link
  std::uint64_t received = 0;  // peers' records handed to perception
};

class Cooperation {
 public:
  // `link` may be nullptr: a robot that works alone. Both must outlive it.
  Cooperation(Exchange& exchange, PeerLink* link) : exchange_(exchange), link_(link) {}

  // The thread's body.
  void run(const std::atomic<bool>& stop);
  // Moves what is there, both ways.
  void turn_once();

  bool has_link() const { return link_ != nullptr; }
  // Any thread.
  CooperationCounters counters() const;

 private:
  void send_own();
  void receive();

  Exchange& exchange_;
  PeerLink* link_;
  std::array<LandmarkRecord, 64> batch_;
  // Taken from the link while perception's queue was full.
  PeerRecord held_;
  bool holds_ = false;
  std::atomic<std::uint64_t> sent_ = 0;
  std::atomic<std::uint64_t> unheard_ = 0;
  std::atomic<std::uint64_t> received_ = 0;
};

}  // namespace zenith
