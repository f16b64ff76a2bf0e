#include "slam/image/corners.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "slam/kernels/image/image_kernels.h"

namespace zenith {
namespace {

constexpr int kN = kRectifiedSize;
constexpr int kMaxPeaks = 8192;
constexpr int kCell = 32;
constexpr int kCells = (kN + kCell - 1) / kCell;

// Strongest first; a total order, so that corners do not depend on how they are sorted.
bool weaker(const Corner& a, const Corner& b) {
  if (a.response != b.response) return a.response < b.response;
  return a.v_px != b.v_px ? a.v_px > b.v_px : a.u_px > b.u_px;
}

}  // namespace

void CornerDetector::layout(Arena& arena) {
  response_ = arena.take<float>(kN * kN);
  scratch_ = arena.take<float>(harris_scratch(kN));
  places_ = arena.take<std::int32_t>(kMaxPeaks);
  peaks_ = arena.take<Corner>(kMaxPeaks);
}

// Local maxima of 3 x 3, each refined by the quadratic through its neighbours.
void CornerDetector::refine_peaks(int border_px) {
  const int count =
      image_kernels().peaks(response_.data(), kN, border_px, places_.data(), kMaxPeaks);
  peak_count_ = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i < peak_count_; ++i) {
    const float* r = response_.data() + places_[i];
    const float m = r[0];
    const float dx = 0.5F * (r[1] - r[-1]);
    const float dy = 0.5F * (r[kN] - r[-kN]);
    const float dxx = r[1] - 2.0F * m + r[-1];
    const float dyy = r[kN] - 2.0F * m + r[-kN];
    const float dxy = 0.25F * (r[kN + 1] - r[kN - 1] - r[-kN + 1] + r[-kN - 1]);
    const float det = dxx * dyy - dxy * dxy;
    float su = 0.0F;
    float sv = 0.0F;
    if (det > 1e-12F * m * m) {
      su = std::clamp(-(dyy * dx - dxy * dy) / det, -0.75F, 0.75F);
      sv = std::clamp(-(dxx * dy - dxy * dx) / det, -0.75F, 0.75F);
    }
    peaks_[i] = {static_cast<float>(places_[i] % kN) + su, static_cast<float>(places_[i] / kN) + sv,
                 m};
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
  assert(image.width == kN && image.height == kN && settings.border_px >= kHarrisEdge);
  image_kernels().harris(image.data, image.stride, kN, static_cast<float>(settings.min_eigenvalue),
                         response_.data(), scratch_.data());
  refine_peaks(settings.border_px);
  // A heap: of many peaks only some hundred are looked at.
  const auto peaks = peaks_.begin();
  auto end = peaks + static_cast<std::ptrdiff_t>(peak_count_);
  std::make_heap(peaks, end, weaker);
  std::array<int, kCells* kCells> in_cell = {};
  const auto limit = static_cast<std::size_t>(std::min(settings.max_corners, kMaxCorners));
  for (; end != peaks && corners.size() < limit; --end) {
    std::pop_heap(peaks, end, weaker);
    const Corner& peak = *(end - 1);
    int& used = in_cell[static_cast<std::size_t>(static_cast<int>(peak.v_px) / kCell * kCells +
                                                 static_cast<int>(peak.u_px) / kCell)];
    if (used >= settings.per_cell) continue;
    if (take(peak, settings, corners)) ++used;
  }
}

}  // namespace zenith
