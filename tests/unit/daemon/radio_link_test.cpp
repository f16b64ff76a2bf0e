// The cooperation thread's work on real sockets of the loopback interface.

#include "platform/daemon/radio_link.h"

#include <sys/resource.h>
#include <unistd.h>

#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "platform/daemon/cooperation.h"
#include "platform/linux/clock.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

RadioConfig radio_config() {
  RadioConfig config;
  config.udp.port = 20000 + static_cast<int>(::getpid() % 10000);
  config.udp.own_port = 0;
  config.udp.interface = "lo";
  return config;
}

SessionSettings session_settings(const char* name, std::uint8_t fleet) {
  SessionSettings settings;
  for (std::uint8_t& byte : settings.keys.current.bytes()) byte = fleet;
  settings.name.assign(name);
  settings.boot = secret_number();
  settings.secret = SecretKey::random();
  return settings;
}

struct Robot {
  explicit Robot(const char* name, std::uint8_t fleet = 1,
                 const RadioConfig& config = radio_config())
      : link(std::make_unique<RadioLink>(config, session_settings(name, fleet),
                                         static_cast<std::uint32_t>(secret_number()), *exchange)),
        cooperation(std::make_unique<Cooperation>(*exchange, link.get())) {}

  void turn() {
    cooperation->turn_once(monotonic_now());
    link->wait(monotonic_now());
  }
  LinkStatus status() const {
    LinkStatus status;
    cooperation->read(status);
    return status;
  }
  // What perception would take out.
  void perceive() {
    for (PeerNews news; exchange->peers.pop(news);) {
      if (news.kind == PeerNews::Kind::kForget) ++forgotten;
      if (news.kind == PeerNews::Kind::kRecord) ++records;
      slot = news.peer;
    }
    for (MergeNews merge; exchange->merges_with_us.pop(merge);) offer = merge;
  }

  std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
  std::unique_ptr<RadioLink> link;
  std::unique_ptr<Cooperation> cooperation;
  int records = 0;
  int forgotten = 0;
  int slot = -1;
  MergeNews offer = {-1, {}};
};

LandmarkRecord landmark(std::uint32_t id) {
  LandmarkRecord record;
  record.id = id;
  record.x_m = 1.0F;
  record.z_m = 2.0F;
  record.covariance_m2 = {0.01F, 0.0F, 0.0F, 0.01F, 0.0F, 0.01F};
  return record;
}

class RadioLinkTest : public testing::Test {
 protected:
  void SetUp() override {
    if (usable_interfaces("lo", false).empty()) {
      GTEST_SKIP() << "SKIPPED: no address on the loopback interface";
    }
  }
  // Turns both until it holds.
  static bool run_until(Robot& a, Robot& b, const std::function<bool()>& holds,
                        double limit_s = kPatience_s) {
    const Time limit = monotonic_now() + Duration::from_seconds(limit_s);
    while (monotonic_now() < limit) {
      for (Robot* robot : {&a, &b}) {
        robot->turn();
        robot->perceive();
      }
      if (holds()) return true;
    }
    return false;
  }
};

TEST_F(RadioLinkTest, TwoRobotsTellEachOtherTheirMapsAndMerges) {
  Robot ada("ada");
  Robot bert("bert");
  for (std::uint32_t id = 1; id <= 100; ++id) ada.exchange->own.push(landmark(id));
  ASSERT_TRUE(run_until(ada, bert, [&] { return bert.records >= 100; })) << bert.records;
  EXPECT_EQ(ada.cooperation->counters().sent, 100u);
  EXPECT_EQ(bert.cooperation->counters().received, 100u);

  // Bert merges ada's map: ada hears how.
  OwnState state;
  state.has_pose = true;
  PeerReport merged;
  merged.peer = bert.slot;
  merged.state = AlignmentState::kMerged;
  merged.T_own_peer = {2.0, 1.0, 0.5};
  state.peers.push_back(merged);
  bert.exchange->own_state.write(state);
  ASSERT_TRUE(run_until(ada, bert, [&] { return ada.offer.peer >= 0; }));
  const Pose2 expected = merged.T_own_peer.inverse();
  EXPECT_NEAR(ada.offer.T_own_peer.x_m, expected.x_m, 0.002);
  EXPECT_NEAR(ada.offer.T_own_peer.y_m, expected.y_m, 0.002);
  EXPECT_NEAR(ada.offer.T_own_peer.theta_rad, expected.theta_rad, 0.001);

  // The status has it all.
  ASSERT_TRUE(run_until(ada, bert, [&] {
    const LinkStatus status = bert.status();
    return status.peers.size() == 1 && status.peers[0].complete;
  }));
  const LinkStatus status = bert.status();
  EXPECT_TRUE(status.enabled);
  EXPECT_TRUE(status.open);
  EXPECT_EQ(status.peers[0].name.view(), "ada");
  EXPECT_EQ(status.peers[0].landmarks, 100u);
  EXPECT_STREQ(status.name_of(status.peers[0].slot), "ada");
  EXPECT_STREQ(status.name_of(-1), "?");
  EXPECT_FALSE(status.peers[0].quarantined);

  // And goodbye.
  ada.link->finish(monotonic_now());
  ASSERT_TRUE(run_until(bert, bert, [&] { return bert.status().peers.empty(); }));
}

