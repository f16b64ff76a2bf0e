// Looks of a recording, by the map that the Mapper makes of it.

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "platform/recording/recording.h"
#include "slam/mapper.h"
#include "tools/descriptors/extractor.h"
#include "tools/descriptors/looks.h"

namespace zenith::tools {
namespace {

constexpr double kSamePlace_px = 2.0;
constexpr double kMinStep_m = 0.1;
constexpr double kMinTurn_rad = 5.0 * std::numbers::pi / 180.0;

class OwnMapper {
 public:
  OwnMapper(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed)
      : memory_(needed(parameters)) {
    Arena arena(memory_.span());
    mapper_.layout(arena, parameters);
    mapper_.build(robot, parameters, seed);
  }
  Mapper* operator->() { return &mapper_; }

 private:
  static std::size_t needed(const Parameters& parameters) {
    Arena arena;
    Mapper mapper;
    mapper.layout(arena, parameters);
    return arena.used();
  }
  MemoryBlock memory_;
  Mapper mapper_;
};

// The described feature nearest to `m` within `radius` tangents, or -1.
int nearest_feature(const Features& features, const Eigen::Vector2d& m, double radius) {
  int best = -1;
  double best_distance = radius;
  for (std::size_t k = 0; k < features.size(); ++k) {
    const Feature& f = features[k];
    const double distance =
        std::hypot(static_cast<double>(f.zx) - m.x(), static_cast<double>(f.zy) - m.y());
    if (!f.described || distance >= best_distance) continue;
    best_distance = distance;
    best = static_cast<int>(k);
  }
  return best;
}

class Collector {
 public:
  explicit Collector(LookSequence& out) : out_(out) {}

  void add(OwnMapper& mapper, const FeatureExtractor& view, const Features& features, int frame) {
    const Pose2 pose = mapper->pose().mean;
    const Eigen::Vector2d camera = pose * mapper->lever_m();
    const double camera_z_m = mapper->robot().mount.z_m;
    for (const Candidate& c : mapper->candidates()) {
      const LandmarkInfo& l = mapper->map().info(c.slot);
      if (l.state != LandmarkState::kPromoted) continue;
      const Eigen::Vector3d place = l.position_m();
      const Eigen::Vector2d m =
          rotation(-pose.theta_rad) * (place.head<2>() - camera) / (place.z() - camera_z_m);
      const int k = nearest_feature(features, m, kSamePlace_px / view.pinhole().focal_px);
      if (k < 0) continue;
      const Feature& f = features[static_cast<std::size_t>(k)];
      const auto direction =
          static_cast<float>(wrap_angle(pose.theta_rad + static_cast<double>(f.orientation_rad)));
      out_.looks.push_back({index_of(l.id, place), 0, frame, pose, direction, f.patch});
    }
  }

 private:
  int index_of(std::uint32_t id, const Eigen::Vector3d& place_m) {
    const auto [at, is_new] = index_.try_emplace(id, static_cast<int>(out_.places_m.size()));
    if (is_new) out_.places_m.emplace_back();
    out_.places_m[static_cast<std::size_t>(at->second)] = place_m;
    return at->second;
  }

  LookSequence& out_;
  std::unordered_map<std::uint32_t, int> index_;
};

}  // namespace

Result<LookSequence> mapped_looks(const std::filesystem::path& recording, std::uint64_t seed) {
  const auto source = Recording::open(recording, {});
  if (!source.ok()) return source.error();
  const RobotConfig& robot = (*source)->config();
  OwnExtractor extractor(robot, Parameters{});
  OwnMapper mapper(robot, Parameters{}, seed);
  LookSequence out;
  out.name = (*source)->name();
  Collector collector(out);
  WheelMotion wheels;
  wheels.build(robot.wheels, mapper->motion_noise());
  MotionIncrement unused;
  std::optional<Pose2> looked;
  SourceFrame frame;
  for (int number = 0;; ++number) {
    const Result<bool> more = (*source)->next(frame);
    if (!more.ok()) return more.error();
    if (!*more) break;
    for (const WheelSample& sample : frame.wheels) wheels.add(sample);
    unused = unused * wheels.advance(frame.stamp).motion;
    const ImageView image = {frame.pixels.data(), robot.lens.width_px, robot.lens.height_px,
                             robot.lens.width_px};
    Features& features = extractor->extract(image);
    const MotionIncrement moved = wheels.with_floor(unused);
    if (!mapper->worth_using(moved)) continue;
    unused = {};
    mapper->update(moved, features, *extractor);
    const Pose2 pose = mapper->pose().mean;
    if (looked && (pose.position() - looked->position()).norm() < kMinStep_m &&
        std::abs(wrap_angle(pose.theta_rad - looked->theta_rad)) < kMinTurn_rad) {
      continue;
    }
    looked = pose;
    collector.add(mapper, *extractor, features, number);
  }
  return out;
}

}  // namespace zenith::tools
