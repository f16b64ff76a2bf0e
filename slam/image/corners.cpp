#include "slam/image/corners.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace zenith {
namespace {

constexpr int kN = kRectifiedSize;
constexpr int kMaxPeaks = 8192;
constexpr float kHarrisK = 0.04F;
constexpr int kCell = 32;
constexpr int kCells = (kN + kCell - 1) / kCell;
constexpr std::array<float, 7> kWindow = {1.0F / 64,  6.0F / 64, 15.0F / 64, 20.0F / 64,
                                          15.0F / 64, 6.0F / 64, 1.0F / 64};

// Products of the gradients into three planes; the outermost pixels stay 0.
void gradient_products(const ImageView& image, float* xx, float* xy, float* yy) {
  for (int v = 1; v < kN - 1; ++v) {
    const std::uint8_t* a = image.row(v - 1);
    const std::uint8_t* b = image.row(v);
    const std::uint8_t* c = image.row(v + 1);
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(v) * kN;
    for (int u = 1; u < kN - 1; ++u) {
      const int gx =
          3 * (a[u + 1] - a[u - 1]) + 10 * (b[u + 1] - b[u - 1]) + 3 * (c[u + 1] - c[u - 1]);
      const int gy = 3 * (c[u - 1] - a[u - 1]) + 10 * (c[u] - a[u]) + 3 * (c[u + 1] - a[u + 1]);
      const float fx = static_cast<float>(gx) * (1.0F / 32);
      const float fy = static_cast<float>(gy) * (1.0F / 32);
      xx[o + u] = fx * fx;
      xy[o + u] = fx * fy;
      yy[o + u] = fy * fy;
    }
  }
}

// The window along rows, then along columns, in place; `line` holds seven rows.
void smooth_plane(float* plane, float* line) {
  for (int v = 0; v < kN; ++v) {
    float* row = plane + static_cast<std::ptrdiff_t>(v) * kN;
    std::copy(row, row + kN, line);
    for (int u = 3; u < kN - 3; ++u) {
      row[u] = kWindow[0] * (line[u - 3] + line[u + 3]) + kWindow[1] * (line[u - 2] + line[u + 2]) +
               kWindow[2] * (line[u - 1] + line[u + 1]) + kWindow[3] * line[u];
    }
  }
  // Rows above the one in work are already replaced, so their originals are kept in a ring.
  const auto kept = [line](int v) { return line + static_cast<std::ptrdiff_t>(v % 4) * kN; };
  for (int v = 0; v < 3; ++v) std::copy_n(plane + static_cast<std::ptrdiff_t>(v) * kN, kN, kept(v));
  for (int v = 3; v < kN - 3; ++v) {
    float* row = plane + static_cast<std::ptrdiff_t>(v) * kN;
    std::copy_n(row, kN, kept(v));
    const float* m3 = kept(v - 3);
    const float* m2 = kept(v - 2);
    const float* m1 = kept(v - 1);
    const float* m0 = kept(v);
    for (int u = 0; u < kN; ++u) {
      row[u] = kWindow[0] * (m3[u] + row[u + 3 * kN]) + kWindow[1] * (m2[u] + row[u + 2 * kN]) +
               kWindow[2] * (m1[u] + row[u + kN]) + kWindow[3] * m0[u];
    }
  }
}

}  // namespace

void harris_response(const ImageView& image, double min_eigenvalue, std::span<float> response,
                     std::span<float> scratch) {
  assert(image.width == kN && image.height == kN);
  assert(scratch.size() >= 3 * kN * kN);
  float* xx = scratch.data();
  float* xy = xx + kN * kN;
  float* yy = xy + kN * kN;
  gradient_products(image, xx, xy, yy);
  smooth_plane(xx, response.data());
  smooth_plane(xy, response.data());
  smooth_plane(yy, response.data());
  const auto floor = static_cast<float>(min_eigenvalue);
  for (int i = 0; i < kN * kN; ++i) {
    const float a = xx[i];
    const float b = xy[i];
    const float c = yy[i];
    const float r = a * c - b * b - kHarrisK * (a + c) * (a + c);
    // Smaller eigenvalue >= floor, written without the root: det(A - floor I) >= 0, tr >= 2 floor.
    const bool strong = (a - floor) * (c - floor) - b * b >= 0.0F && a + c >= 2.0F * floor;
    response[i] = strong && r > 0.0F ? r : 0.0F;
  }
}

