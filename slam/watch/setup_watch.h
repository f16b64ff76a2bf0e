#pragma once
// Watches whether camera, wheels, clock and what is configured of them fit together: an independent
// comparison of what the camera saw with what the wheels told, beside the filter, which takes the
// set-up for right. Says a SetupVerdict (verdict.h).
//
//   every kCompare: visual_motion() since the reference frame   -> intervals
//   when the wheels of an interval and of all delays are there  -> wheel_fit.h
//   every few intervals: decide
//
// No clock, no heap; 13 kB. The cost is that of one comparison of 64 with 128 compact patches
// every kCompare.

#include <array>
#include <optional>
#include <span>

#include "slam/filter/motion.h"
#include "slam/image/feature.h"
#include "slam/robot.h"
#include "slam/watch/lens_fit.h"
#include "slam/watch/measures.h"
#include "slam/watch/picture_watch.h"
#include "slam/watch/reasons.h"
#include "slam/watch/slip_watch.h"
#include "slam/watch/stamp_jitter.h"
#include "slam/watch/travel_grid.h"
#include "slam/watch/turn_scale.h"
#include "slam/watch/verdict.h"
#include "slam/watch/visual_motion.h"
#include "slam/watch/wheel_fit.h"

namespace zenith {

struct WatchedFrame {
  Time stamp;
  std::span<const Feature> features;  // as extracted, strongest first
  ImageView rectified;
  bool repeated = false;  // the picture is the last one's, bit for bit: features tell nothing new
};

class SetupWatch {
 public:
  static constexpr Duration kCompare = {140'000'000};
  struct Bounds {
    double doubtful = 0.0;
    double wrong = 0.0;
  };

  void build(const RobotConfig& robot);

  // One accepted frame, and the wheels so far.
  void observe(const WatchedFrame& frame, const WheelHistory& wheels);

  // What the filter says of this frame, after its step.
  void note_tracking(bool lost, Time stamp);

  const SetupVerdict& verdict() const { return verdict_; }
  const SetupMeasures& measures() const { return measures_; }
  // For tests and reports.
  const DelayedFits& fits() const { return fits_; }

 private:
  struct Interval {
    Time from;
    Time to;
    VisualMotion seen;
  };

  void compare(Time stamp, std::span<const Feature> features);
  void take_reference(Time stamp, std::span<const Feature> features);
  std::optional<Eigen::Vector2d> expected_shift() const;
  void add_waiting();
  void add(const Interval& interval);
  Eigen::Vector2d told(const Interval& interval, Duration delay) const;
  void add_to_fits(const Interval& interval, double turn_m, std::complex<double> shift,
                   double weight, double fade);
  Duration known_delay() const;
  double rest_of_turn(const Interval& interval) const;
  void note_turn(const Interval& interval, double rest_rad, double fade);
  void note_jitter(const Interval& interval, double rest_rad, double fade);
  void note_standing(const VisualMotion& seen, Time now);
  void decide(Time now);
  // Whether turns and directions fit at all; false: one of the codes for wrong signs is given.
  bool judge_signs(const WheelFit& fit, Time now);
  void judge_straight(const WheelFit& fit, Time now);
  void judge_turns(const DelayedFits::Best& best, Time now);
  void judge_axis(const WheelFit& fit, bool turns_known, Time now);
  void give(SetupCode code, double found, Bounds bounds, double value, Time now);
  Eigen::Vector2d vertical(const WheelFit& fit) const;

  RobotConfig robot_;
  bool begun_ = false;
  Time first_;
  WheelTravel last_total_;
  TravelGrid travel_;
  PictureWatch picture_;
  SlipWatch slips_;
  KeptCorners reference_;
  Time reference_stamp_;
  WheelTravel reference_total_;
  Time compared_;
  bool has_reference_ = false;
  FixedVector<Interval, 16> waiting_;
  DelayedFits fits_;
  DelayedFits::Best best_;  // at the last decision
  StampJitter jitter_;
  TurnScale turn_scale_;
  LensFit lens_;
  bool signs_right_ = false;
  int slips_in_row_ = 0;
  bool lost_ = false;
  Time lost_since_;
  int added_ = 0;
  double forward_m_ = 0.0;   // by the wheels, with its sign, faded
  double straight_m_ = 0.0;  // compared
  Reasons reasons_;
  SetupMeasures measures_;
  SetupVerdict verdict_;
};

}  // namespace zenith
