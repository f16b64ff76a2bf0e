#include "tests/system/hostile.h"

#include <unistd.h>

#include <array>
#include <sstream>
#include <utility>

#include "drivers/radio/endpoint_text.h"
#include "platform/linux/clock.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

RadioSettings settings() {
  RadioSettings settings;
  settings.own_port = 0;
  return settings;
}

class NoMap final : public exchange::RecordSink {
 public:
  std::size_t room(int) override { return 1000; }
  void take(int, const LandmarkRecord&) override {}
  void forget(int) override {}
};

Hostile::Datagram sealed(const SecretKey& fleet, FrameHeader header,
                         std::span<const std::uint8_t> payload) {
  header.key_hint = key_hint(fleet);
  Hostile::Datagram datagram(kMaxDatagramBytes);
  datagram.resize(seal(sender_key(fleet, header.sender), header, payload, datagram));
  return datagram;
}

// RECORDS whose one record says what no honest robot can.
std::vector<std::vector<std::uint8_t>> extreme_payloads() {
  const auto records = [](std::uint8_t count, std::vector<std::uint8_t> body) {
    std::vector<std::uint8_t> payload = {5, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 9, 0, 0, 0, count};
    payload.insert(payload.end(), body.begin(), body.end());
    payload[1] = static_cast<std::uint8_t>(payload.size() - 3);
    return payload;
  };
  // id, revision, looks, observations, place, deviations, correlations
  std::vector<std::uint8_t> record = {7, 0, 0, 0, 0, 0,   0,   1,   0, 0, 0x80, 0,
                                      0, 0, 0, 0, 0, 255, 255, 255, 0, 0, 0};
  std::vector<std::vector<std::uint8_t>> all = {records(1, record)};  // a place of -2^23
  record[10] = 0;
  record[20] = 0x80;  // a correlation of -128
  all.push_back(records(1, record));
  record[20] = 127;
  record[21] = 0x81;
  record[22] = 127;  // correlations that no matrix has
  all.push_back(records(1, record));
  all.push_back(records(255, {}));  // records that are not there
  return all;
}

}  // namespace

Hostile::Hostile(const std::string& victim, UniqueFd victims_sockets, std::uint64_t seed)
    : victims_sockets_(std::move(victims_sockets)),
      radio_(std::make_unique<UdpRadio>(settings())),
      random_(seed) {
  if (const auto endpoint = parse_endpoint(victim, 1); endpoint.ok()) victim_ = *endpoint;
}

void Hostile::send(std::span<const std::uint8_t> datagram) {
  radio_->send(victim_, datagram);
  // No faster than the victim takes them, so that its kernel drops none: every single one shall be
  // rejected.
  if (radio_->counters().sent % 50 != 0) return;
  const Time limit = monotonic_now() + kPatience;
  while (!victim_has_taken_all() && monotonic_now() < limit) {
    sleep_until(monotonic_now() + Duration{1'000'000});
  }
}

// By the bytes that wait in its sockets: the second of the two numbers "tx_queue:rx_queue".
bool Hostile::victim_has_taken_all() const {
  std::array<char, 16384> text;
  const ssize_t size = ::pread(victims_sockets_.get(), text.data(), text.size(), 0);
  if (size < 0) return true;  // not known: the test tells of what was dropped
  std::istringstream lines(std::string(text.data(), static_cast<std::size_t>(size)));
  std::string line;
  std::getline(lines, line);  // the heading
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string slot, local, remote, state, queues;
    words >> slot >> local >> remote >> state >> queues;
    if (queues.substr(queues.find(':') + 1) != "00000000") return false;
  }
  return true;
}

std::vector<Hostile::Datagram> Hostile::record(Duration time, std::size_t least) {
  std::vector<Datagram> all;
  const Time begin = monotonic_now();
  while (monotonic_now() < begin + time ||
         (all.size() < least && monotonic_now() < begin + kPatience)) {
    radio_->wait({50'000'000});
    for (auto batch = radio_->receive(); !batch.empty(); batch = radio_->receive()) {
      for (const RadioDatagram& d : batch) all.emplace_back(d.bytes.begin(), d.bytes.end());
    }
  }
  return all;
}

std::uint64_t Hostile::replay(const std::vector<Datagram>& recorded) {
  for (const Datagram& datagram : recorded) send(datagram);
  return recorded.size();
}

