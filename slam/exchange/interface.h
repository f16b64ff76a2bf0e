#pragma once
// What the synchroniser needs and gives: plain data and the one interface through which it hands on
// peers' records.

#include <cstdint>

#include "platform/base/time.h"
#include "slam/capacity.h"
#include "slam/exchange/messages.h"
#include "slam/fleet/record.h"

namespace zenith::exchange {

inline constexpr int kEverybody = -1;

// What a robot sends in any one second at most, in bytes with all headers; a part of the protocol.
inline constexpr std::uint32_t kMaxRate = 500'000;
// What is taken of one peer on average, and at once after a pause: the network may have held back
// what the peer sent, and send it on in one go.
inline constexpr std::uint32_t kTakenRate = kMaxRate + kMaxRate / 2;

// A verified sender: one start of one robot's program, and the fleet's key that it seals with.
struct Sender {
  std::uint64_t robot = 0;  // as in the frame's header
  std::uint64_t boot = 0;
  std::uint16_t key = 0;  // the key's hint

  bool operator==(const Sender&) const = default;
};

struct Settings {
  std::uint64_t robot = 0;  // this one, as in the frame's header
  Hello name;
  std::uint32_t map = 0;   // random, of the map as it is now
  std::uint64_t seed = 0;  // of jitter

  // Bytes a second, all headers included: what is sent in any one second at most, and the part of
  // it that changes of known landmarks may take on average. At least 700 for each copy of what
  // goes to everybody; with less, records or even states cannot be sent.
  std::uint32_t max_rate = 125'000;
  std::uint32_t news_rate = 20'000;
  // A landmark that peers know is told of again after so long, however often it changes.
  Duration rest = Duration::from_seconds(8.0);
  // What is taken of one peer, on average and at once.
  std::uint32_t peer_rate = kTakenRate;

  std::size_t headers_below = kIpv4UdpBytes;  // of IP and UDP
  int slots = kMaxReplicas;                   // peers' maps that are kept
};

// Takes the peers' records. A slot is one (robot, boot, map); what is told of a slot before
// forget() belongs to another map than what comes after it.
class RecordSink {
 public:
  // Records that take() has room for. A section with more is left out whole; it comes again.
  virtual std::size_t room(int slot) = 0;
  virtual void take(int slot, const LandmarkRecord& record) = 0;
  // The slot's map is no more. Must always work, even when there is no room.
  virtual void forget(int slot) = 0;

 protected:
  ~RecordSink() = default;
};

enum class Verdict : std::uint8_t {
  kUsed,
  kMalformed,     // a fault: nothing of it was used
  kInconsistent,  // a fault: well-formed, but it contradicts itself or what was said before
  kTooMuch,       // a fault: more than one robot may send or have
  kNoRoom,        // some records were left out; they will be asked for again
  kQuarantined,   // not looked at: too many faults before
};

// A payload for next()'s caller to seal and send.
struct Outgoing {
  int to = kEverybody;   // a session, or everybody
  std::size_t size = 0;  // 0: nothing is due
};

// An own alignment to be told; `slot` is the peer's.
struct OwnAlignment {
  int slot = 0;
  AlignmentNotice::State state = AlignmentNotice::State::kCandidate;
  Pose2 T_own_peer;
  std::array<double, 3> deviations = {};  // x, y in metres, angle in radians
  int correspondences = 0;
  double confidence = 0.0;
};

// What is known of the (robot, boot, map) in one slot.
struct PeerStatus {
  bool used = false;
  std::uint64_t robot = 0;
  std::uint64_t boot = 0;  // that told the map
  std::uint32_t map = 0;
  int session = -1;       // -1: silent, or this map is its old one
  bool complete = false;  // all that the last state told of is here, and the checksum agreed
  std::uint32_t landmarks = 0;
  bool heard = false;  // `state` says something
  Time heard_at;
  StateNotice state;
  bool about_us_heard = false;  // with the own present map
  AlignmentNotice about_us;     // how the peer aligns our map with its own
};

// Since configure().
struct Counters {
  std::uint64_t datagrams_sent = 0;
  std::uint64_t bytes_sent = 0;  // all headers included
  std::uint64_t datagrams_received = 0;
  std::uint64_t states_sent = 0;
  std::uint64_t news_sent = 0;      // records
  std::uint64_t served_sent = 0;    // records that somebody asked for
  std::uint64_t requests_sent = 0;  // sections
  std::uint64_t requests_received = 0;
  std::uint64_t records_received = 0;
  std::uint64_t records_new = 0;  // of these
  std::uint64_t malformed = 0;
  std::uint64_t inconsistent = 0;
  std::uint64_t too_much = 0;
  std::uint64_t no_room = 0;      // sections that the sink or the pool had no room for
  std::uint64_t other_map = 0;    // sections about another map than the present one
  std::uint64_t quarantined = 0;  // datagrams that were not looked at
  std::uint64_t quarantines = 0;
  std::uint64_t checksum_differed = 0;
  std::uint64_t slots_refused = 0;  // peers whose map found no slot
  std::uint64_t own_refused = 0;    // own records that cannot be told, see encode_record()
  std::uint64_t tombstones_forgotten = 0;
};

}  // namespace zenith::exchange
