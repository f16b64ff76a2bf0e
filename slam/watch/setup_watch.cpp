#include "slam/watch/setup_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/image/rectify.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// A reference frame is kept until the image or a wheel has moved this far, or this long.
constexpr double kMoved = 0.045;  // tangents: 5 pixels
constexpr double kTold_m = 0.1;
constexpr Duration kOldest = {700'000'000};
constexpr int kWithCorners = 20;
// What is forgotten: after so much turning, so long a way.
constexpr double kForgetTurn_rad = 6.0 * std::numbers::pi;
constexpr double kForgetWay_m = 30.0;
constexpr int kDecideEvery = 4;  // intervals
// An interval that is off by more counts less, as in Huber's loss.
constexpr double kPlain_m = 0.02;
constexpr double kPlainShift = 0.06;  // tangents
constexpr double kSlip_rad = 4.0 * kDegree;
// An interval of which the scale of turns is learned: turns so much, and fits so well.
constexpr double kLeastTurn_rad = 3.0 * kDegree;
constexpr double kPlainTurn_rad = 2.0 * kDegree;
constexpr double kTurnScaleSigma = 0.02;
constexpr int kSlipsInRow = 12;
// Enough to judge by: intervals, and standard deviations of the fit.
constexpr double kLeastIntervals = 10.0;
constexpr double kSignSigma = 0.12;
constexpr double kScaleSigma = 0.03;
constexpr double kDirectionSigma = 0.05;
constexpr double kStraightWay_m = 5.0;
// Signs and quadrants.
constexpr double kQuadrant = 0.25 * std::numbers::pi;
constexpr double kTurned = 30.0 * kDegree;
constexpr double kCross = 0.3;
constexpr double kClear = 5.0;         // standard deviations
constexpr double kUnexplained = 0.15;  // of the seen turns' power
// Amounts: beyond the first the map suffers, beyond the second it cannot be used.
constexpr SetupWatch::Bounds kYawBounds = {2.5 * kDegree, 8.0 * kDegree};
constexpr SetupWatch::Bounds kUnequalBounds = {0.03, 0.1};
// Of the turns' scale: in standard deviations of a track width that was measured with a rule.
constexpr double kTrackSigma = 0.01;
constexpr SetupWatch::Bounds kScaleBounds = {3.6, 5.0};
constexpr SetupWatch::Bounds kDelayBounds_s = {0.03, 0.08};
constexpr SetupWatch::Bounds kJitterBounds_s = {0.01, 1.0};
constexpr SetupWatch::Bounds kVerticalBounds = {0.045, 0.1};
constexpr SetupWatch::Bounds kAheadBounds = {0.0105, 0.045};
constexpr SetupWatch::Bounds kFocalBounds = {0.04, 0.08};
constexpr double kFocalSigma = 0.02;
constexpr double kAheadSigma = 0.01;
constexpr double kDelayGain = 1.15;
constexpr double kExplained = 0.1;  // share of the turns' power that may be left
// A running mean over some 30 comparisons in which the picture moved.
constexpr double kStandingRate = 0.03;
constexpr double kStandingShare = 0.1;

std::complex<double> shift_of(const WheelFit& fit, const Eigen::Vector2d& u) {
  return u.x() * fit.beta1 + u.y() * fit.beta2;
}

}  // namespace

void SetupWatch::build(const RobotConfig& robot) {
  robot_ = robot;
}

void SetupWatch::observe(const WatchedFrame& frame, const WheelHistory& wheels) {
  const Time stamp = frame.stamp;
  const WheelTravel total = wheels.at(stamp).total;
  if (!begun_) {
    begun_ = true;
    first_ = compared_ = stamp;
    last_total_ = total;
  }
  travel_.advance(wheels, stamp);
  const Wheels& w = robot_.wheels;
  const WheelTravel travel = {w.left_scale * (total.left_m - last_total_.left_m),
                              w.right_scale * (total.right_m - last_total_.right_m)};
  last_total_ = total;
  const int corners = static_cast<int>(frame.features.size());
  picture_.observe(stamp, {frame.rectified, corners, frame.repeated}, travel, reasons_);
  const bool due = stamp - compared_ >= kCompare || !has_reference_ || stamp < compared_;
  if (due && !frame.repeated) compare(stamp, frame.features);
  add_waiting();
  verdict_ = reasons_.verdict(first_, stamp, measures_.judged);
}

