#include "platform/link/sessions.h"

#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/link_rig.h"

namespace zenith {
namespace {

TEST(Sessions, VerifyBeforeTheyListen) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  EXPECT_FALSE(ada.hear(at(0), bert.address, bert.hello()));
  EXPECT_EQ(ada.rejected(Rejected::kUnverified), 1u);
  EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot), -1);

  const auto challenges = ada.answers();
  ASSERT_EQ(challenges.size(), 1u);
  EXPECT_EQ(challenges[0].first, bert.address);
  EXPECT_FALSE(bert.hear(at(0), ada.address, challenges[0].second));
  const auto responses = bert.answers();
  ASSERT_EQ(responses.size(), 1u);
  EXPECT_EQ(responses[0].first, ada.address);
  EXPECT_FALSE(ada.hear(at(0.1), bert.address, responses[0].second));
  const int slot = ada.sessions.find_peer(bert.sessions.own().robot);
  ASSERT_GE(slot, 0);

  EXPECT_TRUE(ada.hear(at(1), bert.address, bert.hello()));
  EXPECT_EQ(ada.fresh.session, slot);
  EXPECT_EQ(ada.sessions.session(slot)->name.view(), "bert");
  const auto events = ada.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, LinkEventKind::kFound);
  EXPECT_EQ(events[0].name.view(), "bert");
  // The other way round nobody has answered yet.
  EXPECT_EQ(bert.sessions.find_peer(ada.sessions.own().robot), -1);
}

TEST(Sessions, AnAnswerIsNeverLongerThanWhatItAnswers) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("b", 2, 2);
  const Datagram small = bert.say({99, 30, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                   0,  0,  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_LT(small.size(), kAnswerBytes);
  ada.hear(at(0), bert.address, small);
  EXPECT_EQ(ada.answers().size(), 0u);
  const Datagram hello = bert.hello();
  ada.hear(at(0), bert.address, hello);
  const auto answers = ada.answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].second.size(), kAnswerBytes);
  EXPECT_LE(answers[0].second.size(), hello.size());
}

TEST(Sessions, WhatWasRecordedIsNotFreshAgain) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  const Datagram before = bert.hello();
  verify(ada, bert, at(0));
  const Datagram first = bert.hello();
  const Datagram second = bert.hello();
  EXPECT_TRUE(ada.hear(at(1), bert.address, second));
  EXPECT_TRUE(ada.hear(at(1), bert.address, first)) << "overtaken on the way, yet fresh";
  EXPECT_FALSE(ada.hear(at(1), bert.address, first));
  EXPECT_FALSE(ada.hear(at(1), bert.address, second));
  EXPECT_FALSE(ada.hear(at(1), bert.address, before)) << "older than the response";
  EXPECT_EQ(ada.rejected(Rejected::kRepeated), 3u);
}

// A whole conversation, recorded and played to a robot that was restarted since.
TEST(Sessions, ARecordedConversationConvincesNobody) {
  TestRobot bert("bert", 2, 2);
  std::vector<Datagram> recorded;
  {
    TestRobot ada("ada", 1, 1);
    recorded.push_back(bert.hello());
    ada.hear(at(0), bert.address, recorded.back());
    bert.hear(at(0), ada.address, ada.answers().at(0).second);
    recorded.push_back(bert.answers().at(0).second);
    ada.hear(at(0), bert.address, recorded.back());
    ASSERT_GE(ada.sessions.find_peer(bert.sessions.own().robot), 0);
    recorded.push_back(bert.hello());
  }
  TestRobot ada("ada", 3, 1);
  for (const Datagram& datagram : recorded) {
    EXPECT_FALSE(ada.hear(at(1), bert.address, datagram));
  }
  EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot), -1);
}

TEST(Sessions, AResponseHoldsForTenSecondsAtMost) {
  for (const double late_s : {0.0, 4.9, 10.0, 15.0}) {
    TestRobot ada("ada", 1, 1);
    TestRobot bert("bert", 2, 2);
    ada.hear(at(0), bert.address, bert.hello());
    bert.hear(at(0), ada.address, ada.answers().at(0).second);
    ada.hear(at(late_s), bert.address, bert.answers().at(0).second);
    EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot) >= 0, late_s < 10.0) << late_s;
  }
}

