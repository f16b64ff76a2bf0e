#include "sim/renderer.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace zenith::sim {
namespace {

struct Sample {
  float u;
  float v;
  float time;  // in exposures, from its middle
};

// A rotated grid; times, columns and rows are all stratified.
constexpr std::array<Sample, 4> kInside = {{{-0.125F, -0.375F, 0.125F},
                                            {0.375F, -0.125F, -0.125F},
                                            {0.125F, 0.375F, -0.375F},
                                            {-0.375F, 0.125F, 0.375F}}};
constexpr std::array<Sample, 8> kEdge = {{{-0.4375F, -0.0625F, 0.3125F},
                                          {-0.3125F, 0.3125F, -0.1875F},
                                          {-0.1875F, -0.3125F, -0.4375F},
                                          {-0.0625F, 0.0625F, 0.0625F},
                                          {0.0625F, 0.4375F, 0.4375F},
                                          {0.1875F, -0.4375F, 0.1875F},
                                          {0.3125F, 0.1875F, -0.3125F},
                                          {0.4375F, -0.1875F, -0.0625F}}};

constexpr int kMaxAround = 9;

// log2 with straight lines between powers of two; exact there and at most 0.09 below elsewhere.
float rough_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<float>(bits) * (1.0F / 8388608.0F) - 127.0F;
}

struct Vec {
  float x, y, z;
};

// The plane's coordinates of a vector: (normal, a, b).
Vec in_plane(const Vec& v, int axis) {
  if (axis == 2) return {v.z, v.x, v.y};
  if (axis == 0) return {v.x, v.y, v.z};
  return {v.y, v.x, v.z};
}

int clamped_level(float level) {
  return level <= 0.0F ? 0 : std::min(static_cast<int>(level), kMipLevels - 1);
}

bool covers(const FloorPlan& plan, const Facet& facet, float a, float b) {
  if (a < facet.a0 || a > facet.a1 || b < facet.b0 || b > facet.b1) return false;
  const Hole* holes = plan.holes(facet);
  for (std::uint32_t i = 0; i < facet.hole_count; ++i) {
    const Hole& hole = holes[i];
    if (a > hole.a0 && a < hole.a1 && b > hole.b0 && b < hole.b1) return false;
  }
  return true;
}

}  // namespace

struct Renderer::Eye {
  Vec position;
  Vec motion;  // over the exposure
  float turn;  // over the exposure, radians
  float cos_yaw;
  float sin_yaw;

  Vec rotated(const float (&d)[3]) const {
    return {cos_yaw * d[0] - sin_yaw * d[1], sin_yaw * d[0] + cos_yaw * d[1], d[2]};
  }
  // How the ray changes over the exposure.
  Vec swing(const Vec& d) const { return {-turn * d.y, turn * d.x, 0.0F}; }
};

Renderer::Renderer(const FloorPlan& plan, const Scene& scene, const Camera& camera)
    : plan_(plan), scene_(scene), camera_(camera) {
  facets_.assign(static_cast<std::size_t>(camera.width() + 2) * (camera.height() + 2), kNoFacet);
  radiance_.assign(static_cast<std::size_t>(camera.width()) * camera.height(), 0.0F);
}

const std::vector<float>& Renderer::render(const CameraMotion& motion) {
  const auto f = [](double v) { return static_cast<float>(v); };
  skyline_.look(plan_, motion.x_m, motion.y_m, motion.z_m, camera_.min_slope());
  find_facets(motion.yaw_rad);
  const Eye eye = {{f(motion.x_m), f(motion.y_m), f(motion.z_m)},
                   {f(motion.dx_m), f(motion.dy_m), 0.0F},
                   f(motion.dyaw_rad),
                   f(std::cos(motion.yaw_rad)),
                   f(std::sin(motion.yaw_rad))};
  for (int row = 0; row < camera_.height(); ++row) shade_row(eye, row);
  return radiance_;
}

void Renderer::find_facets(double yaw_rad) {
  const double turns = yaw_rad / (2.0 * std::numbers::pi);
  const auto turn = static_cast<float>(turns - std::floor(turns));
  for (int row = 0; row < camera_.height(); ++row) {
    const PixelSpan& span = camera_.span(row);
    const PixelRay* ray = camera_.rays(span);
    FacetId* out = facets_.data() + static_cast<std::size_t>(row + 1) * (camera_.width() + 2) + 1;
    for (int u = span.first; u < span.last; ++u, ++ray) {
      out[u] = skyline_.facet(ray->turn + turn, ray->slope);
    }
  }
}

void Renderer::shade_row(const Eye& eye, int row) {
  const PixelSpan& span = camera_.span(row);
  const PixelRay* ray = camera_.rays(span);
  const int stride = camera_.width() + 2;
  const FacetId* at = facets_.data() + static_cast<std::size_t>(row + 1) * stride + 1 + span.first;
  float* out = radiance_.data() + static_cast<std::size_t>(row) * camera_.width();
  const std::array<int, 8> neighbours = {-stride - 1, -stride,    -stride + 1, -1,
                                         1,           stride - 1, stride,      stride + 1};
  for (int u = span.first; u < span.last; ++u, ++ray, ++at) {
    std::array<FacetId, kMaxAround> around = {*at};
    int count = 1;
    for (const int step : neighbours) {
      const FacetId id = at[step];
      if (id == *at || id == kNoFacet) continue;
      bool known = false;
      for (int i = 1; i < count; ++i) known = known || around[static_cast<std::size_t>(i)] == id;
      if (!known) around[static_cast<std::size_t>(count++)] = id;
    }
    const float value =
        count == 1 ? shade_inside(eye, *ray, *at) : shade_edge(eye, *ray, around.data(), count);
    out[u] = value * ray->gain;
  }
}

