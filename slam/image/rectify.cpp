#include "slam/image/rectify.h"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

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
  const Eigen::Matrix3d R_camera_base = mount_rotation(mount).transpose();
  for (int v = 0; v < kRectifiedSize; ++v) {
    for (int u = 0; u < kRectifiedSize; ++u) {
      const Eigen::Vector2d m = pinhole.normalise(u, v);
      const Eigen::Vector2d at = lens.project(R_camera_base * Eigen::Vector3d(m.x(), m.y(), 1.0));
      RemapEntry& entry = table_[static_cast<std::size_t>(v * kRectifiedSize + u)];
      entry = {};
      const double fu = std::floor(at.x());
      const double fv = std::floor(at.y());
      if (fu < 0.0 || fv < 0.0 || fu > lens.width_px - 2 || fv > lens.height_px - 2) continue;
      entry.offset = static_cast<std::uint32_t>(fv) * static_cast<std::uint32_t>(lens.width_px) +
                     static_cast<std::uint32_t>(fu);
      entry.weight_u = static_cast<std::uint8_t>(std::lround((at.x() - fu) * 128.0));
      entry.weight_v = static_cast<std::uint8_t>(std::lround((at.y() - fv) * 128.0));
      entry.inside = 1;
    }
  }
}

void Rectifier::apply(const ImageView& frame, const MutableImageView& out) const {
  assert(frame.width == frame_width_);
  remap_bilinear(frame, frame_width_, table_, out);
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
  // What the lens sees is convex here, so the corners of the square tell.
  return inside(lo_u, lo_v) && inside(hi_u, lo_v) && inside(lo_u, hi_v) && inside(hi_u, hi_v);
}

void remap_bilinear(const ImageView& frame, int frame_width, std::span<const RemapEntry> table,
                    const MutableImageView& out) {
  const bool dense = frame.stride == frame_width;
  const auto stride = static_cast<std::size_t>(frame.stride);
  for (int v = 0; v < out.height; ++v) {
    const RemapEntry* entries = table.data() + static_cast<std::ptrdiff_t>(v) * out.width;
    std::uint8_t* row = out.row(v);
    for (int u = 0; u < out.width; ++u) {
      const RemapEntry& e = entries[u];
      std::size_t offset = e.offset;
      if (!dense) {
        const auto w = static_cast<std::size_t>(frame_width);
        offset = offset / w * stride + offset % w;
      }
      const std::uint8_t* p = frame.data + (e.inside != 0 ? offset : 0);
      const int wu = e.weight_u;
      const int wv = e.weight_v;
      const int top = p[0] * (128 - wu) + p[1] * wu;
      const int bottom = p[stride] * (128 - wu) + p[stride + 1] * wu;
      const int value = (top * (128 - wv) + bottom * wv + 8192) >> 14;
      row[u] = static_cast<std::uint8_t>(e.inside != 0 ? value : 0);
    }
  }
}

}  // namespace zenith
