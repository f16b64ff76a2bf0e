#include "slam/closing_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "platform/base/fixed_vector.h"

namespace zenith {
namespace {

constexpr double kCell_px = 3.0;
constexpr int kHalfCells = 12;
constexpr int kCells = 2 * kHalfCells + 1;
constexpr double kTurn_rad = std::numbers::pi / 180.0;
constexpr int kHalfTurns = 10;
constexpr int kTurns = 2 * kHalfTurns + 1;
constexpr int kSuppressed = 2;  // cells to each side of a peak that was taken
constexpr float kLeastVotes = 3.0F;
constexpr int kSimilar = 4;  // corners that one landmark votes for
constexpr float kMaxTurn_rad = 0.6F;

struct Similar {
  float ncc = 0.0F;
  const Feature* corner = nullptr;
};
using SimilarCorners = FixedVector<Similar, kSimilar>;

void add_similar(const Similar& one, SimilarCorners& all) {
  if (all.push_back(one)) return;
  auto* least = std::min_element(all.begin(), all.end(),
                                 [](const Similar& a, const Similar& b) { return a.ncc < b.ncc; });
  if (least->ncc < one.ncc) *least = one;
}

}  // namespace

Eigen::Vector2d lever_of(const Candidate& c) {
  const double rho = -c.G(0, 0);
  return {(-c.G(1, 2) - c.m.x()) / rho, (c.G(0, 2) - c.m.y()) / rho};
}

void ClosingVotes::layout(Arena& arena) {
  grid_ = arena.take<float>(static_cast<std::size_t>(kTurns) * kCells * kCells);
}

void ClosingVotes::build(double pixel, float ncc_min) {
  pixel_ = pixel;
  ncc_min_ = ncc_min;
}

float& ClosingVotes::at(int turn, int y, int x) {
  return grid_[static_cast<std::size_t>((turn * kCells + y) * kCells + x)];
}

float ClosingVotes::around(int turn, int y, int x) {
  float sum = 0.0F;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) sum += at(turn, y + dy, x + dx);
  }
  return sum;
}

void ClosingVotes::begin(double rho, double most_turn_rad) {
  std::fill(grid_.begin(), grid_.end(), 0.0F);
  cell_m_ = kCell_px * pixel_ / rho;
  turns_ = static_cast<int>(std::min(most_turn_rad / kTurn_rad, static_cast<double>(kHalfTurns)));
}

// A landmark that looks like many corners says little about each of them.
void ClosingVotes::add(const Candidate& landmark, const Map& map, std::span<const Feature> features,
                       double heading_rad) {
  const double reach = kHalfCells * kCell_px * pixel_;
  SimilarCorners similar;
  for (const Feature& f : features) {
    if (!f.described) continue;
    if ((Eigen::Vector2d(f.zx, f.zy) - landmark.m).squaredNorm() > reach * reach) continue;
    const auto direction =
        static_cast<float>(wrap_angle(heading_rad + static_cast<double>(f.orientation_rad)));
    const float ncc = map.best_ncc(landmark.slot, f.patch, direction, kMaxTurn_rad);
    if (ncc >= ncc_min_) add_similar({ncc, &f}, similar);
  }
  const double rho = -landmark.G(0, 0);
  const Eigen::Vector2d lever = lever_of(landmark);
  if (similar.empty()) return;
  const float weight = 1.0F / std::sqrt(static_cast<float>(similar.size()));
  for (int turn = -turns_; turn <= turns_; ++turn) {
    const Eigen::Matrix2d R = rotation(turn * kTurn_rad);
    for (const Similar& s : similar) {
      const Eigen::Vector2d z(s.corner->zx, s.corner->zy);
      const Eigen::Vector2d t = (landmark.m - R * z) / rho - (R * lever - lever);
      const double x = std::round(t.x() / cell_m_);
      const double y = std::round(t.y() / cell_m_);
      if (!(std::abs(x) <= kHalfCells && std::abs(y) <= kHalfCells)) continue;
      at(turn + kHalfTurns, static_cast<int>(y) + kHalfCells, static_cast<int>(x) + kHalfCells) +=
          weight;
    }
  }
}

bool ClosingVotes::take_peak(Pose2& jump) {
  float most = 0.0F;
  std::array<int, 3> peak = {};
  for (int turn = kHalfTurns - turns_; turn <= kHalfTurns + turns_; ++turn) {
    for (int y = 1; y + 1 < kCells; ++y) {
      for (int x = 1; x + 1 < kCells; ++x) {
        const float votes = around(turn, y, x);
        if (votes <= most) continue;
        most = votes;
        peak = {turn, y, x};
      }
    }
  }
  if (most < kLeastVotes) return false;
  const auto [turn, y, x] = peak;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto share = static_cast<double>(at(turn, y + dy, x + dx) / most);
      centre += share * Eigen::Vector2d(x + dx - kHalfCells, y + dy - kHalfCells);
    }
  }
  jump = {centre.x() * cell_m_, centre.y() * cell_m_, (turn - kHalfTurns) * kTurn_rad};
  for (int k = std::max(turn - kSuppressed, 0); k <= std::min(turn + kSuppressed, kTurns - 1);
       ++k) {
    for (int v = std::max(y - kSuppressed, 0); v <= std::min(y + kSuppressed, kCells - 1); ++v) {
      for (int u = std::max(x - kSuppressed, 0); u <= std::min(x + kSuppressed, kCells - 1); ++u) {
        at(k, v, u) = 0.0F;
      }
    }
  }
  return true;
}

}  // namespace zenith
