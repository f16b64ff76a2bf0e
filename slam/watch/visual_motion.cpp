#include "slam/watch/visual_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/geometry.h"
#include "slam/image/ncc.h"

namespace zenith {
namespace {

// Where to look for a corner first: rotations of 14 degrees, and shifts of a quarter of the height;
// on ceilings that are plain or repeat themselves there is less to be mistaken for. Then anywhere.
constexpr float kNearShift = 0.25F;
constexpr float kNearTurn = 0.25F;
constexpr float kSimilarNear = 0.65F;
constexpr float kSimilar = 0.75F;
constexpr int kChoices = 2;  // corners that one may be, at most
constexpr int kMaxPairs = 64 * kChoices;
constexpr int kBins = 72;
constexpr double kBin_rad = 2.0 * std::numbers::pi / kBins;
constexpr double kAround_rad = 3.0 * kBin_rad;  // of the winning direction
constexpr double kNear = 0.08;                  // tangents: pairs that vote for each other
constexpr double kTiny = 0.15;                  // how much of its votes a shift of 1 costs
constexpr double kAsExpected = 0.1;             // tangents
constexpr double kAsMany = 0.6;                 // of the most votes
constexpr std::array<double, 4> kTolerances = {0.06, 0.035, 0.02, 0.02};
// Corners that must agree: fewer near, where accidents are rare.
constexpr int kLeastNear = 6;
constexpr int kLeast = 12;
constexpr double kLeastShare = 0.3;  // of the kept ones, anywhere
constexpr double kStands = 0.006;    // tangents, 0.6 pixels
constexpr double kMoves = 0.03;

struct Pair {
  Eigen::Vector2d before;
  Eigen::Vector2d after;
  double turned_rad = 0.0;  // of the patch
  int corner = 0;           // before
  double error = 0.0;
};
using Pairs = FixedVector<Pair, kMaxPairs>;

// For each kept corner the features that look most like it.
int find_pairs(const KeptCorners& before, std::span<const Feature> after, bool near, Pairs& pairs) {
  const auto dot = match_in_use().compact.dot;
  const float least = near ? kSimilarNear : kSimilar;
  pairs.clear();
  int matched = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const KeptCorner& corner = before[i];
    std::array<float, kChoices> best;
    std::array<int, kChoices> found;
    const float radius = kNearShift + kNearTurn * corner.z.norm();
    best.fill(least);
    found.fill(-1);
    for (std::size_t j = 0; j < after.size(); ++j) {
      const Eigen::Vector2f way(after[j].zx - corner.z.x(), after[j].zy - corner.z.y());
      if (near && way.squaredNorm() > radius * radius) continue;
      const CompactPatch& other = after[j].compact;
      const float ncc =
          static_cast<float>(dot(corner.appearance.values.data(), other.values.data())) *
          corner.appearance.inverse_norm * other.inverse_norm;
      if (!(ncc > best[kChoices - 1])) continue;
      int at = kChoices - 1;
      for (; at > 0 && ncc > best[at - 1]; --at) {
        best[at] = best[at - 1];
        found[at] = found[at - 1];
      }
      best[at] = ncc;
      found[at] = static_cast<int>(j);
    }
    matched += found[0] >= 0 ? 1 : 0;
    for (const int j : found) {
      if (j < 0) break;
      const Feature& f = after[static_cast<std::size_t>(j)];
      pairs.push_back({corner.z.cast<double>(),
                       {static_cast<double>(f.zx), static_cast<double>(f.zy)},
                       wrap_angle(static_cast<double>(f.orientation_rad - corner.direction_rad)),
                       static_cast<int>(i),
                       0.0});
    }
  }
  return matched;
}

// How far the image turned, by the patches.
double vote_rotation(const Pairs& pairs) {
  std::array<int, kBins> votes = {};
  for (const Pair& p : pairs) {
    const int bin = static_cast<int>(std::floor((p.turned_rad + std::numbers::pi) / kBin_rad));
    ++votes[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
  }
  int best = 0;
  int most = -1;
  for (int b = 0; b < kBins; ++b) {
    const int sum = votes[(b + kBins - 1) % kBins] + 2 * votes[b] + votes[(b + 1) % kBins];
    if (sum > most) {
      most = sum;
      best = b;
    }
  }
  const double centre = (best + 0.5) * kBin_rad - std::numbers::pi;
  double sum = 0.0;
  int count = 0;
  for (const Pair& p : pairs) {
    const double off = wrap_angle(p.turned_rad - centre);
    if (std::abs(off) > 1.5 * kBin_rad) continue;
    sum += off;
    ++count;
  }
  return centre + (count > 0 ? sum / count : 0.0);
}

// The image's shift for that rotation.
Eigen::Vector2d vote_shift(const Pairs& pairs, double rotation_rad,
                           const std::optional<Eigen::Vector2d>& expected) {
  const Eigen::Matrix2d R = rotation(rotation_rad);
  struct Peak {
    Eigen::Vector2d at;
    double score = 0.0;
  };
  FixedVector<Eigen::Vector2d, kMaxPairs> shifts;
  FixedVector<Peak, kMaxPairs> near_expected;
  for (const Pair& p : pairs) {
    if (std::abs(wrap_angle(p.turned_rad - rotation_rad)) > kAround_rad) continue;
    shifts.push_back(p.after - R * p.before);
  }
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double most = -1.0;
  for (const Eigen::Vector2d& s : shifts) {
    int votes = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& other : shifts) {
      if ((other - s).squaredNorm() > kNear * kNear) continue;
      ++votes;
      sum += other;
    }
    const double score = votes * (1.0 - kTiny * std::min(s.norm(), 2.0));
    if (expected && (sum / votes - *expected).norm() < kAsExpected) {
      near_expected.push_back({sum / votes, score});
    }
    if (score <= most) continue;
    most = score;
    best = sum / votes;
  }
  for (const Peak& peak : near_expected) {
    if (peak.score < kAsMany * most) continue;
    most = peak.score / kAsMany;
    best = peak.at;
  }
  return best;
}

struct Rigid {
  double rotation_rad = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
};

// Of each corner the pair with the smallest error, when that is small enough.
int choose(Pairs& pairs, const Rigid& rigid, double tolerance,
           std::array<bool, kMaxPairs>& chosen) {
  const Eigen::Matrix2d R = rotation(rigid.rotation_rad);
  chosen.fill(false);
  int count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].error = (pairs[i].after - R * pairs[i].before - rigid.shift).norm();
    if (pairs[i].error > tolerance) continue;
    if (i > 0 && chosen[i - 1] && pairs[i - 1].corner == pairs[i].corner) {
      if (pairs[i - 1].error <= pairs[i].error) continue;
      chosen[i - 1] = false;
      --count;
    }
    chosen[i] = true;
    ++count;
  }
  return count;
}