TEST(Sessions, AnotherRobotsResponseIsNone) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  TestRobot carl("carl", 3, 3);
  ada.hear(at(0), bert.address, bert.hello());
  // Carl answers what bert was asked.
  carl.hear(at(0), ada.address, ada.answers().at(0).second);
  EXPECT_EQ(carl.answers().size(), 1u) << "a challenge for another one is a stranger's datagram";
  std::vector<std::uint8_t> stolen = {3, 32, 0};
  stolen.resize(35);
  ada.hear(at(0), carl.address, carl.say(stolen));
  EXPECT_EQ(ada.sessions.find_peer(carl.sessions.own().robot), -1);
  EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot), -1);
}

TEST(Sessions, AnswersAreFew) {
  TestRobot ada("ada", 1, 1);
  // The same robot again and again: once in two seconds.
  TestRobot bert("bert", 2, 2);
  std::size_t answers = 0;
  for (int i = 0; i < 1000; ++i) {
    ada.hear(at(i * 0.001), bert.address, bert.hello());
    answers += ada.answers().size();
  }
  EXPECT_EQ(answers, 1u);
  // Ever new ones at one address: a burst, then so many a second. At many addresses: likewise, all
  // together.
  for (const std::uint64_t addresses : {1, 200}) {
    answers = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
      TestRobot stranger("s" + std::to_string(i), 10 + i, 9);
      const auto number = static_cast<std::uint8_t>(20 + i % addresses);
      ada.hear(at(2.0 + static_cast<double>(addresses) + static_cast<double>(i) * 0.001),
               address_of(number), stranger.hello());
      answers += ada.answers().size();
    }
    const std::size_t burst =
        addresses == 1 ? std::size_t{AnswerBudget::kSourceBurst} : AnswerBudget::kMaxBurst;
    const int rate = addresses == 1 ? AnswerBudget::kPerSourceAndSecond : Handshake::kPerSecond;
    EXPECT_GE(answers, burst);
    EXPECT_LE(answers, burst + static_cast<std::size_t>(rate) + 1);
  }
  EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot), -1);
}

TEST(Sessions, ARobotThatBeganAnewTakesItsPlace) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  verify(ada, bert, at(0));
  ada.hear(at(1), bert.address, bert.hello());
  const int before = ada.sessions.find_peer(bert.sessions.own().robot);
  const Datagram under_way = bert.hello();
  ada.events();

  TestRobot again("bert", 3, 2);
  verify(ada, again, at(2));
  const int after = ada.sessions.find_peer(bert.sessions.own().robot);
  ASSERT_GE(after, 0);
  EXPECT_NE(after, before);
  EXPECT_FALSE(ada.sessions.session(before)->is_peer());
  const auto events = ada.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, LinkEventKind::kRestarted);
  EXPECT_EQ(events[0].name.view(), "bert");
  // The last words of the old one are no conflict ...
  EXPECT_FALSE(ada.hear(at(4.9), bert.address, under_way));
  EXPECT_EQ(ada.events().size(), 0u);
  // ... but an old one that goes on talking is: two robots have one name.
  EXPECT_FALSE(ada.hear(at(30), bert.address, bert.hello()));
  EXPECT_FALSE(ada.hear(at(31), bert.address, bert.hello()));
  const auto conflict = ada.events();
  ASSERT_EQ(conflict.size(), 1u);
  EXPECT_EQ(conflict[0].kind, LinkEventKind::kNameConflict);
  EXPECT_EQ(ada.rejected(Rejected::kNameTaken), 3u);
}

TEST(Sessions, ANamesakeIsToldOnceAndNotHeard) {
  TestRobot ada("ada", 1, 1);
  TestRobot other("ada", 2, 2);
  verify(ada, other, at(0));
  EXPECT_FALSE(ada.hear(at(1), other.address, other.hello()));
  EXPECT_FALSE(ada.hear(at(5), other.address, other.hello()));
  EXPECT_FALSE(ada.hear(at(6), other.address, other.hello()));
  const auto events = ada.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, LinkEventKind::kNameConflict);
  EXPECT_EQ(events[0].name.view(), "ada");
  EXPECT_EQ(events[0].address, other.address);
  EXPECT_EQ(ada.sessions.find_peer(other.sessions.own().robot), -1);
}

