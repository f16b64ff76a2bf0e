#include "platform/link/sessions.h"

#include <algorithm>
#include <cassert>

namespace zenith {
namespace {

using exchange::Bytes;

// Datagrams of an older boot may still be under way this long after a newer one was verified.
constexpr Duration kUnderWay = {3'000'000'000};
// A session may be given up for a new one when it was silent this long: longer than a nonce holds,
// so that no RESPONSE of it is good any more.
constexpr Duration kGivesWay = {15'000'000'000};

}  // namespace

Sessions::Sessions(const SessionSettings& settings)
    : own_{robot_id(settings.name.view()), settings.boot},
      name_(settings.name),
      forget_after_(std::max(settings.forget_after, kGivesWay)),
      handshake_(settings.secret) {
  prepare_cryptography();
  set_keys(settings.keys);
}

// The counter goes on: with whichever key, none is used twice.
void Sessions::set_keys(const FleetKeys& keys) {
  fleet_keys_ = {keys.current, keys.previous};
  hints_ = {key_hint(keys.current), key_hint(keys.previous)};
  key_count_ = keys.has_previous ? 2 : 1;
  own_key_ = sender_key(keys.current, own_);
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (!used_[i]) continue;
    guards_[i].fleet_key = 0;
    guards_[i].key = sender_key(keys.current, ids_[i]);
  }
}

bool Sessions::reject(Rejected reason) {
  count_rejected(reason);
  return false;
}

int Sessions::fleet_key_of(const KeyHint& hint) const {
  for (std::size_t i = 0; i < key_count_; ++i) {
    if (hints_[i] == hint) return static_cast<int>(i);
  }
  return -1;
}

int Sessions::find(const SenderId& id) const {
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    if (ids_[i] == id && used_[i]) return static_cast<int>(i);
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
  FrameHeader header;
  if (!read_header(datagram, header)) return reject(Rejected::kForeign);
  if (header.sender == own_) return reject(Rejected::kEcho);
  if (fleet_key_of(header.key_hint) < 0) return reject(Rejected::kOtherKey);
  const int slot = find(header.sender);
  if (slot >= 0 && !guards_[static_cast<std::size_t>(slot)].window.is_new(header.counter)) {
    return reject(Rejected::kRepeated);
  }
  std::size_t bytes = 0;
  if (!unseal(slot, header, datagram, payload, bytes)) return reject(Rejected::kForged);
  if (header.version != kProtocolVersion) return note_version(header, from);
  const Bytes opened = payload.first(bytes);
  if (slot < 0) return greet(now, from, header, opened, datagram.size());
  if (!note_peer(now, slot, header, from, opened)) return false;
  ++counters_.received;
  counters_.received_bytes += datagram.size();
  out = {slot, header.counter, opened};
  return true;
}

bool Sessions::unseal(int slot, const FrameHeader& header, Bytes datagram,
                      std::span<std::uint8_t> payload, std::size_t& bytes) {
  const int fleet_key = fleet_key_of(header.key_hint);
  Guard* guard = slot >= 0 ? &guards_[static_cast<std::size_t>(slot)] : nullptr;
  if (guard != nullptr && guard->fleet_key == fleet_key) {
    return open(guard->key, datagram, payload, bytes);
  }
  const SecretKey key = sender_key(fleet_keys_[static_cast<std::size_t>(fleet_key)], header.sender);
  if (!open(key, datagram, payload, bytes)) return false;
  if (guard != nullptr) {  // the peer changed its key
    guard->fleet_key = fleet_key;
    guard->key = key;
  }
  return true;
}

bool Sessions::note_version(const FrameHeader& header, const Endpoint& from) {
  const auto told = told_versions_.span();
  if (std::find(told.begin(), told.end(), header.sender.boot) == told.end() &&
      told_versions_.push_back(header.sender.boot)) {
    put_event({LinkEventKind::kOtherVersion, header.sender.robot, {}, from, header.version});
  }
  return reject(Rejected::kOtherVersion);
}

// An unverified sender.
bool Sessions::greet(Time now, const Endpoint& from, const FrameHeader& header, Bytes payload,
                     std::size_t datagram_bytes) {
  Greetings greetings;
  if (!read_greetings(payload, header.sender.robot, greetings)) {
    return reject(Rejected::kMalformed);
  }
  const auto is_for_us = [&](const std::optional<exchange::Challenge>& c) {
    return c && c->robot == own_.robot && c->boot == own_.boot;
  };
  if (is_for_us(greetings.response) &&
      handshake_.is_answered(now, header.sender, greetings.response->nonce)) {
    admit(now, from, header);
    return false;
  }
  if (is_for_us(greetings.challenge)) {
    counters_.responses +=
        handshake_.respond(now, header.sender, from, *greetings.challenge) ? 1 : 0;
  } else if (!greetings.bye) {
    counters_.challenges += handshake_.challenge(now, header.sender, from, datagram_bytes) ? 1 : 0;
  }
  return reject(Rejected::kUnverified);
}

void Sessions::admit(Time now, const Endpoint& from, const FrameHeader& header) {
  const int slot = room_for(now);
  if (slot < 0) {
    put_event({LinkEventKind::kNoRoom, header.sender.robot, {}, from, 0});
    count_rejected(Rejected::kNoRoom);
    return;
  }
  const int older = find_newest(header.sender.robot);
  const auto s = static_cast<std::size_t>(slot);
  used_[s] = true;
  ids_[s] = header.sender;
  sessions_[s] = {};
  sessions_[s].id = header.sender;
  sessions_[s].address = from;
  sessions_[s].verified = now;
  sessions_[s].heard = now;
  sessions_[s].is_namesake = header.sender.robot == own_.robot;
  guards_[s].fleet_key = fleet_key_of(header.key_hint);
  guards_[s].key =
      sender_key(fleet_keys_[static_cast<std::size_t>(guards_[s].fleet_key)], header.sender);
  guards_[s].window.begin(header.counter);
  ++counters_.verified;
  ++changes_;
  if (older < 0) return;
  Session& before = sessions_[static_cast<std::size_t>(older)];
  before.is_superseded = true;
  sessions_[s].name = before.name;
  tell(LinkEventKind::kRestarted, sessions_[s]);
}

// A free slot, or that of the one that was silent for longest; -1 when all are busy.
int Sessions::room_for(Time now) const {
  int oldest = -1;
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    const int slot = static_cast<int>(i);
    if (!used_[i]) return slot;
    if (now < sessions_[i].heard + kGivesWay) continue;
    if (oldest < 0 || sessions_[i].heard < sessions_[static_cast<std::size_t>(oldest)].heard) {
      oldest = slot;
    }
  }
  return oldest;
}

// A datagram of a verified sender that was not heard before. False when it is not to be used.
bool Sessions::note_peer(Time now, int slot, const FrameHeader& header, const Endpoint& from,
                         Bytes payload) {
  Session& session = sessions_[static_cast<std::size_t>(slot)];
  ReplayWindow& window = guards_[static_cast<std::size_t>(slot)].window;
  const bool is_newest = header.counter > window.newest();
  window.note(header.counter);
  if (is_newest) session.address = from;
  session.heard = now;
  if (session.is_superseded || session.is_namesake) return note_double(session, now);
  if (session.has_left) return reject(Rejected::kUnverified);
  if (session.is_silent) {
    session.is_silent = false;
    ++changes_;
    tell(LinkEventKind::kFound, session);
  }
  Greetings greetings;
  if (!read_greetings(payload, session.id.robot, greetings)) return true;  // a fault: see there
  if (greetings.name && session.name.empty()) {
    session.name = *greetings.name;
    tell(LinkEventKind::kFound, session);
  }
  if (greetings.challenge && greetings.challenge->robot == own_.robot &&
      greetings.challenge->boot == own_.boot) {
    counters_.responses +=
        handshake_.respond(now, header.sender, from, *greetings.challenge) ? 1 : 0;
  }
  if (greetings.bye) {
    session.has_left = true;
    ++changes_;
    tell(LinkEventKind::kLeft, session);
  }
  return true;
}

bool Sessions::note_double(Session& session, Time now) {
  if (!session.conflict_told && now > session.verified + kUnderWay) {
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
  header.sender = own_;
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
