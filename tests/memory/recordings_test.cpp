// Whole simulated drives under the guard: what a robot does with a frame, with its map and with its
// peers' datagrams uses no heap.

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "platform/link/peer_exchange.h"
#include "slam/slam.h"
#include "tests/memory/eigen_no_malloc.h"
#include "tests/memory/heap_guard.h"
#include "tests/support/figure.h"
#include "tests/support/link_rig.h"
#include "tools/runner/simulated_source.h"

namespace zenith {
namespace {

// Both: Eigen's is told apart in the message.
struct Forbidden {
  explicit Forbidden(const char* in) : heap(in) {}
  EigenNoMalloc eigen;
  NoAllocation heap;
};

// A robot as the daemon is, in one thread and without a clock of its own.
class GuardedRobot final : private exchange::RecordSink {
 public:
  GuardedRobot(Source& source, std::uint8_t number)
      : source_(source),
        memory_(Slam::memory_needed({})),
        slam_(source.config(), {}, number, memory_.span()),
        link_(settings(source.name(), number)),
        address_(address_of(number)) {}

  // False at the end. The source may use the heap: it is no part of the robot.
  bool load() {
    const auto more = source_.next(frame_);
    return more.ok() && *more;
  }
  Time stamp() const { return frame_.stamp; }

  void step() {
    const Lens& lens = source_.config().lens;
    const StepInput input = {frame_.stamp,
                             {frame_.pixels.data(), lens.width_px, lens.height_px, lens.width_px},
                             frame_.wheels};
    const Forbidden guard("Slam::step");
    slam_.step(input);
    ++steps_;
  }

  // What it has to tell, over the sealed link, until nothing is due.
  void talk(GuardedRobot& peer) {
    const Forbidden guard("the exchange");
    std::size_t count = 0;
    while ((count = slam_.publish(records_)) > 0) {
      for (std::size_t i = 0; i < count; ++i) link_.synchroniser().set_own(records_[i]);
    }
    tell_state();
    for (Dispatch d = link_.next(stamp(), datagram_); d.size > 0;
         d = link_.next(stamp(), datagram_)) {
      peer.link_.receive(stamp(), address_, std::span(datagram_).first(d.size), peer);
    }
    take_offers();
  }

  int steps() const { return steps_; }
  std::size_t landmarks() {
    estimates_.resize(kMaxLandmarks);
    return slam_.landmarks(estimates_);
  }
  bool merged() const {
    return !slam_.alignments().empty() && slam_.alignments()[0].state == AlignmentState::kMerged;
  }
  double confidence() const {
    return slam_.alignments().empty() ? 0.0 : slam_.alignments()[0].confidence;
  }

 private:
  static PeerExchangeSettings settings(const std::string& name, std::uint8_t number) {
    PeerExchangeSettings s;
    s.sessions = session_settings(name, number);
    s.synchroniser.map = number;
    s.synchroniser.seed = number;
    return s;
  }

  std::size_t room(int) override { return 1000; }
  void take(int slot, const LandmarkRecord& record) override { slam_.receive(slot, {&record, 1}); }
  void forget(int slot) override { slam_.forget(slot); }

  void tell_state() {
    FixedVector<exchange::OwnAlignment, kMaxPeers> own;
    for (const Alignment& a : slam_.alignments()) {
      exchange::OwnAlignment told;
      told.slot = a.peer;
      if (a.state == AlignmentState::kMerged)
        told.state = exchange::AlignmentNotice::State::kMerged;
      told.T_own_peer = a.T_own_peer;
      told.confidence = a.confidence;
      told.correspondences = a.correspondences;
      own.push_back(told);
    }
    link_.synchroniser().set_state(slam_.output().T_start_robot, exchange::Health{}, own.span());
  }
  void take_offers() {
    for (int slot = 0; slot < kMaxPeers; ++slot) {
      const exchange::PeerStatus& peer = link_.synchroniser().peer(slot);
      if (!peer.used || !peer.about_us_heard) continue;
      if (peer.about_us.state != exchange::AlignmentNotice::State::kMerged) continue;
      slam_.offer_alignment(slot, peer.about_us.T_own_peer.inverse());
    }
  }

  Source& source_;
  MemoryBlock memory_;
  Slam slam_;
  PeerExchange link_;
  Endpoint address_;
  SourceFrame frame_;
  int steps_ = 0;
  std::array<LandmarkRecord, 64> records_;
  std::array<std::uint8_t, kMaxDatagramBytes> datagram_;
  std::vector<LandmarkEstimate> estimates_;
};

TEST(Recordings, OneRobotUsesNoHeap) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const auto team = tools::simulate_team("loop", 1, 15.0, Parameters{});
  ASSERT_TRUE(team.ok());
  const auto robot = std::make_unique<GuardedRobot>(*team->sources[0], std::uint8_t{1});
  while (robot->load()) robot->step();
  EXPECT_GT(robot->steps(), 100);
  EXPECT_GT(robot->landmarks(), 100U);
}

TEST(Recordings, TwoRobotsThatMergeUseNoHeap) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const auto team = tools::simulate_team("corridor-rooms", 1, 52.0, Parameters{});
  ASSERT_TRUE(team.ok());
  const auto a = std::make_unique<GuardedRobot>(*team->sources[0], std::uint8_t{1});
  const auto b = std::make_unique<GuardedRobot>(*team->sources[1], std::uint8_t{2});
  double confidence = 0.0;
  while (a->load() && b->load()) {
    a->step();
    b->step();
    a->talk(*b);
    b->talk(*a);
    confidence = std::max({confidence, a->confidence(), b->confidence()});
    if (a->merged() && b->merged()) break;
  }
  EXPECT_TRUE(a->merged());
  EXPECT_TRUE(b->merged());
  EXPECT_GT(confidence, 0.5) << "no search found the other's map";
  print_figure("memory: %d steps of two robots that merge, without any use of the heap",
               a->steps() + b->steps());
}

}  // namespace
}  // namespace zenith
