#include "tools/calibrate/drive_setup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/geometry.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
// As slam/watch: how well signs must be known, how much may be left unexplained.
constexpr double kSignSigma = 0.12;
constexpr double kDirectionSigma = 0.2;
constexpr double kUnexplained = 0.15;
// Of alpha: the turn that a straight way may seem to make, and the scale of the true turns.
constexpr double kCross = 0.4;
constexpr double kLeastScale = 0.4;
constexpr double kMostScale = 2.5;
// A mount that is turned by more is a mistake, not what a ruler leaves.
constexpr double kTurned_rad = 20.0 / kDegPerRad;
// Stamps that are apart by more are a mistake; less is the base's latency, and calibrated.
constexpr double kApart_s = 0.08;
// Of the whole way, that must have been forward to call wheels reversed that tell of backward.
constexpr double kMostly = 0.2;

struct Shape {  // of the fit, after a change
  double alpha1 = 0.0;
  double alpha2 = 0.0;
  std::complex<double> beta1;
};

// With u = M u' for wheels that were mended: alpha' = M^T alpha, beta' = M^T beta.
Shape shape_after(const WheelFit& fit, const SetupChange& change, double mount_yaw_rad) {
  // What the wheels told when the mended ones tell of 1 m straight, and of a turn.
  const auto told = [&](double forward, double turning) {
    // Undo the change: find the reading (l, r) that it takes to these.
    WheelTravel t = {forward - turning, forward + turning};
    if (change.wheels.invert_left) t.left_m = -t.left_m;
    if (change.wheels.invert_right) t.right_m = -t.right_m;
    if (change.wheels.swap) std::swap(t.left_m, t.right_m);
    return std::pair(0.5 * (t.left_m + t.right_m), 0.5 * (t.right_m - t.left_m));
  };
  const auto [f1, f2] = told(1.0, 0.0);
  const auto [t1, t2] = told(0.0, 1.0);
  Shape s;
  s.alpha1 = fit.alpha1 * f1 + fit.alpha2 * f2;
  s.alpha2 = fit.alpha1 * t1 + fit.alpha2 * t2;
  s.beta1 = fit.beta1 * f1 + fit.beta2 * f2;
  if (change.picture == Mirrored::kNot) return s;
  // Shifts are mirrored at an axis that the mount has turned.
  s.alpha1 = -s.alpha1;
  s.alpha2 = -s.alpha2;
  s.beta1 = std::polar(1.0, 2.0 * mount_yaw_rad) * std::conj(s.beta1);
  if (change.picture == Mirrored::kColumns) s.beta1 = -s.beta1;
  return s;
}

bool one_reversed(const WheelOrder& w) {
  return w.invert_left != w.invert_right;
}

int mistakes(const SetupChange& c) {
  return (c.wheels.swap ? 1 : 0) + (c.wheels.invert_left || c.wheels.invert_right ? 1 : 0) +
         (c.picture != Mirrored::kNot ? 1 : 0) + (c.yaw_rad != 0.0 ? 1 : 0);
}

// Which of those with as few mistakes is likelier: robots drive forward, a camera that flips its
// picture is more common than a base with both wheels reversed or exchanged, and a mount that is
// turned as well less than wheels that are wrong in two ways.
int rank(const SetupChange& c, const SetupFit& fit, double way_m) {
  const bool backward = fit.forward_m < -kMostly * way_m;
  const bool both = c.wheels.invert_left && c.wheels.invert_right;
  const int turned = c.yaw_rad != 0.0 ? 10 : 0;
  if (both) return turned + (backward ? 0 : 4);
  if (c.picture == Mirrored::kColumns) return turned + 1;
  return turned + (c.picture == Mirrored::kRows ? 3 : 2);
}

std::vector<SetupChange> explanations(const SetupFit& fit, double mount_yaw_rad, double way_m) {
  std::vector<SetupChange> out;
  for (int k = 0; k < 24; ++k) {
    SetupChange c;
    c.wheels = {(k & 1) != 0, (k & 2) != 0, (k & 4) != 0};
    c.picture = static_cast<Mirrored>(k / 8);
    const Shape s = shape_after(fit.fit, c, mount_yaw_rad);
    if (s.alpha2 < kLeastScale || s.alpha2 > kMostScale || std::abs(s.alpha1) > kCross) continue;
    const double yaw = std::arg(s.beta1);
    if (std::abs(yaw) > kTurned_rad) c.yaw_rad = -yaw;
    out.push_back(c);
  }
  const auto order = [&](const SetupChange& a, const SetupChange& b) {
    const int more = mistakes(a) - mistakes(b);
    return more != 0 ? more < 0 : rank(a, fit, way_m) < rank(b, fit, way_m);
  };
  std::stable_sort(out.begin(), out.end(), order);
  const auto worse = std::find_if(out.begin(), out.end(), [&](const SetupChange& c) {
    return mistakes(c) > mistakes(out.front());
  });
  out.erase(worse, out.end());
  return out;
}

std::vector<SetupCode> causes_of(const SetupChange& c, double delay_s) {
  using enum SetupCode;
  std::vector<SetupCode> out;
  if (c.picture != Mirrored::kNot) out.push_back(kPictureMirrored);
  if (c.wheels.swap) out.push_back(kWheelsSwapped);
  if (c.wheels.invert_left && c.wheels.invert_right) {
    out.push_back(kWheelsReversed);
  } else if (one_reversed(c.wheels)) {
    out.push_back(c.wheels.invert_left ? kLeftReversed : kRightReversed);
  }
  if (c.yaw_rad != 0.0) out.push_back(kYawWrong);
  if (std::abs(delay_s) > kApart_s) out.push_back(kStampsApart);
  return out;
}

}  // namespace