TEST(Sessions, OtherVersionsAreToldOnceAndNotAnswered) {
  TestRobot ada("ada", 1, 1);
  FrameHeader header;
  header.version = 3;
  header.version_min = 3;
  header.version_max = 4;
  header.key_hint = key_hint(key_of(1));
  header.sender = {robot_id("newer"), 77};
  const SecretKey key = sender_key(key_of(1), header.sender);
  for (header.counter = 1; header.counter <= 5; ++header.counter) {
    Datagram datagram(kMaxDatagramBytes);
    datagram.resize(seal(key, header, std::vector<std::uint8_t>(100), datagram));
    EXPECT_FALSE(ada.hear(at(0), address_of(9), datagram));
  }
  EXPECT_EQ(ada.rejected(Rejected::kOtherVersion), 5u);
  EXPECT_EQ(ada.answers().size(), 0u);
  const auto events = ada.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, LinkEventKind::kOtherVersion);
  EXPECT_EQ(events[0].value, 3);
  // A version that somebody without the key only claims is a forgery.
  Datagram forged(kMaxDatagramBytes);
  forged.resize(seal(key_of(5), header, std::vector<std::uint8_t>(100), forged));
  EXPECT_FALSE(ada.hear(at(0), address_of(9), forged));
  EXPECT_EQ(ada.rejected(Rejected::kForged), 1u);
}

// A robot of version 1 shows its plain number, and its recorded boots, played again and again, fill
// no log; it is told all the same.
TEST(Sessions, OlderVersionsAreToldHoweverManyBootsAreRepeated) {
  TestRobot ada("ada", 1, 1);
  std::vector<Datagram> recorded;
  for (std::uint64_t boot = 1; boot <= 100; ++boot) {
    FrameHeader header;
    header.version = header.version_min = header.version_max = 1;
    header.key_hint = key_hint(key_of(1));
    header.sender = {robot_id("older"), 500 + boot};
    header.counter = 1;
    recorded.emplace_back(kMaxDatagramBytes);
    recorded.back().resize(seal(sender_key(key_of(1), header.sender), header,
                                std::vector<std::uint8_t>(100), recorded.back()));
  }
  std::size_t told = 0;
  for (int i = 0; i < 6000; ++i) {
    EXPECT_FALSE(
        ada.hear(at(0.01 * i), address_of(9), recorded[static_cast<std::size_t>(i) % 100]));
    for (const LinkEvent& event : ada.events()) {
      EXPECT_EQ(event.kind, LinkEventKind::kOtherVersion);
      EXPECT_EQ(event.value, 1);
      ++told;
    }
  }
  EXPECT_GE(told, 1u);
  EXPECT_LE(told, 13u) << "in a minute";
  EXPECT_EQ(ada.rejected(Rejected::kOtherVersion), 6000u);
}

TEST(Sessions, OtherFleetsAreNotHeard) {
  TestRobot ada("ada", 1, 1);
  TestRobot stranger(session_settings("zoe", 5, 2), 5);
  EXPECT_FALSE(ada.hear(at(0), stranger.address, stranger.hello()));
  EXPECT_EQ(ada.rejected(Rejected::kOtherKey), 1u);
  EXPECT_EQ(ada.answers().size(), 0u);
}

// Bert still has the old key only, ada both: ada hears bert. When bert has the new one too, both
// hear each other.
TEST(Sessions, TwoKeysHoldWhileTheyChange) {
  SessionSettings settings = session_settings("ada", 1, 2);
  settings.keys.previous = key_of(1);
  settings.keys.has_previous = true;
  TestRobot ada(settings, 1);
  TestRobot bert(session_settings("bert", 2, 1), 2);
  EXPECT_FALSE(ada.hear(at(0), bert.address, bert.hello()));
  const auto challenge = ada.answers();
  ASSERT_EQ(challenge.size(), 1u);
  EXPECT_FALSE(bert.hear(at(0), ada.address, challenge[0].second));
  EXPECT_EQ(bert.rejected(Rejected::kOtherKey), 1u);

  TestRobot carl(session_settings("carl", 3, 2), 3);
  verify(ada, carl, at(1));
  verify(carl, ada, at(1));
  EXPECT_TRUE(ada.hear(at(2), carl.address, carl.hello()));
  EXPECT_TRUE(carl.hear(at(2), ada.address, ada.hello()));
  settings.keys.previous = key_of(3);
  settings.keys.current = key_of(1);
  settings.name.assign("dora");
  settings.boot = 9;
  TestRobot dora(settings, 4);  // seals with what is ada's previous key
  verify(ada, dora, at(3));
  EXPECT_EQ(ada.sessions.find_peer(dora.sessions.own().robot), -1) << "dora cannot read ada's";
}

