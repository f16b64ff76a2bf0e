#include "slam/fleet/hough.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/bounds.h"
#include "slam/fleet/align.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kHeadingBins = 72;
constexpr double kFarthestSeen_m = 1000.0;  // a circle has 60 000 cells then

double bearing(const Eigen::Vector2d& d) {
  return std::atan2(d.y(), d.x());
}

// The difference, brought to within half a period.
Eigen::Vector2d wrapped(Eigen::Vector2d d, double period) {
  d.x() -= period * std::round(d.x() / period);
  d.y() -= period * std::round(d.y() / period);
  return d;
}

// Side lobes of a peak lead to the peak's own place.
bool same_place(const Pose2& a, const Pose2& b) {
  return (a.position() - b.position()).norm() < 0.2 &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < 5.0 * kDegree;
}

// Best landmark for each observed one within `radius_m` of where `T_peer_robot` puts it; each
// landmark of the peer serves once.
int collect_pairs(const OverlapMatches& matches, const Pose2& T_peer_robot, double radius_m,
                  PlaceFix& fix) {
  std::array<float, kMaxCorners> best;
  best.fill(-1.0F);
  fix.peer_slot.fill(-1);
  for (const OverlapMatch& m : matches) {
    const auto i = static_cast<std::size_t>(m.observed);
    const Eigen::Vector2d d = T_peer_robot * m.from_robot_m - m.landmark_m;
    if (d.squaredNorm() > radius_m * radius_m || m.ncc <= best[i]) continue;
    if (std::abs(wrap_angle(static_cast<double>(m.heading_rad) - T_peer_robot.theta_rad)) > 0.6) {
      continue;
    }
    const auto slot = static_cast<std::int16_t>(m.peer_slot);
    const auto taken = std::find(fix.peer_slot.begin(), fix.peer_slot.end(), slot);
    if (taken != fix.peer_slot.end()) {
      const auto other = static_cast<std::size_t>(taken - fix.peer_slot.begin());
      if (best[other] >= m.ncc) continue;
      *taken = -1;
      best[other] = -1.0F;
    }
    fix.peer_slot[i] = slot;
    best[i] = m.ncc;
  }
  return static_cast<int>(std::count_if(fix.peer_slot.begin(), fix.peer_slot.end(),
                                        [](std::int16_t s) { return s >= 0; }));
}

Pose2 fit_pairs(const OverlapMatches& matches, const PlaceFix& fix) {
  FixedVector<PointPair, kMaxCorners> pairs;
  for (const OverlapMatch& m : matches) {
    if (fix.peer_slot[static_cast<std::size_t>(m.observed)] != m.peer_slot) continue;
    PointPair pair;
    pair.a = m.landmark_m;
    pair.b = m.from_robot_m;
    pairs.push_back(pair);
  }
  return fit_rigid(pairs.span());
}

}  // namespace

void HoughSearch::layout(Arena& arena) {
  grid_ = arena.take<float>(static_cast<std::size_t>(kCells) * kCells);
}

void HoughSearch::vote(const OverlapMatch& match, double arc_rad) {
  const Eigen::Vector2d& z = match.from_robot_m;
  const Eigen::Vector2d& landmark = match.landmark_m;
  const double radius = z.norm();
  if (!is_within(radius, kFarthestSeen_m)) return;
  const double centre = bearing(z) + static_cast<double>(match.heading_rad) + std::numbers::pi;
  const double step = kCell_m / std::max(radius, kCell_m);
  const int steps = static_cast<int>(std::min(arc_rad, std::numbers::pi) / step);
  int last_x = -1;
  int last_y = -1;
  // From the landmark to the circle's point, in cells, turned on by `step` each time.
  const double scale = radius / kCell_m;
  Eigen::Vector2d to(scale * std::cos(centre - steps * step),
                     scale * std::sin(centre - steps * step));
  const double c = std::cos(step);
  const double s = std::sin(step);
  const Eigen::Vector2d from = landmark / kCell_m;
  for (int k = -steps; k <= steps; ++k) {
    const int x = static_cast<int>(std::floor(from.x() + to.x()));
    const int y = static_cast<int>(std::floor(from.y() + to.y()));
    to = {c * to.x() - s * to.y(), s * to.x() + c * to.y()};
    if (x == last_x && y == last_y) continue;
    cell(x, y) += match.weight;
    last_x = x;
    last_y = y;
  }
}

float HoughSearch::around(int x, int y) {
  float sum = 0.0F;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) sum += cell(x + dx, y + dy);
  }
  return sum;
}

// The best peaks of the grid, `apart` cells or more from each other.
void HoughSearch::find_peaks(int apart, Peaks& peaks) {
  constexpr int kAtOnce = 16;  // most cells are empty
  float least_votes = 0.0F;    // when `peaks` is full
  for (int y = 0; y < kCells; ++y) {
    const float* row = &cell(0, y);
    for (int begin = 0; begin < kCells; begin += kAtOnce) {
      float largest = 0.0F;
      for (int x = begin; x < begin + kAtOnce; ++x) largest = std::max(largest, row[x]);
      if (largest <= 0.0F) continue;
      for (int x = begin; x < begin + kAtOnce; ++x) {
        if (row[x] <= 0.0F) continue;
        const Peak peak = {x, y, around(x, y)};
        if (peak.votes <= least_votes) continue;
        note_peak(peak, apart, peaks);
        if (peaks.full()) least_votes = weakest(peaks)->votes;
      }
    }
  }
}

