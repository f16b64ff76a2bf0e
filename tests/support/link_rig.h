#pragma once
// Robots of a test that hand each other datagrams by hand.

#include <array>
#include <string>
#include <vector>

#include "platform/link/sessions.h"

namespace zenith {

using Datagram = std::vector<std::uint8_t>;

inline SecretKey key_of(std::uint8_t number) {
  SecretKey key;
  for (std::uint8_t& byte : key.bytes()) byte = number;
  return key;
}

// 10.0.0.N:7000
inline Endpoint address_of(std::uint8_t number) {
  Endpoint endpoint;
  endpoint.address = {10, 0, 0, number};
  endpoint.port = 7000;
  return endpoint;
}

inline SessionSettings session_settings(const std::string& name, std::uint64_t boot,
                                        std::uint8_t fleet = 1) {
  SessionSettings settings;
  settings.keys.current = key_of(fleet);
  settings.name.assign(name);
  settings.boot = boot;
  settings.secret = key_of(static_cast<std::uint8_t>(100 + boot));
  return settings;
}

// One robot's sessions, with what it hears and says.
class TestRobot {
 public:
  TestRobot(const std::string& name, std::uint64_t boot, std::uint8_t number)
      : TestRobot(session_settings(name, boot), number) {}
  TestRobot(const SessionSettings& settings, std::uint8_t number)
      : sessions(settings), address(address_of(number)), name_(settings.name) {}

  Datagram say(const std::vector<std::uint8_t>& payload) {
    Datagram datagram(kMaxDatagramBytes);
    datagram.resize(sessions.seal(payload, datagram));
    return datagram;
  }
  // As long as a real one, with STATE beside it.
  Datagram hello() {
    std::vector<std::uint8_t> payload = {1, static_cast<std::uint8_t>(1 + name_.view().size()), 0,
                                         static_cast<std::uint8_t>(name_.view().size())};
    for (const char c : name_.view()) payload.push_back(static_cast<std::uint8_t>(c));
    payload.insert(payload.end(), {99, 32, 0});  // a section of the future
    payload.resize(payload.size() + 32);
    return say(payload);
  }
  Datagram bye() { return say({7, 0, 0}); }

  // True: fresh, from a verified peer.
  bool hear(Time now, const Endpoint& from, const Datagram& datagram) {
    return sessions.receive(now, from, datagram, payload_, fresh);
  }
  // The answers that wait, with where they go.
  std::vector<std::pair<Endpoint, Datagram>> answers() {
    std::vector<std::pair<Endpoint, Datagram>> all;
    while (sessions.has_answer()) {
      Datagram datagram(kMaxDatagramBytes);
      Endpoint to;
      datagram.resize(sessions.next_answer(to, datagram));
      all.emplace_back(to, datagram);
    }
    return all;
  }
  std::uint64_t rejected(Rejected reason) const {
    return sessions.counters().rejected[static_cast<std::size_t>(reason)];
  }
  std::uint64_t all_rejected() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : sessions.counters().rejected) sum += count;
    return sum;
  }
  std::vector<LinkEvent> events() {
    std::vector<LinkEvent> all;
    for (LinkEvent event; sessions.next_event(event);) all.push_back(event);
    return all;
  }

  Sessions sessions;
  Endpoint address;
  Fresh fresh;

 private:
  RobotName name_;
  std::array<std::uint8_t, kMaxPayloadBytes> payload_;
};

inline Time at(double s) {
  return Time{} + Duration::from_seconds(1000.0 + s);
}

// `listener` verifies `speaker`: HELLO, CHALLENGE, RESPONSE.
inline void verify(TestRobot& listener, TestRobot& speaker, Time now) {
  listener.hear(now, speaker.address, speaker.hello());
  for (const auto& [to, challenge] : listener.answers()) {
    if (to == speaker.address) speaker.hear(now, listener.address, challenge);
  }
  for (const auto& [to, response] : speaker.answers()) {
    if (to == listener.address) listener.hear(now, speaker.address, response);
  }
}

}  // namespace zenith
