#include "platform/daemon/radio_link.h"

#include <algorithm>
#include <cmath>

#include "drivers/radio/endpoint_text.h"
#include "platform/linux/log.h"

namespace zenith {
namespace {

constexpr Duration kSecond = {1'000'000'000};
constexpr Duration kRefresh = {2'000'000'000};
constexpr Duration kState = {200'000'000};
// Of one turn, so that a flood cannot hold up the rest.
constexpr int kMaxBatches = 8;
constexpr int kMaxSent = 64;
// Lines of the log about peers: those of a whole fleet that comes and goes.
constexpr std::uint32_t kEventsPerSecond = 1;
constexpr std::uint32_t kEventsAtOnce = 2 * kMaxSessions;

// Of each kind. However many are asked for, they take an eighth of the cap, or the little that
// robots need to get to know each other.
int answers_per_second(std::uint32_t max_rate) {
  constexpr int kFewest = 8;
  constexpr std::size_t kBytes = kAnswerBytes + exchange::kIpv6UdpBytes;
  return std::clamp(static_cast<int>(max_rate / 8 / kBytes), kFewest, Handshake::kPerSecond);
}

PeerExchangeSettings exchange_settings(const RadioConfig& config, const SessionSettings& sessions,
                                       std::uint32_t map) {
  PeerExchangeSettings settings;
  settings.sessions = sessions;
  settings.sessions.answers_per_second = answers_per_second(config.max_rate);
  settings.synchroniser.map = map;
  settings.synchroniser.seed = sessions.boot;
  settings.synchroniser.max_rate = config.max_rate;
  settings.synchroniser.news_rate = std::min(config.news_rate, config.max_rate);
  const bool ipv6 = config.udp.group.find(':') != std::string::npos;
  settings.synchroniser.headers_below = ipv6 ? exchange::kIpv6UdpBytes : exchange::kIpv4UdpBytes;
  settings.synchroniser.slots = kPeerSlots;
  return settings;
}

exchange::AlignmentNotice::State notice_state(AlignmentState state) {
  switch (state) {
    case AlignmentState::kMerged:
      return exchange::AlignmentNotice::State::kMerged;
    case AlignmentState::kWithdrawn:
      return exchange::AlignmentNotice::State::kWithdrawn;
    case AlignmentState::kCandidate:
      break;
  }
  return exchange::AlignmentNotice::State::kCandidate;
}

exchange::OwnAlignment own_alignment(const PeerReport& report) {
  exchange::OwnAlignment own;
  own.slot = report.peer;
  own.state = notice_state(report.state);
  own.T_own_peer = report.T_own_peer;
  for (std::size_t i = 0; i < own.deviations.size(); ++i) {
    own.deviations[i] = std::sqrt(std::max(report.variance[i], 0.0));
  }
  own.correspondences = report.correspondences;
  own.confidence = report.confidence;
  return own;
}

const char* event_name(LinkEventKind kind) {
  switch (kind) {
    case LinkEventKind::kFound:
      return "peer-found";
    case LinkEventKind::kRestarted:
      return "peer-restarted";
    case LinkEventKind::kSilent:
      return "peer-silent";
    case LinkEventKind::kLeft:
      return "peer-left";
    case LinkEventKind::kQuarantined:
      return "peer-quarantined";
    case LinkEventKind::kOtherVersion:
      return "peer-other-version";
    case LinkEventKind::kNameConflict:
      return "peer-name-conflict";
    case LinkEventKind::kNoRoom:
      return "peer-no-room";
  }
  return "";
}

void log_event(const LinkEvent& event) {
  const std::string address = endpoint_text(event.address);
  const char* name = event.name.empty() ? "?" : event.name.c_str();
  LogFields fields(event_name(event.kind));
  fields.text("ZENITH_PEER", name);
  switch (event.kind) {
    case LinkEventKind::kFound:
      return log_line(LogLevel::kNotice, fields, "robot %s found at %s", name, address.c_str());
    case LinkEventKind::kRestarted:
      return log_line(LogLevel::kNotice, fields, "robot %s began anew, at %s", name,
                      address.c_str());
    case LinkEventKind::kSilent:
      return log_line(LogLevel::kNotice, fields, "robot %s is silent; its map stays", name);
    case LinkEventKind::kLeft:
      return log_line(LogLevel::kNotice, fields, "robot %s said goodbye; its map stays", name);
    case LinkEventKind::kQuarantined:
      return log_line(LogLevel::kWarning, fields,
                      "robot %s at %s makes too many faults: its map is withdrawn, and it is not "
                      "listened to for a while",
                      name, address.c_str());
    case LinkEventKind::kOtherVersion:
      return log_line(LogLevel::kWarning, fields,
                      "a robot at %s speaks version %d of the protocol, this one %d: they cannot "
                      "work together",
                      address.c_str(), event.value, kProtocolVersion);
    case LinkEventKind::kNameConflict:
      return log_line(LogLevel::kWarning, fields,
                      "two robots have the name %s, one of them at %s: give one another robot.name",
                      name, address.c_str());
    case LinkEventKind::kNoRoom:
      return log_line(LogLevel::kWarning, fields,
                      "a robot at %s is one too many: %d are heard at most", address.c_str(),
                      kMaxSessions);
  }
}

}  // namespace

RadioLink::RadioLink(const RadioConfig& config, const SessionSettings& sessions, std::uint32_t map,
                     Exchange& exchange)
    : exchange_(exchange), radio_(config.udp), peers_(exchange_settings(config, sessions, map)) {
  peers_.synchroniser().set_copies_to_everybody(std::max(radio_.copies_to_everybody(), 1));
  log_budget_.configure_average(kEventsPerSecond, kEventsAtOnce);
}

void RadioLink::turn(Time now, exchange::Health health) {
  keep_open(now);
  tell_forgotten();
  receive(now);
  tell_state(now, health);
  send(now);
  if (now >= next_second_) {
    next_second_ = now + kSecond;
    peers_.forget_silent(now);
    note_names();
    offer_alignments(now);
  }
  log_news(now);
}

void RadioLink::wait(Time now) {
  // Without sockets nothing can be sent, however much is due.
  const Duration due = radio_.is_open() ? peers_.next_time(now) - now : kSlice;
  radio_.wait(std::min(due, kSlice));
}

void RadioLink::finish(Time now) {
  peers_.synchroniser().say_bye();
  send(now);
  radio_.close();
}

// --- the sockets ---------------------------------------------------------------------------------

void RadioLink::keep_open(Time now) {
  if (!radio_.is_open()) {
    if (!tries_.due(now)) return;
    tries_.note(radio_.open(), now);
    next_refresh_ = now;
    if (!radio_.is_open()) return;
    log_line(LogLevel::kInfo, "radio: open, own port %d", radio_.own_port());
  }
  if (now < next_refresh_) return;
  next_refresh_ = now + kRefresh;
  radio_.refresh();
  const std::string joined = radio_.joined_text();
  if (joined == told_joined_) return;
  told_joined_ = joined;
  log_line(LogLevel::kInfo, "radio: the group is joined on %s",
           joined.empty() ? "no interface" : joined.c_str());
}

void RadioLink::receive(Time now) {
  for (int i = 0; i < kMaxBatches; ++i) {
    const auto batch = radio_.receive();
    if (batch.empty()) return;
    for (const RadioDatagram& datagram : batch) {
      peers_.receive(now, datagram.from, datagram.bytes, *this);
    }
  }
}

void RadioLink::send(Time now) {
  // What is handed out counts as sent: without sockets nothing is.
  if (!radio_.is_open()) return;
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  for (int i = 0; i < kMaxSent; ++i) {
    const Dispatch dispatch = peers_.next(now, datagram);
    if (dispatch.size == 0) return;
    const auto bytes = std::span<const std::uint8_t>(datagram).first(dispatch.size);
    if (dispatch.to_everybody) {
      radio_.send_to_everybody(bytes);
    } else {
      radio_.send(dispatch.to, bytes);
    }
  }
}

// --- the map and the state -----------------------------------------------------------------------

std::size_t RadioLink::room(int slot) {
  if (slot < 0 || slot >= kPeerSlots) return 0;
  tell_forgotten();
  if (forgotten_[static_cast<std::size_t>(slot)]) return 0;
  return Exchange::kRecords - exchange_.peers.size();
}

void RadioLink::take(int slot, const LandmarkRecord& record) {
  if (!exchange_.peers.push({slot, PeerNews::Kind::kRecord, record})) return;
  exchange_.shown.note(map_news(slot, record));
  ++records_received_;
}

void RadioLink::forget(int slot) {
  if (slot < 0 || slot >= kPeerSlots) return;
  forgotten_[static_cast<std::size_t>(slot)] = true;
  names_[static_cast<std::size_t>(slot)] = {};
  tell_forgotten();
}

void RadioLink::tell_forgotten() {
  for (std::size_t slot = 0; slot < forgotten_.size(); ++slot) {
    if (!forgotten_[slot]) continue;
    const int peer = static_cast<int>(slot);
    if (!exchange_.peers.push({peer, PeerNews::Kind::kForget, {}})) continue;
    exchange_.shown.note({peer, MapNews::Kind::kForget});
    forgotten_[slot] = false;
  }
}

void RadioLink::tell_state(Time now, exchange::Health health) {
  if (now < next_state_) return;
  next_state_ = now + kState;
  OwnState state;
  if (!exchange_.own_state.read(state)) return;
  FixedVector<exchange::OwnAlignment, kMaxPeers> alignments;
  for (const PeerReport& peer : state.peers) alignments.push_back(own_alignment(peer));
  peers_.synchroniser().set_state(state.T_start_robot, health, alignments.span());
}

// Peers that have merged with the own map say so in their state, again and again.
void RadioLink::offer_alignments(Time now) {
  constexpr Duration kFresh = {3'000'000'000};
  for (int slot = 0; slot < kPeerSlots; ++slot) {
    const exchange::PeerStatus& peer = peers_.synchroniser().peer(slot);
    if (!peer.used || !peer.about_us_heard || now > peer.heard_at + kFresh) continue;
    if (peer.about_us.state != exchange::AlignmentNotice::State::kMerged) continue;
    exchange_.merges_with_us.push({slot, peer.about_us.T_own_peer.inverse()});
  }
}

// --- telling -------------------------------------------------------------------------------------

void RadioLink::note_names() {
  for (int slot = 0; slot < kPeerSlots; ++slot) {
    const int session = peers_.synchroniser().peer(slot).session;
    const Session* peer = session >= 0 ? peers_.sessions().session(session) : nullptr;
    if (peer != nullptr && !peer->name.empty()) names_[static_cast<std::size_t>(slot)] = peer->name;
  }
}

// Whoever has the key can cause as many events as it likes; the log has other readers.
void RadioLink::log_news(Time now) {
  LinkEvent event;
  while (peers_.sessions().next_event(event)) {
    if (!log_budget_.spend(now, 1)) {
      ++not_logged_;
      continue;
    }
    if (not_logged_ > 0) {
      log_line(LogLevel::kWarning, "radio: %llu events of peers were not logged: too many",
               static_cast<unsigned long long>(not_logged_));
    }
    not_logged_ = 0;
    log_event(event);
  }
  std::string news;
  if (radio_.next_news(news)) log_lines(LogLevel::kWarning, news);
}

void RadioLink::write_status(LinkStatus& out, Time now) const {
  out.enabled = true;
  out.open = radio_.is_open();
  out.radio = radio_.counters();
  out.link = peers_.sessions().counters();
  out.exchange = peers_.synchroniser().counters();
  out.names = names_;
  out.peers.clear();
  for (int i = 0; i < kMaxSessions; ++i) {
    const Session* session = peers_.sessions().session(i);
    if (session == nullptr || !session->is_peer()) continue;
    LinkPeer peer;
    peer.name = session->name;
    peer.robot = session->id.robot;
    peer.address = session->address;
    peer.heard = session->heard;
    peer.slot = peers_.synchroniser().slot_of(i);
    peer.quarantined = peers_.synchroniser().quarantined(now, i);
    if (peer.slot >= 0) {
      const exchange::PeerStatus& map = peers_.synchroniser().peer(peer.slot);
      peer.complete = map.complete;
      peer.landmarks = map.landmarks;
      peer.has_pose = map.heard;
      peer.T_start_robot = map.state.T_start_robot;
    }
    out.peers.push_back(peer);
  }
}

}  // namespace zenith