bool DriveSetup::contradicts() const {
  return std::find(causes.begin(), causes.end(), SetupCode::kWheelsContradict) != causes.end();
}

DriveSetup find_setup(const DriveData& data) {
  DriveSetup out;
  out.fit =
      fit_setup(data.seen, data.wheels, data.believed.wheels, {-kLongestDelay_s, kLongestDelay_s});
  const SetupFit& f = out.fit;
  if (!f.known) return out;
  if (f.delay_is_sure()) out.delay_s = f.delay_s;
  const double turn_sigma = std::max(f.fit.alpha1_sigma, f.fit.alpha2_sigma);
  if (turn_sigma > kSignSigma) return out;
  if (f.fit.turn_rest > kUnexplained) {
    out.judged = true;
    out.causes = {SetupCode::kWheelsContradict};
    return out;
  }
  double way_m = 0.0;
  for (const SeenInterval& i : data.seen) {
    const WheelTravel t = data.travel(i.from_s, i.to_s, out.delay_s);
    way_m += std::max(std::abs(t.left_m), std::abs(t.right_m));
  }
  const auto found = explanations(f, data.believed.mount.yaw_rad, way_m);
  const bool straight = std::max(f.fit.beta1_sigma, f.fit.beta2_sigma) <
                        kDirectionSigma * std::max(std::abs(f.fit.beta1), std::abs(f.fit.beta2));
  if (!straight) return out;
  out.judged = true;
  if (found.empty()) {
    out.causes = {SetupCode::kWheelsContradict};
    return out;
  }
  out.change = found.front();
  out.alternatives.assign(found.begin() + 1, found.end());
  out.causes = causes_of(out.change, out.delay_s);
  return out;
}

DriveData mended(const DriveData& data, const DriveSetup& setup) {
  DriveData out = data;
  out.wheels = data.wheels.corrected(setup.change.wheels, setup.delay_s);
  std::erase_if(out.frames, [&](const DriveFrame& frame) {
    return frame.time_s < out.wheels.begin_s() || frame.time_s > out.wheels.end_s();
  });
  const Mirrored picture = setup.change.picture;
  if (picture == Mirrored::kNot) return out;
  const int axis = picture == Mirrored::kColumns ? 0 : 1;
  for (DriveFrame& frame : out.frames) {
    for (Sighting& sighting : frame.sightings) sighting.ray(axis) = -sighting.ray(axis);
  }
  return out;
}

std::string change_text(const SetupChange& c) {
  std::string text;
  const auto add = [&text](const std::string& more) {
    text += (text.empty() ? "" : " and ") + more;
  };
  if (c.picture == Mirrored::kColumns)
    add("the picture is mirrored: its columns run the wrong way");
  if (c.picture == Mirrored::kRows) add("the picture is mirrored: its rows run the wrong way");
  if (c.wheels.swap) add("left and right wheel are exchanged");
  if (c.wheels.invert_left && c.wheels.invert_right) {
    add("both wheels count backward");
  } else if (one_reversed(c.wheels)) {
    add(std::string("the ") + (c.wheels.invert_left ? "left" : "right") + " wheel counts backward");
  }
  if (c.yaw_rad != 0.0) {
    add(formatted("the camera is turned by %.0f degrees against mount.yaw_deg",
                  c.yaw_rad * kDegPerRad));
  }
  return text;
}

std::vector<std::string> setup_text(const DriveSetup& setup) {
  std::vector<std::string> lines;
  if (!setup.judged) {
    lines.emplace_back(
        "the drive does not show whether wheels and camera are the right way round: drive 2 m "
        "straight, and turn on the spot by 180 degrees to each side");
  }
  if (setup.contradicts()) {
    lines.push_back(
        formatted("the wheels do not explain %.0f %% of the turning that is seen, ",
                  100.0 * setup.fit.fit.turn_rest) +
        formatted("in whatever order and sign and with delays of up to %.1f s; ", kLongestDelay_s) +
        "expected less than 15: check which signals are the wheels', and whether both "
        "clocks run alike");
    return lines;
  }
  const std::string change = change_text(setup.change);
  if (!change.empty()) {
    lines.push_back(change + formatted(": with that the wheels explain %.0f %% of the turning that "
                                       "is seen; change the lines below",
                                       100.0 * (1.0 - setup.fit.fit.turn_rest)));
  }
  if (!change.empty() && !setup.alternatives.empty()) {
    std::string others;
    for (const SetupChange& c : setup.alternatives) {
      others += (others.empty() ? "" : "; or ") + change_text(c);
    }
    lines.push_back("one camera does not tell this from another cause, look at the robot: " +
                    others);
  }
  if (std::abs(setup.delay_s) > kApart_s) {
    lines.push_back(formatted("the wheels' stamps are %.0f ms %s against the frames'",
                              1e3 * std::abs(setup.delay_s),
                              setup.delay_s > 0.0 ? "late" : "early") +
                    ": stamp both when they are measured, by one clock, or change "
                    "odometry.latency_s as below");
  }
  return lines;
}

}  // namespace zenith::tools
