#include "tools/map_export.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/atomic_output.h"
#include "tools/report/canvas.h"

namespace zenith::tools {
namespace {

constexpr int kWidth_px = 1600;
constexpr double kMargin_px = 60.0;
constexpr double kHeader_px = 70.0;

double deviation(float variance) {
  return std::sqrt(static_cast<double>(variance));
}

}  // namespace

std::string map_as_ply(const storage::StoredMap& map) {
  std::string text = "ply\nformat ascii 1.0\ncomment zenith stored map of " +
                     std::string(map.head.robot.view()) + ", checkpoint " +
                     std::to_string(map.head.checkpoint) + "\nelement vertex " +
                     std::to_string(map.landmarks.size()) + "\n";
  for (const char* name : {"x", "y", "z", "sigma_x", "sigma_y", "sigma_z"}) {
    text += std::string("property float ") + name + "\n";
  }
  text += "property int observations\nend_header\n";
  char line[160];
  for (const LandmarkRecord& l : map.landmarks) {
    std::snprintf(line, sizeof line, "%.3f %.3f %.3f %.4f %.4f %.4f %d\n",
                  static_cast<double>(l.x_m), static_cast<double>(l.y_m),
                  static_cast<double>(l.z_m), deviation(l.covariance_m2[0]),
                  deviation(l.covariance_m2[3]), deviation(l.covariance_m2[5]), l.observations);
    text += line;
  }
  return text;
}

std::string map_as_csv(const storage::StoredMap& map) {
  std::string text = "id,x_m,y_m,z_m,var_xx,var_xy,var_yy,var_zz,observations\n";
  char line[200];
  for (const LandmarkRecord& l : map.landmarks) {
    const auto& c = l.covariance_m2;
    std::snprintf(line, sizeof line, "%u,%.3f,%.3f,%.3f,%.6g,%.6g,%.6g,%.6g,%d\n", l.id,
                  static_cast<double>(l.x_m), static_cast<double>(l.y_m),
                  static_cast<double>(l.z_m), static_cast<double>(c[0]), static_cast<double>(c[1]),
                  static_cast<double>(c[3]), static_cast<double>(c[5]), l.observations);
    text += line;
  }
  return text;
}

Status draw_stored_map(const storage::StoredMap& map, const std::filesystem::path& file) {
  Eigen::Vector2d low(0.0, 0.0);  // the origin is always seen
  Eigen::Vector2d high(1.0, 1.0);
  for (const LandmarkRecord& l : map.landmarks) {
    const Eigen::Vector2d p(l.x_m, l.y_m);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector2d size = high - low;
  const double scale = std::min((kWidth_px - 2.0 * kMargin_px) / size.x(), 2400.0 / size.y());
  const double bottom_px = kHeader_px + scale * size.y() + kMargin_px;
  Canvas canvas(kWidth_px, static_cast<int>(bottom_px + 90.0));
  const auto place = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(kMargin_px + scale * (p.x() - low.x()),
                           kHeader_px + scale * (high.y() - p.y()));
  };
  for (const LandmarkRecord& l : map.landmarks) {
    canvas.disc(place({l.x_m, l.y_m}), 2.0, robot_colour(0));
  }
  const Eigen::Vector2d origin = place({0.0, 0.0});
  canvas.ring(origin, 8.0, kMagenta, 2.0);
  canvas.line(origin, place({1.0, 0.0}), kMagenta, 2.0);
  char title[160];
  std::snprintf(title, sizeof title, "%s: %zu landmarks, checkpoint %llu", map.head.robot.c_str(),
                map.landmarks.size(), static_cast<unsigned long long>(map.head.checkpoint));
  canvas.text({kMargin_px, 40.0}, title, 16.0, kInk, Anchor::kLeft, true);
  const double metres = scale * 10.0 < kWidth_px / 2.0 ? 10.0 : 1.0;
  const Eigen::Vector2d start(kMargin_px, bottom_px + 20.0);
  canvas.line(start, start + Eigen::Vector2d(scale * metres, 0.0), kInk, 3.0);
  canvas.text(start + Eigen::Vector2d(0.0, 28.0),
              std::to_string(static_cast<int>(metres)) +
                  " m; the ring is the map's origin, its line points along x",
              12.0, kInk);
  return canvas.save(file);
}

Status export_map(const storage::StoredMap& map, const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".ply") return write_file(file, map_as_ply(map));
  if (ending == ".csv") return write_file(file, map_as_csv(map));
  if (ending == ".png") return draw_stored_map(map, file);
  return Error{file.string() + ": expected a name that ends in .ply, .csv or .png"};
}

}  // namespace zenith::tools