TEST_F(RadioLinkTest, LosesNothingThatPerceptionHasNoRoomFor) {
  Robot ada("ada");
  Robot bert("bert");
  const int many = static_cast<int>(Exchange::kRecords) + 300;
  for (int id = 1; id <= many; ++id) {
    ASSERT_TRUE(ada.link->send_own(landmark(static_cast<std::uint32_t>(id))));
  }
  // Perception sleeps until the queue is full.
  const Time limit = monotonic_now() + kPatience;
  while (bert.exchange->peers.size() + 60 < Exchange::kRecords && monotonic_now() < limit) {
    ada.turn();
    bert.turn();
  }
  EXPECT_EQ(bert.exchange->peers.rejected(), 0u);
  EXPECT_TRUE(run_until(ada, bert, [&] { return bert.records >= many; })) << bert.records;
}

// More than any queue holds; nobody takes out what people would be shown.
TEST_F(RadioLinkTest, PeersRecordsDoNotWaitForWhatIsShown) {
  Robot ada("ada");
  Robot bert("bert");
  constexpr int kMany = 2200;
  for (int round = 1; round <= 2; ++round) {
    for (int id = 1; id <= kMany; ++id) {
      LandmarkRecord record = landmark(static_cast<std::uint32_t>(id));
      record.observations = static_cast<std::uint16_t>(round);
      ASSERT_TRUE(ada.link->send_own(record));
    }
    ASSERT_TRUE(run_until(
        ada, bert, [&] { return bert.records >= round * kMany; }, 120.0))
        << bert.records;
  }
}

TEST_F(RadioLinkTest, TakesANewKeyWhileItRuns) {
  Robot ada("ada", 1);
  Robot bert("bert", 2);
  const auto heard = [&] { return ada.records > 0 && bert.records > 0; };
  ada.exchange->own.push(landmark(1));
  bert.exchange->own.push(landmark(1));
  EXPECT_FALSE(run_until(ada, bert, heard, 3.0));
  ada.cooperation->set_keys(session_settings("", 7).keys);  // replaced before it is taken
  ada.cooperation->set_keys(session_settings("", 2).keys);
  EXPECT_TRUE(run_until(ada, bert, heard));
}

// What a peer may send does not depend on what this robot may: one that hardly says anything is
// told everything as fast as the protocol allows.
TEST_F(RadioLinkTest, TheLowestCapTakesWhatThePeerWithTheHighestSends) {
  RadioConfig low = radio_config();
  low.max_rate = 5000;
  low.news_rate = 1000;
  RadioConfig high = radio_config();
  high.max_rate = exchange::kMaxRate;
  high.news_rate = exchange::kMaxRate;
  Robot ada("ada", 1, low);
  Robot bert("bert", 1, high);
  constexpr int kMany = 4000;
  for (int id = 1; id <= kMany; ++id) {
    LandmarkRecord record = landmark(static_cast<std::uint32_t>(id));
    record.appearance_count = kPublishedAppearances;
    ASSERT_TRUE(bert.link->send_own(record));
  }
  EXPECT_TRUE(run_until(ada, bert, [&] { return ada.records >= kMany; })) << ada.records;
  EXPECT_EQ(ada.status().exchange.too_much, 0u);
  EXPECT_EQ(ada.status().exchange.quarantines, 0u);
}

// Without sockets there is nothing to wait for but the next try: the thread sleeps. So it does with
// sockets and nobody there. A turn that does not sleep takes a few microseconds.
class RadioThread : public RadioLinkTest {
 protected:
  static void expect_sleep(const RadioConfig& config, bool open) {
    constexpr int kTurns = 50;
    Robot ada("ada", 1, config);
    for (std::uint32_t id = 1; id <= 100; ++id) ada.exchange->own.push(landmark(id));
    const Time begin = monotonic_now();
    for (int i = 0; i < kTurns; ++i) ada.turn();
    const Duration slept = monotonic_now() - begin;
    EXPECT_GE(slept, Duration{kTurns * RadioLink::kSlice.ns / 2});
    EXPECT_EQ(ada.status().open, open);
  }
};

TEST_F(RadioThread, SleepsWhileItsPortIsTaken) {
  RadioConfig config = radio_config();
  UdpRadio other(config.udp);
  ASSERT_TRUE(other.open().ok());
  config.udp.own_port = other.own_port();
  expect_sleep(config, false);
}

