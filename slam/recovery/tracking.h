#pragma once
// Whether the robot still knows where it is in its own map. Decides by how many of the landmarks
// that must be in view are matched; the searches that answer a weak frame are done elsewhere.

#include <cstdint>

namespace zenith {

enum class TrackingState : std::uint8_t {
  kTracking,  // in the map
  kHeld,      // this frame does not fit where the wheels lead: the pose is theirs, the map waits
  kLost,      // so for long, and nowhere near: it is looked for in the whole map
};

// As files and telemetry say it.
constexpr const char* state_name(TrackingState state) {
  if (state == TrackingState::kTracking) return "tracking";
  return state == TrackingState::kHeld ? "held" : "lost";
}

// Reliable landmarks that a frame must show, and those of them that were matched; all recent ones
// that may be in it, and those whose matches agree on one pose.
struct MatchShare {
  int expected = 0;
  int matched = 0;
  int recent = 0;
  int agreeing = 0;
};

class Tracking {
 public:
  // A frame that cannot be of where the robot is taken to be: few of its landmarks are found. Where
  // few are expected nothing can be said. Many that agree do not do so by chance, nor does a fair
  // part of all that may be seen: beside them a map that is bent, and lies there a second time, is
  // not found.
  static bool is_weak(const MatchShare& share) {
    if (share.expected < kLeastExpected || share.agreeing >= kEnoughAgreeing) return false;
    return !(share.agreeing >= kLeastAgreeing && is_fair_part(share)) &&
           share.matched < kWeakShare * static_cast<double>(share.expected);
  }

  // Where a picture shows little but its noise, landmarks made of it are found again by accident:
  // of all recent ones in view up to a fifth agree on some pose. Where wheels slipped it is a
  // third.
  static bool is_fair_part(const MatchShare& share) {
    return share.agreeing >= kFairShare * static_cast<double>(share.recent);
  }

  TrackingState state() const { return state_; }
  // The frame fits, or was made to fit by a search.
  void follow() { *this = {}; }
  // It does not. `travel_m` of the wheels since the last used frame.
  void hold(double travel_m) {
    ++frames_;
    travel_m_ += travel_m;
    if (state_ == TrackingState::kTracking) state_ = TrackingState::kHeld;
    const bool long_enough = frames_ >= kMostFrames || travel_m_ >= kMostTravel_m;
    if (frames_ >= kLeastFrames && long_enough) state_ = TrackingState::kLost;
  }
  double held_m() const { return travel_m_; }

 private:
  static constexpr int kLeastExpected = 10;
  static constexpr double kWeakShare = 0.35;
  static constexpr int kEnoughAgreeing = 20;
  static constexpr int kLeastAgreeing = 10;
  static constexpr double kFairShare = 0.25;
  static constexpr int kLeastFrames = 5;
  static constexpr int kMostFrames = 40;
  static constexpr double kMostTravel_m = 0.6;

  TrackingState state_ = TrackingState::kTracking;
  int frames_ = 0;
  double travel_m_ = 0.0;
};

}  // namespace zenith
