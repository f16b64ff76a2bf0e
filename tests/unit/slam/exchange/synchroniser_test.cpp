#include "slam/exchange/synchroniser.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/slam/exchange/synchroniser_rig.h"

namespace zenith::exchange {
namespace {

using Rig = SynchroniserRig;

std::uint64_t checksum_of(Range revisions) {
  std::uint64_t sum = 0;
  for (std::uint32_t r = revisions.first; r <= revisions.last; ++r) sum += mix(r, r);
  return sum;
}

TEST(Synchroniser, TellsStateEverySecondAndItsNameEveryOther) {
  Rig rig;
  const auto sent = rig.run_until(110.0);
  EXPECT_NEAR(static_cast<double>(Rig::sections(sent, SectionType::kState).size()), 10.0, 1.0);
  EXPECT_NEAR(static_cast<double>(Rig::sections(sent, SectionType::kHello).size()), 5.0, 1.0);
  for (const auto& s : sent) EXPECT_EQ(s.to, kEverybody);
}

TEST(Synchroniser, AsksForGapsAndKnowsWhenItHasAll) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 3, {700});
  rig.hear(3, Payload().state(7, 10, 10, checksum_of({1, 10})).records(7, {1, 4}));
  rig.hear(3, Payload().records(7, {7, 8}));
  EXPECT_FALSE(rig.sync.peer(0).complete);
  auto requests = Rig::sections(rig.run_until(100.5), SectionType::kRequest);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].to, 3);
  Request request;
  ASSERT_TRUE(decode(requests[0].payload, request));
  EXPECT_EQ(request.robot, 700u);
  EXPECT_EQ(request.map, 7u);
  ASSERT_EQ(request.ranges.size(), 2u);
  EXPECT_EQ(request.ranges[0], (Range{5, 6}));
  EXPECT_EQ(request.ranges[1], (Range{9, 10}));
  requests = Rig::sections(rig.run_until(102.0), SectionType::kRequest);
  EXPECT_EQ(requests.size(), 1u) << "again, a second later";

  rig.hear(3, Payload().records(7, {5, 10}));
  rig.hear(3, Payload().state(7, 10, 10, checksum_of({1, 10})));
  EXPECT_TRUE(rig.sync.peer(0).complete);
  EXPECT_EQ(rig.sync.peer(0).landmarks, 10u);
  EXPECT_EQ(rig.sink.maps[0].size(), 10u);
  EXPECT_TRUE(Rig::sections(rig.run_until(110.0), SectionType::kRequest).empty());
}

TEST(Synchroniser, AsksSeveralOwnersWithOneDatagram) {
  Rig rig;
  for (const int session : {0, 1, 2}) {
    rig.sync.join(rig.at(rig.now_s), session, {700 + static_cast<std::uint64_t>(session)});
    rig.hear(session, Payload().state(7, 5, 5, 1));
  }
  std::set<int> to;
  for (const auto& r : Rig::sections(rig.run_until(100.5), SectionType::kRequest)) to.insert(r.to);
  EXPECT_TRUE(to.contains(kEverybody));
}

TEST(Synchroniser, ServesOneAloneAndSeveralAtOnce) {
  Rig rig;
  for (const int session : {0, 1}) {
    rig.sync.join(rig.at(rig.now_s), session, {700 + static_cast<std::uint64_t>(session)});
  }
  for (std::uint32_t id = 1; id <= 30; ++id) rig.sync.set_own(rig_landmark(id));
  rig.run_until(101.5);
  rig.hear(0, Payload().request(500, 5, {2, 5}));
  auto served = Rig::sections(rig.run_until(101.9), SectionType::kRecords);
  ASSERT_EQ(served.size(), 1u);
  EXPECT_EQ(served[0].to, 0);
  RecordsReader reader(served[0].payload);
  EXPECT_EQ(reader.header().range, (Range{2, 5}));
  EXPECT_EQ(reader.header().count, 4);

  rig.hear(0, Payload().request(500, 5, {1, 10}));
  rig.hear(1, Payload().request(500, 5, {1, kToHead}));
  served = Rig::sections(rig.run_until(102.5), SectionType::kRecords);
  ASSERT_FALSE(served.empty());
  EXPECT_EQ(served[0].to, kEverybody);
  std::size_t records = 0;
  for (const auto& s : served) records += RecordsReader(s.payload).header().count;
  EXPECT_LE(records, 40u);
  EXPECT_GE(records, 30u);

  rig.hear(0, Payload().request(500, 6, {1, 10}));
  rig.hear(0, Payload().request(501, 5, {1, 10}));
  rig.hear(0, Payload().request(500, 5, {31, 40}));
  EXPECT_TRUE(Rig::sections(rig.run_until(103.5), SectionType::kRecords).empty())
      << "another map, another robot, not told yet";
}

