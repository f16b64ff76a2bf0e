#include "platform/link/sessions.h"

#include <algorithm>
#include <cassert>

namespace zenith {
namespace {

using exchange::Bytes;

// Datagrams of an older boot may still be under way this long after a newer one was verified.
constexpr Duration kUnderWay = {3'000'000'000};
// A peer that was silent for so long, five STATEs, gives way when there is no other room.
constexpr Duration kGivesWay = {5'000'000'000};
// Only a peer that is not heard at its address is looked for at another one: whoever repeats its
// datagrams from elsewhere does not move it, and one with two addresses keeps the one that works.
constexpr Duration kStays = {2'500'000'000};
constexpr Duration kStillTalks = {5'000'000'000};
// The same trouble is not told more often.
constexpr Duration kToldAgain = {60'000'000'000};
constexpr Duration kVersionToldAgain = {5'000'000'000};
constexpr Duration kForgottenAtTheEarliest = {15'000'000'000};

}  // namespace

Sessions::Sessions(const SessionSettings& settings)
    : own_{robot_id(settings.name.view()), settings.boot},
      name_(settings.name),
      forget_after_(std::max(settings.forget_after, kForgottenAtTheEarliest)),
      handshake_(settings.secret, settings.answers_per_second),
      version_told_(Time{} - kVersionToldAgain),
      no_room_told_(Time{} - kToldAgain) {
  prepare_cryptography();
  set_keys(settings.keys);
}

// The counter goes on: with whichever key, none is used twice.
void Sessions::set_keys(const FleetKeys& keys) {
  fleet_keys_ = {keys.current, keys.previous};
  hints_ = {key_hint(keys.current), key_hint(keys.previous)};
  key_count_ = keys.has_previous ? 2 : 1;
  own_shown_ = masked(keys.current, own_);
  own_key_ = sender_key(keys.current, own_shown_);
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (used_[i]) set_key(static_cast<int>(i), hints_[0], keys.current);
  }
}

// From now on the session's datagrams are sealed with what this key of the fleet gives.
void Sessions::set_key(int slot, const KeyHint& hint, const SecretKey& fleet_key) {
  const auto s = static_cast<std::size_t>(slot);
  guards_[s].hint = hint;
  shown_[s] = masked(fleet_key, ids_[s]);
  guards_[s].key = sender_key(fleet_key, shown_[s]);
}

bool Sessions::reject(Rejected reason) {
  count_rejected(reason);
  return false;
}

const SecretKey* Sessions::fleet_key_of(const KeyHint& hint) const {
  for (std::size_t i = 0; i < key_count_; ++i) {
    if (hints_[i] == hint) return &fleet_keys_[i];
  }
  return nullptr;
}

int Sessions::find(const std::array<SenderId, kMaxSessions>& ids, const SenderId& id) const {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == id && used_[i]) return static_cast<int>(i);
  }
  return -1;
}

int Sessions::find_peer(std::uint64_t robot) const {
  const int slot = find_newest(robot);
  return slot >= 0 && sessions_[static_cast<std::size_t>(slot)].is_peer() ? slot : -1;
}

int Sessions::find_newest(std::uint64_t robot) const {
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (used_[i] && ids_[i].robot == robot && sessions_[i].is_newest()) return static_cast<int>(i);
  }
  return -1;
}

// --- in ------------------------------------------------------------------------------------------

bool Sessions::receive(Time now, const Endpoint& from, Bytes datagram,
                       std::span<std::uint8_t> payload, Fresh& out) {
  Opened opened{now, from, {}, {}, {}, datagram.size()};
  FrameHeader& header = opened.header;
  if (!read_header(datagram, header)) return reject(Rejected::kForeign);
  if (header.sender == own_shown_) return reject(Rejected::kEcho);
  const SecretKey* fleet_key = fleet_key_of(header.key_hint);
  if (fleet_key == nullptr) return reject(Rejected::kOtherKey);
  int slot = find(shown_, header.sender);
  // Sealed with another key than the hint says, it is a forgery: see below.
  if (slot >= 0 && guards_[static_cast<std::size_t>(slot)].hint != header.key_hint) slot = -1;
  const auto is_repeated = [&] {
    return slot >= 0 && !guards_[static_cast<std::size_t>(slot)].window.is_new(header.counter);
  };
  if (is_repeated()) return reject(Rejected::kRepeated);
  std::size_t bytes = 0;
  const bool is_right =
      slot >= 0 ? open(guards_[static_cast<std::size_t>(slot)].key, datagram, payload, bytes)
                : open(sender_key(*fleet_key, header.sender), datagram, payload, bytes);
  if (!is_right) return reject(Rejected::kForged);
  if (header.version != kProtocolVersion) return note_version(opened);
  opened.payload = payload.first(bytes);
  if (slot < 0) {
    opened.sender = masked(*fleet_key, header.sender);
    if (opened.sender == own_) return reject(Rejected::kEcho);
    slot = find(ids_, opened.sender);
    if (is_repeated()) return reject(Rejected::kRepeated);
    if (slot < 0) return greet(opened);
    set_key(slot, header.key_hint, *fleet_key);  // the peer changed its key
  }
  opened.sender = ids_[static_cast<std::size_t>(slot)];
  if (!note_peer(slot, opened)) return false;
  ++counters_.received;
  counters_.received_bytes += datagram.size();
  out = {slot, header.counter, header.key_hint, opened.payload};
  return true;
}

bool Sessions::note_version(const Opened& opened) {
  const std::uint64_t boot = opened.header.sender.boot;
  const bool is_told =
      std::find(told_versions_.begin(), told_versions_.end(), boot) != told_versions_.end();
  if (!is_told && opened.now >= version_told_ + kVersionToldAgain) {
    version_told_ = opened.now;
    told_versions_[next_told_version_] = boot;
    next_told_version_ = (next_told_version_ + 1) % told_versions_.size();
    put_event({LinkEventKind::kOtherVersion, 0, {}, opened.from, opened.header.version});
  }
  return reject(Rejected::kOtherVersion);
}

bool Sessions::is_for_us(const std::optional<exchange::Challenge>& challenge) const {
  return challenge && challenge->robot == own_.robot && challenge->boot == own_.boot;
}

// An unverified sender.
bool Sessions::greet(const Opened& opened) {
  Greetings greetings;
  if (!read_greetings(opened.payload, opened.sender.robot, greetings)) {
    return reject(Rejected::kMalformed);
  }
  if (is_for_us(greetings.response) &&
      handshake_.joins(opened.now, opened.sender, greetings.response->nonce)) {
    admit(opened, greetings.response->nonce);
    return false;
  }
  if (is_for_us(greetings.challenge)) {
    respond(opened, *greetings.challenge);
  } else if (!greetings.bye) {
    (void)challenge(opened, Handshake::Asked::kJoin);
  }
  return reject(Rejected::kUnverified);
}

bool Sessions::challenge(const Opened& opened, Handshake::Asked asked) {
  const bool queued =
      handshake_.challenge(opened.now, asked, opened.sender, opened.from, opened.datagram_bytes);
  counters_.challenges += queued ? 1 : 0;
  return queued;
}

void Sessions::respond(const Opened& opened, const exchange::Challenge& challenge) {
  const bool queued = handshake_.respond(opened.now, opened.sender, opened.from, challenge);
  counters_.responses += queued ? 1 : 0;
}

void Sessions::admit(const Opened& opened, const Handshake::Nonce& nonce) {
  const int slot = room_for(opened.now, opened.sender.robot);
  if (slot < 0) {
    if (opened.now >= no_room_told_ + kToldAgain) {
      no_room_told_ = opened.now;
      put_event({LinkEventKind::kNoRoom, opened.sender.robot, {}, opened.from, 0});
    }
    count_rejected(Rejected::kNoRoom);
    return;
  }
  RobotName name;
  const int older = find_newest(opened.sender.robot);
  if (older >= 0) {
    name = sessions_[static_cast<std::size_t>(older)].name;
    sessions_[static_cast<std::size_t>(older)].is_superseded = true;
    sessions_[static_cast<std::size_t>(older)].unheard_since = opened.now;
  }
  const auto s = static_cast<std::size_t>(slot);
  used_[s] = true;
  ids_[s] = opened.sender;
  Session& session = sessions_[s] = {};  // perhaps that of the older boot
  session.id = opened.sender;
  session.key = opened.header.key_hint;
  session.name = name;
  session.address = opened.from;
  session.reached = handshake_.reaches(opened.now, opened.sender, opened.from, nonce);
  session.verified = opened.now;
  session.heard = opened.now;
  session.heard_at_address = opened.now;
  session.is_namesake = opened.sender.robot == own_.robot;
  session.unheard_since = opened.now;
  set_key(slot, session.key, *fleet_key_of(session.key));
  guards_[s].window.begin(opened.header.counter);
  ++counters_.verified;
  ++changes_;
  if (!session.reached) (void)note_address(session, opened);
  if (older >= 0) tell(LinkEventKind::kRestarted, session);
}

// A free slot; else that of a sender that is not heard any more, or of the robot's own older boot,
// or of the peer that was silent for longest. -1: all are busy.
//
// Nobody is given up as long as a RESPONSE of it may still be good: repeated, it would be let in
// again, and with it everything that it said since.
int Sessions::room_for(Time now, std::uint64_t robot) const {
  enum Rank { kFree, kNotListenedTo, kOlderBoot, kSilent, kBusy };
  const auto rank = [&](std::size_t i) {
    const Session& session = sessions_[i];
    if (!used_[i]) return kFree;
    if (now < session.verified + Handshake::kNonceHolds) return kBusy;
    if (!session.is_newest()) return kNotListenedTo;
    if (session.id.robot == robot) return kOlderBoot;
    return now < session.heard + kGivesWay ? kBusy : kSilent;
  };
  int best = -1;
  Rank best_rank = kBusy;
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    const Rank here = rank(i);
    const bool is_longer_silent =
        best >= 0 && here == best_rank &&
        sessions_[i].heard < sessions_[static_cast<std::size_t>(best)].heard;
    if (here >= best_rank && !is_longer_silent) continue;
    best = static_cast<int>(i);
    best_rank = here;
  }
  return best;
}

// A datagram of a verified sender that was not heard before. False when it is not to be used.
bool Sessions::note_peer(int slot, const Opened& opened) {
  const Time now = opened.now;
  Session& session = sessions_[static_cast<std::size_t>(slot)];
  ReplayWindow& window = guards_[static_cast<std::size_t>(slot)].window;
  const bool is_newest = opened.header.counter > window.newest();
  window.note(opened.header.counter);
  session.heard = now;
  if (is_newest) session.key = opened.header.key_hint;
  if (session.is_superseded || session.is_namesake) return note_double(session, now);
  if (session.has_left) return reject(Rejected::kUnverified);
  if (session.is_silent) {
    session.is_silent = false;
    ++changes_;
    tell(LinkEventKind::kFound, session);
  }
  Greetings greetings;
  // A fault when it cannot be read: see there.
  if (!read_greetings(opened.payload, session.id.robot, greetings)) return true;
  if (is_for_us(greetings.response)) note_response(session, opened, greetings.response->nonce);
  const bool is_asked = is_newest && note_address(session, opened);
  if (greetings.name && session.name.empty()) {
    session.name = *greetings.name;
    tell(LinkEventKind::kFound, session);
  }
  // One datagram gets one answer, which is not longer; the challenge comes again.
  if (is_for_us(greetings.challenge) && !is_asked) respond(opened, *greetings.challenge);
  if (greetings.bye) {
    session.has_left = true;
    ++changes_;
    tell(LinkEventKind::kLeft, session);
  }
  return true;
}

// Whoever repeats a robot's datagrams from elsewhere gets one challenge for it, and nothing else:
// where a robot is reached is shown by its answer to what was sent there. True: it was challenged.
bool Sessions::note_address(Session& session, const Opened& opened) {
  if (session.reached && opened.from == session.address) {
    session.heard_at_address = opened.now;
    return false;
  }
  if (session.reached && opened.now < session.heard_at_address + kStays) return false;
  session.moved_to = opened.from;
  return challenge(opened, Handshake::Asked::kMove);
}

// The way of the answer may be another one than that of the challenge.
void Sessions::note_response(Session& session, const Opened& opened,
                             const Handshake::Nonce& nonce) {
  for (const Endpoint& at : {opened.from, session.moved_to}) {
    if (!handshake_.reaches(opened.now, session.id, at, nonce)) continue;
    session.address = at;
    session.reached = true;
    session.heard_at_address = opened.now;
    return;
  }
}

bool Sessions::note_double(Session& session, Time now) {
  if (!session.conflict_told && now > session.unheard_since + kUnderWay) {
    session.conflict_told = true;
    if (session.is_namesake) session.name = name_;
    tell(LinkEventKind::kNameConflict, session);
  }
  return reject(Rejected::kNameTaken);
}

// --- out -----------------------------------------------------------------------------------------

std::size_t Sessions::seal(Bytes payload, std::span<std::uint8_t> datagram) {
  FrameHeader header;
  header.key_hint = hints_[0];
  header.sender = own_shown_;
  header.counter = ++counter_;
  const std::size_t bytes = zenith::seal(own_key_, header, payload, datagram);
  ++counters_.sent;
  counters_.sent_bytes += bytes;
  return bytes;
}

std::size_t Sessions::next_answer(Endpoint& to, std::span<std::uint8_t> datagram) {
  Answer answer;
  if (!handshake_.next(answer)) return 0;
  std::array<std::uint8_t, kAnswerPayloadBytes> payload;
  exchange::ByteWriter writer(payload);
  append(writer,
         answer.kind == Answer::Kind::kChallenge ? exchange::SectionType::kChallenge
                                                 : exchange::SectionType::kResponse,
         answer.proof);
  assert(writer.left() == 0 && !writer.failed());
  to = answer.to;
  return seal(payload, datagram);
}

// --- care ----------------------------------------------------------------------------------------

void Sessions::forget_silent(Time now) {
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (!used_[i] || now < sessions_[i].heard + forget_after_) continue;
    const bool is_peer = sessions_[i].is_peer();
    if (!is_peer && sessions_[i].is_newest()) continue;
    ++changes_;
    if (is_peer) {
      tell(LinkEventKind::kSilent, sessions_[i]);
      sessions_[i].is_silent = true;
    } else {
      used_[i] = false;
      ids_[i] = {};
    }
  }
}

void Sessions::set_aside(Time now, int slot) {
  Session& bad = sessions_[static_cast<std::size_t>(slot)];
  Session* other = nullptr;
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    Session& session = sessions_[i];
    if (!used_[i] || session.id.robot != bad.id.robot || !session.is_superseded) continue;
    if (session.has_left || now >= session.heard + kStillTalks) continue;
    if (other == nullptr || session.heard > other->heard) other = &session;
  }
  if (other == nullptr || bad.is_superseded) return;
  bad.is_superseded = true;
  bad.unheard_since = now;
  other->is_superseded = false;
  ++changes_;
  tell(LinkEventKind::kFound, *other);
}

void Sessions::tell(LinkEventKind kind, const Session& session, int value) {
  put_event({kind, session.id.robot, session.name, session.address, value});
}

void Sessions::put_event(const LinkEvent& event) {
  if (waiting_events_ == events_.size()) {
    ++counters_.events_lost;
    return;
  }
  events_[(first_event_ + waiting_events_++) % events_.size()] = event;
}

bool Sessions::next_event(LinkEvent& out) {
  if (waiting_events_ == 0) return false;
  out = events_[first_event_];
  first_event_ = (first_event_ + 1) % events_.size();
  --waiting_events_;
  return true;
}

const char* rejected_name(Rejected reason) {
  constexpr std::array<const char*, kRejectedKinds> kNames = {
      "foreign",       "echo",      "other_key",   "forged",     "repeated", "unverified",
      "other_version", "malformed", "quarantined", "name_taken", "no_room"};
  return kNames[static_cast<std::size_t>(reason)];
}

}  // namespace zenith
