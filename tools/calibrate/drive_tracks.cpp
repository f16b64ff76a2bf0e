#include "tools/calibrate/drive_tracks.h"

#include <cmath>
#include <numbers>

#include "slam/image/ncc.h"
#include "tools/calibrate/median.h"
#include "tools/descriptors/extractor.h"

namespace zenith::tools {
namespace {

constexpr double kKeepDistance_m = 0.12;
constexpr double kKeepTurn_rad = 8.0 * std::numbers::pi / 180.0;
constexpr double kSearch = 0.25;     // tangents, round the place that the turn predicts
constexpr double kAgreement = 0.08;  // tangents, round the motion of most
constexpr float kAlike = 0.7F;

struct Followed {
  Feature feature;
  int track = -1;
  Eigen::Vector2d z() const { return {feature.zx, feature.zy}; }
};

struct Match {
  std::size_t before;
  std::size_t now;
  Eigen::Vector2d moved;
};

// The most alike of `candidates` near `expected`, or -1.
int most_alike(const Followed& one, const Eigen::Vector2d& expected,
               const std::vector<Followed>& candidates) {
  int best = -1;
  float best_ncc = kAlike;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if ((candidates[i].z() - expected).norm() > kSearch) continue;
    const float similarity = ncc(one.feature.patch, candidates[i].feature.patch);
    if (similarity <= best_ncc) continue;
    best = static_cast<int>(i);
    best_ncc = similarity;
  }
  return best;
}

// Pairs that choose each other, and move as most do.
std::vector<Match> match(const std::vector<Followed>& before, const std::vector<Followed>& now,
                         double turn_rad) {
  const Eigen::Matrix2d R = rotation(-turn_rad);
  std::vector<Match> matches;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int k = most_alike(before[i], R * before[i].z(), now);
    if (k < 0) continue;
    const Followed& found = now[static_cast<std::size_t>(k)];
    if (most_alike(found, R.transpose() * found.z(), before) != static_cast<int>(i)) continue;
    matches.push_back({i, static_cast<std::size_t>(k), found.z() - R * before[i].z()});
  }
  if (matches.empty()) return matches;
  std::vector<double> x;
  std::vector<double> y;
  for (const Match& m : matches) {
    x.push_back(m.moved.x());
    y.push_back(m.moved.y());
  }
  const Eigen::Vector2d most(median(x), median(y));
  std::erase_if(matches, [&](const Match& m) { return (m.moved - most).norm() > kAgreement; });
  return matches;
}

class Tracker {
 public:
  explicit Tracker(const RobotConfig& robot)
      : extractor_(robot, Parameters{}), R_camera_base_(mount_rotation(robot.mount).transpose()) {}

  // Returns the turn since the last frame as it is seen; `told_rad`, the wheels' one, where it is
  // not. Whatever is wrong with the wheels, corners are followed.
  double follow(double time_s, const ImageView& image, double told_rad) {
    std::vector<Followed> now;
    const Features& features = extractor_->extract(image);
    const VisualMotion seen = visual_motion(last_, features);
    const double turn_rad = seen.known ? seen.turn_rad : told_rad;
    keep_corners(features, last_);
    seen_.add(time_s, features);
    for (const Feature& feature : features) {
      if (feature.described) now.push_back({feature, -1});
    }
    for (const Match& m : match(followed_, now, turn_rad)) {
      now[m.now].track = followed_[m.before].track;
    }
    for (Followed& f : now) {
      if (f.track < 0) f.track = tracks_++;
    }
    followed_ = std::move(now);
    return turn_rad;
  }

  DriveFrame frame(double time_s) const {
    DriveFrame frame{time_s, {}};
    for (const Followed& f : followed_) {
      const Eigen::Vector3d level(f.feature.zx, f.feature.zy, 1.0);
      frame.sightings.push_back({f.track, (R_camera_base_ * level).normalized()});
    }
    return frame;
  }
  int tracks() const { return tracks_; }
  const std::vector<SeenInterval>& seen() const { return seen_.intervals(); }

 private:
  OwnExtractor extractor_;
  Eigen::Matrix3d R_camera_base_;
  std::vector<Followed> followed_;
  KeptCorners last_;
  SeenMotion seen_;
  int tracks_ = 0;
};

}  // namespace

Result<DriveData> track_drive(Source& source, const std::function<void(double)>& progress) {
  DriveData data;
  data.believed = source.config();
  const Lens& lens = data.believed.lens;
  Tracker tracker(data.believed);
  SourceFrame frame;
  std::optional<Time> start;
  WheelTravel kept;
  WheelTravel before;
  double turned_rad = 0.0;  // since the last kept frame
  const auto told_turn = [&data](const WheelTravel& from, const WheelTravel& to) {
    return wheel_motion(data.believed.wheels, {to.left_m - from.left_m, to.right_m - from.right_m})
        .theta_rad;
  };
  for (;;) {
    const auto more = source.next(frame);
    if (!more) return more.error();
    if (!*more) break;
    if (!start) start = frame.stamp;
    for (const WheelSample& sample : frame.wheels) {
      data.wheels.add((sample.stamp - *start).seconds(), {sample.left_m, sample.right_m});
    }
    const double now_s = (frame.stamp - *start).seconds();
    if (data.wheels.empty()) continue;
    const WheelTravel total = data.wheels.at(now_s);
    const bool first = data.images++ == 0;
    if (first) before = kept = total;
    const ImageView image{frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
    turned_rad += tracker.follow(now_s, image, told_turn(before, total));
    before = total;
    const double moved_m =
        std::max(std::abs(total.left_m - kept.left_m), std::abs(total.right_m - kept.right_m));
    if (first || moved_m > kKeepDistance_m || std::abs(turned_rad) > kKeepTurn_rad) {
      data.frames.push_back(tracker.frame(now_s));
      kept = total;
      turned_rad = 0.0;
    }
    progress(static_cast<double>(data.images) / std::max(1, source.frame_count()));
  }
  data.tracks = tracker.tracks();
  data.seen = tracker.seen();
  if (data.frames.size() < 20) {
    return Error{"the robot hardly moved: " + std::to_string(data.images) + " frames, but only " +
                 std::to_string(data.frames.size()) +
                 " places; `zenith calibrate drive --guide` says how to drive"};
  }
  return data;
}

}  // namespace zenith::tools
