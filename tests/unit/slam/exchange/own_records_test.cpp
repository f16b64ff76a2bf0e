#include "slam/exchange/own_records.h"

#include <map>

#include <gtest/gtest.h>

#include "slam/exchange/checksum.h"
#include "tests/support/arena_block.h"

namespace zenith::exchange {
namespace {

using Queue = OwnRecords::Queue;

LandmarkRecord landmark(std::uint32_t id, float x_m = 1.0F) {
  LandmarkRecord r;
  r.id = id;
  r.x_m = x_m;
  r.covariance_m2 = {1e-4F, 0.0F, 0.0F, 1e-4F, 0.0F, 1e-4F};
  return r;
}

LandmarkRecord removal(std::uint32_t id) {
  LandmarkRecord r;
  r.id = id;
  r.removed = true;
  return r;
}

struct Rig {
  Rig() : memory([this](Arena& arena) { own.layout(arena); }) { own.clear(); }

  // Tells all that waits; returns ids by revision.
  std::map<std::uint32_t, std::uint32_t> tell(Time now = {}) {
    std::map<std::uint32_t, std::uint32_t> told;
    for (const Queue queue : {Queue::kNew, Queue::kChanged}) {
      while (own.waiting(queue) > 0) {
        std::array<std::uint8_t, kMaxPayload> room = {};
        ByteWriter out(room);
        RecordsWriter records(out, 1, own.head() + 1);
        own.tell_next(now, queue, records);
        records.finish(own.head());
        for (const auto& r : read(out)) told[r.revision] = r.id;
      }
    }
    return told;
  }
  std::vector<LandmarkRecord> told(Range range) {
    std::array<std::uint8_t, kMaxPayload> room = {};
    ByteWriter out(room);
    RecordsWriter records(out, 1, range.first);
    covered = own.write_told(range, records);
    records.finish(std::max(covered, range.first));
    return read(out);
  }
  static std::vector<LandmarkRecord> read(const ByteWriter& out) {
    RecordsReader reader(out.written().subspan(kSectionHeader));
    std::vector<LandmarkRecord> records;
    LandmarkRecord r;
    while (reader.next(r)) records.push_back(r);
    EXPECT_FALSE(reader.malformed());
    return records;
  }

  OwnRecords own;
  ArenaBlock memory;
  std::uint32_t covered = 0;
};

TEST(OwnRecords, RevisionsAreGivenWhenTold) {
  Rig rig;
  rig.own.set(landmark(10));
  rig.own.set(landmark(20));
  EXPECT_EQ(rig.own.head(), 0u);
  EXPECT_EQ(rig.own.waiting(Queue::kNew), 2u);
  EXPECT_EQ(rig.tell(), (std::map<std::uint32_t, std::uint32_t>{{1, 10}, {2, 20}}));
  EXPECT_EQ(rig.own.present(), 2u);
  EXPECT_EQ(rig.own.checksum(), mix(10, 1) + mix(20, 2));
  rig.own.set(landmark(10, 2.0F));
  rig.own.advance(Time{});
  EXPECT_EQ(rig.own.waiting(Queue::kChanged), 1u);
  EXPECT_EQ(rig.own.checksum(), mix(10, 1) + mix(20, 2)) << "not told yet";
  EXPECT_EQ(rig.tell(), (std::map<std::uint32_t, std::uint32_t>{{3, 10}}));
  EXPECT_EQ(rig.own.checksum(), mix(10, 3) + mix(20, 2));
}

TEST(OwnRecords, AChangeReplacesTheOneThatWaits) {
  Rig rig;
  for (int i = 0; i < 5; ++i) rig.own.set(landmark(10, static_cast<float>(i)));
  EXPECT_EQ(rig.own.waiting(Queue::kNew), 1u);
  EXPECT_EQ(rig.own.waiting_bytes(Queue::kNew), kRecordBytes);
  rig.tell();
  const auto told = rig.told({1, 1});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].x_m, 4.0F);
}

TEST(OwnRecords, WhatCameAndWentIsNeverTold) {
  Rig rig;
  rig.own.set(landmark(10));
  rig.own.set(landmark(11));
  rig.own.set(removal(10));
  rig.own.set(removal(99));
  EXPECT_EQ(rig.tell(), (std::map<std::uint32_t, std::uint32_t>{{1, 11}}));
}

