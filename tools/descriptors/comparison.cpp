#include "tools/descriptors/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "platform/base/random.h"
#include "slam/image/ncc.h"

namespace zenith::tools {
namespace {

constexpr float kStoredAnew = 0.85F;   // Parameters::ncc_new_appearance
constexpr double kNeighbour_m = 0.10;  // perhaps the same corner, counted twice: neither
constexpr double kTurned_rad = 0.6;    // AssociationSettings::max_turn_rad

// Looks by number in the sequence, grouped by landmark.
using Groups = std::vector<std::vector<int>>;

// Similarities of right and of wrong pairs, in bins of 0.001.
class Histogram {
 public:
  void add(float ncc) { ++bins_[bin(ncc)]; }
  double share_from(double threshold) const { return share(bin(static_cast<float>(threshold))); }
  // The highest bin from which upwards at least `wanted` of all lie.
  std::size_t bin_for(double wanted) const {
    std::size_t b = bins_.size() - 1;
    while (b > 0 && share(b) < wanted) --b;
    return b;
  }
  double share(std::size_t first_bin) const {
    std::uint64_t all = 0;
    std::uint64_t above = 0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      all += bins_[b];
      if (b >= first_bin) above += bins_[b];
    }
    return all == 0 ? 0.0 : static_cast<double>(above) / static_cast<double>(all);
  }