void SetupWatch::note_tracking(bool lost, Time stamp) {
  if (lost && !lost_) lost_since_ = stamp;
  lost_ = lost;
  if (!lost) return;
  reasons_.happened(SetupCode::kLost, (stamp - lost_since_).seconds(), stamp);
  verdict_ = reasons_.verdict(first_, stamp, measures_.judged);
}

void SetupWatch::take_reference(Time stamp, std::span<const Feature> features) {
  keep_corners(features, reference_);
  reference_stamp_ = stamp;
  reference_total_ = last_total_;
  has_reference_ = true;
}

void SetupWatch::compare(Time stamp, std::span<const Feature> features) {
  compared_ = stamp;
  const Duration age = stamp - reference_stamp_;
  if (!has_reference_ || age.ns <= 0 || age > Duration{2 * kOldest.ns}) {
    take_reference(stamp, features);
    return;
  }
  const VisualMotion seen = visual_motion(reference_, features, expected_shift());
  const Wheels& w = robot_.wheels;
  const double told_m =
      std::max(std::abs(w.left_scale * (last_total_.left_m - reference_total_.left_m)),
               std::abs(w.right_scale * (last_total_.right_m - reference_total_.right_m)));
  if (seen.known && seen.moved < kMoved && told_m < kTold_m && age < kOldest) return;
  const bool corners = static_cast<int>(reference_.size()) >= kWithCorners &&
                       static_cast<int>(features.size()) >= kWithCorners;
  if ((seen.known || corners) && !waiting_.push_back({reference_stamp_, stamp, seen})) {
    waiting_.clear();  // the wheels are away
  }
  take_reference(stamp, features);
}

// By the wheels since the reference, and by what the fit makes of them.
std::optional<Eigen::Vector2d> SetupWatch::expected_shift() const {
  const WheelFit& f = best_.fit;
  if (!f.known || f.n < kLeastIntervals) return {};
  const Wheels& w = robot_.wheels;
  const double left = w.left_scale * (last_total_.left_m - reference_total_.left_m);
  const double right = w.right_scale * (last_total_.right_m - reference_total_.right_m);
  const std::complex<double> shift = shift_of(f, {0.5 * (left + right), 0.5 * (right - left)});
  return Eigen::Vector2d(shift.real(), shift.imag());
}

void SetupWatch::add_waiting() {
  std::size_t done = 0;
  for (; done < waiting_.size(); ++done) {
    const Interval& i = waiting_[done];
    if (!travel_.covers(i.to, i.to + DelayedFits::longest())) break;
    if (travel_.covers(i.from - DelayedFits::longest(), i.to)) add(i);
  }
  if (done == 0) return;
  std::copy(waiting_.begin() + done, waiting_.end(), waiting_.begin());
  waiting_.shrink_to(waiting_.size() - done);
}

// (l + r) / 2 and (r - l) / 2 of the wheels whose stamps are late by `delay`.
Eigen::Vector2d SetupWatch::told(const Interval& interval, Duration delay) const {
  const Wheels& w = robot_.wheels;
  const WheelTravel t = travel_.between(interval.from + delay, interval.to + delay);
  const double left = t.left_m * w.left_scale;
  const double right = t.right_m * w.right_scale;
  return {0.5 * (left + right), 0.5 * (right - left)};
}

