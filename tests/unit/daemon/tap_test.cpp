#include "platform/daemon/tap/tap.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/memory/heap_guard.h"

namespace zenith::tap {
namespace {

constexpr int kWidth = 6;
constexpr int kHeight = 4;

// A frame whose every pixel says which frame it is; its rows have gaps, as a driver's may.
struct NumberedFrame {
  explicit NumberedFrame(int number) {
    pixels.assign(static_cast<std::size_t>(kStride * kHeight), 255);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        pixels[static_cast<std::size_t>(v * kStride + u)] = static_cast<std::uint8_t>(number);
      }
    }
    frame.stamp = {number};
    frame.sequence = static_cast<std::uint64_t>(number);
    frame.luma = {pixels.data(), kWidth, kHeight, kStride};
  }
  static constexpr int kStride = kWidth + 3;
  std::vector<std::uint8_t> pixels;
  CameraFrame frame;
};

void add(Tap& tap, int number) {
  tap.add(NumberedFrame(number).frame);
}

CanFrame can_frame(int number) {
  CanFrame frame;
  frame.stamp = {number};
  return frame;
}

TEST(Tap, CopiesFramesOnlyWhileSomebodyRecords) {
  Tap tap(kWidth, kHeight, 4);
  add(tap, 1);
  tap.add(can_frame(1));
  tap.add(TappedPose{});
  TappedFrame frame;
  CanFrame can;
  TappedPose pose;
  EXPECT_FALSE(tap.next(frame));
  EXPECT_FALSE(tap.next(can));
  EXPECT_FALSE(tap.next(pose));

  tap.start();
  add(tap, 2);
  ASSERT_TRUE(tap.next(frame));
  EXPECT_EQ(frame.head.stamp.ns, 2);
  EXPECT_EQ(frame.head.sequence, 2u);
  EXPECT_EQ(frame.head.width, kWidth);
  for (int i = 0; i < kWidth * kHeight; ++i) EXPECT_EQ(frame.pixels[i], 2) << i;
  tap.give_back(frame);
}

TEST(Tap, FramesWithoutASlotAreDroppedAndCounted) {
  Tap tap(kWidth, kHeight, 3);
  tap.start();
  for (int i = 0; i < 8; ++i) add(tap, i);
  EXPECT_EQ(tap.drops().frames, 5u);
  TappedFrame frame;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(tap.next(frame));
    EXPECT_EQ(frame.pixels[0], i) << "the oldest stay";
    // A slot that its reader holds is not overwritten.
    add(tap, 100 + i);
    EXPECT_EQ(frame.pixels[0], i);
    tap.give_back(frame);
  }
  EXPECT_EQ(tap.drops().frames, 6u) << "two more found a slot that had been given back";
  ASSERT_TRUE(tap.next(frame));
  EXPECT_EQ(frame.pixels[0], 101);
  for (int i = 0; i < 4096 + 7; ++i) tap.add(can_frame(i));
  for (int i = 0; i < 256 + 2; ++i) tap.add(TappedPose{});
  EXPECT_EQ(tap.drops().can, 7u);
  EXPECT_EQ(tap.drops().poses, 2u);
}

TEST(Tap, ANewRecordingBeginsEmptyAndCountsFromZero) {
  Tap tap(kWidth, kHeight, 2);
  tap.start();
  for (int i = 0; i < 5; ++i) add(tap, i);
  tap.add(can_frame(1));
  tap.stop();
  EXPECT_EQ(tap.drops().frames, 3u);
  tap.start();
  EXPECT_EQ(tap.drops().frames, 0u);
  TappedFrame frame;
  CanFrame can;
  EXPECT_FALSE(tap.next(can));
  add(tap, 7);
  add(tap, 8);
  EXPECT_EQ(tap.drops().frames, 0u) << "all slots are free again";
  ASSERT_TRUE(tap.next(frame));
  EXPECT_EQ(frame.pixels[0], 7);
}

TEST(Tap, IgnoresFramesOfAnotherSize) {
  Tap tap(kWidth + 1, kHeight, 2);
  tap.start();
  add(tap, 1);
  TappedFrame frame;
  EXPECT_FALSE(tap.next(frame));
}

TEST(Tap, GoesBetweenTwoThreadsWithoutTearingAndWithoutTheHeap) {
  constexpr int kFrames = 20'000;
  Tap tap(kWidth, kHeight, 8);
  tap.start();
  std::atomic<bool> done = false;
  std::uint64_t heap_calls = 0;
  std::vector<NumberedFrame> frames;
  for (int i = 0; i < 200; ++i) frames.emplace_back(i);
  for (NumberedFrame& f : frames) f.frame.luma.data = f.pixels.data();
  std::thread perception([&] {
    const HeapGuard guard;
    for (int i = 0; i < kFrames; ++i) {
      tap.add(frames[static_cast<std::size_t>(i % 200)].frame);
      tap.add(can_frame(i));
      tap.add(TappedPose{});
    }
    heap_calls = guard.calls();
    done = true;
  });
  std::uint64_t received = 0;
  TappedFrame frame;
  bool torn = false;
  for (bool last = false; !last;) {
    last = done;
    while (tap.next(frame)) {
      ++received;
      for (int i = 0; i < kWidth * kHeight; ++i) {
        torn = torn || frame.pixels[i] != static_cast<std::uint8_t>(frame.head.stamp.ns);
      }
      tap.give_back(frame);
    }
  }
  perception.join();
  EXPECT_FALSE(torn);
  EXPECT_GT(received, 0u);
  EXPECT_EQ(received + tap.drops().frames, static_cast<std::uint64_t>(kFrames));
  if (HeapGuard::works()) {
    EXPECT_EQ(heap_calls, 0u);
  }
}

}  // namespace
}  // namespace zenith::tap
