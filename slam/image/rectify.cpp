#include "slam/image/rectify.h"

#include <cmath>

#include <Eigen/Geometry>

#include "slam/image/lens_projection.h"

namespace zenith {

Eigen::Matrix3d mount_rotation(const CameraMount& mount) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(mount.yaw_rad, Vector3d::UnitZ()) *
          AngleAxisd(mount.pitch_rad, Vector3d::UnitY()) *
          AngleAxisd(mount.roll_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

Pinhole Pinhole::from_fov(double fov_rad) {
  Pinhole p;
  p.focal_px = 0.5 * kRectifiedSize / std::tan(0.5 * fov_rad);
  return p;
}

void Rectifier::layout(Arena& arena) {
  table_ = arena.take<RemapEntry>(kRectifiedSize * kRectifiedSize);
}

void Rectifier::build(const Lens& lens, const CameraMount& mount, const Pinhole& pinhole) {
  frame_width_ = lens.width_px;
  frame_height_ = lens.height_px;
  const LensProjection projection(lens);
  const Eigen::Matrix3d R_camera_base = mount_rotation(mount).transpose();
  for (int v = 0; v < kRectifiedSize; ++v) {
    for (int u = 0; u < kRectifiedSize; ++u) {
      const Eigen::Vector2d m = pinhole.normalise(u, v);
      const auto pixel = projection.project(R_camera_base * Eigen::Vector3d(m.x(), m.y(), 1.0));
      RemapEntry& entry = table_[static_cast<std::size_t>(v * kRectifiedSize + u)];
      entry = {};
      if (!pixel) continue;
      const Eigen::Vector2d& at = *pixel;
      const double fu = std::floor(at.x());
      const double fv = std::floor(at.y());
      // Written so that what is no number lies outside.
      if (!(fu >= 0.0 && fv >= 0.0 && fu <= lens.width_px - 2 && fv <= lens.height_px - 2))
        continue;
      // Kernels must not read behind the frame.
      if (fv > lens.height_px - 3 && fu > lens.width_px - kRemapReads) continue;
      entry.u = static_cast<std::uint16_t>(fu);
      entry.v = static_cast<std::uint16_t>(fv);
      entry.weight_u = static_cast<std::uint8_t>(std::lround((at.x() - fu) * 128.0));
      entry.weight_v = static_cast<std::uint8_t>(std::lround((at.y() - fv) * 128.0));
      entry.inside = 1;
    }
  }
}

void Rectifier::apply(const ImageView& frame, const MutableImageView& out) const {
  if (!fits(frame)) return;
  const auto remap = image_kernels().remap;
  for (int v = 0; v < out.height; ++v) {
    remap(frame.data, frame.stride, table_.data() + static_cast<std::ptrdiff_t>(v) * out.width,
          out.width, out.row(v));
  }
}

bool Rectifier::sees(int u, int v, int margin_px) const {
  const int lo_u = u - margin_px;
  const int hi_u = u + margin_px;
  const int lo_v = v - margin_px;
  const int hi_v = v + margin_px;
  if (lo_u < 0 || lo_v < 0 || hi_u >= kRectifiedSize || hi_v >= kRectifiedSize) return false;
  const auto inside = [this](int uu, int vv) {
    return table_[static_cast<std::size_t>(vv * kRectifiedSize + uu)].inside != 0;
  };
  // What the lens sees is nearly convex here (barrel distortion hollows its edges a little), so the
  // corners of the square and the middles of its sides tell.
  return inside(lo_u, lo_v) && inside(hi_u, lo_v) && inside(lo_u, hi_v) && inside(hi_u, hi_v) &&
         inside(u, lo_v) && inside(u, hi_v) && inside(lo_u, v) && inside(hi_u, v);
}

}  // namespace zenith
