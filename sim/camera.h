#pragma once
// The camera as a table: for every pixel inside the image circle its ray and how the ray
// changes from pixel to pixel, in base_link's axes (mount and tilt applied).
//
//   ray(u + du, v + dv) = d + du * d_u + dv * d_v        within a pixel; the rest is below 1e-5
//
// The table is exact for every model of slam/image/lens.h: pixel (0, 0) has its centre at (0, 0).

#include <vector>

#include <Eigen/Core>

#include "sim/world_file.h"
#include "slam/robot.h"

namespace zenith::sim {

struct PixelRay {
  float d[3] = {};  // unit length
  float d_u[3] = {};
  float d_v[3] = {};
  float slope = 0.0F;  // z over the horizontal distance
  float turn = 0.0F;   // azimuth in turns, [0, 1)
  float gain = 0.0F;   // vignetting: cos-like fall-off and the soft edge of the image circle
};

// The pixels of one row that are rendered: columns [first, last), rays from `start` on.
struct PixelSpan {
  int first = 0;
  int last = 0;
  int start = 0;
};

class Camera {
 public:
  // `max_view_angle_deg` from the optical axis limits what is rendered.
  Camera(const RobotConfig& robot, double field_deg, double max_view_angle_deg);

  int width() const { return width_; }
  int height() const { return height_; }
  const PixelSpan& span(int row) const { return spans_[static_cast<std::size_t>(row)]; }
  const PixelRay* rays(const PixelSpan& span) const { return rays_.data() + span.start; }
  float min_slope() const { return min_slope_; }
  const CameraMount& mount() const { return mount_; }

 private:
  int width_;
  int height_;
  CameraMount mount_;
  float min_slope_ = 0.0F;
  std::vector<PixelSpan> spans_;
  std::vector<PixelRay> rays_;
};

// R_base_camera = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Matrix3d mount_rotation(const CameraMount& mount);

}  // namespace zenith::sim