// P = C + t d with t = (plane - C_n) / d_n; its derivative along a change (dC, dd) of eye and ray
// is dC + t dd - d (dC_n + t dd_n) / d_n.
float Renderer::shade_inside(const Eye& eye, const PixelRay& ray, FacetId id) const {
  const Facet& facet = plan_.facets()[id];
  const Texture& texture = scene_.texture(id);
  const Vec world = eye.rotated(ray.d);
  const Vec c = in_plane(eye.position, facet.axis);
  const Vec d = in_plane(world, facet.axis);
  const Vec du = in_plane(eye.rotated(ray.d_u), facet.axis);
  const Vec dv = in_plane(eye.rotated(ray.d_v), facet.axis);
  const Vec dt = in_plane(eye.swing(world), facet.axis);
  const Vec dc = in_plane(eye.motion, facet.axis);
  const float scale = texture.texels_per_m();
  const float inverse = 1.0F / d.x;
  const float t = (facet.offset - c.x) * inverse;
  const float ts = t * scale;
  const float slope_a = d.y * inverse;
  const float slope_b = d.z * inverse;
  const float a = (c.y + t * d.y - facet.a0) * scale;
  const float b = (c.z + t * d.z - facet.b0) * scale;
  const float a_u = ts * (du.y - slope_a * du.x);
  const float b_u = ts * (du.z - slope_b * du.x);
  const float a_v = ts * (dv.y - slope_a * dv.x);
  const float b_v = ts * (dv.z - slope_b * dv.x);
  const float a_t = ts * (dt.y - slope_a * dt.x) + scale * (dc.y - slope_a * dc.x);
  const float b_t = ts * (dt.z - slope_b * dt.x) + scale * (dc.z - slope_b * dc.x);
  // Half a pixel's footprint in texels; its fraction between two levels is dithered.
  const float foot2 = 0.125F * (a_u * a_u + b_u * b_u + a_v * a_v + b_v * b_v);
  float level = 0.5F * rough_log2(foot2 + 1e-6F);
  float sum = 0.0F;
  for (const Sample& s : kInside) {
    level += 0.25F;
    sum += texture.at(clamped_level(level), a + s.u * a_u + s.v * a_v + s.time * a_t,
                      b + s.u * b_u + s.v * b_v + s.time * b_t);
  }
  return 0.25F * sum;
}

float Renderer::shade_edge(const Eye& eye, const PixelRay& ray, const FacetId* around,
                           int count) const {
  const Vec d0 = eye.rotated(ray.d);
  const Vec du = eye.rotated(ray.d_u);
  const Vec dv = eye.rotated(ray.d_v);
  const Vec swing = eye.swing(d0);
  const float pixel = std::sqrt(du.x * du.x + du.y * du.y + du.z * du.z);
  float sum = 0.0F;
  for (const Sample& s : kEdge) {
    const Vec d = {d0.x + s.u * du.x + s.v * dv.x + s.time * swing.x,
                   d0.y + s.u * du.y + s.v * dv.y + s.time * swing.y,
                   d0.z + s.u * du.z + s.v * dv.z + s.time * swing.z};
    const Vec origin = {eye.position.x + s.time * eye.motion.x,
                        eye.position.y + s.time * eye.motion.y, eye.position.z};
    float nearest = std::numeric_limits<float>::infinity();
    FacetId hit = around[0];
    float hit_a = 0.0F;
    float hit_b = 0.0F;
    for (int i = 0; i < count; ++i) {
      const Facet& facet = plan_.facets()[around[i]];
      const Vec c = in_plane(origin, facet.axis);
      const Vec q = in_plane(d, facet.axis);
      const float t = (facet.offset - c.x) / q.x;
      const float a = c.y + t * q.y;
      const float b = c.z + t * q.z;
      const bool on = t > 0.0F && t < nearest && covers(plan_, facet, a, b);
      // The first one stands in for a hit that none of them has.
      if (on || i == 0) {
        nearest = on ? t : nearest;
        hit = around[i];
        hit_a = a - facet.a0;
        hit_b = b - facet.b0;
      }
    }
    const Texture& texture = scene_.texture(hit);
    const float scale = texture.texels_per_m();
    const Facet& facet = plan_.facets()[hit];
    const Vec q = in_plane(d, facet.axis);
    const float t = std::abs((facet.offset - in_plane(origin, facet.axis).x) / q.x);
    // Footprint of a pixel's third, stretched by half of the slant's stretch.
    const float foot = 0.33F * pixel * t * scale / std::sqrt(std::abs(q.x) + 1e-3F);
    const int level = clamped_level(rough_log2(foot + 1e-6F) + 0.5F);
    sum += texture.at(level, hit_a * scale, hit_b * scale);
  }
  return 0.125F * sum;
}

}  // namespace zenith::sim