Rigid fit(const Pairs& pairs, const std::array<bool, kMaxPairs>& chosen, int count) {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen[i]) continue;
    a += pairs[i].before;
    b += pairs[i].after;
  }
  a /= count;
  b /= count;
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen[i]) continue;
    const Eigen::Vector2d p = pairs[i].before - a;
    const Eigen::Vector2d q = pairs[i].after - b;
    cosine += p.dot(q);
    sine += p.x() * q.y() - p.y() * q.x();
  }
  Rigid rigid;
  rigid.rotation_rad = std::atan2(sine, cosine);
  rigid.shift = b - rotation(rigid.rotation_rad) * a;
  return rigid;
}

// Corners that stay in their place although the motion would carry them away.
void count_standing(const Pairs& pairs, const Rigid& rigid, VisualMotion& motion) {
  const Eigen::Matrix2d R = rotation(rigid.rotation_rad);
  int last = -1;
  for (const Pair& p : pairs) {
    if (p.corner == last || (p.after - p.before).norm() > kStands) continue;
    if ((R * p.before + rigid.shift - p.before).norm() < kMoves) continue;
    last = p.corner;
    ++motion.standing;
    motion.standing_at += p.before;
  }
  if (motion.standing > 0) motion.standing_at /= motion.standing;
}