 private:
  static std::size_t bin(float ncc) {
    return static_cast<std::size_t>(std::clamp(std::floor((ncc + 1.0F) * 1000.0F), 0.0F, 2000.0F));
  }
  std::array<std::uint64_t, 2001> bins_ = {};
};

struct Tally {
  Histogram right;
  Histogram wrong;
  int recognised = 0;
};

struct Trial {
  const LookSequence& sequence;
  const ComparisonSettings& settings;
  Groups stored;  // of the one robot
  std::vector<int> queries;
};

const Look& look_at(const LookSequence& sequence, int number) {
  return sequence.looks[static_cast<std::size_t>(number)];
}

bool apart(const Look& a, const Look& b, const LookSequence& sequence,
           const ComparisonSettings& settings) {
  if (sequence.synthetic) return a.frame != b.frame;
  const Pose2& p = a.T_world_robot;
  const Pose2& q = b.T_world_robot;
  return (p.position() - q.position()).norm() >= settings.apart_m ||
         std::abs(wrap_angle(p.theta_rad - q.theta_rad)) >= settings.apart_rad;
}

Groups group(const LookSequence& sequence, int robot) {
  Groups groups(sequence.places_m.size());
  for (std::size_t i = 0; i < sequence.looks.size(); ++i) {
    const Look& look = sequence.looks[i];
    if (look.robot != robot) continue;
    groups[static_cast<std::size_t>(look.landmark)].push_back(static_cast<int>(i));
  }
  return groups;
}

// What a map would keep: a look that none of the stored ones resembles.
std::vector<int> choose_stored(const LookSequence& sequence, const std::vector<int>& looks,
                               int at_most) {
  std::vector<int> stored;
  for (const int i : looks) {
    if (static_cast<int>(stored.size()) == at_most) break;
    const bool known = std::any_of(stored.begin(), stored.end(), [&](int s) {
      return ncc(look_at(sequence, i).patch, look_at(sequence, s).patch) >= kStoredAnew;
    });
    if (!known) stored.push_back(i);
  }
  return stored;
}

Trial make_trial(const LookSequence& sequence, const ComparisonSettings& settings, int store_robot,
                 int query_robot) {
  Trial trial = {sequence, settings, group(sequence, store_robot), {}};
  for (auto& looks : trial.stored) looks = choose_stored(sequence, looks, settings.stored_looks);
  Random random(settings.seed, static_cast<std::uint64_t>(16 * store_robot + query_robot));
  for (std::vector<int>& looks : group(sequence, query_robot)) {
    if (looks.empty()) continue;
    const auto landmark = static_cast<std::size_t>(look_at(sequence, looks[0]).landmark);
    std::erase_if(looks, [&](int i) {
      const auto& stored = trial.stored[landmark];
      return std::none_of(stored.begin(), stored.end(), [&](int s) {
        return apart(look_at(sequence, i), look_at(sequence, s), sequence, settings);
      });
    });
    for (int k = 0; k < settings.queries && !looks.empty(); ++k) {
      const auto chosen = random.below(static_cast<std::uint32_t>(looks.size()));
      trial.queries.push_back(looks[chosen]);
      looks.erase(looks.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
  }
  return trial;
}

// All looks of the sequence as queries and as stored ones.
struct Described {
  std::vector<Descriptor> query;
  std::vector<Descriptor> stored;
};

Described describe_all(const LookSequence& sequence, const DescriptorKind& kind) {
  Described out;
  for (const Look& look : sequence.looks) {
    out.query.push_back(describe(look.patch, kind.length));
    out.stored.push_back(kind.sent ? sent(out.query.back()) : out.query.back());
  }
  return out;
}

void run_query(const Trial& trial, int query, const Described& described, Tally& tally) {
  const Look& look = look_at(trial.sequence, query);
  const Descriptor& mine = described.query[static_cast<std::size_t>(query)];
  const Eigen::Vector3d& place = trial.sequence.places_m[static_cast<std::size_t>(look.landmark)];
  float right = -1.0F;
  float wrong = -1.0F;
  for (std::size_t l = 0; l < trial.stored.size(); ++l) {
    const bool own = static_cast<int>(l) == look.landmark;
    if (!own && (trial.sequence.places_m[l] - place).norm() < kNeighbour_m) continue;
    float best = -2.0F;
    for (const int s : trial.stored[l]) {
      if (own && !apart(look, look_at(trial.sequence, s), trial.sequence, trial.settings)) continue;
      best = std::max(best, similarity(mine, described.stored[static_cast<std::size_t>(s)]));
    }
    if (best < -1.5F) continue;
    (own ? tally.right : tally.wrong).add(best);
    (own ? right : wrong) = std::max(own ? right : wrong, best);
  }
  tally.recognised += right > wrong ? 1 : 0;
}

bool is_turned(const Trial& trial, int query) {
  const Look& look = look_at(trial.sequence, query);
  const auto& stored = trial.stored[static_cast<std::size_t>(look.landmark)];
  return std::all_of(stored.begin(), stored.end(), [&](int s) {
    const Look& other = look_at(trial.sequence, s);
    if (!apart(look, other, trial.sequence, trial.settings)) return true;
    const auto turn = static_cast<double>(look.direction_rad - other.direction_rad);
    return std::abs(wrap_angle(turn)) > kTurned_rad;
  });
}

Comparison run_trials(const LookSequence& sequence, const ComparisonSettings& settings,
                      const std::vector<Trial>& trials, const char* views) {
  Comparison out{sequence.name, views, 0, 0, 0.0, {}};
  for (const Trial& trial : trials) {
    const auto landmarks = std::count_if(trial.stored.begin(), trial.stored.end(),
                                         [](const auto& looks) { return !looks.empty(); });
    out.landmarks = std::max(out.landmarks, static_cast<int>(landmarks));
    out.queries += static_cast<int>(trial.queries.size());
    for (const int query : trial.queries) out.turned += is_turned(trial, query) ? 1.0 : 0.0;
  }
  if (out.queries == 0) return out;
  out.turned /= out.queries;
  for (const DescriptorKind& kind : kComparedKinds) {
    const Described described = describe_all(sequence, kind);
    Tally tally;
    for (const Trial& trial : trials) {
      for (const int query : trial.queries) run_query(trial, query, described, tally);
    }
    out.scores.push_back({kind, static_cast<double>(tally.recognised) / out.queries,
                          tally.right.share_from(settings.threshold),
                          tally.wrong.share_from(settings.threshold),
                          tally.wrong.share(tally.right.bin_for(0.8))});
  }
  return out;
}

}  // namespace

std::vector<Comparison> compare_descriptors(const LookSequence& sequence,
                                            const ComparisonSettings& settings) {
  std::vector<Trial> same;
  std::vector<Trial> other;
  for (int a = 0; a < sequence.robots; ++a) {
    for (int b = 0; b < sequence.robots; ++b) {
      if (sequence.synthetic && (a != 0 || b != 1)) continue;
      (a == b ? same : other).push_back(make_trial(sequence, settings, a, b));
    }
  }
  std::vector<Comparison> out;
  if (!same.empty()) out.push_back(run_trials(sequence, settings, same, "same robot"));
  if (!other.empty()) {
    const char* views = sequence.synthetic ? "seen again" : "other robot";
    out.push_back(run_trials(sequence, settings, other, views));
  }
  return out;
}

}  // namespace zenith::tools