void CornerDetector::layout(Arena& arena) {
  response_ = arena.take<float>(kN * kN);
  scratch_ = arena.take<float>(3 * kN * kN);
  peaks_ = arena.take<Corner>(kMaxPeaks);
}

// Local maxima of 3 x 3, each refined by the quadratic through its neighbours.
void CornerDetector::collect_peaks(int border_px) {
  peak_count_ = 0;
  for (int v = border_px; v < kN - border_px; ++v) {
    const float* r = response_.data() + static_cast<std::ptrdiff_t>(v) * kN;
    for (int u = border_px; u < kN - border_px; ++u) {
      const float m = r[u];
      if (m <= 0.0F) continue;
      if (m < r[u - 1] || m <= r[u + 1] || m < r[u - kN] || m <= r[u + kN]) continue;
      if (m < r[u - kN - 1] || m < r[u - kN + 1] || m <= r[u + kN - 1] || m <= r[u + kN + 1]) {
        continue;
      }
      if (peak_count_ == peaks_.size()) return;
      const float dx = 0.5F * (r[u + 1] - r[u - 1]);
      const float dy = 0.5F * (r[u + kN] - r[u - kN]);
      const float dxx = r[u + 1] - 2.0F * m + r[u - 1];
      const float dyy = r[u + kN] - 2.0F * m + r[u - kN];
      const float dxy = 0.25F * (r[u + kN + 1] - r[u + kN - 1] - r[u - kN + 1] + r[u - kN - 1]);
      const float det = dxx * dyy - dxy * dxy;
      float su = 0.0F;
      float sv = 0.0F;
      if (det > 1e-12F * m * m) {
        su = std::clamp(-(dyy * dx - dxy * dy) / det, -0.75F, 0.75F);
        sv = std::clamp(-(dxx * dy - dxy * dx) / det, -0.75F, 0.75F);
      }
      peaks_[peak_count_++] = {static_cast<float>(u) + su, static_cast<float>(v) + sv, m};
    }
  }
}

bool CornerDetector::take(const Corner& peak, const CornerSettings& settings,
                          Corners& corners) const {
  const auto d2 = static_cast<float>(settings.min_distance_px * settings.min_distance_px);
  for (const Corner& other : corners) {
    const float du = other.u_px - peak.u_px;
    const float dv = other.v_px - peak.v_px;
    if (du * du + dv * dv < d2) return false;
  }
  return corners.push_back(peak);
}

void CornerDetector::detect(const ImageView& image, const CornerSettings& settings,
                            Corners& corners) {
  corners.clear();
  harris_response(image, settings.min_eigenvalue, response_, scratch_);
  collect_peaks(settings.border_px);
  std::sort(peaks_.begin(), peaks_.begin() + static_cast<std::ptrdiff_t>(peak_count_),
            [](const Corner& a, const Corner& b) {
              if (a.response != b.response) return a.response > b.response;
              return a.v_px != b.v_px ? a.v_px < b.v_px : a.u_px < b.u_px;
            });
  std::array<int, kCells* kCells> in_cell = {};
  const auto limit = static_cast<std::size_t>(std::min(settings.max_corners, kMaxCorners));
  for (std::size_t i = 0; i < peak_count_ && corners.size() < limit; ++i) {
    const Corner& peak = peaks_[i];
    int& used = in_cell[static_cast<std::size_t>(static_cast<int>(peak.v_px) / kCell * kCells +
                                                 static_cast<int>(peak.u_px) / kCell)];
    if (used >= settings.per_cell) continue;
    if (take(peak, settings, corners)) ++used;
  }
}

}  // namespace zenith
