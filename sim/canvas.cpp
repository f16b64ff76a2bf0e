#include "sim/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace zenith::sim {

Canvas::Canvas(double width_m, double height_m, double texel_m, double value)
    : width_m_(width_m),
      height_m_(height_m),
      texel_m_(texel_m),
      columns_(std::max(1, static_cast<int>(std::ceil(width_m / texel_m - 1e-6)))),
      rows_(std::max(1, static_cast<int>(std::ceil(height_m / texel_m - 1e-6)))),
      values_(static_cast<std::size_t>(columns_) * rows_, static_cast<float>(value)) {}

template <typename Coverage>
void Canvas::cover(double x0, double y0, double x1, double y1, const Ink& ink, Coverage coverage) {
  const int i0 = std::max(0, static_cast<int>(std::floor(x0 / texel_m_)));
  const int j0 = std::max(0, static_cast<int>(std::floor(y0 / texel_m_)));
  const int i1 = std::min(columns_, static_cast<int>(std::ceil(x1 / texel_m_)));
  const int j1 = std::min(rows_, static_cast<int>(std::ceil(y1 / texel_m_)));
  for (int j = j0; j < j1; ++j) {
    float* values = row(j);
    const double y = (j + 0.5) * texel_m_;
    for (int i = i0; i < i1; ++i) {
      const auto c = static_cast<float>(coverage((i + 0.5) * texel_m_, y)) * ink.alpha;
      values[i] = ink.multiply ? values[i] * (1.0F + c * (ink.value - 1.0F))
                               : values[i] + c * (ink.value - values[i]);
    }
  }
}

namespace {

// The part of a texel centred at `x` that lies in [x0, x1].
double overlap(double x, double texel, double x0, double x1) {
  const double low = std::max(x - 0.5 * texel, x0);
  const double high = std::min(x + 0.5 * texel, x1);
  return std::max(0.0, high - low) / texel;
}

double edge_coverage(double inside_m, double texel) {
  return std::clamp(inside_m / texel + 0.5, 0.0, 1.0);
}

}  // namespace

void Canvas::rect(const Rect& r, const Ink& ink) {
  cover(r.x0, r.y0, r.x1, r.y1, ink, [&](double x, double y) {
    return overlap(x, texel_m_, r.x0, r.x1) * overlap(y, texel_m_, r.y0, r.y1);
  });
}

void Canvas::frame(const Rect& r, double line_m, const Ink& ink) {
  const double w = line_m;
  rect({r.x0, r.y0, r.x1, r.y0 + w}, ink);
  rect({r.x0, r.y1 - w, r.x1, r.y1}, ink);
  rect({r.x0, r.y0 + w, r.x0 + w, r.y1 - w}, ink);
  rect({r.x1 - w, r.y0 + w, r.x1, r.y1 - w}, ink);
}

void Canvas::disc(double x, double y, double radius_m, const Ink& ink) {
  const double r = radius_m + texel_m_;
  cover(x - r, y - r, x + r, y + r, ink, [&](double px, double py) {
    return edge_coverage(radius_m - std::hypot(px - x, py - y), texel_m_);
  });
}

void Canvas::ring(double x, double y, double radius_m, double line_m, const Ink& ink) {
  const double r = radius_m + line_m + texel_m_;
  const double thin = std::min(1.0, line_m / texel_m_);
  cover(x - r, y - r, x + r, y + r, ink, [&](double px, double py) {
    const double d = std::abs(std::hypot(px - x, py - y) - radius_m);
    return thin * edge_coverage(std::max(0.5 * line_m, 0.5 * texel_m_) - d, texel_m_);
  });
}

void Canvas::line(double x0, double y0, double x1, double y1, double line_m, const Ink& ink) {
  const double r = line_m + texel_m_;
  const double dx = x1 - x0;
  const double dy = y1 - y0;
  const double length2 = std::max(1e-12, dx * dx + dy * dy);
  const double thin = std::min(1.0, line_m / texel_m_);
  cover(std::min(x0, x1) - r, std::min(y0, y1) - r, std::max(x0, x1) + r, std::max(y0, y1) + r, ink,
        [&](double px, double py) {
          const double t = std::clamp(((px - x0) * dx + (py - y0) * dy) / length2, 0.0, 1.0);
          const double ex = px - x0 - t * dx;
          const double ey = py - y0 - t * dy;
          const double d = std::sqrt(ex * ex + ey * ey);
          return thin * edge_coverage(std::max(0.5 * line_m, 0.5 * texel_m_) - d, texel_m_);
        });
}

void Canvas::blob(double x, double y, double radius_m, double softness_m, const Ink& ink,
                  Random& random) {
  std::array<double, 4> amplitude = {};
  std::array<double, 4> phase = {};
  for (std::size_t k = 0; k < 4; ++k) {
    amplitude[k] = random.uniform(-0.22, 0.22) / std::sqrt(1.0 + static_cast<double>(k));
    phase[k] = random.uniform(0.0, 2.0 * std::numbers::pi);
  }
  const double r = 1.7 * radius_m + softness_m;
  const double soft = std::max(softness_m, texel_m_);
  cover(x - r, y - r, x + r, y + r, ink, [&](double px, double py) {
    const double angle = std::atan2(py - y, px - x);
    double edge = radius_m;
    for (std::size_t k = 0; k < 4; ++k) {
      edge += radius_m * amplitude[k] * std::sin((1.0 + static_cast<double>(k)) * angle + phase[k]);
    }
    return edge_coverage(edge - std::hypot(px - x, py - y), soft);
  });
}

void Canvas::mottle(double size_m, double amplitude, Random& random) {
  const double per_texel = texel_m_ / size_m;
  const int nx = static_cast<int>(columns_ * per_texel) + 3;
  const int ny = static_cast<int>(rows_ * per_texel) + 3;
  std::vector<float> lattice(static_cast<std::size_t>(nx) * ny);
  for (float& value : lattice) value = static_cast<float>(random.uniform(-1.0, 1.0) * amplitude);
  const double shift = random.uniform();
  const auto smooth = [](double f) { return static_cast<float>(f * f * (3.0 - 2.0 * f)); };
  std::vector<int> cell(static_cast<std::size_t>(columns_));
  std::vector<float> blend(static_cast<std::size_t>(columns_));
  for (int i = 0; i < columns_; ++i) {
    const double x = i * per_texel + shift;
    cell[static_cast<std::size_t>(i)] = static_cast<int>(x);
    blend[static_cast<std::size_t>(i)] = smooth(x - std::floor(x));
  }
  for (int j = 0; j < rows_; ++j) {
    const double y = j * per_texel + shift;
    const float fy = smooth(y - std::floor(y));
    const float* top = lattice.data() + static_cast<std::size_t>(static_cast<int>(y)) * nx;
    const float* bottom = top + nx;
    float* values = row(j);
    for (int i = 0; i < columns_; ++i) {
      const int c = cell[static_cast<std::size_t>(i)];
      const float fx = blend[static_cast<std::size_t>(i)];
      const float a = top[c] + fx * (top[c + 1] - top[c]);
      const float b = bottom[c] + fx * (bottom[c + 1] - bottom[c]);
      values[i] *= 1.0F + a + fy * (b - a);
    }
  }
}

void Canvas::pores(double depth, Random& random) {
  for (float& value : values_) {
    const auto u = static_cast<float>(random.uniform());
    const float u4 = u * u * u * u;
    value *= 1.0F - static_cast<float>(depth) * u4 * u4;
  }
}

}  // namespace zenith::sim