TEST(Synchroniser, NothingIsMarkedWhenTheSinkIsFull) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.sink.room_left = 2;
  EXPECT_EQ(rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})).records(7, {1, 5})),
            Verdict::kNoRoom);
  EXPECT_TRUE(rig.sink.maps[0].empty());
  const auto requests = Rig::sections(rig.run_until(140.0), SectionType::kRequest);
  EXPECT_GE(requests.size(), 1u);
  rig.sink.room_left = 100;
  EXPECT_EQ(rig.hear(0, Payload().records(7, {1, 5})), Verdict::kUsed);
  rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})));
  EXPECT_TRUE(rig.sync.peer(0).complete);
}

TEST(Synchroniser, ADifferentChecksumBringsAllOnceMore) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.hear(0, Payload().state(7, 5, 5, 0).records(7, {1, 5}));
  ASSERT_EQ(rig.sink.maps[0].size(), 5u);
  // The owner has 1 to 4 only: the removal of 5 is forgotten.
  const std::uint64_t checksum = checksum_of({1, 4});
  rig.hear(0, Payload().state(7, 6, 4, checksum));
  rig.hear(0, Payload().covered(7, {6, 6}));
  rig.hear(0, Payload().state(7, 6, 4, checksum));
  EXPECT_EQ(rig.sync.counters().checksum_differed, 1u);
  const auto requests = Rig::sections(rig.run_until(100.5), SectionType::kRequest);
  ASSERT_EQ(requests.size(), 1u);
  Request request;
  ASSERT_TRUE(decode(requests[0].payload, request));
  ASSERT_EQ(request.ranges.size(), 1u);
  EXPECT_EQ(request.ranges[0], (Range{1, 6}));
  EXPECT_EQ(rig.sink.maps[0].size(), 5u) << "until all is here again";
  rig.hear(0, Payload().records(7, {1, 4}));
  rig.hear(0, Payload().covered(7, {5, 6}));
  EXPECT_EQ(rig.sink.maps[0].size(), 4u);
  EXPECT_FALSE(rig.sink.maps[0].contains(5));
  rig.hear(0, Payload().state(7, 6, 4, checksum));
  EXPECT_TRUE(rig.sync.peer(0).complete);
}

// The owner told of 3 once more before it covered its old revision; this state is older than that.
TEST(Synchroniser, AStateThatRecordsOvertookIsNotCompared) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.counter = 10;
  rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})).records(7, {1, 2}));
  rig.hear(0, Payload().records(7, {4, 5}));
  rig.counter = 20;
  rig.hear(0, Payload().covered(7, {3, 3}));
  rig.counter = 15;
  rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})));
  EXPECT_EQ(rig.sync.counters().checksum_differed, 0u);
  rig.counter = 25;
  rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})));
  EXPECT_EQ(rig.sync.counters().checksum_differed, 1u);
}

// Of an empty map there is nothing to ask for, whatever its checksum.
TEST(Synchroniser, AnEmptyMapWithAChecksumIsAskedForNothing) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.hear(0, Payload().state(7, 0, 0, 99));
  EXPECT_TRUE(Rig::sections(rig.run_until(105.0), SectionType::kRequest).empty());
  EXPECT_FALSE(rig.sync.peer(0).complete);
}

TEST(Synchroniser, ALateRecordDoesNotBringBackARemovedLandmark) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  Payload late;
  late.records(7, {1, 1});
  rig.hear(0, Payload().state(7, 1, 1, checksum_of({1, 1})));
  Payload removal;
  LandmarkRecord r = rig_landmark(1);
  r.removed = true;
  EncodedRecord encoded;
  ASSERT_TRUE(encode_record(r, encoded));
  RecordsWriter writer(removal.out, 7, 2);
  writer.add(encoded, 2);
  writer.finish(2);
  rig.hear(0, removal);
  rig.hear(0, late);
  EXPECT_TRUE(rig.sink.maps[0].empty());
}

