#include "tools/calibrate/drive_picture.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "tools/doctor/formatted.h"
#include "tools/report/canvas.h"

namespace zenith::tools {
namespace {

constexpr int kSize_px = 1000;
constexpr double kTop_px = 150.0;
constexpr double kMargin_px = 50.0;
constexpr Colour kSeen{33, 37, 41};
constexpr Colour kBefore{213, 94, 0};
constexpr Colour kAfter{0, 114, 178};

using Way = std::vector<Eigen::Vector2d>;

Way by_wheels(const DriveData& data, const Wheels& wheels, double latency_s) {
  Way way;
  Pose2 pose;
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    if (i > 0) {
      pose = pose * wheel_motion(wheels, data.travel(data.frames[i - 1].time_s,
                                                     data.frames[i].time_s, latency_s));
    }
    way.push_back(pose.position());
  }
  return way;
}

Way by_sight(const DriveSolution& solution) {
  Way way;
  for (const Pose2& pose : solution.poses) way.push_back(pose.position());
  return way;
}

}  // namespace

Status draw_drive(const DriveData& data, const DriveCalibration& c,
                  const std::filesystem::path& path) {
  const Way seen = by_sight(c.solution);
  const Way before = by_wheels(data, data.believed.wheels, 0.0);
  const Way after = by_wheels(mended(data, c.setup), c.robot.wheels, c.latency_s - c.setup.delay_s);
  Eigen::AlignedBox<double, 2> box;
  for (const Way* way : {&seen, &before, &after}) {
    for (const auto& p : *way) box.extend(p);
  }
  const double scale = std::min(kSize_px - 2.0 * kMargin_px, kSize_px - kTop_px - kMargin_px) /
                       std::max(0.1, box.sizes().maxCoeff());
  const auto at = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(kMargin_px + scale * (p.x() - box.min().x()),
                           kTop_px + scale * (box.max().y() - p.y()));
  };
  Canvas canvas(kSize_px, kSize_px);
  const auto draw = [&](const Way& way, Colour colour, double thickness) {
    Way points;
    for (const auto& p : way) points.push_back(at(p));
    canvas.path(points, colour, thickness);
    canvas.disc(points.back(), 5.0, colour);
  };
  canvas.text({kMargin_px, 44.0}, "The way of the drive", 20.0, kInk, Anchor::kLeft, true);
  canvas.text({kMargin_px, 74.0}, "black: by the ceiling", 12.0, kSeen);
  canvas.text({kMargin_px, 98.0}, "orange: by the wheels alone, with the numbers as they were",
              12.0, kBefore);
  canvas.text({kMargin_px, 122.0}, "blue: by the wheels alone, with the numbers found", 12.0,
              kAfter);
  draw(seen, kSeen, 4.0);
  draw(before, kBefore, 1.5);
  draw(after, kAfter, 1.5);
  canvas.ring(at(seen.front()), 8.0, kInk, 2.0);
  canvas.line({kMargin_px, kSize_px - 20.0}, {kMargin_px + scale, kSize_px - 20.0}, kInk, 2.0);
  canvas.text({kMargin_px + scale + 8.0, kSize_px - 15.0}, "1 m", 11.0, kInk);
  return canvas.save(path);
}

}  // namespace zenith::tools