void SetupWatch::add(const Interval& interval) {
  const double half_track_m = 0.5 * robot_.wheels.track_width_m;
  const double interval_s = (interval.to - interval.from).seconds();
  const Eigen::Vector2d now = told(interval, {0});
  const ToldMotion motion = {now.x(), now.y() / half_track_m};
  if (!interval.seen.known) {
    slips_.add_unmatched(motion, interval_s);
    return;
  }
  const VisualMotion& seen = interval.seen;
  const double turn_m = seen.turn_rad * half_track_m;
  const std::complex<double> shift(seen.shift.x(), seen.shift.y());
  const double fade = std::exp(-std::abs(seen.turn_rad) / kForgetTurn_rad -
                               std::abs(motion.forward_m) / kForgetWay_m);
  const double rest_rad = rest_of_turn(interval);
  // Once the set-up is known, a slip says nothing of it; unless it goes on.
  const bool slips = measures_.judged && std::abs(rest_rad) > kSlip_rad;
  slips_in_row_ = slips ? slips_in_row_ + 1 : 0;
  const double off = std::abs(turn_m - now.y());
  const double shift_off =
      best_.fit.known ? std::abs(shift - shift_of(best_.fit, told(interval, known_delay()))) : 0.0;
  const double weight = std::min({1.0, kPlain_m / off, kPlainShift / shift_off});
  if (!slips || slips_in_row_ > kSlipsInRow) add_to_fits(interval, turn_m, shift, weight, fade);
  forward_m_ = fade * forward_m_ + now.x();
  straight_m_ += std::abs(now.x());
  ++added_;
  lens_.add(seen.lens, fade);
  note_standing(seen, interval.to);
  if (measures_.judged && signs_right_ && !slips) {
    note_turn(interval, rest_rad, fade);
    note_jitter(interval, rest_rad, fade);
  }
  if (!measures_.judged || !signs_right_ || verdict_.state == VerdictState::kWrong) {
    slips_ = {};
  } else {
    // By the set-up as it is: a track width that is a little off turns no corner into a slip.
    const double scale = turn_scale_.sigma() < kTurnScaleSigma ? turn_scale_.value() : 1.0;
    slips_.add(seen, {motion.forward_m, scale * motion.turn_rad}, interval_s,
               1.0 / measures_.height_m, interval.to, reasons_);
  }
  if (added_ % kDecideEvery == 0) decide(interval.to);
}

void SetupWatch::add_to_fits(const Interval& interval, double turn_m, std::complex<double> shift,
                             double weight, double fade) {
  fits_.fade(fade);
  for (int i = 0; i < DelayedFits::kDelays; ++i) {
    const Eigen::Vector2d u = told(interval, DelayedFits::delay(i));
    fits_.sums(i).add(u.x(), u.y(), turn_m, shift, weight);
  }
}

// Kept off the ends, for turn rates need some time to both sides.
Duration SetupWatch::known_delay() const {
  const double most_s = DelayedFits::longest().seconds() - 0.05;
  return Duration::from_seconds(std::clamp(best_.delay_s, -most_s, most_s));
}

// Of the turn that was seen, what the fit does not explain.
double SetupWatch::rest_of_turn(const Interval& interval) const {
  const Eigen::Vector2d u = told(interval, known_delay());
  return interval.seen.turn_rad - (best_.fit.alpha1 * u.x() + best_.fit.alpha2 * u.y()) /
                                      (0.5 * robot_.wheels.track_width_m);
}

void SetupWatch::note_turn(const Interval& interval, double rest_rad, double fade) {
  const double half_track_m = 0.5 * robot_.wheels.track_width_m;
  const Eigen::Vector2d u = told(interval, known_delay());
  if (std::abs(u.y()) < kLeastTurn_rad * half_track_m || std::abs(rest_rad) > kPlainTurn_rad)
    return;
  turn_scale_.add(u.x(), u.y(), interval.seen.turn_rad * half_track_m - best_.fit.alpha1 * u.x(),
                  fade);
}

void SetupWatch::note_jitter(const Interval& interval, double rest_rad, double fade) {
  constexpr Duration kHalf = {40'000'000};
  const auto rate = [&](Time at) {
    return told({at - kHalf, at + kHalf, {}}, known_delay()).y() /
           (robot_.wheels.track_width_m * kHalf.seconds());
  };
  jitter_.add(rest_rad, rate(interval.from), rate(interval.to), fade);
  measures_.jitter_s = jitter_.sigma_s();
}

void SetupWatch::note_standing(const VisualMotion& seen, Time now) {
  if (seen.moved < kMoved) return;
  const double share = static_cast<double>(seen.standing) / (seen.standing + seen.inliers);
  measures_.standing += kStandingRate * (share - measures_.standing);
  reasons_.set(SetupCode::kRobotInView, measures_.standing > kStandingShare,
               VerdictState::kDoubtful, 100.0 * measures_.standing, now);
}