TEST(Synchroniser, ThreeFaultsAndNothingIsUsedForAMinute) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.hear(0, Payload().state(7, 5, 5, 0).records(7, {1, 5}));
  Payload malformed;
  malformed.out.u8(9);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(rig.hear(0, malformed), Verdict::kMalformed);
  EXPECT_TRUE(rig.sync.quarantined(rig.at(rig.now_s), 0));
  EXPECT_TRUE(rig.sink.maps[0].empty()) << "its map is withdrawn";
  EXPECT_EQ(rig.sync.slot_of(0), -1);
  EXPECT_EQ(rig.hear(0, Payload().state(7, 5, 5, 0)), Verdict::kQuarantined);
  rig.now_s += 61.0;
  EXPECT_EQ(rig.hear(0, Payload().state(7, 5, 5, 0).records(7, {1, 5})), Verdict::kUsed);
  EXPECT_EQ(rig.sink.maps[0].size(), 5u);
}

TEST(Synchroniser, NoticesContradictions) {
  const auto verdict = [](auto first, auto second) {
    Rig rig;
    rig.sync.join(rig.at(rig.now_s), 0, {700});
    EXPECT_EQ(rig.hear(0, first), Verdict::kUsed);
    return rig.hear(0, second);
  };
  const Payload start = Payload().state(7, 5, 5, 0).records(7, {1, 5});
  EXPECT_EQ(verdict(start, Payload().state(7, 4, 4, 0)), Verdict::kInconsistent) << "head sank";
  EXPECT_EQ(verdict(Payload().state(7, 5, 5, 0).records(7, {1, 9}), Payload().state(7, 8, 8, 0)),
            Verdict::kInconsistent)
      << "records above the head";
  EXPECT_EQ(verdict(start, Payload().records(7, {6, 10}, static_cast<std::uint32_t>(-5), 90.0F)),
            Verdict::kInconsistent)
      << "landmarks jump";
  EXPECT_EQ(verdict(start, Payload().records(7, {6, 10}, static_cast<std::uint32_t>(-5), 3.0F)),
            Verdict::kUsed);
  EXPECT_EQ(verdict(start, Payload().state(8, 0, 0, 0)), Verdict::kInconsistent)
      << "a new map at once";
}

TEST(Synchroniser, AnOlderStateIsPassedOver) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  const Payload old = Payload().state(7, 3, 3, 0);
  rig.counter = 10;
  rig.hear(0, Payload().state(7, 5, 5, 0));
  rig.counter = 4;
  EXPECT_EQ(rig.hear(0, old), Verdict::kUsed);
  EXPECT_EQ(rig.sync.peer(0).state.head, 5u);
  rig.counter = 5;
  EXPECT_EQ(rig.hear(0, Payload().records(7, {6, 6})), Verdict::kInconsistent)
      << "sent before a state whose head is lower";
}

TEST(Synchroniser, MoreThanOneRobotMaySendIsAFault) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  const Payload big = Payload().state(7, 60, 60, 0).records(7, {1, 45});
  Verdict last = Verdict::kUsed;
  for (int i = 0; i < 1000 && last == Verdict::kUsed; ++i) last = rig.hear(0, big);
  EXPECT_EQ(last, Verdict::kTooMuch);
}

TEST(Synchroniser, MoreLandmarksThanOneRobotMayHaveIsAFault) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.hear(0, Payload().state(7, 1, 1, 0));
  Verdict last = Verdict::kUsed;
  std::uint32_t first = 1;
  for (; last == Verdict::kUsed; first += 40) {
    rig.now_s += 0.1;
    last = rig.hear(0, Payload().records(7, {first, first + 39}));
  }
  EXPECT_EQ(last, Verdict::kTooMuch);
  EXPECT_GT(first, static_cast<std::uint32_t>(kMaxRecordsOfPeer));
  EXPECT_LE(rig.sync.peer(0).landmarks, static_cast<std::uint32_t>(kMaxRecordsOfPeer));
}