std::uint64_t Hostile::flip_bits(const std::vector<Datagram>& recorded) {
  for (Datagram datagram : recorded) {
    const auto bit = random_.below(static_cast<std::uint32_t>(8 * datagram.size()));
    datagram[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    send(datagram);
  }
  return recorded.size();
}

std::uint64_t Hostile::truncate(const std::vector<Datagram>& recorded) {
  for (const Datagram& datagram : recorded) {
    send(std::span(datagram).first(random_.below(static_cast<std::uint32_t>(datagram.size()))));
  }
  return recorded.size();
}

std::uint64_t Hostile::spoof(const std::vector<Datagram>& recorded) {
  for (Datagram datagram : recorded) {
    const std::size_t field = random_.below(3);
    if (field == 0) datagram[2] = 77;                         // version
    if (field == 1) datagram[16 + random_.below(8)] ^= 0x55;  // boot
    if (field == 2) datagram[26 + random_.below(6)] ^= 0x55;  // counter
    for (std::size_t i = kHeaderBytes; i < datagram.size(); ++i) {
      if (field == 2) datagram[i] = static_cast<std::uint8_t>(random_.next_u32());
    }
    send(datagram);
  }
  return recorded.size();
}

std::uint64_t Hostile::flood(std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    Datagram datagram(1 + random_.below(kMaxDatagramBytes));
    for (std::uint8_t& byte : datagram) byte = static_cast<std::uint8_t>(random_.next_u32());
    if (i % 2 == 0 && datagram.size() > 2) {
      datagram[0] = 0x5A;
      datagram[1] = 0x4E;
    }
    send(datagram);
  }
  return count;
}

std::uint64_t Hostile::knock(const FleetKeys& keys, std::uint64_t count) {
  const std::vector<std::uint8_t> payload = [] {
    std::vector<std::uint8_t> section = {99, 40, 0};
    section.resize(43);
    return section;
  }();
  for (std::uint64_t i = 0; i < count; ++i) {
    FrameHeader header;
    header.sender = {random_.next_u32(), random_.next_u32()};
    header.counter = 1;
    send(sealed(keys.current, header, payload));
  }
  return count;
}

std::uint64_t Hostile::speak_other_versions(const FleetKeys& keys, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    FrameHeader header;
    header.version = static_cast<std::uint8_t>(kProtocolVersion + 1 + i % 200);
    header.sender = {4711, 42};
    header.counter = i + 1;
    send(sealed(keys.current, header, std::vector<std::uint8_t>(100)));
  }
  return count;
}

bool Hostile::tell_extremes(const FleetKeys& keys, std::uint64_t victim_robot,
                            const std::function<bool()>& is_known) {
  PeerExchangeSettings settings;
  settings.sessions.keys = keys;
  settings.sessions.name.assign("mallory");
  settings.sessions.boot = secret_number();
  settings.sessions.secret = SecretKey::random();
  settings.synchroniser.map = 1;
  settings.synchroniser.seed = 1;
  PeerExchange exchange(settings);
  NoMap map;
  std::array<std::uint8_t, kMaxDatagramBytes> datagram;
  const auto run_until = [&](auto holds) {
    const Time end = monotonic_now() + kPatience;
    while (!holds() && monotonic_now() < end) {
      radio_->wait({20'000'000});
      const Time now = monotonic_now();
      for (auto batch = radio_->receive(); !batch.empty(); batch = radio_->receive()) {
        for (const RadioDatagram& d : batch) exchange.receive(now, d.from, d.bytes, map);
      }
      while (true) {
        const Dispatch dispatch = exchange.next(now, datagram);
        if (dispatch.size == 0) break;
        radio_->send(dispatch.to_everybody ? victim_ : dispatch.to,
                     std::span(datagram).first(dispatch.size));
      }
    }
  };
  const auto is_verified = [&] {
    return exchange.sessions().find_peer(victim_robot) >= 0 &&
           exchange.sessions().counters().responses > 0;
  };
  run_until([&] { return is_verified() && is_known(); });
  if (!is_verified()) return false;
  for (const auto& payload : extreme_payloads()) {
    send(std::span(datagram).first(exchange.sessions().seal(payload, datagram)));
  }
  // It stays for a while: what the victim says now is answered.
  const Time leave = monotonic_now() + Duration{2'000'000'000};
  run_until([&] { return monotonic_now() > leave; });
  return true;
}

}  // namespace zenith