TEST(OwnRecords, RemovalsAreToldAndStay) {
  Rig rig;
  rig.own.set(landmark(10));
  rig.tell();
  rig.own.set(removal(10));
  EXPECT_EQ(rig.own.present(), 1u);
  rig.own.advance(Time{} + Duration::from_seconds(10.0));
  rig.tell();
  EXPECT_EQ(rig.own.present(), 0u);
  EXPECT_EQ(rig.own.checksum(), 0u);
  const auto told = rig.told({1, 2});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].removed);
  EXPECT_EQ(told[0].revision, 2u);
}

TEST(OwnRecords, AskedForIsWhatWasToldNotWhatWaits) {
  Rig rig;
  rig.own.set(landmark(10, 1.0F));
  rig.tell();
  rig.own.set(landmark(10, 2.0F));
  const auto told = rig.told({1, 1});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].x_m, 1.0F);
}

TEST(OwnRecords, WritesAsMuchAsFits) {
  Rig rig;
  for (std::uint32_t id = 1; id <= 100; ++id) rig.own.set(landmark(id));
  rig.tell();
  const auto told = rig.told({5, 90});
  EXPECT_EQ(told.size(), (kMaxPayload - kRecordsHeader) / kRecordBytes);
  EXPECT_EQ(told.front().revision, 5u);
  EXPECT_EQ(rig.covered, told.back().revision);
}

TEST(OwnRecords, RestsAfterItWasTold) {
  Rig rig;
  rig.own.set_rest(Duration::from_seconds(5.0));
  const auto at = [](double s) { return Time{} + Duration::from_seconds(s); };
  rig.own.set(landmark(10));
  rig.tell(at(100.0));
  rig.own.set(landmark(10, 2.0F));
  rig.own.advance(at(104.9));
  EXPECT_EQ(rig.own.waiting(Queue::kChanged), 0u);
  rig.own.set(landmark(10, 3.0F));
  rig.own.advance(at(105.1));
  EXPECT_EQ(rig.own.waiting(Queue::kChanged), 1u);
  EXPECT_EQ(rig.own.waiting_bytes(Queue::kChanged), kRecordBytes);
  rig.tell(at(106.0));
  EXPECT_EQ(rig.told({2, 2}).at(0).x_m, 3.0F);
  rig.own.advance(at(120.0));
  EXPECT_EQ(rig.own.waiting(Queue::kChanged), 0u) << "there is nothing to tell";
}

TEST(OwnRecords, NobodyIsToldAtOnce) {
  Rig rig;
  rig.own.set_rest(Duration::from_seconds(5.0));
  rig.own.set(landmark(1));
  rig.tell();
  rig.own.set(landmark(1, 2.0F));  // rests
  rig.own.set(landmark(2));
  rig.own.set(landmark(3));
  rig.own.set(removal(3));
  rig.own.tell_nobody();
  EXPECT_EQ(rig.own.head(), 3u);
  EXPECT_EQ(rig.own.present(), 2u);
  EXPECT_EQ(rig.told({1, 3}).size(), 2u);
}

TEST(OwnRecords, FullForgetsTheOldestRemovalThenRefuses) {
  Rig rig;
  for (std::uint32_t id = 1; id <= kMaxOwnRecords; ++id) {
    ASSERT_EQ(rig.own.set(landmark(id)), OwnRecords::Outcome::kTaken);
  }
  EXPECT_EQ(rig.own.set(landmark(9000)), OwnRecords::Outcome::kFull);
  rig.own.tell_nobody();
  rig.own.set(removal(7));
  rig.own.set(removal(3));
  EXPECT_EQ(rig.own.set(landmark(9000)), OwnRecords::Outcome::kFull) << "they wait to be told";
  rig.own.tell_nobody();
  EXPECT_EQ(rig.own.set(landmark(9000)), OwnRecords::Outcome::kTaken);
  EXPECT_EQ(rig.own.forgotten(), 1u);
  const std::uint32_t head = rig.own.head();
  const auto told = rig.told({head - 1, head});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].id, 3u) << "7 was told before 3";
}

TEST(OwnRecords, TheLogOfRevisionsIsCompacted) {
  Rig rig;
  for (std::uint32_t round = 0; round < 5u * kMaxOwnRecords; ++round) {
    rig.own.set(landmark(1 + round % 3, static_cast<float>(round % 100)));
    rig.own.tell_nobody();
  }
  EXPECT_EQ(rig.own.head(), 5u * kMaxOwnRecords);
  EXPECT_EQ(rig.told({1, rig.own.head()}).size(), 3u);
}

TEST(OwnRecords, RefusesWhatCannotBeTold) {
  Rig rig;
  EXPECT_EQ(rig.own.set(landmark(1, 1e6F)), OwnRecords::Outcome::kUntellable);
}

}  // namespace
}  // namespace zenith::exchange