TEST(Synchroniser, OldMapsGiveWayUnmergedOnesFirst) {
  Settings settings;
  settings.slots = 3;
  Rig rig(settings);
  const auto begin = [&](std::uint32_t map) {
    rig.now_s += 20.0;
    return rig.hear(0, Payload().state(map, 1, 1, 0).records(map, {1, 1}));
  };
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  EXPECT_EQ(begin(1), Verdict::kUsed);
  OwnAlignment merged;
  merged.slot = rig.sync.slot_of(0);
  merged.state = AlignmentNotice::State::kMerged;
  rig.sync.set_state({}, Health::kMerged, std::span(&merged, 1));
  for (const std::uint32_t map : {2u, 3u, 4u, 5u}) EXPECT_EQ(begin(map), Verdict::kUsed);
  std::set<std::uint32_t> maps;
  for (int slot = 0; slot < 3; ++slot) maps.insert(rig.sync.peer(slot).map);
  EXPECT_EQ(maps, (std::set<std::uint32_t>{1, 4, 5}));

  for (const int session : {1, 2}) {
    rig.sync.join(rig.at(rig.now_s), session, {700 + static_cast<std::uint64_t>(session)});
    EXPECT_EQ(rig.hear(session, Payload().state(9, 0, 0, 0)), Verdict::kUsed);
  }
  rig.sync.join(rig.at(rig.now_s), 3, {703});
  EXPECT_EQ(rig.hear(3, Payload().state(9, 0, 0, 0)), Verdict::kNoRoom);
  EXPECT_EQ(rig.sync.slot_of(3), -1);
  EXPECT_EQ(rig.sync.counters().slots_refused, 1u);
}

TEST(Synchroniser, WhoComesBackWithItsMapNeedsOnlyWhatIsNew) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  rig.hear(0, Payload().state(7, 5, 5, checksum_of({1, 5})).records(7, {1, 5}));
  rig.sync.leave(rig.at(rig.now_s), 0);
  EXPECT_EQ(rig.sync.peer(0).session, -1);
  EXPECT_EQ(rig.sink.maps[0].size(), 5u);
  rig.sync.join(rig.at(rig.now_s), 8, {700});
  rig.hear(8, Payload().state(7, 6, 6, checksum_of({1, 6})));
  EXPECT_EQ(rig.sync.slot_of(8), 0);
  const auto requests = Rig::sections(rig.run_until(100.5), SectionType::kRequest);
  ASSERT_EQ(requests.size(), 1u);
  Request request;
  ASSERT_TRUE(decode(requests[0].payload, request));
  EXPECT_EQ(request.ranges[0], (Range{6, 6}));
}

TEST(Synchroniser, AlignmentsTakeTurnsAndAreHeard) {
  Rig rig;
  std::vector<OwnAlignment> own;
  for (int session = 0; session < 12; ++session) {
    rig.sync.join(rig.at(rig.now_s), session, {700 + static_cast<std::uint64_t>(session)});
    rig.hear(session, Payload().state(7, 0, 0, 0));
    own.emplace_back();
    own.back().slot = rig.sync.slot_of(session);
  }
  rig.sync.set_state({1.0, 2.0, 3.0}, Health::kMapping, own);
  std::set<std::uint64_t> told;
  for (const auto& body : Rig::sections(rig.run_until(103.0), SectionType::kState)) {
    StateNotice state;
    ASSERT_TRUE(decode(body.payload, state));
    EXPECT_LE(state.alignments.size(), 8u);
    for (const AlignmentNotice& a : state.alignments) told.insert(a.robot);
  }
  EXPECT_EQ(told.size(), 12u);

  Payload about_us;
  StateNotice state;
  state.map = 7;
  AlignmentNotice notice;
  notice.robot = 500;
  notice.map = 5;
  notice.T_own_peer = {4.0, 5.0, 0.0};
  state.alignments.push_back(notice);
  append(about_us.out, state);
  rig.hear(2, about_us);
  const PeerStatus& peer = rig.sync.peer(rig.sync.slot_of(2));
  EXPECT_TRUE(peer.about_us_heard);
  EXPECT_EQ(peer.about_us.T_own_peer.x_m, 4.0);
  rig.sync.reset_own(6);
  EXPECT_FALSE(peer.about_us_heard) << "it was about another map";
}