// Where the vertical lies in the rectified image: what the image turns around is the camera's own
// axis, or the robot's turning point where the camera stands beside it.
//   beta_2 = (lever / h - vertical) i / (b / 2)
Eigen::Vector2d SetupWatch::vertical(const WheelFit& fit) const {
  const std::complex<double> turning =
      fit.beta2 * (0.5 * robot_.wheels.track_width_m) / std::complex<double>(0.0, 1.0);
  const std::complex<double> lever(robot_.mount.x_m, robot_.mount.y_m);
  const std::complex<double> at = lever * std::abs(fit.beta1) - turning;
  return {at.real(), at.imag()};
}

void SetupWatch::decide(Time now) {
  best_ = fits_.best();
  measures_.intervals = added_;
  const WheelFit& f = best_.fit;
  if (!f.known) return;
  measures_.turn_scale = turn_scale_.sigma() < kTurnScaleSigma ? turn_scale_.value() : f.alpha2;
  measures_.wheel_balance = f.alpha1;
  measures_.yaw_error_rad = std::arg(f.beta1);
  measures_.height_m = std::abs(f.beta1) > 0.0 ? 1.0 / std::abs(f.beta1) : 0.0;
  measures_.delay_s = best_.delay_s;
  measures_.unexplained = f.turn_rest;
  measures_.vertical = vertical(f);
  measures_.lens = lens_.error();
  const double scale_sigma = std::hypot(kTrackSigma, turn_scale_.sigma());
  measures_.metre_checked_to = std::min(kScaleBounds.doubtful * scale_sigma, 1.0);
  if (f.n < kLeastIntervals) return;
  const bool turns_known = f.alpha2_sigma < kScaleSigma && f.alpha2 > kCross;
  const bool straight_known =
      f.alpha1_sigma < kScaleSigma && f.beta1_sigma < kDirectionSigma * std::abs(f.beta1);
  signs_right_ = judge_signs(f, now);
  if (!signs_right_ || !straight_known) return;
  // Who drives straight ahead for long, and sees it, is good until he turns.
  measures_.judged = measures_.judged || turns_known || straight_m_ > kStraightWay_m;
  if (!measures_.judged) return;
  judge_straight(f, now);
  if (turns_known) judge_turns(best_, now);
  judge_axis(f, turns_known, now);
}

// The turns tell whether left and right are exchanged or reversed, the direction of straight
// driving how the camera is mounted. In a picture whose columns run the other way both are
// mirrored: turns are inverted, and the direction is mirrored at the line across the columns.
bool SetupWatch::judge_signs(const WheelFit& f, Time now) {
  using enum SetupCode;
  const auto give = [&](SetupCode code, bool holds, double value = 0.0) {
    reasons_.set(code, holds, VerdictState::kWrong, value, now);
    return holds;
  };
  // One wheel counts backward: what the wheels call turning is driving straight.
  const bool crosses =
      std::abs(f.alpha2) < kCross && std::abs(f.beta2.real()) > kClear * f.beta2_sigma;
  const bool one_reversed = crosses && std::abs(f.beta2) > std::abs(f.beta1) - f.beta1_sigma;
  bool wrong = give(kLeftReversed, one_reversed && f.beta2.real() > 0.0);
  wrong |= give(kRightReversed, one_reversed && f.beta2.real() < 0.0);

  const double least = kDegree * 0.5 * robot_.wheels.track_width_m;
  const bool unseen =
      std::abs(f.alpha2) < kCross && f.alpha2_sigma < kScaleSigma && f.alpha1_sigma < kScaleSigma;
  const bool contradict =
      !one_reversed && (unseen || (f.turn_rest > kUnexplained && f.turn_rest_m2 > least * least));
  wrong |= give(kWheelsContradict, contradict, 100.0 * f.turn_rest);

  const bool clear = !contradict && !one_reversed && f.alpha2_sigma < kSignSigma &&
                     f.beta1_sigma < 0.2 * std::abs(f.beta1);
  const double direction = std::arg(f.beta1);
  const bool inverted = clear && f.alpha2 < 0.0;
  const bool ahead = std::abs(direction) < kQuadrant;
  const bool behind = std::abs(direction) > std::numbers::pi - kQuadrant;
  const double columns = wrap_angle(2.0 * robot_.mount.yaw_rad + std::numbers::pi);
  const bool as_mirrored = std::abs(wrap_angle(direction - columns)) < kQuadrant;
  const bool both = inverted && behind && forward_m_ < 0.0;
  wrong |= give(kWheelsReversed, both);
  wrong |= give(kPictureMirrored, inverted && !both && (as_mirrored || !ahead));
  wrong |= give(kWheelsSwapped, inverted && !both && !as_mirrored && ahead);
  const bool turned = clear && !inverted && std::abs(direction) > kTurned;
  if (turned || wrong) wrong |= give(kYawWrong, turned, direction / kDegree);
  // A direction that is off means one thing or another, by the turns.
  return !wrong && (clear || std::abs(direction) < kTurned);
}

