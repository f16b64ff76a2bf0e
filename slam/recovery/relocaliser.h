#pragma once
// Finds a lost robot in its own map: poses that single frames propose are moved on by the wheels
// and tested by every further frame, until one of them explains what is seen and no other does. The
// standard of evidence is that of prior maps (fleet/fleet.h, DecisionSettings).

#include <optional>

#include "slam/fleet/hypothesis.h"
#include "slam/recovery/pose_search.h"

namespace zenith {

class Relocaliser {
 public:
  void reset() { *this = {}; }

  // A frame of a lost robot that moved by `moved` since the last one, by its wheels. The pose, once
  // it is found.
  std::optional<Pose2> step(const FrameOverMap& frame, const Pose2& moved, PoseSearch& search);

 private:
  struct Guess {
    Pose2 T_own_robot;
    Evidence evidence;
    double travel_m = 0.0;

    double score() const;
    void test(const FrameOverMap& frame);
  };
  static constexpr std::size_t kMaxGuesses = 12;

  bool search_due(const Pose2& moved);
  void propose(const FrameOverMap& frame, PoseSearch& search);
  void drop_twins();
  std::optional<Pose2> decide() const;

  FixedVector<Guess, kMaxGuesses> guesses_;
  double travel_m_ = 0.0;  // since the last search
  double turn_rad_ = 0.0;
  bool begun_ = false;
};

}  // namespace zenith