// The motion that most pairs agree on; without inliers when there is none.
Rigid find_motion(Pairs& pairs, int least, const std::optional<Eigen::Vector2d>& expected,
                  std::array<bool, kMaxPairs>& chosen, int& inliers) {
  Rigid rigid;
  inliers = 0;
  if (static_cast<int>(pairs.size()) < least) return rigid;
  rigid.rotation_rad = vote_rotation(pairs);
  rigid.shift = vote_shift(pairs, rigid.rotation_rad, expected);
  for (const double tolerance : kTolerances) {
    inliers = choose(pairs, rigid, tolerance, chosen);
    if (inliers < least) {
      inliers = 0;
      break;
    }
    rigid = fit(pairs, chosen, inliers);
  }
  return rigid;
}

bool stands(const Pair& p) {
  return (p.after - p.before).squaredNorm() <= kStands * kStands;
}

LensEvidence lens_evidence(const Pairs& pairs, const std::array<bool, kMaxPairs>& chosen,
                           const Rigid& rigid) {
  if (rigid.shift.norm() < kMoves) return {};
  const Eigen::Matrix2d R = rotation(rigid.rotation_rad);
  LensInterval interval(rigid.shift);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen[i]) continue;
    const Eigen::Vector2d turned = R * pairs[i].before;
    interval.add(0.5 * (turned + pairs[i].after), pairs[i].after - turned);
  }
  return interval.evidence();
}

double root_mean_square(const Pairs& pairs, const std::array<bool, kMaxPairs>& chosen, int count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (chosen[i]) sum += (pairs[i].after - pairs[i].before).squaredNorm();
  }
  return std::sqrt(sum / count);
}

}  // namespace

void keep_corners(std::span<const Feature> features, KeptCorners& out) {
  out.clear();
  for (const Feature& f : features) {
    if (!f.described || !(f.compact.inverse_norm > 0.0F)) continue;
    if (!out.push_back({{f.zx, f.zy}, f.orientation_rad, f.compact})) return;
  }
}

VisualMotion visual_motion(const KeptCorners& before, std::span<const Feature> after,
                           std::optional<Eigen::Vector2d> expected) {
  if (expected) expected = -*expected;  // the picture moves the other way
  VisualMotion motion;
  Pairs pairs;
  std::array<bool, kMaxPairs> chosen;
  Rigid rigid;
  for (const bool near : {true, false}) {
    motion.matches = find_pairs(before, after, near, pairs);
    const int share = static_cast<int>(kLeastShare * static_cast<double>(before.size()));
    const int least = near ? kLeastNear : std::max(kLeast, share);
    rigid = find_motion(pairs, least, expected, chosen, motion.inliers);
    if (motion.inliers > 0) break;
  }
  if (motion.inliers == 0) return motion;
  motion.share = static_cast<double>(motion.inliers) / static_cast<double>(before.size());
  motion.moved = root_mean_square(pairs, chosen, motion.inliers);
  if (motion.moved < kStands) {
    // What stands may be of the robot itself: whether there is something behind it that moves.
    Pairs others;
    for (const Pair& p : pairs) {
      const auto same = [&p](const Pair& other) {
        return other.corner == p.corner && stands(other);
      };
      if (std::none_of(pairs.begin(), pairs.end(), same)) others.push_back(p);
    }
    int inliers = 0;
    const Rigid second = find_motion(others, kLeastNear, {}, chosen, inliers);
    const double moved = inliers > 0 ? root_mean_square(others, chosen, inliers) : 0.0;
    if (moved > kMoves) {
      motion.inliers = inliers;
      motion.share = static_cast<double>(inliers) / static_cast<double>(others.size());
      motion.moved = moved;
      rigid = second;
    }
  } else {
    motion.lens = lens_evidence(pairs, chosen, rigid);
  }
  motion.known = true;
  motion.turn_rad = -rigid.rotation_rad;
  motion.shift = -(rotation(0.5 * motion.turn_rad) * rigid.shift);
  count_standing(pairs, rigid, motion);
  return motion;
}

}  // namespace zenith
