// On real sockets of the loopback interface.

#include "drivers/radio/udp_radio.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/radio/endpoint_text.h"
#include "platform/linux/clock.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

struct Heard {
  std::string text;
  Endpoint from;
};

// All that comes until `count` are there, or for a while when they do not come.
std::vector<Heard> listen(UdpRadio& radio, std::size_t count, Duration patience = kPatience) {
  std::vector<Heard> all;
  const Time limit = monotonic_now() + patience;
  do {  // once at least: what is there is there
    radio.wait({20'000'000});
    for (auto batch = radio.receive(); !batch.empty(); batch = radio.receive()) {
      for (const RadioDatagram& d : batch) {
        all.push_back({std::string(d.bytes.begin(), d.bytes.end()), d.from});
      }
    }
  } while (all.size() < count && monotonic_now() < limit);
  return all;
}

// A port that is free now, different for each running test program.
int test_port() {
  static int port = 30000 + static_cast<int>(::getpid() % 10000) * 2;
  return port++;
}

class UdpRadioTest : public testing::TestWithParam<const char*> {
 protected:
  RadioSettings settings() const {
    RadioSettings settings;
    settings.group = GetParam();
    settings.port = port_;
    settings.own_port = 0;
    settings.interface = interface_;
    return settings;
  }
  bool is_ipv6() const { return std::string(GetParam()).find(':') != std::string::npos; }
  // The kernel has no IPv6 multicast on the loopback interface; what another one sends comes back
  // as well.
  void SetUp() override {
    if (is_ipv6()) {
      const auto all = usable_interfaces("", true);
      interface_ = all.empty() || all[0].name == "lo" ? "" : all[0].name;
    } else if (!usable_interfaces("lo", false).empty()) {
      interface_ = "lo";
    }
    const int fd = ::socket(is_ipv6() ? AF_INET6 : AF_INET, SOCK_DGRAM, 0);
    if (fd >= 0) ::close(fd);
    if (fd < 0 || interface_.empty()) {
      GTEST_SKIP() << "SKIPPED: no sockets, or no interface with an address, for " << GetParam();
    }
  }

  std::string interface_;
  const int port_ = test_port();
};

TEST_P(UdpRadioTest, SeveralOnOneComputerHearEachOther) {
  UdpRadio ada(settings());
  UdpRadio bert(settings());
  UdpRadio carl(settings());
  for (UdpRadio* radio : {&ada, &bert, &carl}) {
    const Status opened = radio->open();
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    EXPECT_EQ(radio->joined_text(), interface_);
    EXPECT_EQ(radio->copies_to_everybody(), 1);
  }
  EXPECT_NE(ada.own_port(), bert.own_port());

  ada.send_to_everybody(bytes("hello all"));
  for (UdpRadio* radio : {&ada, &bert, &carl}) {
    const auto heard = listen(*radio, 1);
    ASSERT_EQ(heard.size(), 1u);
    EXPECT_EQ(heard[0].text, "hello all");
    EXPECT_EQ(heard[0].from.port, ada.own_port());
  }
  // The answer goes to whom it came from, and to nobody else.
  ada.send_to_everybody(bytes("anybody?"));
  const auto question = listen(bert, 1);
  ASSERT_EQ(question.size(), 1u);
  bert.send(question[0].from, bytes("me"));
  const auto answer = listen(ada, 2);  // its own question, too
  ASSERT_EQ(answer.size(), 2u);
  EXPECT_TRUE(answer[0].text == "me" || answer[1].text == "me");
  const auto at_carl = listen(carl, 2, {200'000'000});
  ASSERT_EQ(at_carl.size(), 1u);
  EXPECT_EQ(at_carl[0].text, "anybody?");
}

TEST_P(UdpRadioTest, ReachesListedAddressesWithoutAGroup) {
  RadioSettings listener = settings();
  listener.group = "";
  const std::string loopback = is_ipv6() ? "[::1]:" : "127.0.0.1:";
  listener.peers = loopback + "9";  // whom it sends to does not matter here
  UdpRadio bert(listener);
  ASSERT_TRUE(bert.open().ok());
  RadioSettings speaker = listener;
  speaker.peers = loopback + std::to_string(bert.own_port()) + "," + loopback + "9";
  UdpRadio ada(speaker);
  ASSERT_TRUE(ada.open().ok());
  EXPECT_EQ(ada.copies_to_everybody(), 2);
  ada.send_to_everybody(bytes("hello bert"));
  const auto heard = listen(bert, 1);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].text, "hello bert");
  EXPECT_EQ(endpoint_text(heard[0].from), loopback + std::to_string(ada.own_port()));
}

