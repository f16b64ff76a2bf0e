#include "platform/daemon/cooperation.h"

#include <deque>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

class FakeLink : public PeerLink {
 public:
  void send(std::span<const LandmarkRecord> records) override {
    sent.insert(sent.end(), records.begin(), records.end());
  }
  void send_merge(const MergeNews& merge) override { merges.push_back(merge); }
  bool receive(PeerRecord& out) override {
    if (incoming.empty()) return false;
    out = incoming.front();
    incoming.pop_front();
    return true;
  }
  bool receive_merge(MergeNews&) override { return false; }

  std::vector<LandmarkRecord> sent;
  std::vector<MergeNews> merges;
  std::deque<PeerRecord> incoming;
};

LandmarkRecord record(std::uint32_t id) {
  LandmarkRecord r;
  r.id = id;
  return r;
}

TEST(Cooperation, SendsAllOwnNewsInOrder) {
  const auto exchange = std::make_unique<Exchange>();
  FakeLink link;
  Cooperation cooperation(*exchange, &link);
  for (std::uint32_t i = 0; i < 200; ++i) exchange->own.push(record(i));
  exchange->own_merges.push({3, {1.0, 2.0, 0.5}});
  cooperation.turn_once();
  ASSERT_EQ(link.sent.size(), 200u);
  for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQ(link.sent[i].id, i);
  ASSERT_EQ(link.merges.size(), 1u);
  EXPECT_EQ(link.merges[0].peer, 3);
  EXPECT_EQ(cooperation.counters().sent, 200u);
  EXPECT_EQ(cooperation.counters().unheard, 0u);
}

TEST(Cooperation, LosesNothingThatPerceptionHasNoRoomFor) {
  const auto exchange = std::make_unique<Exchange>();
  FakeLink link;
  Cooperation cooperation(*exchange, &link);
  constexpr std::uint32_t kMany = Exchange::kRecords + 100;
  for (std::uint32_t i = 0; i < kMany; ++i) link.incoming.push_back({1, record(i)});
  cooperation.turn_once();
  EXPECT_EQ(exchange->peers.size(), Exchange::kRecords);
  std::uint32_t expected = 0;
  PeerRecord got;
  while (expected < kMany && exchange->peers.pop(got)) {
    EXPECT_EQ(got.record.id, expected++);
    cooperation.turn_once();
  }
  EXPECT_EQ(expected, kMany);
  EXPECT_EQ(cooperation.counters().received, kMany);
}

TEST(Cooperation, AloneItCountsWhatNobodyHears) {
  const auto exchange = std::make_unique<Exchange>();
  Cooperation cooperation(*exchange, nullptr);
  exchange->own.push(record(1));
  exchange->own_merges.push({});
  cooperation.turn_once();
  EXPECT_EQ(exchange->own.size(), 0u);
  EXPECT_EQ(cooperation.counters().unheard, 1u);
  EXPECT_FALSE(cooperation.has_link());
}

}  // namespace
}  // namespace zenith