TEST_F(RadioThread, SleepsWhileNoSocketIsToBeHad) {
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none = {0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  expect_sleep(radio_config(), false);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
}

TEST_F(RadioThread, SleepsWhileItsInterfaceIsNotThere) {
  RadioConfig config = radio_config();
  config.udp.interface = "zenith-none";
  expect_sleep(config, true);
}

// A peer whose socket the test holds, and another socket from which its words may come.
class SpoofedPeer : public RadioLinkTest {
 protected:
  class NoMap final : public exchange::RecordSink {
   public:
    std::size_t room(int) override { return 100000; }
    void take(int, const LandmarkRecord&) override {}
    void forget(int) override {}
  };
  static PeerExchangeSettings peer_settings() {
    PeerExchangeSettings settings;
    settings.sessions = session_settings("bert", 1);
    settings.synchroniser.map = 1;
    settings.synchroniser.seed = 1;
    return settings;
  }
  static RadioSettings socket_settings() {
    RadioSettings settings;
    settings.group = "";
    settings.peers = "127.0.0.1:9";
    settings.own_port = 0;
    return settings;
  }
  void SetUp() override {
    RadioLinkTest::SetUp();
    if (IsSkipped()) return;
    ASSERT_TRUE(group_.open().ok());
    ASSERT_TRUE(other_.open().ok());
  }
  // Ada and bert, who hears and speaks through `radio`. Bytes that came to him there.
  std::size_t turn(UdpRadio& radio, const Endpoint* to) {
    ada_.turn();
    std::size_t bytes = 0;
    for (auto batch = radio.receive(); !batch.empty(); batch = radio.receive()) {
      for (const RadioDatagram& d : batch) {
        bytes += d.bytes.size();
        bert_.receive(monotonic_now(), d.from, d.bytes, no_map_);
      }
    }
    std::array<std::uint8_t, kMaxDatagramBytes> out;
    for (Dispatch d = bert_.next(monotonic_now(), out); d.size > 0;
         d = bert_.next(monotonic_now(), out)) {
      const auto datagram = std::span<const std::uint8_t>(out).first(d.size);
      if (to != nullptr) {
        radio.send(*to, datagram);
      } else if (d.to_everybody) {
        radio.send_to_everybody(datagram);
      } else {
        radio.send(d.to, datagram);
      }
    }
    return bytes;
  }
  std::vector<std::uint8_t> request_for_all() {
    exchange::Request request;
    const exchange::PeerStatus& map = bert_.synchroniser().peer(0);
    request.robot = map.robot;
    request.map = map.map;
    request.ranges.push_back({1, exchange::kToHead});
    std::vector<std::uint8_t> payload(100);
    exchange::ByteWriter writer(payload);
    append(writer, request);
    payload.resize(writer.size());
    std::vector<std::uint8_t> datagram(kMaxDatagramBytes);
    datagram.resize(bert_.sessions().seal(payload, datagram));
    return datagram;
  }

  Robot ada_{"ada"};
  PeerExchange bert_{peer_settings()};
  NoMap no_map_;
  UdpRadio group_{radio_config().udp};
  UdpRadio other_{socket_settings()};
};

TEST_F(SpoofedPeer, GetsNothingElsewhereUntilItAnswersThere) {
  for (std::uint32_t id = 1; id <= 1000; ++id) ada_.exchange->own.push(landmark(id));
  const auto peers = [&] {
    const int slot = bert_.synchroniser().slot_of(0);
    return ada_.status().peers.size() == 1 && slot == 0 && bert_.synchroniser().peer(0).complete;
  };
  const Time limit = monotonic_now() + kPatience;
  while (!peers() && monotonic_now() < limit) (void)turn(group_, nullptr);
  ASSERT_TRUE(peers());
  const Endpoint victim = bert_.sessions().session(0)->address;

  // His words come from elsewhere, and he is silent: ada sends no more there than came from there.
  std::size_t sent = 0;
  std::size_t received = 0;
  for (int i = 0; i < 200; ++i) {
    if (i % 10 == 0) {
      const auto request = request_for_all();
      other_.send(victim, request);
      sent += request.size();
    }
    ada_.turn();
    for (auto batch = other_.receive(); !batch.empty(); batch = other_.receive()) {
      for (const RadioDatagram& d : batch) received += d.bytes.size();
    }
  }
  EXPECT_LE(received, sent);

  // He is there indeed, and answers: now he is served there.
  received = 0;
  const Time end = monotonic_now() + kPatience;
  while (received < 20'000 && monotonic_now() < end) {
    received += turn(other_, &victim);
    other_.send(victim, request_for_all());
  }
  EXPECT_GE(received, 20'000u);
  EXPECT_EQ(ada_.status().peers.size(), 1u);
}

TEST_F(RadioLinkTest, AnotherFleetIsNotHeard) {
  Robot ada("ada", 1);
  Robot zoe("zoe", 2);
  zoe.exchange->own.push(landmark(1));
  ASSERT_TRUE(run_until(ada, zoe, [&] {
    return ada.status().link.rejected[static_cast<std::size_t>(Rejected::kOtherKey)] > 2;
  }));
  EXPECT_TRUE(ada.status().peers.empty());
  EXPECT_EQ(ada.records, 0);
}

}  // namespace
}  // namespace zenith