// Not over other interfaces than the loopback one: others would hear it.
TEST_P(UdpRadioTest, TakesBurstsAndWhatIsTooLongIsNotOurs) {
  if (interface_ != "lo") return;
  UdpRadio ada(settings());
  UdpRadio bert(settings());
  ASSERT_TRUE(ada.open().ok());
  ASSERT_TRUE(bert.open().ok());
  for (int i = 0; i < 70; ++i) {
    ada.send_to_everybody(
        std::vector<std::uint8_t>(i % 7 == 0 ? UdpRadio::kMaxBytes + 1 : UdpRadio::kMaxBytes));
  }
  EXPECT_EQ(listen(bert, 60).size(), 60u);
  EXPECT_EQ(bert.counters().too_long, 10u);
  EXPECT_EQ(bert.counters().received, 60u);
  EXPECT_EQ(ada.counters().sent, 70u);
}

TEST_P(UdpRadioTest, CountsWhatTheKernelDropped) {
  if (interface_ != "lo") return;
  UdpRadio ada(settings());
  UdpRadio bert(settings());
  ASSERT_TRUE(ada.open().ok());
  ASSERT_TRUE(bert.open().ok());
  constexpr std::uint64_t kMany = 3000;
  const std::vector<std::uint8_t> full(UdpRadio::kMaxBytes);
  for (std::uint64_t i = 0; i < kMany; ++i) ada.send_to_everybody(full);
  std::uint64_t heard = listen(bert, kMany, {300'000'000}).size();
  // The kernel tells its count with the next datagram.
  ada.send_to_everybody(full);
  heard += listen(bert, 1).size();
  EXPECT_GT(bert.counters().dropped, 0u);
  EXPECT_EQ(heard + bert.counters().dropped, kMany + 1);
}

TEST_P(UdpRadioTest, APortThatIsTakenIsSaid) {
  UdpRadio ada(settings());
  ASSERT_TRUE(ada.open().ok());
  RadioSettings same = settings();
  same.own_port = ada.own_port();
  UdpRadio bert(same);
  const Status opened = bert.open();
  ASSERT_FALSE(opened.ok());
  EXPECT_THAT(opened.error().message, HasSubstr("give radio.own_port another number"));
  EXPECT_FALSE(bert.is_open());
  ada.close();
  EXPECT_TRUE(bert.open().ok()) << "again, when it is free";
}

TEST_P(UdpRadioTest, WithoutItsInterfaceItIsOpenAndSaysOnceThatItCannotSend) {
  RadioSettings absent = settings();
  absent.interface = "nowlan7";
  UdpRadio ada(absent);
  ASSERT_TRUE(ada.open().ok());
  EXPECT_EQ(ada.joined_text(), "");
  std::string news;
  EXPECT_FALSE(ada.next_news(news));
  for (int i = 0; i < 5; ++i) ada.send_to_everybody(bytes("anybody?"));
  EXPECT_EQ(ada.counters().unreachable, 5u);
  ASSERT_TRUE(ada.next_news(news));
  EXPECT_THAT(news, HasSubstr("ENETUNREACH"));
  EXPECT_FALSE(ada.next_news(news));
}

INSTANTIATE_TEST_SUITE_P(Families, UdpRadioTest, testing::Values("239.255.90.78", "ff02::5a4e"),
                         [](const auto& family) { return family.index == 0 ? "Ipv4" : "Ipv6"; });

TEST(RadioSettings, AreChecked) {
  RadioSettings settings;
  EXPECT_TRUE(check(settings).ok());
  settings.group = "10.0.0.1";
  EXPECT_THAT(check(settings).error().message, HasSubstr("multicast group"));
  settings.group = "";
  EXPECT_THAT(check(settings).error().message, HasSubstr("neither a group nor peers"));
  settings.peers = "10.0.0.1";
  EXPECT_TRUE(check(settings).ok());
  settings.own_port = 0;
  EXPECT_THAT(check(settings).error().message, HasSubstr("need ports"));
  settings.peers = "10.0.0.1:9, x";
  EXPECT_THAT(check(settings).error().message, HasSubstr("found \"x\""));
}

}  // namespace
}  // namespace zenith