// Where the vertical lies: by turns, and ahead by straight driving, which shows it better.
void SetupWatch::judge_axis(const WheelFit& f, bool turns_known, Time now) {
  const LensError& lens = measures_.lens;
  const double ahead =
      lens.ahead_sigma < kAheadSigma ? std::abs(lens.ahead) - 2.0 * lens.ahead_sigma : 0.0;
  double off = ahead;
  double tangent = lens.ahead;
  Bounds bounds = kAheadBounds;
  if (turns_known) {
    // Across the direction of driving the ceiling's heights blur what is seen, along it they do
    // not.
    const double half_track_m = 0.5 * robot_.wheels.track_width_m;
    const double along = std::abs(measures_.vertical.x()) - 2.0 * half_track_m * f.beta2_left_sigma;
    const double across = std::abs(measures_.vertical.y()) - 3.0 * half_track_m * f.beta2_sigma;
    const double turned = std::max(along, across);
    if (turned / kVerticalBounds.doubtful > ahead / kAheadBounds.doubtful) {
      off = turned;
      tangent = measures_.vertical.norm();
      bounds = kVerticalBounds;
    }
  }
  give(SetupCode::kLensWrong, off, bounds, std::atan(std::abs(tangent)) / kDegree, now);
}

// found: doubtful beyond the first bound, wrong beyond the second.
void SetupWatch::give(SetupCode code, double found, Bounds bounds, double value, Time now) {
  reasons_.set(code, found > bounds.doubtful,
               found > bounds.wrong ? VerdictState::kWrong : VerdictState::kDoubtful, value, now);
}

void SetupWatch::judge_straight(const WheelFit& f, Time now) {
  const double yaw = std::abs(measures_.yaw_error_rad);
  const double yaw_sigma = f.beta1_left_sigma / std::abs(f.beta1);
  give(SetupCode::kYawWrong, yaw - 2.0 * yaw_sigma, kYawBounds, measures_.yaw_error_rad / kDegree,
       now);
  give(SetupCode::kWheelsUnequal, std::abs(f.alpha1) - 2.0 * f.alpha1_sigma, kUnequalBounds,
       -f.alpha1 / (0.5 * robot_.wheels.track_width_m) / kDegree, now);
  const LensError& lens = measures_.lens;
  const double focal = std::abs(lens.focal) - 2.0 * lens.focal_sigma;
  give(SetupCode::kFocalWrong, lens.focal_sigma < kFocalSigma ? focal : 0.0, kFocalBounds,
       100.0 * lens.focal, now);
}

void SetupWatch::judge_turns(const DelayedFits::Best& best, Time now) {
  using enum SetupCode;
  const WheelFit& f = best.fit;
  const double scale = turn_scale_.value();
  const double off_scale = std::abs(scale - 1.0) / std::hypot(kTrackSigma, turn_scale_.sigma());
  give(kTurnScale, off_scale, kScaleBounds, 1.0 / scale, now);
  const bool sure = std::abs(best.delay_s) > 3.5 * best.sigma_s && best.gain > kDelayGain &&
                    f.turn_rest < kExplained;
  give(kStampsApart, sure ? std::abs(best.delay_s) : 0.0, kDelayBounds_s, 1e3 * best.delay_s, now);
  give(kStampsJitter, measures_.jitter_s, kJitterBounds_s, 1e3 * measures_.jitter_s, now);
}

}  // namespace zenith