// Numbers of sessions and slots come from other parts of the program: none reaches beyond a table.
TEST(Synchroniser, SessionsAndSlotsThatCannotBeAreLeftOut) {
  Rig rig;
  for (const int session : {-1, kMaxSessions, 2'000'000'000, 3}) {
    EXPECT_EQ(rig.hear(session, Payload().state(7, 1, 1, 1)), Verdict::kQuarantined) << session;
  }
  EXPECT_EQ(rig.sync.counters().quarantined, 4u);
  EXPECT_FALSE(rig.sync.peer(0).used);
  rig.sync.fault(rig.at(rig.now_s), 3, rig.sink);
  std::vector<OwnAlignment> own(3);
  own[0].slot = -1;
  own[1].slot = kMaxReplicas;
  own[2].slot = -2'000'000'000;
  rig.sync.set_state({1.0, 2.0, 3.0}, Health::kMapping, own);
  for (const auto& body : Rig::sections(rig.run_until(103.0), SectionType::kState)) {
    StateNotice state;
    ASSERT_TRUE(decode(body.payload, state));
    EXPECT_EQ(state.alignments.size(), 0u);
  }
}

TEST(Synchroniser, ByeIsTheLast) {
  Rig rig;
  rig.run_until(100.5);
  rig.sync.say_bye();
  const auto sent = rig.run_until(105.0);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(Rig::sections(sent, SectionType::kBye).size(), 1u);
}

// A list of addresses instead of multicast: all copies count.
TEST(Synchroniser, CopiesToEverybodyKeepTheCap) {
  Settings settings;
  settings.max_rate = 60'000;
  Rig rig(settings);
  rig.sync.set_copies_to_everybody(40);
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  for (std::uint32_t id = 1; id <= 500; ++id) rig.sync.set_own(rig_landmark(id));
  std::vector<std::pair<double, std::size_t>> sent;
  std::size_t records = 0;
  for (; rig.now_s < 130.0; rig.now_s += 0.01) {
    for (const auto& s : rig.send()) {
      sent.emplace_back(rig.now_s, (s.payload.size() + kFrameBytes + kIpv4UdpBytes) *
                                       (s.to == kEverybody ? 40 : 1));
      for (const auto& r : Rig::sections({s}, SectionType::kRecords)) {
        records += RecordsReader(r.payload).header().count;
      }
    }
  }
  EXPECT_EQ(records, 500u);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    std::size_t second = 0;
    for (std::size_t k = i; k < sent.size() && sent[k].first < sent[i].first + 1.0; ++k) {
      second += sent[k].second;
    }
    ASSERT_LE(second, 60'000u);
  }
}

TEST(Synchroniser, OwnDatagramsOfTheCallerCountToo) {
  Settings settings;
  settings.max_rate = 10'000;
  Rig rig(settings);
  int spent = 0;
  while (rig.sync.spend(rig.at(rig.now_s), 20)) ++spent;
  EXPECT_GT(spent, 3);
  EXPECT_LE(spent, 60);
  EXPECT_TRUE(rig.send().empty()) << "nothing is left for the state";
  EXPECT_GT(rig.sync.next_time(rig.at(rig.now_s)), rig.at(rig.now_s));
}

TEST(Synchroniser, SaysWhenItHasSomething) {
  Rig rig;
  rig.sync.join(rig.at(rig.now_s), 0, {700});
  for (std::uint32_t id = 1; id <= 3000; ++id) rig.sync.set_own(rig_landmark(id));
  rig.hear(0, Payload().state(7, 50, 50, 0));
  Time now = rig.at(rig.now_s);
  std::uint64_t news = 0;
  int idle = 0;
  while (now < rig.at(110.0)) {
    rig.now_s = static_cast<double>(now.ns) * 1e-9;
    std::vector<std::uint8_t> room(kMaxPayload);
    bool any = false;
    while (rig.sync.next(now, room).size > 0) any = true;
    if (!any) ++idle;
    const Time next = rig.sync.next_time(now);
    ASSERT_GT(next, now) << "nothing was left to send";
    ASSERT_LE(next, now + Duration::from_seconds(1.1));
    now = next;
  }
  news = rig.sync.counters().news_sent;
  EXPECT_EQ(news, 3000u);
  EXPECT_LE(idle, 3) << "it promised and did not send";
}

}  // namespace
}  // namespace zenith::exchange