// Two robots that run get a new key: first both learn it, then both use it, then the old one ends.
TEST(Sessions, KeysChangeWhileTheyRun) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  verify(ada, bert, at(0));
  verify(bert, ada, at(0));
  const auto both_hear = [&](double s) {
    return ada.hear(at(s), bert.address, bert.hello()) &&
           bert.hear(at(s), ada.address, ada.hello());
  };
  ASSERT_TRUE(both_hear(1));
  const FleetKeys learn = {key_of(1), key_of(2), true};
  const FleetKeys use = {key_of(2), key_of(1), true};
  const FleetKeys end = {key_of(2), {}, false};
  double s = 2;
  for (const FleetKeys& keys : {learn, use, end}) {
    for (TestRobot* robot : {&ada, &bert}) {
      robot->sessions.set_keys(keys);
      EXPECT_TRUE(both_hear(s += 1));
      EXPECT_TRUE(both_hear(s += 1));
    }
  }
  const FleetKeys other = {key_of(4), {}, false};  // all at once
  for (TestRobot* robot : {&ada, &bert}) robot->sessions.set_keys(other);
  EXPECT_TRUE(both_hear(s += 1));
  EXPECT_EQ(ada.sessions.counters().verified, 1u) << "not challenged anew";
  EXPECT_EQ(ada.all_rejected(), 1u) << "the first HELLO alone";
  // Whoever has the old key alone is a stranger now.
  TestRobot carl("carl", 3, 3);
  EXPECT_FALSE(ada.hear(at(s), carl.address, carl.hello()));
  EXPECT_EQ(ada.rejected(Rejected::kOtherKey), 1u);
  // What was sealed before and comes late, or again, counts as what it is.
  TestRobot dora("dora", 4, 4);
  const Datagram old = dora.hello();
  dora.sessions.set_keys(other);
  verify(ada, dora, at(s));
  EXPECT_FALSE(ada.hear(at(s), dora.address, old));
  EXPECT_EQ(ada.rejected(Rejected::kOtherKey), 2u);
}

// Who has only the old one of two keys cannot speak as if it had the new one.
TEST(Sessions, AHintOfAnotherKeyThanTheOneThatSealsIsAForgery) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  verify(ada, bert, at(0));
  const FleetKeys both = {key_of(2), key_of(1), true};
  ada.sessions.set_keys(both);
  ASSERT_TRUE(ada.hear(at(1), bert.address, bert.hello()));
  EXPECT_EQ(ada.fresh.key, key_hint(key_of(1)));
  FrameHeader header;
  header.key_hint = key_hint(key_of(2));
  header.sender = masked(key_of(1), bert.sessions.own());
  header.counter = 1000;
  Datagram datagram(kMaxDatagramBytes);
  datagram.resize(seal(sender_key(key_of(1), header.sender), header,
                       std::vector<std::uint8_t>{99, 0, 0}, datagram));
  EXPECT_FALSE(ada.hear(at(2), bert.address, datagram));
  EXPECT_EQ(ada.rejected(Rejected::kForged), 1u);
  EXPECT_TRUE(ada.hear(at(3), bert.address, bert.hello()));
}

// Somebody without the key who listens, and tries as many names as he likes: he finds none, and
// does not see either that two starts are of one robot.
TEST(Sessions, NamesCannotBeGuessedFromWhatIsSaid) {
  std::set<std::string> heard;
  for (std::uint64_t boot = 1; boot <= 20; ++boot) {
    TestRobot robot("robot-7", boot, 1);
    const Datagram hello = robot.hello();
    heard.emplace(hello.begin() + 8, hello.begin() + 16);
  }
  EXPECT_EQ(heard.size(), 20u) << "two starts look alike";
  for (int i = 0; i < 1000; ++i) {
    std::uint64_t guess = robot_id("robot-" + std::to_string(i));
    std::string bytes;
    for (int k = 0; k < 8; ++k, guess >>= 8u) bytes.push_back(static_cast<char>(guess & 0xFFu));
    EXPECT_EQ(heard.count(bytes), 0u) << i;
  }
}

