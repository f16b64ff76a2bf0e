#include "tests/support/image_matching.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "slam/geometry.h"
#include "slam/image/corners.h"
#include "slam/image/ncc.h"

namespace zenith {
namespace {

struct AlignedBytes {
  explicit AlignedBytes(std::size_t size) : bytes(size + Arena::kAlignment) {}
  std::span<std::byte> block(std::size_t size) {
    void* start = bytes.data();
    std::size_t space = bytes.size();
    std::align(Arena::kAlignment, size, start, space);
    return {static_cast<std::byte*>(start), size};
  }
  std::vector<std::byte> bytes;
};

// The best of `others` for one corner, and how far it leads the second best.
struct Best {
  int index = -1;
  double ncc = -1.0;
  double lead = 0.0;
};

Best best_match(const DescribedCorner& corner, const std::vector<DescribedCorner>& others,
                double radius) {
  Best best;
  double second = -1.0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (radius > 0.0 && (others[i].place - corner.place).norm() > radius) continue;
    const auto similarity = static_cast<double>(ncc(corner.patch, others[i].patch));
    if (similarity > best.ncc) {
      second = best.ncc;
      best.ncc = similarity;
      best.index = static_cast<int>(i);
    } else {
      second = std::max(second, similarity);
    }
  }
  best.lead = best.ncc - second;
  return best;
}

// Closed form over the given pairs (Umeyama 1991 in the plane).
SimilarityFit fit_pairs(const std::vector<DescribedCorner>& a,
                        const std::vector<DescribedCorner>& b, const std::vector<IndexPair>& pairs,
                        bool with_scale) {
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_b = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(pairs.size());
  for (const IndexPair& pair : pairs) {
    mean_a += a[static_cast<std::size_t>(pair.a)].place / n;
    mean_b += b[static_cast<std::size_t>(pair.b)].place / n;
  }
  double dot = 0.0;
  double cross = 0.0;
  double squares = 0.0;
  for (const IndexPair& pair : pairs) {
    const Eigen::Vector2d p = a[static_cast<std::size_t>(pair.a)].place - mean_a;
    const Eigen::Vector2d q = b[static_cast<std::size_t>(pair.b)].place - mean_b;
    dot += p.dot(q);
    cross += p.x() * q.y() - p.y() * q.x();
    squares += p.squaredNorm();
  }
  SimilarityFit fit;
  fit.theta_rad = std::atan2(cross, dot);
  if (with_scale && squares > 0.0) fit.scale = std::hypot(dot, cross) / squares;
  fit.translation = mean_b - fit.scale * (rotation(fit.theta_rad) * mean_a);
  return fit;
}

bool agrees(const SimilarityFit& fit, const DescribedCorner& a, const DescribedCorner& b,
            const SimilaritySettings& settings) {
  if ((fit * a.place - b.place).norm() > settings.tolerance) return false;
  if (settings.max_turn_rad <= 0.0) return true;
  const double turn = b.orientation_rad - a.orientation_rad - fit.theta_rad;
  return std::abs(wrap_angle(turn)) <= settings.max_turn_rad;
}

void collect_inliers(const std::vector<DescribedCorner>& a, const std::vector<DescribedCorner>& b,
                     const std::vector<IndexPair>& pairs, const SimilaritySettings& settings,
                     SimilarityFit& fit) {
  double squares = 0.0;
  for (const IndexPair& pair : pairs) {
    const DescribedCorner& p = a[static_cast<std::size_t>(pair.a)];
    const DescribedCorner& q = b[static_cast<std::size_t>(pair.b)];
    if (!agrees(fit, p, q, settings)) continue;
    fit.inliers.push_back(pair);
    squares += (fit * p.place - q.place).squaredNorm();
  }
  if (fit.inliers.empty()) return;
  fit.rms = std::sqrt(squares / static_cast<double>(fit.inliers.size()));
}

}  // namespace

Eigen::Vector2d SimilarityFit::operator*(const Eigen::Vector2d& p) const {
  return scale * (rotation(theta_rad) * p) + translation;
}

std::vector<DescribedCorner> describe_image(const ImageView& image) {
  CornerDetector detector;
  Arena counting;
  detector.layout(counting);
  AlignedBytes memory(counting.used());
  Arena arena(memory.block(counting.used()));
  detector.layout(arena);
  Corners corners;
  detector.detect(image, CornerSettings{}, corners);

  std::vector<DescribedCorner> described;
  for (const Corner& corner : corners) {
    const float orientation = patch_orientation(image, corner.u_px, corner.v_px);
    const Patch patch = sample_patch(image, corner.u_px, corner.v_px, orientation);
    if (patch.inverse_norm <= 0.0F) continue;
    described.push_back({{corner.u_px, corner.v_px}, orientation, patch});
  }
  return described;
}

std::vector<IndexPair> match_corners(const std::vector<DescribedCorner>& a,
                                     const std::vector<DescribedCorner>& b,
                                     const MatchSettings& settings) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Best there = best_match(a[i], b, settings.radius);
    if (there.index < 0 || there.ncc < settings.ncc_min || there.lead < settings.lead) continue;
    const Best back = best_match(b[static_cast<std::size_t>(there.index)], a, settings.radius);
    if (back.index != static_cast<int>(i)) continue;
    pairs.push_back({static_cast<int>(i), there.index});
  }
  return pairs;
}

SimilarityFit find_similarity(const std::vector<DescribedCorner>& a,
                              const std::vector<DescribedCorner>& b,
                              const std::vector<IndexPair>& pairs,
                              const SimilaritySettings& settings, Random& random) {
  SimilarityFit best;
  if (pairs.size() < 2) return best;
  const auto count = static_cast<std::uint32_t>(pairs.size());
  for (int trial = 0; trial < settings.trials; ++trial) {
    const IndexPair first = pairs[random.below(count)];
    const IndexPair second = pairs[random.below(count)];
    if (first.a == second.a) continue;
    SimilarityFit fit = fit_pairs(a, b, {first, second}, settings.with_scale);
    if (fit.scale > settings.max_scale || fit.scale * settings.max_scale < 1.0) continue;
    collect_inliers(a, b, pairs, settings, fit);
    if (fit.inliers.size() > best.inliers.size()) best = fit;
  }
  if (best.inliers.size() < 2) return best;
  SimilarityFit refined = fit_pairs(a, b, best.inliers, settings.with_scale);
  collect_inliers(a, b, pairs, settings, refined);
  return refined.inliers.size() >= best.inliers.size() ? refined : best;
}

}  // namespace zenith