HoughSearch::Peak* HoughSearch::weakest(Peaks& peaks) {
  return std::min_element(peaks.begin(), peaks.end(),
                          [](const Peak& a, const Peak& b) { return a.votes < b.votes; });
}

void HoughSearch::note_peak(const Peak& peak, int apart, Peaks& peaks) {
  const auto near = std::find_if(peaks.begin(), peaks.end(), [&](const Peak& p) {
    const int dx = std::abs(p.x - peak.x);
    const int dy = std::abs(p.y - peak.y);
    return std::min(dx, kCells - dx) <= apart && std::min(dy, kCells - dy) <= apart;
  });
  if (near != peaks.end()) {
    if (peak.votes > near->votes) *near = peak;
  } else if (!peaks.push_back(peak)) {
    Peak* least = weakest(peaks);
    if (least->votes < peak.votes) *least = peak;
  }
}

void HoughSearch::find_places(const OverlapMatches& matches, const HoughSettings& settings,
                              PlaceFixes& out) {
  out.clear();
  if (matches.size() < static_cast<std::size_t>(settings.min_inliers)) return;
  std::fill(grid_.begin(), grid_.end(), 0.0F);
  for (const OverlapMatch& m : matches) vote(m, settings.arc_deg * kDegree);

  Peaks peaks;
  find_peaks(static_cast<int>(settings.peak_distance_m / kCell_m), peaks);
  for (const Peak& peak : peaks) {
    const Eigen::Vector2d place((peak.x + 0.5) * kCell_m, (peak.y + 0.5) * kCell_m);
    PlaceFix fix = fix_place(matches, settings, place, kCells * kCell_m);
    fix.votes = peak.votes;
    if (fix.inliers < settings.min_inliers) continue;
    auto* same = std::find_if(out.begin(), out.end(), [&fix](const PlaceFix& other) {
      return same_place(fix.T_peer_robot, other.T_peer_robot);
    });
    if (same != out.end()) {
      if (same->inliers < fix.inliers) *same = fix;
      continue;
    }
    if (out.push_back(fix)) continue;
    auto* least = std::min_element(
        out.begin(), out.end(), [](const auto& a, const auto& b) { return a.inliers < b.inliers; });
    if (least->inliers < fix.inliers) *least = fix;
  }
  std::sort(out.begin(), out.end(),
            [](const PlaceFix& a, const PlaceFix& b) { return a.inliers > b.inliers; });
}

PlaceFix fix_place(const OverlapMatches& matches, const HoughSettings& settings,
                   const Eigen::Vector2d& place, double period_m) {
  // The heading by vote, over the matches whose circle passes here.
  std::array<float, kHeadingBins> votes = {};
  std::array<Eigen::Vector2d, kHeadingBins> centre;
  centre.fill(Eigen::Vector2d::Zero());
  for (const OverlapMatch& m : matches) {
    const Eigen::Vector2d raw = m.landmark_m - place;
    const Eigen::Vector2d to = wrapped(raw, period_m);
    if (std::abs(to.norm() - m.from_robot_m.norm()) > settings.radius_m) continue;
    const auto told = static_cast<double>(m.heading_rad);
    const double seen = bearing(to) - bearing(m.from_robot_m);
    if (to.norm() > 0.5 && std::abs(wrap_angle(seen - told)) > settings.arc_deg * kDegree) continue;
    const double heading = to.norm() > 0.5 ? seen : told;
    const double turn = (wrap_angle(heading) / (2.0 * std::numbers::pi) + 0.5) * kHeadingBins;
    const auto bin = static_cast<std::size_t>(turn) % kHeadingBins;
    votes[bin] += m.weight;
    centre[bin] += static_cast<double>(m.weight) * (place + raw - to);
  }
  int best = -1;
  float best_votes = 0.0F;
  Eigen::Vector2d start = place;
  for (int b = 0; b < kHeadingBins; ++b) {
    float sum = 0.0F;
    Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
    for (int k = -1; k <= 1; ++k) {
      const auto bin = static_cast<std::size_t>((b + k + kHeadingBins) % kHeadingBins);
      sum += votes[bin];
      weighted += centre[bin];
    }
    if (sum > best_votes) {
      best_votes = sum;
      best = b;
      start = weighted / static_cast<double>(sum);
    }
  }
  PlaceFix fix;
  fix.peer_slot.fill(-1);
  if (best < 0) return fix;
  const double heading = ((best + 0.5) / kHeadingBins - 0.5) * 2.0 * std::numbers::pi;
  fix.T_peer_robot = {start.x(), start.y(), heading};
  double radius = 0.15 + 2.0 * settings.radius_m;
  for (int iteration = 0; iteration < 4; ++iteration) {
    fix.inliers = collect_pairs(matches, fix.T_peer_robot, radius, fix);
    if (fix.inliers < 3) return fix;
    fix.T_peer_robot = fit_pairs(matches, fix);
    radius = std::max(settings.inlier_m, 0.5 * radius);
  }
  fix.inliers = collect_pairs(matches, fix.T_peer_robot, settings.inlier_m, fix);
  return fix;
}

}  // namespace zenith