TEST(Sessions, OwnDatagramsComeBackFromTheGroup) {
  TestRobot ada("ada", 1, 1);
  EXPECT_FALSE(ada.hear(at(0), ada.address, ada.hello()));
  EXPECT_EQ(ada.rejected(Rejected::kEcho), 1u);
  EXPECT_EQ(ada.answers().size(), 0u);
}

TEST(Sessions, ByeEndsAndNothingOfItIsFreshAgain) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  verify(ada, bert, at(0));
  ada.hear(at(1), bert.address, bert.hello());
  const auto changes = ada.sessions.changes();
  const Datagram bye = bert.bye();
  EXPECT_TRUE(ada.hear(at(2), bert.address, bye));
  EXPECT_EQ(ada.sessions.find_peer(bert.sessions.own().robot), -1);
  EXPECT_GT(ada.sessions.changes(), changes);
  EXPECT_EQ(ada.events().back().kind, LinkEventKind::kLeft);
  EXPECT_FALSE(ada.hear(at(3), bert.address, bye));
  EXPECT_FALSE(ada.hear(at(3), bert.address, bert.hello()));
  EXPECT_EQ(ada.events().size(), 0u);
}

TEST(Sessions, TheSilentAreNoPeersUntilTheyAreHeardAgain) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  const std::uint64_t robot = bert.sessions.own().robot;
  verify(ada, bert, at(0));
  const Datagram first = bert.hello();
  ada.hear(at(1), bert.address, first);
  ada.events();
  ada.sessions.forget_silent(at(60));
  EXPECT_GE(ada.sessions.find_peer(robot), 0);
  ada.sessions.forget_silent(at(61.1));
  ada.sessions.forget_silent(at(62.1));
  EXPECT_EQ(ada.sessions.find_peer(robot), -1);
  const auto silent = ada.events();
  ASSERT_EQ(silent.size(), 1u);
  EXPECT_EQ(silent[0].kind, LinkEventKind::kSilent);
  // What it said before is not fresh again, however long ago that was.
  EXPECT_FALSE(ada.hear(at(5000), address_of(66), first));
  EXPECT_EQ(ada.rejected(Rejected::kRepeated), 1u);
  EXPECT_EQ(ada.sessions.find_peer(robot), -1);
  const std::uint64_t changes = ada.sessions.changes();
  EXPECT_TRUE(ada.hear(at(5000), bert.address, bert.hello()));
  EXPECT_GE(ada.sessions.find_peer(robot), 0);
  EXPECT_NE(ada.sessions.changes(), changes);
  EXPECT_EQ(ada.sessions.counters().verified, 1u);
  const auto back = ada.events();
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].kind, LinkEventKind::kFound);
  // Silent again, it begins anew: the new boot takes the old one's place, which is then forgotten.
  ada.sessions.forget_silent(at(5100));
  TestRobot again("bert", 9, 2);
  verify(ada, again, at(5110));
  EXPECT_EQ(ada.sessions.session(ada.sessions.find_peer(robot))->id.boot, 9u);
  EXPECT_FALSE(ada.hear(at(5111), bert.address, bert.hello()));
  EXPECT_EQ(ada.rejected(Rejected::kNameTaken), 1u);
  ada.hear(at(5160), again.address, again.hello());
  ada.sessions.forget_silent(at(5175));
  int used = 0;
  for (int i = 0; i < kMaxSessions; ++i) used += ada.sessions.session(i) != nullptr ? 1 : 0;
  EXPECT_EQ(used, 1);
}

TEST(Sessions, ANameOfAnotherRobotIsAFault) {
  TestRobot ada("ada", 1, 1);
  TestRobot bert("bert", 2, 2);
  std::vector<std::uint8_t> lie = {1, 5, 0, 4, 'c', 'a', 'r', 'l', 99, 32, 0};
  lie.resize(lie.size() + 32);
  EXPECT_FALSE(ada.hear(at(0), bert.address, bert.say(lie)));
  EXPECT_EQ(ada.rejected(Rejected::kMalformed), 1u);
  EXPECT_EQ(ada.answers().size(), 0u);
}

}  // namespace
}  // namespace zenith
